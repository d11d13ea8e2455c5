#include "coppice/field/weights/nnls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/random.h"

namespace coppice {
namespace {

SparseRows make_rows(std::size_t rows, std::uint32_t columns,
                     const std::function<double(std::size_t, std::uint32_t)>& entry) {
    SparseRows a;
    a.columns = columns;
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double v = entry(j, i);
            if (v == 0) continue;
            a.column.push_back(i);
            a.value.push_back(v);
        }
        a.first.push_back(a.value.size());
    }
    return a;
}

/// Each entry exists with probability `fill`; values in [low, 1).
SparseRows random_rows(std::size_t rows, std::uint32_t columns, double fill, double low, std::uint64_t seed) {
    const CounterRandom there(seed, 1), value(seed, 2);
    return make_rows(rows, columns, [&](std::size_t j, std::uint32_t i) {
        const std::uint64_t at = j * columns + i;
        return there.uniform(at) < fill ? value.uniform(at, low, 1) : 0.0;
    });
}

/// Rows with a few adjacent columns, as for points on a long branch.
SparseRows chain_rows(std::size_t columns, std::size_t per_column, std::uint64_t seed) {
    const CounterRandom value(seed, 3);
    SparseRows a;
    a.columns = static_cast<std::uint32_t>(columns);
    for (std::size_t j = 0; j < columns * per_column; ++j) {
        const std::size_t middle = j / per_column;
        for (std::size_t i = middle > 1 ? middle - 2 : 0; i < std::min(columns, middle + 3); ++i) {
            a.column.push_back(static_cast<std::uint32_t>(i));
            a.value.push_back(value.uniform(8 * j + (i + 2 - middle), -0.2, 1));
        }
        a.first.push_back(a.value.size());
    }
    return a;
}

std::vector<double> random_vector(std::size_t n, double low, double high, std::uint64_t seed) {
    const CounterRandom random(seed, 4);
    std::vector<double> b(n);
    for (std::size_t i = 0; i < n; ++i) b[i] = random.uniform(i, low, high);
    return b;
}

double objective(const SparseRows& a, std::span<const double> x, std::span<const double> b) {
    double sum = 0;
    const std::vector<double> ax = product(a, x);
    for (std::size_t j = 0; j < b.size(); ++j) sum += (ax[j] - b[j]) * (ax[j] - b[j]);
    return sum;
}

/// x >= 0; A^T (A x - b) is 0 where x > 0, and >= 0 elsewhere.
void expect_optimal(const SparseRows& a, std::span<const double> b, std::span<const double> x,
                    double tolerance) {
    std::vector<double> g(a.columns, 0.0), length(a.columns, 0.0);
    const std::vector<double> ax = product(a, x);
    double size = 0;
    for (std::size_t j = 0; j < a.rows(); ++j) {
        size += b[j] * b[j];
        for (std::uint64_t e = a.first[j]; e < a.first[j + 1]; ++e) {
            g[a.column[e]] += a.value[e] * (ax[j] - b[j]);
            length[a.column[e]] += a.value[e] * a.value[e];
        }
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double scale = tolerance * std::sqrt(length[i] * size);
        EXPECT_GE(x[i], 0) << i;
        EXPECT_GE(g[i], -scale) << i;
        if (x[i] > 0) {
            EXPECT_LE(g[i], scale) << i;
        }
    }
}

/// Gauss-Jordan elimination with pivoting on the normal equations of the columns in `set`; empty if they are
/// linearly dependent.
std::vector<double> least_squares(const SparseRows& a, std::span<const double> b, unsigned set) {
    const std::size_t n = a.columns;
    std::vector<std::vector<double>> m(n, std::vector<double>(n + 1, 0.0));
    for (std::size_t j = 0; j < a.rows(); ++j) {
        for (std::uint64_t e = a.first[j]; e < a.first[j + 1]; ++e) {
            for (std::uint64_t f = a.first[j]; f < a.first[j + 1]; ++f)
                m[a.column[e]][a.column[f]] += a.value[e] * a.value[f];
            m[a.column[e]][n] += a.value[e] * b[j];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (set >> i & 1) continue;
        for (std::size_t k = 0; k < n; ++k) m[i][k] = m[k][i] = 0;
        m[i][i] = 1;
        m[i][n] = 0;
    }
    for (std::size_t i = 0; i < n; ++i) {
        std::size_t best = i;
        for (std::size_t k = i; k < n; ++k)
            if (std::abs(m[k][i]) > std::abs(m[best][i])) best = k;
        std::swap(m[i], m[best]);
        if (std::abs(m[i][i]) < 1e-9) return {};
        for (std::size_t k = 0; k < n; ++k) {
            if (k == i) continue;
            const double factor = m[k][i] / m[i][i];
            for (std::size_t c = i; c <= n; ++c) m[k][c] -= factor * m[i][c];
        }
    }
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = m[i][n] / m[i][i];
    return x;
}

TEST(Nnls, SolvesTwoUnknowns) {
    // A = [1 1; 0 1]: with b = (1, 2) both are free: x2 = 2, x1 = -1 < 0, so x1 = 0 and x2 = (1 + 2) / 2.
    const SparseRows a = make_rows(2, 2, [](std::size_t j, std::uint32_t i) { return j > i ? 0.0 : 1.0; });
    const NnlsResult r = nnls(a, std::vector<double>{1, 2});
    EXPECT_EQ(r.x[0], 0);
    EXPECT_NEAR(r.x[1], 1.5, 1e-12);
    EXPECT_TRUE(r.converged);
    const NnlsResult free = nnls(a, std::vector<double>{3, 2});
    EXPECT_NEAR(free.x[0], 1, 1e-12);
    EXPECT_NEAR(free.x[1], 2, 1e-12);
}

TEST(Nnls, IsOptimalOnDenseAndSparseProblems) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        for (const double fill : {1.0, 0.2, 0.03}) {
            for (const double low : {0.0, -1.0}) {
                SCOPED_TRACE(testing::Message() << seed << ' ' << fill << ' ' << low);
                const auto columns = static_cast<std::uint32_t>(20 + 17 * seed);
                const SparseRows a = random_rows(3 * columns, columns, fill, low, seed);
                const std::vector<double> b = random_vector(a.rows(), -0.5, 1, seed);
                const NnlsResult r = nnls(a, b);
                EXPECT_TRUE(r.converged);
                EXPECT_EQ(r.sweeps, 0);
                expect_optimal(a, b, r.x, 1e-9);
            }
        }
    }
    const SparseRows a = chain_rows(5000, 3, 5);
    const std::vector<double> b = random_vector(a.rows(), -1, 1, 5);
    const NnlsResult r = nnls(a, b);
    EXPECT_TRUE(r.converged);
    EXPECT_LT(r.pivots, 40);
    expect_optimal(a, b, r.x, 1e-9);
}

