#include "coppice/tetra/lattice/cells_internal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/id.h"

#include "tetra/lattice_support.h"

namespace coppice {
namespace {

using namespace lattice_test;
using Cell = Octree::Cell;

std::vector<SplitKeys> octrees() {
    std::vector<SplitKeys> out{{}, {{0}}, {{0}, {0, 1, 2, 3, 4, 5, 6, 7}}};
    // Towards one corner, and towards the middle of the cube.
    out.push_back({{0}, {7}, {56}, {448}, {3584}});
    out.push_back({{0}, {0}, {7}, {63}, {511}});
    for (std::uint64_t seed = 0; seed < 12; ++seed)
        out.push_back(random_splits(2 + static_cast<unsigned>(seed % 4), 0.15, seed));
    return out;
}

bool touch(const Cell& a, const Cell& b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (a.low[axis] > b.low[axis] + b.side || b.low[axis] > a.low[axis] + a.side) return false;
    }
    return true;
}

std::vector<Cell> collect_leaves(const Octree& tree) {
    std::vector<Cell> out;
    for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) out.push_back(tree.cell(leaf));
    return out;
}

/// Returns the leaves of the octree with exactly these split cells; keys as in Octree.
std::vector<Cell> plain_leaves(const SplitKeys& split) {
    std::vector<Cell> out;
    const auto descend = [&](const auto& self, std::size_t level, std::uint64_t key, Cell cell) -> void {
        if (level >= split.size() || !std::ranges::binary_search(split[level], key))
            return out.push_back(cell);
        for (unsigned o = 0; o < 8; ++o) {
            Cell child{cell.low, cell.side / 2};
            for (unsigned axis = 0; axis < 3; ++axis) child.low[axis] += (o >> axis & 1) * child.side;
            self(self, level + 1, key << 3 | o, child);
        }
    };
    descend(descend, 0, 0, {{0, 0, 0}, Octree::kSide});
    return out;
}

/// Splits the larger one of any two adjacent leaves that differ by more than one level, until there is no
/// such pair.
std::vector<Cell> brute_balance(std::vector<Cell> leaves) {
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            const Cell large = leaves[i];
            if (std::ranges::none_of(
                    leaves, [&](const Cell& c) { return c.side * 2 < large.side && touch(c, large); }))
                continue;
            changed = true;
            const std::uint32_t half = large.side / 2;
            leaves[i].side = half;
            for (unsigned o = 1; o < 8; ++o) {
                Cell child{large.low, half};
                for (unsigned axis = 0; axis < 3; ++axis) child.low[axis] += (o >> axis & 1) * half;
                leaves.push_back(child);
            }
        }
    }
    return leaves;
}

using CellKey = std::array<std::uint32_t, 4>;
std::vector<CellKey> sorted_keys(const std::vector<Cell>& cells) {
    std::vector<CellKey> out;
    for (const Cell& c : cells) out.push_back({c.low[0], c.low[1], c.low[2], c.side});
    std::ranges::sort(out);
    return out;
}

TEST(Octree, IsTheCoarsestBalancedOctreeWithTheGivenCells) {
    for (const SplitKeys& split : octrees()) {
        const std::vector<Cell> leaves = collect_leaves(Octree(split, {}));
        EXPECT_EQ(sorted_keys(leaves), sorted_keys(brute_balance(plain_leaves(split))));
    }
}

TEST(Octree, LeavesFollowTheMortonCurve) {
    for (const SplitKeys& split : octrees()) {
        const Octree tree(split, {});
        std::uint64_t end = 0;
        for (const Cell& c : collect_leaves(tree)) {
            std::uint64_t key = 0;
            // Coordinates of leaves are even; halves fit into 63 bits.
            for (unsigned b = 0; b < Octree::kMaxLevels; ++b) {
                for (std::uint64_t axis = 0; axis < 3; ++axis)
                    key |= std::uint64_t{c.low[axis] >> (b + 1) & 1} << (3 * b + axis);
            }
            ASSERT_EQ(key, end);
            end += std::uint64_t{c.side / 2} * (c.side / 2) * (c.side / 2);
        }
        EXPECT_EQ(end, std::uint64_t{1} << (3 * Octree::kMaxLevels));
    }
}

