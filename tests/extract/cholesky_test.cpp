#include "coppice/extract/mesh/cholesky_internal.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"

namespace coppice::extract_internal {
namespace {

/// Returns the Laplacian of a square grid plus `shift` on the diagonal: symmetric, positive definite for
/// shift > 0.
SparseCholesky::Matrix grid(int side, double shift) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto join = [&](int a, int b) {
        for (const int v : {a, b}) entries.emplace_back(v, v, 1.0);
        entries.emplace_back(a, b, -1.0);
        entries.emplace_back(b, a, -1.0);
    };
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const int v = x + side * y;
            entries.emplace_back(v, v, shift);
            if (x + 1 < side) join(v, v + 1);
            if (y + 1 < side) join(v, v + side);
        }
    }
    SparseCholesky::Matrix a(side * side, side * side);
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
}

TEST(SparseCholesky, SolvesForSeveralMatricesOfOnePattern) {
    SparseCholesky solver;
    solver.analyze(grid(20, 1));
    SparseCholesky::Columns x(400, 3);
    for (int i = 0; i < 400; ++i) x.row(i) << i, 1.0 / (1 + i), i % 7;
    for (const double shift : {1.0, 0.01}) {
        const auto a = grid(20, shift);
        ASSERT_TRUE(solver.factorize(a, {}));
        EXPECT_LT((solver.solve(a * x) - x).cwiseAbs().maxCoeff(), 1e-9) << shift;
    }
}

TEST(SparseCholesky, ReportsMatricesThatAreNotPositiveDefinite) {
    SparseCholesky solver;
    solver.analyze(grid(5, 1));
    EXPECT_FALSE(solver.factorize(grid(5, -1), {}));
    EXPECT_FALSE(solver.factorize(grid(5, std::numeric_limits<double>::quiet_NaN()), {}));
}

TEST(SparseCholesky, CanBeStopped) {
    std::stop_source source;
    source.request_stop();
    SparseCholesky solver;
    solver.analyze(grid(5, 1));
    EXPECT_THROW(solver.factorize(grid(5, 1), {.stop = source.get_token()}), Cancelled);
}

}  // namespace
}  // namespace coppice::extract_internal
