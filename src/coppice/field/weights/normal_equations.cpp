#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <limits>

#include "coppice/base/parallel.h"
#include "coppice/field/weights/normal_equations_internal.h"

namespace coppice {
namespace {

using Eigen::Index;
using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr std::size_t kColumnGrain = 64;
constexpr std::size_t kMaxDense = 4096;    // maximum number of unknowns: 134 MB
constexpr double kDenseEnough = 0.25;      // minimum share of all pairs of columns for a dense matrix
constexpr double kMaxProducts = 4.3e9;     // maximum number for a factorization
constexpr double kMaxGramProducts = 1e11;  // maximum number for a dense matrix, computed once
constexpr std::uint64_t kMaxPairs = std::uint64_t{1} << 30;    // pairs of entries in a row
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 25;  // maximum number of entries of the sparse G
constexpr std::uint64_t kMaxFill = std::uint64_t{1} << 26;     // maximum number of entries of its factors

// G has a diagonal of 1. This additional diagonal makes it definite for all columns, and kRounds of iterative
// refinement with the residual of the right-hand side remove its effect if columns are independent.
constexpr double kDamping = 1e-10;
constexpr int kRounds = 3;

Eigen::VectorXd right_side(const ScaledColumns& a, std::span<const double> b) {
    Eigen::VectorXd h = Eigen::VectorXd::Zero(static_cast<Index>(a.columns()));
    for (std::size_t i = 0; i < a.columns(); ++i)
        for (std::uint64_t e = a.first[i]; e < a.first[i + 1]; ++e)
            h[static_cast<Index>(i)] += a.value[e] * b[a.row[e]];
    return h;
}

class DenseEquations final : public NormalEquations {
  public:
    DenseEquations(const ScaledColumns& a, std::span<const double> b, const Context& ctx)
        : h_(right_side(a, b)) {
        const auto n = static_cast<Index>(a.columns());
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(static_cast<Index>(a.rows), n);
        parallel_for(ctx, a.columns(), kColumnGrain, [&](std::size_t i) {
            for (std::uint64_t e = a.first[i]; e < a.first[i + 1]; ++e)
                dense(static_cast<Index>(a.row[e]), static_cast<Index>(i)) += a.value[e];
        });
        g_.resize(n, n);
        parallel_for_ranges(ctx, a.columns(), kColumnGrain, [&](IndexRange range) {
            const auto begin = static_cast<Index>(range.begin), count = static_cast<Index>(range.size());
            const Index end = begin + count;
            g_.block(0, begin, end, count).noalias() =
                dense.leftCols(end).transpose() * dense.middleCols(begin, count);
        });
        g_.triangularView<Eigen::StrictlyLower>() = g_.transpose();
    }

    bool solve(std::span<const std::uint8_t> passive, std::span<double> z,
               std::span<double> gradient) override {
        std::vector<Index> chosen;
        for (std::size_t i = 0; i < passive.size(); ++i)
            if (passive[i]) chosen.push_back(static_cast<Index>(i));
        const Eigen::MatrixXd part = g_(chosen, chosen);
        const Eigen::VectorXd h = h_(chosen);
        const auto k = static_cast<Index>(chosen.size());
        Eigen::VectorXd x = Eigen::VectorXd::Zero(k);
        Eigen::MatrixXd damped = part;
        damped.diagonal().array() += kDamping;
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(damped);
        if (factors.info() != Eigen::Success) return false;
        for (int round = 0; round < kRounds; ++round) x += factors.solve(h - part * x);

        Eigen::Map<Eigen::VectorXd> all(z.data(), static_cast<Index>(z.size()));
        Eigen::Map<Eigen::VectorXd> g(gradient.data(), static_cast<Index>(gradient.size()));
        all.setZero();
        all(chosen) = x;
        g = g_ * all - h_;
        g(chosen).setZero();
        return x.allFinite();
    }

