#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/select_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kPassingGrain = 1 << 8;
/// Relative enlargement of cells, so that rounding loses no axis that runs along a face.
constexpr double kSlack = 1e-9;

/// Creates a row for each of `count` items with row(scratch, i), which appends to scratch.
template <class Row>
CompressedRows<std::uint32_t> make_rows(std::size_t count, const Row& row, const Context& ctx) {
    std::vector<std::vector<std::uint32_t>> found((count + kPassingGrain - 1) / kPassingGrain);
    CompressedRows<std::uint32_t> out;
    out.first.assign(count + 1, 0);
    parallel_for_ranges(ctx, count, kPassingGrain, [&](IndexRange range) {
        std::vector<std::uint32_t>& items = found[range.begin / kPassingGrain];
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const std::size_t before = items.size();
            row(items, static_cast<std::uint32_t>(i));
            out.first[i] = static_cast<std::uint32_t>(items.size() - before);
        }
    });
    out.items.reserve(exclusive_scan(std::span(out.first)));
    for (const auto& items : found) out.items.insert(out.items.end(), items.begin(), items.end());
    return out;
}

/// Returns the segments with axes that pass through each leaf.
CompressedRows<std::uint32_t> axes_in_leaves(const LatticeCells& cells, const LeafSegments& segments,
                                             std::span<const RoundCone> cones, const LatticeCube& cube,
                                             const Context& ctx) {
    const double unit = cube.side / Octree::kSide;
    const auto row = [&](std::vector<std::uint32_t>& items, std::uint32_t leaf) {
        const auto near = segments.of_leaf(leaf);
        if (near.empty()) return;
        const Octree::Cell cell = cells.octree().cell(leaf);
        const LatticeCells::Place place = LatticeCells::middle(cell);
        const Vec3d middle{place[0] * unit, place[1] * unit, place[2] * unit};
        const double half = (0.5 + kSlack) * cell.side * unit;
        for (const std::uint32_t s : near) {
            const bool misses = separated(cones[s], 0, middle, [&](Vec3d n, double) {
                return dot(n, middle) - half * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
            });
            if (!misses) items.push_back(s);
        }
    };
    return make_rows(cells.leaf_count(), row, ctx);
}

/// Returns for each leaf the node of `sizing` that contains it.
Buffer<std::uint32_t> sizing_nodes(const Octree& octree, const LatticeSizing& sizing) {
    Buffer<std::uint32_t> node(octree.node_count()), of_leaf(octree.leaf_count());
    node[0] = 0;
    for (std::uint32_t n = 0; n < octree.node_count(); ++n) {
        if (octree.is_leaf(n)) {
            of_leaf[octree.leaf(n)] = node[n];
            continue;
        }
        const std::uint32_t split = sizing.split_number[node[n]];
        for (unsigned o = 0; o < 8; ++o)
            node[octree.child(n, o)] = split == kNoIndex ? node[n] : 8 * split + 1 + o;
    }
    return of_leaf;
}

}  // namespace

LeafSegments::LeafSegments(const Octree& octree, LatticeSizing sizing)
    : sizing_(std::move(sizing)), node_(sizing_nodes(octree, sizing_)) {
    sizing_.split.clear();
    sizing_.split_number = {};
}

CompressedRows<std::uint32_t> passing_axes(const LatticeCells& cells, const LeafSegments& segments,
                                           std::span<const RoundCone> cones, const LatticeCube& cube,
                                           std::span<const std::uint32_t> leaves, const Context& ctx) {
    const CompressedRows<std::uint32_t> in_leaf = axes_in_leaves(cells, segments, cones, cube, ctx);
    const auto row = [&](std::vector<std::uint32_t>& items, std::uint32_t i) {
        const auto begin = static_cast<std::ptrdiff_t>(items.size());
        const auto add = [&](std::uint32_t leaf) {
            const auto in = in_leaf[leaf];
            items.insert(items.end(), in.begin(), in.end());
        };
        add(leaves[i]);
        for (unsigned direction = 0; direction < 6; ++direction) {
            const std::uint32_t other = cells.other(leaves[i], direction);
            if (other != kNoIndex) add(other);
        }
        std::sort(items.begin() + begin, items.end());
        items.erase(std::unique(items.begin() + begin, items.end()), items.end());
    };
    return make_rows(leaves.size(), row, ctx);
}

}  // namespace coppice