TEST(Octree, FindsNeighboursAndLeavesOfPoints) {
    for (const SplitKeys& split : octrees()) {
        const Octree tree(split, {});
        for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
            const Cell c = tree.cell(leaf);
            EXPECT_EQ(tree.leaf_at(c.low), leaf);
            EXPECT_EQ(tree.leaf_at(LatticeCells::middle(c)), leaf);
            for (unsigned s = 0; s < 27; ++s) {
                std::array<std::uint32_t, 3> at = LatticeCells::middle(c);
                const std::array<unsigned, 3> step{s % 3, s / 3 % 3, s / 9};
                for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += (step[axis] - 1) * c.side;
                const Octree::Neighbor n = tree.neighbor(tree.node_of_leaf(leaf), s);
                // Coordinates that wrap around below 0 exceed the upper end, too.
                if (std::ranges::any_of(at, [](std::uint32_t x) { return x >= Octree::kSide; }) ||
                    c.side == Octree::kSide) {
                    EXPECT_EQ(n.node, kNoIndex);
                    continue;
                }
                const std::uint32_t there = tree.leaf_at(at);
                const std::uint32_t side = tree.cell(there).side;
                EXPECT_EQ(n.larger, side > c.side);
                EXPECT_EQ(tree.is_leaf(n.node), side >= c.side);
                if (tree.is_leaf(n.node)) {
                    EXPECT_EQ(tree.leaf(n.node), there);
                } else {
                    std::uint32_t node = tree.child(n.node, 7);
                    while (!tree.is_leaf(node)) node = tree.child(node, 0);
                    EXPECT_EQ(tree.leaf(node), there);
                }
            }
        }
    }
}

TEST(LatticeCells, EveryCenterAndCornerHasOneNumber) {
    for (const SplitKeys& split : octrees()) {
        const LatticeCells cells(Octree(split, {}), {});
        std::set<LatticeCells::Place> expected;
        std::vector<LatticeCells::Place> place(cells.vertex_count());
        std::vector<unsigned> seen(cells.vertex_count());
        for (std::uint32_t leaf = 0; leaf < cells.leaf_count(); ++leaf) {
            cells.visit_vertices(leaf, [&](std::uint32_t v, LatticeCells::Place p) {
                ++seen.at(v);
                place.at(v) = p;
            });
            expected.insert(LatticeCells::middle(cells.octree().cell(leaf)));
            for (unsigned c = 0; c < 8; ++c)
                expected.insert(LatticeCells::place(cells.octree().cell(leaf), c));
        }
        EXPECT_TRUE(std::ranges::all_of(seen, [](unsigned n) { return n == 1; }));
        EXPECT_EQ(expected.size(), place.size());
        for (std::uint32_t leaf = 0; leaf < cells.leaf_count(); ++leaf) {
            for (unsigned c = 0; c < 8; ++c)
                EXPECT_EQ(place[cells.corner(leaf, c)], LatticeCells::place(cells.octree().cell(leaf), c));
        }
    }
}

/// Returns the whole lattice with small integer coordinates.
LatticeMesh whole_mesh(const LatticeCells& cells, unsigned levels) {
    return gather_tetra(cells, all_tetra(cells, {}), whole_cube(levels), {});
}

TEST(LatticeCells, TetrahedraFillTheCubeExceptItsBorder) {
    for (const SplitKeys& split : octrees()) {
        const LatticeCells cells(Octree(split, {}), {});
        const TetraMesh mesh = whole_mesh(cells, 6).mesh;
        // Exact sixfold volume: that of the cube without a pyramid on every square of its border.
        double expected = 6 * 128.0 * 128 * 128, sum = 0;
        for (const Cell& c : collect_leaves(cells.octree())) {
            const double side = c.side / 32768.0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                expected -= c.low[axis] == 0 ? side * side * side : 0;
                expected -= c.low[axis] + c.side == Octree::kSide ? side * side * side : 0;
            }
        }
        for (const Tetra& t : mesh.tetra) {
            EXPECT_GT(volume_six(mesh, t), 0);
            sum += volume_six(mesh, t);
        }
        EXPECT_EQ(sum, expected);
    }
}