  private:
    Eigen::MatrixXd g_;
    Eigen::VectorXd h_;
};

/// Returns the number of products of pairs in the same row; an upper bound for the entries of G.
std::uint64_t pair_count(const SparseRows& a) {
    std::uint64_t sum = 0;
    for (std::size_t j = 0; j < a.rows() && sum <= kMaxPairs; ++j) {
        const std::uint64_t k = std::min(a.first[j + 1] - a.first[j], kMaxPairs);
        sum += k * k;
    }
    return sum;
}

/// Calls visit(k, a_ji scaled, a_jk) for column i and all entries of the rows that contain it.
template <class Visit>
void for_each_pair(const SparseRows& rows, const ScaledColumns& a, std::size_t i, const Visit& visit) {
    for (std::uint64_t e = a.first[i]; e < a.first[i + 1]; ++e) {
        const std::uint32_t j = a.row[e];
        for (std::uint64_t f = rows.first[j]; f < rows.first[j + 1]; ++f)
            visit(rows.column[f], a.value[e], rows.value[f]);
    }
}

/// Marks of visited columns, one set per range, so that ranges share no data.
class Marks {
  public:
    explicit Marks(std::size_t n) : mark_(n, std::numeric_limits<std::uint32_t>::max()) {}
    bool set(std::uint32_t k, std::uint32_t owner) {
        if (mark_[k] == owner) return false;
        mark_[k] = owner;
        return true;
    }

  private:
    std::vector<std::uint32_t> mark_;
};

std::size_t gram_grain(std::size_t n) { return std::max<std::size_t>(256, n / 16); }

/// Computes the number of entries of G by column, then their offsets: first[n] is the total.
std::vector<std::uint64_t> gram_places(const SparseRows& rows, const ScaledColumns& a, const Context& ctx) {
    const std::size_t n = a.columns();
    std::vector<std::uint64_t> first(n + 1, 0);
    parallel_for_ranges(ctx, n, gram_grain(n), [&](IndexRange range) {
        Marks marks(n);
        for (std::size_t i = range.begin; i < range.end; ++i)
            for_each_pair(rows, a, i, [&](std::uint32_t k, double, double) {
                if (marks.set(k, static_cast<std::uint32_t>(i))) ++first[i];
            });
    });
    exclusive_scan(std::span(first));
    return first;
}

SparseMatrix gram(const SparseRows& rows, const ScaledColumns& a, std::span<const std::uint64_t> first,
                  const Context& ctx) {
    const std::size_t n = a.columns();
    SparseMatrix g(static_cast<Index>(n), static_cast<Index>(n));
    g.resizeNonZeros(static_cast<Index>(first[n]));
    std::transform(first.begin(), first.end(), g.outerIndexPtr(),
                   [](std::uint64_t f) { return static_cast<int>(f); });
    parallel_for_ranges(ctx, n, gram_grain(n), [&](IndexRange range) {
        Marks marks(n);
        std::vector<double> sum(n);
        for (std::size_t i = range.begin; i < range.end; ++i) {
            int* const row = g.innerIndexPtr() + first[i];
            std::size_t count = 0;
            for_each_pair(rows, a, i, [&](std::uint32_t k, double own, double other) {
                if (marks.set(k, static_cast<std::uint32_t>(i))) {
                    row[count++] = static_cast<int>(k);
                    sum[k] = 0;
                }
                sum[k] += own * other;
            });
            std::sort(row, row + count);
            for (std::size_t c = 0; c < count; ++c) {
                const auto k = static_cast<std::size_t>(row[c]);
                g.valuePtr()[first[i] + c] = a.length[k] > 0 ? sum[k] / a.length[k] : 0;
            }
        }
    });
    return g;
}

/// Returns whether the factors of a matrix, given by its upper triangle, are within the limits. Follows the
/// elimination tree [Liu1990] without storing the factors.
bool factors_fit(const SparseMatrix& upper) {
    const auto n = static_cast<std::size_t>(upper.cols());
    std::vector<std::size_t> parent(n, n), seen(n), count(n, 1);
    std::uint64_t total = n;
    for (std::size_t k = 0; k < n; ++k) {
        seen[k] = k;
        for (SparseMatrix::InnerIterator it(upper, static_cast<Index>(k)); it; ++it) {
            for (auto i = static_cast<std::size_t>(it.row()); i < k && seen[i] != k; i = parent[i]) {
                if (parent[i] == n) parent[i] = k;
                seen[i] = k;
                ++count[i];
                if (++total > kMaxFill) return false;
            }
        }
    }
    double products = 0;
    for (const std::size_t c : count) products += static_cast<double>(c) * static_cast<double>(c);
    return products <= kMaxProducts;
}

/// Sparse equations in minimum-degree order.
class SparseEquations final : public NormalEquations {
  public:
    SparseEquations(const SparseMatrix& g, const Eigen::VectorXd& h) {
        Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
        Eigen::AMDOrdering<int>()(g.selfadjointView<Eigen::Lower>(), inverse);
        order_ = inverse.inverse();
        upper_.resize(g.rows(), g.cols());
        upper_.selfadjointView<Eigen::Upper>() = g.selfadjointView<Eigen::Upper>().twistedBy(order_);
        // Products with half a matrix require sorted columns, which twistedBy() does not provide.
        upper_ = SparseMatrix(SparseMatrix(upper_.transpose()).transpose());
        h_ = order_ * h;
    }

