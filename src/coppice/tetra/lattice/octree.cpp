#include <algorithm>
#include <bit>

#include "coppice/base/kernel/morton.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/tetra/lattice/octree_internal.h"

namespace coppice {
namespace {

using Keys = Buffer<std::uint64_t>;
constexpr std::size_t kOctreeGrain = 1 << 12;

/// For each set of split octants of a cell, the steps from that cell to all cells that must be split: those
/// that touch a split octant.
constexpr std::array<std::uint32_t, 256> make_needed() {
    std::array<std::uint32_t, 256> needed{};
    for (unsigned octants = 0; octants < 256; ++octants) {
        for (int o = 0; o < 8; ++o) {
            if ((octants >> o & 1) == 0) continue;
            for (int k = 0; k < 8; ++k) {
                const auto step = [&](int axis) { return (k >> axis & 1) * ((o >> axis & 1) != 0 ? 1 : -1); };
                needed[octants] |= 1u << step_code(step(0), step(1), step(2));
            }
        }
    }
    return needed;
}
constexpr std::array<std::uint32_t, 256> kNeeded = make_needed();

/// Calls visit(key) for the cells at those of the 27 steps from `key` that are in the mask and in the cube.
template <class Visit>
void visit_steps(std::uint64_t key, unsigned level, std::uint32_t steps, const Visit& visit) {
    const std::uint64_t within = level == 0 ? 0 : ~std::uint64_t{0} >> (64 - 3 * level);
    std::array<std::array<std::uint64_t, 3>, 3> part{};
    std::uint32_t outside = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const std::uint64_t mask = (kMortonAxis << axis) & within;
        const std::uint64_t here = key & mask;
        part[axis] = {(here - (std::uint64_t{1} << axis)) & mask, here,
                      ((here | ~mask) + (std::uint64_t{1} << axis)) & mask};
        constexpr std::array<std::uint32_t, 3> kLow{0x1249249u, 0x1c0e07u, 0x1ffu};
        constexpr std::array<std::uint32_t, 3> kUp{2, 6, 18};
        if (here == 0) outside |= kLow[axis];
        if (here == mask) outside |= kLow[axis] << kUp[axis];
    }
    for (steps &= ~outside; steps != 0; steps &= steps - 1) {
        const auto s = static_cast<unsigned>(std::countr_zero(steps));
        visit(part[0][s % 3] | part[1][s / 3 % 3] | part[2][s / 9]);
    }
}

/// Returns the cells of the level above that must be split because of these; may contain duplicates.
Keys needed_above(const Keys& split, unsigned level, const Context& ctx) {
    std::vector<std::vector<std::uint64_t>> found((split.size() + kOctreeGrain - 1) / kOctreeGrain);
    parallel_for_ranges(ctx, split.size(), kOctreeGrain, [&](IndexRange range) {
        std::vector<std::uint64_t>& out = found[range.begin / kOctreeGrain];
        for (std::size_t i = range.begin; i < range.end;) {
            const std::uint64_t parent = split[i] >> 3;
            unsigned octants = 0;
            for (; i < range.end && split[i] >> 3 == parent; ++i) octants |= 1u << (split[i] & 7);
            visit_steps(parent, level - 1, kNeeded[octants], [&](std::uint64_t key) { out.push_back(key); });
        }
    });
    Keys all;
    for (const auto& keys : found) all.insert(all.end(), keys.begin(), keys.end());
    return all;
}

void balance(std::vector<Keys>& split, const Context& ctx) {
    for (std::size_t l = split.size(); l-- > 1;) {
        Keys keys = needed_above(split[l], static_cast<unsigned>(l), ctx);
        keys.insert(keys.end(), split[l - 1].begin(), split[l - 1].end());
        if (keys.size() < kOctreeGrain) {
            std::ranges::sort(keys);
        } else {
            radix_sort(ctx, keys, static_cast<unsigned>(3 * (l - 1)), [](std::uint64_t key) { return key; });
        }
        keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        split[l - 1] = std::move(keys);
    }
}

}  // namespace

Octree::Octree(std::vector<Buffer<std::uint64_t>> split, const Context& ctx) {
    while (!split.empty() && split.back().empty()) split.pop_back();
    balance(split, ctx);
    link_nodes(split, ctx);
    number_leaves();
}

void Octree::link_nodes(const std::vector<Keys>& split, const Context& ctx) {
    std::uint32_t count = 0;
    for (const Keys& keys : split) count += static_cast<std::uint32_t>(keys.size());
    around_split_.resize(count);
    cell_of_split_.resize(count);
    link_.assign(8 * std::size_t{count} + 1, 0);
    Buffer<std::uint32_t> node(count);
    for (std::uint32_t l = 0, before = 0, first = 0; l < split.size(); ++l) {
        std::uint32_t parent = before;
        for (std::uint32_t s = first; s < first + split[l].size(); ++s) {
            const std::uint64_t key = split[l][s - first];
            if (l > 0) {
                while (split[l - 1][parent - before] != key >> 3) ++parent;
            }
            const auto octant = static_cast<unsigned>(key & 7);
            node[s] = l == 0 ? 0 : 8 * parent + 1 + octant;
            link_[node[s]] = kSplit + s;
            cell_of_split_[s] = l == 0 ? Cell{{0, 0, 0}, kSide} : child_cell(cell_of_split_[parent], octant);
        }
        parallel_for(ctx, split[l].size(), kOctreeGrain, [&](std::size_t i) {
            const std::uint32_t here = node[first + i];
            for (unsigned s = 0; s < 27; ++s)
                around_split_[first + i][s] = s == 13 ? here : neighbor(here, s).node;
        });
        before = first;
        first += static_cast<std::uint32_t>(split[l].size());
    }
}

void Octree::number_leaves() {
    const auto count = static_cast<std::uint32_t>(cell_of_split_.size());
    Buffer<std::uint32_t> leaves(count), next(count);
    for (std::uint32_t s = count; s-- > 0;) {
        leaves[s] = 0;
        for (std::uint32_t n = 8 * s + 1; n <= 8 * s + 8; ++n)
            leaves[s] += link_[n] >= kSplit ? leaves[link_[n] - kSplit] : 1;
    }
    node_of_leaf_.assign(count > 0 ? leaves[0] : 1, 0);
    if (count > 0) next[0] = 0;
    for (std::uint32_t s = 0; s < count; ++s) {
        std::uint32_t leaf = next[s];
        for (std::uint32_t n = 8 * s + 1; n <= 8 * s + 8; ++n) {
            if (link_[n] >= kSplit) {
                next[link_[n] - kSplit] = leaf;
                leaf += leaves[link_[n] - kSplit];
            } else {
                node_of_leaf_[leaf] = n;
                link_[n] = leaf++;
            }
        }
    }
}

std::uint32_t Octree::leaf_at(std::array<std::uint32_t, 3> point) const {
    std::uint32_t node = 0;
    for (std::uint32_t half = kSide / 2; !is_leaf(node); half /= 2) {
        unsigned octant = 0;
        for (unsigned axis = 0; axis < 3; ++axis) octant |= (point[axis] & half) != 0 ? 1u << axis : 0;
        node = child(node, octant);
    }
    return leaf(node);
}

}  // namespace coppice