TEST(LatticeCells, EveryPointIsInOneTetrahedronOrOnSharedFaces) {
    const CounterRandom random(1, 1);
    for (const SplitKeys& split : octrees()) {
        const LatticeCells cells(Octree(split, {}), {});
        const TetraMesh mesh = whole_mesh(cells, 6).mesh;
        if (mesh.tetra.empty()) continue;
        for (std::uint64_t i = 0; i < 60; ++i) {
            // Within the middle half of the cube; every other point is in a plane that contains many faces.
            const auto draw = [&](std::uint64_t k) {
                return std::floor(random.uniform(3 * i + k, 32, 96) * 64) / 64;
            };
            const Vec3d p{draw(0), draw(1), i % 2 == 0 ? draw(2) : 64};
            unsigned strictly = 0, at_all = 0;
            for (const Tetra& t : mesh.tetra) {
                const auto c = get_corners(mesh, t);
                if (!contains(c, p)) continue;
                ++at_all;
                strictly += contains(c, p, true) ? 1 : 0;
            }
            EXPECT_TRUE(strictly == 1 ? at_all == 1 : strictly == 0 && at_all >= 2)
                << strictly << " " << at_all;
        }
    }
}

TEST(LatticeCells, FindsTheNeighbourAcrossEveryFace) {
    for (const SplitKeys& split : octrees()) {
        const LatticeCells cells(Octree(split, {}), {});
        const SlotMasks masks = all_tetra(cells, {});
        const LatticeMesh all = whole_mesh(cells, 6);
        std::vector<LatticeCells::Name> names;
        for (std::uint32_t leaf = 0; leaf < masks.size(); ++leaf) {
            for (unsigned slot = 0; slot < LatticeCells::kSlots; ++slot) {
                if ((masks[leaf] >> slot & 1) != 0) names.push_back({leaf, slot});
            }
        }
        ASSERT_EQ(names.size(), all.mesh.tetra.size());
        for (const auto& [corners, uses] : face_uses(all.mesh)) {
            ASSERT_LE(uses.size(), 2u);
            for (std::size_t side = 0; side < uses.size(); ++side) {
                const TetraFace f = uses[side].face;
                const LatticeCells::Name next = cells.across(names[f.tetra], f.opposite);
                if (uses.size() == 1) {
                    EXPECT_EQ(next.leaf, kNoIndex);
                    continue;
                }
                const LatticeCells::Name expected = names[uses[1 - side].face.tetra];
                EXPECT_EQ(next.leaf, expected.leaf);
                EXPECT_EQ(next.slot, expected.slot);
                EXPECT_NE(uses[0].ascending, uses[1].ascending);
            }
        }
    }
}

TEST(LatticeCells, DihedralAnglesAreBetween30And135Degrees) {
    // Cells of one size: six edges of 60 or 90 degrees.
    const LatticeCells uniform(Octree({{0}, {0, 1, 2, 3, 4, 5, 6, 7}}, {}), {});
    const TetraMesh alike = whole_mesh(uniform, 6).mesh;
    for (const Tetra& t : alike.tetra) {
        const auto [least, most] = dihedral_range(get_corners(alike, t));
        EXPECT_NEAR(least, 60, 1e-9);
        EXPECT_NEAR(most, 90, 1e-9);
    }
    std::array<double, 2> range{180, 0};
    for (const SplitKeys& split : octrees()) {
        const TetraMesh mesh = whole_mesh(LatticeCells(Octree(split, {}), {}), 6).mesh;
        for (const Tetra& t : mesh.tetra) {
            const auto [least, most] = dihedral_range(get_corners(mesh, t));
            range = {std::min(range[0], least), std::max(range[1], most)};
        }
    }
    EXPECT_NEAR(range[0], 30, 1e-9);
    EXPECT_NEAR(range[1], 135, 1e-9);
}

}  // namespace
}  // namespace coppice