    bool fits() const { return factors_fit(upper_); }

    void analyze() {
        masked_ = upper_;
        solver_.setShift(kDamping);
        solver_.analyzePattern(masked_);
    }

    bool solve(std::span<const std::uint8_t> passive, std::span<double> z,
               std::span<double> gradient) override {
        mask(passive);
        solver_.factorize(masked_);
        if (solver_.info() != Eigen::Success) return false;
        const Index n = h_.size();
        Eigen::VectorXd x = Eigen::VectorXd::Zero(n), rest = h_;
        for (int round = 0; round < kRounds; ++round) {
            hold(rest);
            x += solver_.solve(rest);
            rest = h_ - upper_.selfadjointView<Eigen::Upper>() * x;
        }
        for (Index i = 0; i < n; ++i) {
            const auto place = static_cast<std::size_t>(order_.indices()[i]);
            z[static_cast<std::size_t>(i)] = x[static_cast<Index>(place)];
            gradient[static_cast<std::size_t>(i)] =
                passive[static_cast<std::size_t>(i)] ? 0 : -rest[static_cast<Index>(place)];
        }
        return x.allFinite();
    }

  private:
    /// Replaces rows and columns of unknowns fixed at 0 by those of the identity; the pattern is unchanged.
    void mask(std::span<const std::uint8_t> passive) {
        free_.assign(passive.size(), 0);
        for (std::size_t i = 0; i < passive.size(); ++i)
            free_[static_cast<std::size_t>(order_.indices()[static_cast<Index>(i)])] = passive[i];
        for (Index k = 0; k < upper_.cols(); ++k) {
            SparseMatrix::InnerIterator to(masked_, k);
            for (SparseMatrix::InnerIterator from(upper_, k); from; ++from, ++to) {
                const auto i = from.row();
                const bool both = free_[static_cast<std::size_t>(i)] && free_[static_cast<std::size_t>(k)];
                to.valueRef() = both ? from.value() : i == k ? 1.0 : 0.0;
            }
        }
    }

    void hold(Eigen::VectorXd& v) const {
        for (Index i = 0; i < v.size(); ++i)
            if (!free_[static_cast<std::size_t>(i)]) v[i] = 0;
    }

    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;
    SparseMatrix upper_, masked_;
    Eigen::VectorXd h_;
    std::vector<std::uint8_t> free_;
    Eigen::SimplicialLDLT<SparseMatrix, Eigen::Upper, Eigen::NaturalOrdering<int>> solver_;
};

std::unique_ptr<NormalEquations> dense_equations(const ScaledColumns& a, std::span<const double> b,
                                                 const Context& ctx) {
    const auto n = static_cast<double>(a.columns());
    if (a.columns() > kMaxDense || n * n * static_cast<double>(a.rows) > kMaxGramProducts) return nullptr;
    return std::make_unique<DenseEquations>(a, b, ctx);
}

}  // namespace

std::unique_ptr<NormalEquations> normal_equations(const SparseRows& rows, const ScaledColumns& columns,
                                                  std::span<const double> b, const Context& ctx) {
    const auto n = static_cast<double>(columns.columns());
    const double all = n * static_cast<double>(columns.rows);
    if (static_cast<double>(rows.entries()) > kDenseEnough * all) return dense_equations(columns, b, ctx);
    if (columns.columns() > kMaxEntries || pair_count(rows) > kMaxPairs) return nullptr;
    const std::vector<std::uint64_t> first = gram_places(rows, columns, ctx);
    if (static_cast<double>(first.back()) > kDenseEnough * n * n && columns.columns() <= kMaxDense)
        return dense_equations(columns, b, ctx);
    if (first.back() > kMaxEntries) return nullptr;
    auto sparse = std::make_unique<SparseEquations>(gram(rows, columns, first, ctx), right_side(columns, b));
    if (!sparse->fits()) return nullptr;
    sparse->analyze();
    return sparse;
}

}  // namespace coppice
