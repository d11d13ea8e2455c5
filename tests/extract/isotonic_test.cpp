#include "coppice/extract/prior/isotonic_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice::extract_internal {
namespace {

struct Problem {
    std::vector<std::uint32_t> parent;
    std::vector<double> value, weight;
};

Problem random_problem(std::uint32_t size, std::uint64_t seed, bool chain) {
    const CounterRandom random(seed, 1);
    Problem p;
    for (std::uint32_t n = 0; n < size; ++n) {
        const double place = chain ? 0.999 : random.uniform(3ull * n);
        p.parent.push_back(n == 0 ? kNoIndex : static_cast<std::uint32_t>(place * n));
        p.value.push_back(random.uniform(3ull * n + 1));
        p.weight.push_back(0.1 + random.uniform(3ull * n + 2));
    }
    return p;
}

double cost(const Problem& p, const std::vector<double>& x) {
    double sum = 0;
    for (std::size_t n = 0; n < x.size(); ++n) sum += p.weight[n] * (x[n] - p.value[n]) * (x[n] - p.value[n]);
    return sum;
}

TEST(Isotonic, PreservesDecreasingValues) {
    const std::vector<std::uint32_t> parent{kNoIndex, 0, 1, 0};
    const std::vector<double> value{4, 3, 1, 4}, weight{1, 2, 3, 4};
    EXPECT_EQ(isotonic_on_tree(parent, value, weight), value);
}

TEST(Isotonic, AveragesIncreasingValues) {
    const std::vector<std::uint32_t> parent{kNoIndex, 0, 1, 0};
    const auto x =
        isotonic_on_tree(parent, std::vector<double>{2, 1, 5, 1.5}, std::vector<double>{1, 1, 1, 1});
    const double mean = (2.0 + 1 + 5) / 3;
    EXPECT_EQ(x, (std::vector<double>{mean, mean, mean, 1.5}));
}

// A feasible point is the least squares solution if no block of nodes with a common value improves by a
// feasible move: within a block, the nodes towards the tips tend upward and the others downward.
TEST(Isotonic, IsTheLeastSquaresSolution) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const Problem p = random_problem(40, seed, seed % 3 == 0);
        const auto x = isotonic_on_tree(p.parent, p.value, p.weight);
        for (std::uint32_t n = 1; n < x.size(); ++n) {
            if (p.parent[n] != kNoIndex) {
                ASSERT_LE(x[n], x[p.parent[n]]);
            }
        }
        // Towards any other feasible point the cost does not decrease: it is convex, like the feasible set.
        const CounterRandom random(seed, 2);
        for (std::uint64_t k = 0; k < 200; ++k) {
            std::vector<double> other(x.size());
            for (std::uint32_t n = 0; n < x.size(); ++n) {
                const double free = random.uniform(k * 100 + n, -0.5, 1.5);
                other[n] = p.parent[n] == kNoIndex ? free : std::min(free, other[p.parent[n]]);
            }
            std::vector<double> step(x.size());
            for (std::size_t n = 0; n < x.size(); ++n) step[n] = x[n] + 1e-3 * (other[n] - x[n]);
            ASSERT_GE(cost(p, step), cost(p, x) - 1e-12);
        }
    }
}

TEST(Isotonic, AcceptsLongChains) {
    std::vector<std::uint32_t> parent(200000);
    std::iota(parent.begin() + 1, parent.end(), 0u);
    parent[0] = kNoIndex;
    std::vector<double> value(parent.size());
    std::iota(value.begin(), value.end(), 0.0);
    const auto x = isotonic_on_tree(parent, value, std::vector<double>(parent.size(), 1));
    EXPECT_NEAR(x.front(), 0.5 * static_cast<double>(parent.size() - 1), 1e-6);
    EXPECT_EQ(x.front(), x.back());
}

}  // namespace
}  // namespace coppice::extract_internal
