#include "coppice/extract/prior/isotonic_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "coppice/base/random.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice::extract_internal {
namespace {

constexpr std::uint32_t kNone = DraftTree::kNoParent;

struct Problem {
    std::vector<std::uint32_t> parent;
    std::vector<double> value, weight;
};

Problem random_problem(std::uint32_t size, std::uint64_t seed, bool chain) {
    const CounterRandom random(seed, 1);
    Problem p;
    for (std::uint32_t n = 0; n < size; ++n) {
        const double place = chain ? 0.999 : random.uniform(3ull * n);
        p.parent.push_back(n == 0 ? kNone : static_cast<std::uint32_t>(place * n));
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

TEST(Isotonic, LeavesAloneWhatFallsAlready) {
    const std::vector<std::uint32_t> parent{kNone, 0, 1, 0};
    const std::vector<double> value{4, 3, 1, 4}, weight{1, 2, 3, 4};
    EXPECT_EQ(isotonic_on_tree(parent, value, weight), value);
}

TEST(Isotonic, SharesTheMeanWhereValuesWouldGrow) {
    const std::vector<std::uint32_t> parent{kNone, 0, 1, 0};
    const auto x =
        isotonic_on_tree(parent, std::vector<double>{2, 1, 5, 1.5}, std::vector<double>{1, 1, 1, 1});
    const double mean = (2.0 + 1 + 5) / 3;
    EXPECT_EQ(x, (std::vector<double>{mean, mean, mean, 1.5}));
}

// A feasible point is the least squares solution when no block of nodes that share a value gains by moving as
// far as its neighbours allow: within a block, the part towards the tips wants up and the rest down.
TEST(Isotonic, IsTheBestOfAllThatFall) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const Problem p = random_problem(40, seed, seed % 3 == 0);
        const auto x = isotonic_on_tree(p.parent, p.value, p.weight);
        for (std::uint32_t n = 1; n < x.size(); ++n) {
            if (p.parent[n] != kNone) {
                ASSERT_LE(x[n], x[p.parent[n]]);
            }
        }
        // Towards any other solution the cost does not fall: it is convex, and so is what is allowed.
        const CounterRandom random(seed, 2);
        for (std::uint64_t k = 0; k < 200; ++k) {
            std::vector<double> other(x.size());
            for (std::uint32_t n = 0; n < x.size(); ++n) {
                const double free = random.uniform(k * 100 + n, -0.5, 1.5);
                other[n] = p.parent[n] == kNone ? free : std::min(free, other[p.parent[n]]);
            }
            std::vector<double> step(x.size());
            for (std::size_t n = 0; n < x.size(); ++n) step[n] = x[n] + 1e-3 * (other[n] - x[n]);
            ASSERT_GE(cost(p, step), cost(p, x) - 1e-12);
        }
    }
}

TEST(Isotonic, TakesLongChains) {
    std::vector<std::uint32_t> parent(200000);
    std::iota(parent.begin() + 1, parent.end(), 0u);
    parent[0] = kNone;
    std::vector<double> value(parent.size());
    std::iota(value.begin(), value.end(), 0.0);
    const auto x = isotonic_on_tree(parent, value, std::vector<double>(parent.size(), 1));
    EXPECT_NEAR(x.front(), 0.5 * static_cast<double>(parent.size() - 1), 1e-6);
    EXPECT_EQ(x.front(), x.back());
}

}  // namespace
}  // namespace coppice::extract_internal
