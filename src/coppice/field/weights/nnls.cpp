#include "coppice/field/weights/nnls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/field/weights/normal_equations_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kNnlsGrain = 1024;
constexpr double kTiny = 1e-11;    // relative magnitude below which a wrong sign is a rounding error
constexpr double kOptimal = 1e-8;  // maximum violation at convergence
// Maximum step of the descent at convergence, relative to the largest unknown.
constexpr double kSettled = 1e-13;

void check(const SparseRows& a, std::span<const double> b, const NnlsOptions& options) {
    check_fields(options, "nnls");
    if (b.size() != a.rows())
        throw InvalidInput(fmt::format("nnls: the matrix has {} rows, but the right-hand side has {} numbers",
                                       a.rows(), b.size()));
    COPPICE_ASSERT(a.first.back() == a.value.size() && a.column.size() == a.value.size());
    std::vector<std::uint64_t> last_row(a.columns, 0);  // row index + 1
    for (std::size_t j = 0; j < a.rows(); ++j) {
        for (std::uint64_t e = a.first[j]; e < a.first[j + 1]; ++e) {
            COPPICE_ASSERT(a.column[e] < a.columns && last_row[a.column[e]] != j + 1);
            last_row[a.column[e]] = j + 1;
            if (!std::isfinite(a.value[e]))
                throw InvalidInput(fmt::format("nnls: row {} of the matrix is not finite", j + 1));
        }
    }
    for (const double v : b)
        if (!std::isfinite(v)) throw InvalidInput("nnls: a number of the right-hand side is not finite");
}

double norm(std::span<const double> v) {
    double largest = 0, sum = 0;  // scaled, so that squares do not overflow
    for (const double x : v) largest = std::max(largest, std::abs(x));
    if (largest == 0) return 0;
    for (const double x : v) sum += (x / largest) * (x / largest);
    return largest * std::sqrt(sum);
}

/// Returns the columns, scaled to length 1; columns of length 0 remain 0.
ScaledColumns scaled_columns(const SparseRows& a, const Context& ctx) {
    ScaledColumns s;
    s.rows = a.rows();
    s.first.assign(a.columns + std::size_t{1}, 0);
    s.row.resize(a.entries());
    s.value.resize(a.entries());
    s.length.assign(a.columns, 0);
    for (const std::uint32_t c : a.column) ++s.first[c];
    exclusive_scan(std::span(s.first));
    for (std::size_t j = 0; j < a.rows(); ++j) {
        for (std::uint64_t e = a.first[j]; e < a.first[j + 1]; ++e) {
            const std::uint64_t at = s.first[a.column[e]]++;
            s.row[at] = static_cast<std::uint32_t>(j);
            s.value[at] = a.value[e];
        }
    }
    std::rotate(s.first.begin(), s.first.end() - 1, s.first.end());
    s.first[0] = 0;
    parallel_for(ctx, a.columns, kNnlsGrain, [&](std::size_t i) {
        const auto column = std::span(s.value).subspan(s.first[i], s.first[i + 1] - s.first[i]);
        s.length[i] = norm(column);
        if (s.length[i] > 0)
            for (double& v : column) v /= s.length[i];
    });
    return s;
}

double column_times(const ScaledColumns& a, std::size_t i, std::span<const double> r) {
    double sum = 0;
    for (std::uint64_t e = a.first[i]; e < a.first[i + 1]; ++e) sum += a.value[e] * r[a.row[e]];
    return sum;
}

void add_column(const ScaledColumns& a, std::size_t i, double factor, std::span<double> r) {
    for (std::uint64_t e = a.first[i]; e < a.first[i + 1]; ++e) r[a.row[e]] += factor * a.value[e];
}

std::vector<double> residual(const ScaledColumns& a, std::span<const double> z, std::span<const double> b) {
    std::vector<double> r(b.size());
    for (std::size_t j = 0; j < b.size(); ++j) r[j] = -b[j];
    for (std::size_t i = 0; i < z.size(); ++i)
        if (z[i] != 0) add_column(a, i, z[i], r);
    return r;
}

double violation(const ScaledColumns& a, std::span<const double> z, std::span<const double> b,
                 const Context& ctx) {
    const std::vector<double> r = residual(a, z, b);
    return parallel_reduce<double>(
        ctx, z.size(), kNnlsGrain, 0.0,
        [&](IndexRange range) {
            double worst = 0;
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const double g = column_times(a, i, r);
                worst = std::max(worst, z[i] > 0 ? std::abs(g) : -g);
            }
            return worst;
        },
        [](double x, double y) { return std::max(x, y); });
}

