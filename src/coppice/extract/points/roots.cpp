#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/graph_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kBand = 0.06;       // [height of a tree] height of the band in which trunks are searched
constexpr double kTrunkShare = 0.4;  // minimum number of points of another trunk, relative to the largest one
// minimum number of points of another tree, relative to the largest component
constexpr double kTreeShare = 0.1;
constexpr std::uint32_t kMin = 20;  // minimum number of points of a tree

struct Slice {
    std::vector<std::uint32_t> points;
    float low = 0, high = 0;
};

/// Returns the points of one component with z <= top, by connected sections.
std::vector<Slice> pieces_below(std::span<const Vec3> points, const Graph& graph,
                                std::span<const std::uint32_t> members, float top,
                                std::vector<std::uint8_t>& seen, const Context& ctx) {
    std::vector<Slice> pieces;
    std::vector<std::uint32_t> open;
    for (const std::uint32_t start : members) {
        if (points[start].z > top || seen[start]) continue;
        Slice piece{{}, points[start].z, points[start].z};
        open.assign(1, start);
        seen[start] = 1;
        while (!open.empty()) {
            const std::uint32_t p = open.back();
            open.pop_back();
            poll_stop(ctx, piece.points.size());
            piece.points.push_back(p);
            piece.low = std::min(piece.low, points[p].z);
            piece.high = std::max(piece.high, points[p].z);
            for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
                const std::uint32_t q = graph.to[e];
                if (seen[q] || points[q].z > top) continue;
                seen[q] = 1;
                open.push_back(q);
            }
        }
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

/// Returns the lowest slice of a trunk, high enough to contain a ring of points.
std::vector<std::uint32_t> find_base_points(std::span<const Vec3> points, const Slice& trunk,
                                            double spacing) {
    std::vector<std::uint32_t> base;
    const double top = trunk.low + std::min(std::max(1.5 * spacing, 0.05 * (trunk.high - trunk.low)),
                                            0.5 * double{trunk.high - trunk.low});
    for (const std::uint32_t p : trunk.points) {
        if (points[p].z <= top) base.push_back(p);
    }
    std::ranges::sort(base);
    return base;
}

/// Returns the point of the graph closest to a position; kNoIndex if the graph has no edge.
std::uint32_t nearest_point(std::span<const Vec3> points, const Graph& graph, Vec3d place) {
    std::uint32_t nearest = kNoIndex;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const double squared = length_squared(Vec3d(points[i]) - place);
        if (graph.first[i] == graph.first[i + 1] || squared >= least) continue;
        least = squared;
        nearest = i;
    }
    return nearest;
}

/// Returns the points of each component that is large enough for a tree; empty for the others.
std::vector<std::vector<std::uint32_t>> points_of_trees(const Components& parts) {
    const std::vector<std::uint8_t> large = mark_large_parts(parts);
    std::vector<std::vector<std::uint32_t>> members(parts.size.size());
    for (std::uint32_t i = 0; i < parts.of.size(); ++i)
        if (large[parts.of[i]]) members[parts.of[i]].push_back(i);
    return members;
}

struct Stem {
    std::size_t size;  // number of points of its lowest section
    std::vector<std::uint32_t> base;
};

/// Returns the stems of one component: the lowest sections as thick as a trunk.
std::vector<Stem> find_stems(std::span<const Vec3> points, const Graph& graph,
                             std::span<const std::uint32_t> members, double spacing,
                             std::vector<std::uint8_t>& seen, const Context& ctx) {
    float low = points[members[0]].z, high = low;
    for (const std::uint32_t p : members) {
        low = std::min(low, points[p].z);
        high = std::max(high, points[p].z);
    }
    const auto band = static_cast<float>(std::max(kBand * (high - low), 3 * spacing));
    const auto pieces = pieces_below(points, graph, members, low + band, seen, ctx);
    std::vector<Stem> stems;
    std::size_t most = 0;
    for (const Slice& piece : pieces) most = std::max(most, piece.points.size());
    for (const Slice& piece : pieces) {
        const bool whole = piece.high - piece.low > 0.6f * band;
        const bool thick = static_cast<double>(piece.points.size()) > kTrunkShare * static_cast<double>(most);
        if (piece.points.size() == most || (whole && thick))
            stems.push_back({piece.points.size(), find_base_points(points, piece, spacing)});
    }
    return stems;
}

}  // namespace

std::vector<std::uint8_t> mark_large_parts(const Components& parts) {
    const std::uint32_t largest = *std::ranges::max_element(parts.size);
    std::vector<std::uint8_t> large(parts.size.size());
    for (std::size_t part = 0; part < large.size(); ++part)
        large[part] = parts.size[part] >= std::min(kMin, largest) && parts.size[part] >= kTreeShare * largest;
    return large;
}

std::vector<std::vector<std::uint32_t>> find_roots(std::span<const Vec3> points, const Graph& graph,
                                                   const Components& parts, const RootOptions& options,
                                                   const Context& ctx) {
    if (options.given) {
        const std::uint32_t nearest = nearest_point(points, graph, *options.given);
        if (nearest == kNoIndex) return {};
        return {{nearest}};
    }
    std::vector<Stem> stems;
    std::vector<std::uint8_t> seen(points.size(), 0);
    for (const auto& members : points_of_trees(parts)) {
        if (members.empty()) continue;
        for (Stem& stem : find_stems(points, graph, members, options.spacing, seen, ctx))
            stems.push_back(std::move(stem));
    }
    // Thickest first, so that a limit keeps the most important trees.
    std::ranges::stable_sort(stems, std::ranges::greater{}, &Stem::size);
    if (options.max_trees > 0 && stems.size() > static_cast<std::size_t>(options.max_trees))
        stems.resize(static_cast<std::size_t>(options.max_trees));
    std::vector<std::vector<std::uint32_t>> roots;
    for (Stem& stem : stems) roots.push_back(std::move(stem.base));
    return roots;
}

}  // namespace coppice::extract_internal
