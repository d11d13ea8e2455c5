#include "coppice/mesh/half_edges.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"

namespace coppice {
namespace {

constexpr std::size_t kHalfEdgeGrain = 1 << 14;

/// A half-edge with the vertices of its edge; `code` is 2 half-edge + (1 if it is backward).
struct Entry {
    std::uint32_t low, high, code;
};

bool same_edge(const Entry& a, const Entry& b) { return a.low == b.low && a.high == b.high; }

/// Numbers of elements of a part of the entries; finally of all previous parts.
struct Count {
    std::uint32_t edges = 0, irregular = 0;

    Count& operator+=(const Count& c) {
        edges += c.edges;
        irregular += c.irregular;
        return *this;
    }
};

/// Returns the bounds of parts of about equal size that contain all entries of their lower vertices.
std::vector<std::size_t> split(std::span<const Entry> entries) {
    std::vector<std::size_t> bounds{0};
    while (bounds.back() < entries.size()) {
        std::size_t end = std::min(bounds.back() + kHalfEdgeGrain, entries.size());
        while (end < entries.size() && entries[end].low == entries[end - 1].low) ++end;
        bounds.push_back(end);
    }
    return bounds;
}

/// Calls visit(group) for each longest sequence of entries of which successive ones are the same.
template <class Same, class Visit>
void for_each_group(std::span<Entry> entries, const Same& same, const Visit& visit) {
    for (std::size_t i = 0; i < entries.size();) {
        std::size_t end = i + 1;
        while (end < entries.size() && same(entries[i], entries[end])) ++end;
        visit(entries.subspan(i, end - i));
        i = end;
    }
}

/// Sorts the entries of one lower vertex. Most are few: insertion sort avoids the overhead of std::sort.
void sort_by_high(std::span<Entry> entries) {
    const auto less = [](const Entry& a, const Entry& b) {
        return a.high != b.high ? a.high < b.high : a.code < b.code;
    };
    if (entries.size() > 32) return std::sort(entries.begin(), entries.end(), less);
    for (std::size_t i = 1; i < entries.size(); ++i) {
        const Entry e = entries[i];
        std::size_t j = i;
        for (; j > 0 && less(e, entries[j - 1]); --j) entries[j] = entries[j - 1];
        entries[j] = e;
    }
}

bool is_irregular(std::span<const Entry> edge) {
    return edge.size() > 2 || (edge.size() == 2 && (edge[0].code & 1) == (edge[1].code & 1));
}

Count sort_and_count(std::span<Entry> part) {
    Count count;
    for_each_group(
        part, [](const Entry& a, const Entry& b) { return a.low == b.low; }, sort_by_high);
    for_each_group(part, same_edge, [&](std::span<const Entry> edge) {
        ++count.edges;
        if (is_irregular(edge)) count.irregular += static_cast<std::uint32_t>(edge.size());
    });
    return count;
}

}  // namespace

HalfEdges::HalfEdges(std::span<const Quad> quads, std::uint32_t vertex_count, const Context& ctx)
    : corners_(all_corners(quads)),
      arity_(4),
      face_count_(static_cast<std::uint32_t>(quads.size())),
      vertex_count_(vertex_count) {
    build(ctx);
}

HalfEdges::HalfEdges(std::span<const Triangle> triangles, std::uint32_t vertex_count, const Context& ctx)
    : corners_(all_corners(triangles)),
      arity_(3),
      face_count_(static_cast<std::uint32_t>(triangles.size())),
      vertex_count_(vertex_count) {
    build(ctx);
}

HalfEdges::HalfEdges(const PolygonMesh& mesh, const Context& ctx)
    : corners_(mesh.corners),
      first_(mesh.first),
      face_count_(mesh.face_count()),
      vertex_count_(static_cast<std::uint32_t>(mesh.positions.size())),
      faces_(mesh.corners.size()) {
    build(ctx);
}

void HalfEdges::build(const Context& ctx) {
    COPPICE_ASSERT(corners_.size() <= std::size_t{1} << 31);
    Buffer<Entry> entries(corners_.size());
    parallel_for(ctx, face_count_, kHalfEdgeGrain / 4, [&](std::size_t i) {
        const auto f = static_cast<std::uint32_t>(i);
        const std::uint32_t begin = first(f), end = first(f + 1);
        for (std::uint32_t h = begin; h < end; ++h) {
            const std::uint32_t a = corners_[h], b = corners_[h + 1 < end ? h + 1 : begin];
            entries[h] = {std::min(a, b), std::max(a, b), 2 * h + (a > b ? 1u : 0u)};
            if (arity_ == 0) faces_[h] = f;
        }
    });
    radix_sort(ctx, entries, std::bit_width(vertex_count_), [](const Entry& e) { return e.low; });
    const std::vector<std::size_t> bounds = split(entries);
    std::vector<Count> counts(bounds.size());
    const auto part = [&](std::size_t p) {
        return std::span(entries).subspan(bounds[p], bounds[p + 1] - bounds[p]);
    };
    parallel_for(ctx, bounds.size() - 1, 1, [&](std::size_t p) { counts[p] = sort_and_count(part(p)); });
    const Count total = exclusive_scan(std::span(counts));
    sides_.resize(corners_.size());
    pairs_.resize(total.edges);
    irregular_.resize(total.irregular);
    parallel_for(ctx, bounds.size() - 1, 1, [&](std::size_t p) {
        Count at = counts[p];
        for_each_group(part(p), same_edge, [&](std::span<const Entry> edge) {
            auto& pair = pairs_[at.edges] = {kNoIndex, kNoIndex};
            const bool irregular = is_irregular(edge);
            for (const Entry& e : edge) {
                sides_[e.code >> 1] = 2 * at.edges + (e.code & 1);
                (irregular ? irregular_[at.irregular++] : pair[e.code & 1]) = e.code >> 1;
            }
            ++at.edges;
        });
    });
}

std::span<const std::uint32_t> HalfEdges::halves(std::uint32_t e) const {
    const auto& pair = pairs_[e];
    if (pair[0] != kNoIndex) return {pair.data(), pair[1] != kNoIndex ? std::size_t{2} : 1};
    if (pair[1] != kNoIndex) return {pair.data() + 1, 1};
    const auto find_edge = [&](std::uint32_t h) { return edge(h); };
    return {std::ranges::lower_bound(irregular_, e, {}, find_edge),
            std::ranges::upper_bound(irregular_, e, {}, find_edge)};
}

std::array<std::uint32_t, 2> HalfEdges::ends(std::uint32_t e) const {
    const std::uint32_t h = halves(e)[0], a = origin(h), b = target(h);
    return {std::min(a, b), std::max(a, b)};
}

std::uint32_t HalfEdges::find(std::uint32_t a, std::uint32_t b) const {
    const std::array<std::uint32_t, 2> wanted{std::min(a, b), std::max(a, b)};
    const auto found = std::ranges::lower_bound(pairs_, wanted, {}, [&](const auto& pair) {
        return ends(static_cast<std::uint32_t>(&pair - pairs_.data()));
    });
    if (found == pairs_.end()) return kNoIndex;
    const auto e = static_cast<std::uint32_t>(found - pairs_.begin());
    return ends(e) == wanted ? e : kNoIndex;
}

}  // namespace coppice