/// Searches for the set of unknowns with a solution that satisfies all conditions, starting with all of them,
/// because the weights of a tree are almost all positive. Stores the final solution in z.
void pivot(NormalEquations& system, std::vector<double>& z, int max_pivots, int& pivots, const Context& ctx) {
    constexpr int kMaxStalledSweeps = 3;
    const std::size_t n = z.size();
    std::vector<std::uint8_t> passive(n, 1);
    std::vector<double> gradient(n);
    std::vector<std::uint32_t> wrong;
    std::size_t fewest = n + 1;
    int stalled_sweeps_left = kMaxStalledSweeps;
    while (pivots < max_pivots) {
        ctx.throw_if_cancelled();
        ++pivots;
        if (!system.solve(passive, z, gradient)) return;
        double largest = 1;
        for (const double v : z) largest = std::max(largest, std::abs(v));
        wrong.clear();
        for (std::uint32_t i = 0; i < n; ++i)
            if ((passive[i] ? z[i] : gradient[i]) < -kTiny * largest) wrong.push_back(i);
        if (wrong.empty()) return;
        if (wrong.size() < fewest) {
            fewest = wrong.size();
            stalled_sweeps_left = kMaxStalledSweeps;
        } else if (stalled_sweeps_left-- <= 0) {
            // One at a time, always the last one: this cannot return to a previous set.
            wrong.erase(wrong.begin(), wrong.end() - 1);
        }
        for (const std::uint32_t i : wrong) passive[i] ^= 1;
    }
}

/// Sets one unknown at a time to its optimal value [Franc2005]: keeps x >= 0, and never increases the
/// residual.
int descend(const ScaledColumns& a, std::span<double> z, std::span<const double> b, int max_sweeps,
            const Context& ctx) {
    std::vector<double> r = residual(a, z, b);
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
        ctx.throw_if_cancelled();
        double largest = 0, step = 0;
        for (std::size_t i = 0; i < z.size(); ++i) {
            if (a.length[i] == 0) continue;
            const double better = std::max(0.0, z[i] - column_times(a, i, r));
            if (better != z[i]) add_column(a, i, better - z[i], r);
            step = std::max(step, std::abs(better - z[i]));
            largest = std::max(largest, better);
            z[i] = better;
        }
        if (step <= kSettled * largest) return sweep + 1;
    }
    return max_sweeps;
}

}  // namespace

std::vector<double> product(const SparseRows& a, std::span<const double> x, const Context& ctx) {
    COPPICE_ASSERT(x.size() == a.columns);
    std::vector<double> sum(a.rows());
    parallel_for(ctx, a.rows(), kNnlsGrain, [&](std::size_t j) {
        double s = 0;
        for (std::uint64_t e = a.first[j]; e < a.first[j + 1]; ++e) s += a.value[e] * x[a.column[e]];
        sum[j] = s;
    });
    return sum;
}

NnlsResult nnls(const SparseRows& a, std::span<const double> b, const NnlsOptions& options,
                const Context& ctx) {
    check(a, b, options);
    NnlsResult out;
    out.x.assign(a.columns, 0.0);
    const double size = norm(b);
    if (a.columns == 0 || size == 0) {
        out.converged = true;
        return out;
    }
    std::vector<double> unit(b.begin(), b.end());
    for (double& v : unit) v /= size;
    const ScaledColumns columns = scaled_columns(a, ctx);

    std::vector<double> z(a.columns, 0.0);
    if (options.max_pivots > 0) {
        if (const auto system = normal_equations(a, columns, unit, ctx)) {
            pivot(*system, z, options.max_pivots, out.pivots, ctx);
            for (double& v : z) v = std::isfinite(v) ? std::max(v, 0.0) : 0.0;
        }
    }
    out.violation = violation(columns, z, unit, ctx);
    if (!(out.violation <= kOptimal)) {
        out.sweeps = descend(columns, z, unit, options.max_sweeps, ctx);
        out.violation = violation(columns, z, unit, ctx);
    }
    out.converged = out.violation <= kOptimal;
    for (std::size_t i = 0; i < z.size(); ++i)
        if (columns.length[i] > 0) out.x[i] = z[i] * (size / columns.length[i]);
    return out;
}

void list_fields(NnlsOptions& o, FieldList& list) {
    list.add(Field{"max_pivots", "Maximum number of exchanges of sets before coordinate descent starts.",
                   Unit::none, 0, 1e6},
             o.max_pivots);
    list.add(Field{"max_sweeps", "Maximum number of sweeps of coordinate descent.", Unit::none, 0, 1e6},
             o.max_sweeps);
}

}  // namespace coppice