TEST(Nnls, MatchesExhaustiveSearch) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const auto columns = static_cast<std::uint32_t>(1 + seed % 8);
        const SparseRows a = random_rows(4 + seed % 9, columns, seed % 3 == 0 ? 0.5 : 1, -1, seed);
        const std::vector<double> b = random_vector(a.rows(), -1, 1, seed);
        double best = std::numeric_limits<double>::infinity();
        for (unsigned set = 0; set < 1u << columns; ++set) {
            const std::vector<double> x = least_squares(a, b, set);
            if (x.empty() || std::any_of(x.begin(), x.end(), [](double v) { return v < -1e-12; })) continue;
            best = std::min(best, objective(a, x, b));
        }
        const NnlsResult r = nnls(a, b);
        EXPECT_TRUE(r.converged) << seed;
        EXPECT_NEAR(objective(a, r.x, b), best, 1e-9 * (1 + best)) << seed;
    }
}

TEST(Nnls, FindsExactSolutions) {
    for (const double fill : {1.0, 0.1}) {
        const SparseRows a = random_rows(400, 80, fill, 0, 9);
        std::vector<double> x = random_vector(80, -1, 1, 9);
        for (double& v : x) v = std::max(v, 0.0);
        const NnlsResult r = nnls(a, product(a, x));
        for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(r.x[i], x[i], 1e-9) << i;
    }
}

TEST(Nnls, IsIndependentOfTheScaleOfColumns) {
    const SparseRows a = random_rows(60, 20, 1, -1, 11);
    SparseRows scaled = a;
    for (std::size_t e = 0; e < a.entries(); ++e)
        scaled.value[e] *= std::pow(10.0, a.column[e] % 7 * 4.0 - 12);
    const std::vector<double> b = random_vector(60, -1, 1, 11);
    const NnlsResult r = nnls(a, b), s = nnls(scaled, b);
    EXPECT_TRUE(s.converged);
    for (std::uint32_t i = 0; i < 20; ++i)
        EXPECT_NEAR(s.x[i] * std::pow(10.0, i % 7 * 4.0 - 12), r.x[i], 1e-9) << i;
}

TEST(Nnls, AcceptsEqualAndZeroColumns) {
    // Columns 0 and 1 are equal, 2 is twice as long in the same direction, 3 is 0, 4 is empty.
    const SparseRows a = make_rows(3, 5, [](std::size_t j, std::uint32_t i) {
        const double base = static_cast<double>(j + 1);
        return i < 2 ? base : i == 2 ? 2 * base : 0.0;
    });
    SparseRows with_zero = a;
    with_zero.column.push_back(3);
    with_zero.value.push_back(0);
    with_zero.first.back() += 1;
    for (const auto* m : std::initializer_list<const SparseRows*>{&a, &with_zero}) {
        const NnlsResult r = nnls(*m, std::vector<double>{6, 12, 18});
        EXPECT_TRUE(r.converged);
        // In units of the lengths each of the three gets a third: 2, 2 and 1.
        EXPECT_NEAR(r.x[0], 2, 1e-4);
        EXPECT_NEAR(r.x[1], 2, 1e-4);
        EXPECT_NEAR(r.x[2], 1, 1e-4);
        EXPECT_EQ(r.x[3], 0);
        EXPECT_EQ(r.x[4], 0);
        EXPECT_LT(objective(*m, r.x, std::vector<double>{6, 12, 18}), 1e-16 * 504);
    }
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {  // fewer rows than columns, and repeated ones
        SparseRows wide = random_rows(6, 30, 1, -1, seed);
        for (std::size_t j = 0; j < 6; ++j)
            for (std::size_t i = 20; i < 30; ++i) wide.value[30 * j + i] = wide.value[30 * j + i - 20];
        const std::vector<double> b = random_vector(6, -1, 1, seed);
        const NnlsResult r = nnls(wide, b);
        EXPECT_TRUE(r.converged) << seed;
        expect_optimal(wide, b, r.x, 1e-8);
    }
}

TEST(Nnls, AcceptsEmptyAndZeroProblems) {
    EXPECT_TRUE(nnls({}, {}).converged);
    const SparseRows a = random_rows(5, 3, 1, 0, 1);
    EXPECT_EQ(nnls(a, std::vector<double>(5, 0.0)).x, std::vector<double>(3, 0.0));
    EXPECT_EQ(nnls(a, std::vector<double>(5, -1.0)).x, std::vector<double>(3, 0.0));
    SparseRows empty;
    empty.columns = 4;
    empty.first = {0, 0, 0};
    EXPECT_EQ(nnls(empty, std::vector<double>(2, 1.0)).x, std::vector<double>(4, 0.0));
}

TEST(Nnls, DescentMatchesPivoting) {
    const SparseRows a = random_rows(300, 40, 0.5, -1, 3);
    const std::vector<double> b = random_vector(300, -1, 1, 3);
    const NnlsResult pivoted = nnls(a, b), descended = nnls(a, b, {.max_pivots = 0});
    EXPECT_EQ(descended.pivots, 0);
    EXPECT_GT(descended.sweeps, 2);
    EXPECT_TRUE(descended.converged);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(descended.x[i], pivoted.x[i], 1e-8) << i;
    const NnlsResult cut = nnls(a, b, {.max_pivots = 0, .max_sweeps = 1});
    EXPECT_FALSE(cut.converged);
    EXPECT_GT(cut.violation, 1e-8);
    EXPECT_LT(objective(a, cut.x, b), objective(a, std::vector<double>(40, 0.0), b));
    // Coordinate descent continues where pivoting stopped.
    const NnlsResult stopped = nnls(a, b, {.max_pivots = 1});
    EXPECT_GT(stopped.sweeps, 0);
    EXPECT_TRUE(stopped.converged);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(stopped.x[i], pivoted.x[i], 1e-8) << i;
}

TEST(Nnls, LargeSystemsAreSolvedByDescent) {
    // 6,000 unknowns that all share rows: the matrix is too large for the dense solver.
    const SparseRows a = random_rows(40, 6000, 1, 0, 8);
    const std::vector<double> b = random_vector(40, 0, 1, 8);
    const NnlsResult r = nnls(a, b, {.max_sweeps = 3});
    EXPECT_EQ(r.pivots, 0);
    EXPECT_EQ(r.sweeps, 3);
    EXPECT_LT(objective(a, r.x, b), objective(a, std::vector<double>(6000, 0.0), b));
    // Rows with 45 of 4,500 columns: pairs are few, but the factors fill up, which requires 4,500^3 / 3
    // products.
    const SparseRows scattered = random_rows(4500, 4500, 0.01, 0, 8);
    const NnlsResult s = nnls(scattered, random_vector(4500, 0, 1, 9), {.max_sweeps = 3});
    EXPECT_EQ(s.pivots, 0);
    EXPECT_EQ(s.sweeps, 3);
}

TEST(Nnls, IsBitIdenticalForAnyNumberOfThreads) {
    for (const SparseRows& a : {random_rows(500, 150, 1, -1, 6), chain_rows(2000, 3, 6)}) {
        const std::vector<double> b = random_vector(a.rows(), -0.2, 1, 6);
        const NnlsResult one = nnls(a, b, {}, {.threads = 1});
        for (const unsigned threads : {2u, 7u}) {
            const NnlsResult many = nnls(a, b, {}, {.threads = threads});
            EXPECT_EQ(std::memcmp(one.x.data(), many.x.data(), one.x.size() * sizeof(double)), 0);
            EXPECT_EQ(one.violation, many.violation);
        }
    }
}

TEST(Nnls, RejectsInvalidInput) {
    const SparseRows a = random_rows(3, 2, 1, 0, 1);
    EXPECT_THROW(nnls(a, std::vector<double>{1, 2}), InvalidInput);
    EXPECT_THROW(nnls(a, std::vector<double>{1, 2, std::nan("")}), InvalidInput);
    SparseRows bad = a;
    bad.value[3] = std::numeric_limits<double>::infinity();
    try {
        nnls(bad, std::vector<double>{1, 2, 3});
        FAIL();
    } catch (const InvalidInput& e) {
        EXPECT_STREQ(e.what(), "nnls: row 2 of the matrix is not finite");
    }
    EXPECT_THROW(nnls(a, std::vector<double>{1, 2, 3}, {.max_pivots = -1}), InvalidInput);
}

}  // namespace
}  // namespace coppice
