#include <algorithm>
#include <limits>

#include "coppice/base/parallel.h"
#include "coppice/field/convolution_field.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/remesh/smooth_patch_internal.h"
#include "coppice/pipeline/repair/patch_internal.h"
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

constexpr int kSmoothingPasses = 6;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();  // not equal to any value
constexpr float kMaxTipError = 0.2f;  // [radii] distance of the surface from the end of a tip
constexpr float kBoxMargin = 0.3f;  // [radii] maximum distance of moved vertices from the box of their region

std::vector<EdgeMiddle> ring_middles(std::span<const CutRing> cut_rings) {
    std::vector<EdgeMiddle> out;
    std::uint32_t first = 0;
    for (const CutRing& cut_ring : cut_rings) {
        const auto n = static_cast<std::uint32_t>(cut_ring.ring.size());
        for (std::uint32_t k = 0; k < n; k += 2)
            out.push_back({first + k, first + (k + 2) % n, first + k + 1});
        first += n;
    }
    return out;
}

// Returns the repair level at a row of the surface.
RepairLevel repair_level_at(std::span<const RepairLevel> repair_level, TubeRow s) {
    return repair_level[std::min<std::size_t>(s, repair_level.size() - 1)];
}

float radius_at(const Segment& s, Vec3 p) { return round_cone<float>(s).closest_point(p).radius; }

// Returns the vertices that may move, each with the region of a close segment.
std::vector<PatchVertex> moving_vertices(const PatchSurface& surface, const PatchQuads& made) {
    std::vector<std::uint8_t> is_done(made.positions.size(), 0);
    std::vector<PatchVertex> out;
    const auto near = [&](std::uint32_t v, std::uint32_t triangle) {
        if (v < surface.near.size()) return surface.near[v];
        NodeId found;
        for (const std::uint32_t corner : surface.triangles[triangle]) {
            if (surface.near[corner]) found = surface.near[corner];
        }
        return found;
    };
    for (std::size_t q = 0; q < made.patch.quads.size(); ++q) {
        for (const std::uint32_t v : made.patch.quads[q]) {
            if (v < surface.ring_vertices || is_done[v] != 0) continue;
            is_done[v] = 1;
            const NodeId n = near(v, made.patch.triangle[q]);
            if (n)
                out.push_back(
                    {v, n.index(), radius_at(surface.patch_skeleton.skeleton.segment(n), made.positions[v])});
        }
    }
    std::sort(out.begin(), out.end(), [](const PatchVertex& a, const PatchVertex& b) {
        return a.region != b.region ? a.region < b.region : a.vertex < b.vertex;
    });
    return out;
}

// One region per node: around the vertices of its segment, with a margin.
std::vector<Box3> region_boxes(const Skeleton& s, std::span<const PatchVertex> moving,
                               std::span<const Vec3> positions) {
    std::vector<Box3> boxes(s.size());
    for (const PatchVertex& m : moving) boxes[m.region].extend(positions[m.vertex]);
    for (const NodeId n : nodes(s)) {
        Box3& box = boxes[n.index()];
        if (box.empty()) box.extend(s.position(n));
        const float radius = s.is_root(n) ? s.radius(n) : std::max(s.segment(n).radius_a, s.radius(n));
        box = box.inflated(kBoxMargin * radius);
    }
    return boxes;
}

// Moves the vertex closest to the end of each round tip onto it, and removes it from those that may move.
// Ends inside of other branches have no such vertex. Returns these vertices, ascending.
std::vector<std::uint32_t> pin_tips(std::vector<PatchVertex>& moving, const Skeleton& s,
                                    std::span<Vec3> positions, FieldRef field) {
    std::vector<std::uint32_t> pinned;
    for (std::size_t first = 0, end = 0; first < moving.size(); first = end) {
        while (end < moving.size() && moving[end].region == moving[first].region) ++end;
        const NodeId n(moving[first].region);
        if (s.is_root(n) || !s.is_tip(n)) continue;
        const Segment segment = s.segment(n);
        const Vec3 tip = segment.b + normalized(segment.b - segment.a) * segment.radius_b;
        const auto distance_to_tip = [&](const PatchVertex& m) { return distance(positions[m.vertex], tip); };
        const PatchVertex closest =
            *std::ranges::min_element(moving.begin() + static_cast<std::ptrdiff_t>(first),
                                      moving.begin() + static_cast<std::ptrdiff_t>(end), {}, distance_to_tip);
        Vec3 target = tip;
        move_to_level({&target, 1}, {&closest, 1}, field);
        const bool is_outside = distance(target, tip) < kMaxTipError * segment.radius_b;
        if (!is_outside || distance_to_tip(closest) > segment.radius_b) continue;
        positions[closest.vertex] = target;
        pinned.push_back(closest.vertex);
    }
    std::ranges::sort(pinned);
    std::erase_if(moving, [&](const PatchVertex& m) { return std::ranges::binary_search(pinned, m.vertex); });
    return pinned;
}

void smooth(PatchQuads& made, const PatchSurface& surface, const MeshOptions& options, const Context& ctx) {
    std::vector<PatchVertex> moving = moving_vertices(surface, made);
    if (moving.empty()) return;
    ConvolutionField field(surface.patch_skeleton.skeleton, surface_field_options(options), ctx);
    field.set_regions(region_boxes(surface.patch_skeleton.skeleton, moving, made.positions), ctx);
    if (options.control.tips == TipShape::round)
        made.pinned = pin_tips(moving, surface.patch_skeleton.skeleton, made.positions, FieldRef(field));
    smooth_patch(made.positions, made.patch.quads, moving, FieldRef(field), kSmoothingPasses, ctx);
    enclose_volume(made.positions, made.patch.quads, moving);
}

bool put_back(PatchQuads& made, const Quad& quad, bool tips_too) {
    bool moved = false;
    for (const std::uint32_t v : quad) {
        if (!tips_too && std::ranges::binary_search(made.pinned, v)) continue;
        moved |= made.positions[v] != made.unsmoothed[v];
        made.positions[v] = made.unsmoothed[v];
    }
    return moved;
}

// Undoes smoothing and joining where the repair level requires it.
void raise_repair_level(PatchQuads& made, const PatchSurface& surface,
                        std::span<const RepairLevel> repair_level) {
    std::vector<std::uint8_t> alone(surface.triangles.size());
    for (std::size_t t = 0; t < alone.size(); ++t)
        alone[t] = repair_level_at(repair_level, surface.tube_row[t]) == RepairLevel::flat ? 1 : 0;
    const std::size_t count = made.positions.size();
    split_pairs(made.patch, alone, made.unsmoothed);
    for (std::size_t v = count; v < made.unsmoothed.size(); ++v) made.positions.push_back(made.unsmoothed[v]);
    for (std::size_t q = 0; q < made.patch.quads.size(); ++q) {
        const Quad& quad = made.patch.quads[q];
        const bool is_split =
            std::any_of(quad.begin(), quad.end(), [&](std::uint32_t v) { return v >= count; });
        if (is_split ||
            repair_level_at(repair_level, surface.tube_row[made.patch.triangle[q]]) != RepairLevel::none)
            put_back(made, quad, true);
    }
}

// Moves vertices of folded quads back to their positions before smoothing, those at tips only if nothing else
// helps, until there are no additional folded quads.
void put_back_folded(PatchQuads& made, const Context& ctx) {
    const std::vector<Quad>& quads = made.patch.quads;
    std::vector<std::uint8_t> is_folded(quads.size());
    for (bool moved = true, tips_too = false; moved;) {
        parallel_for(ctx, quads.size(), 1024, [&](std::size_t q) {
            is_folded[q] = scaled_jacobian(quads[q], made.positions) > 0 ? 0 : 1;
        });
        moved = false;
        for (std::size_t q = 0; q < quads.size(); ++q) {
            if (is_folded[q] != 0) moved |= put_back(made, quads[q], tips_too);
        }
        if (moved || tips_too) continue;
        moved = tips_too = true;
    }
}

}  // namespace

void make_quads(PatchQuads& made, const PatchSurface& surface, std::span<const RepairLevel> repair_level,
                const MeshOptions& options, const Context& ctx) {
    Buffer<Vec3> before;
    if (made.patch.quads.empty()) {
        made.positions = surface.positions;
        made.patch = quadrangulate(surface.triangles, ring_middles(surface.group.cut_rings), made.positions);
        made.unsmoothed = made.positions;
        smooth(made, surface, options, ctx);
    } else {
        before = made.positions;
        for (std::size_t q = 0; q < made.is_new.size(); ++q) {
            if (made.is_new[q] == 0) continue;
            for (const std::uint32_t v : made.patch.quads[q]) before[v].x = kUnknown;
        }
    }
    raise_repair_level(made, surface, repair_level);
    put_back_folded(made, ctx);
    // A quad that has neither moved nor been cut again since its check needs no other check.
    made.is_new.resize(made.patch.quads.size());
    for (std::size_t q = 0; q < made.is_new.size(); ++q) {
        const Quad& quad = made.patch.quads[q];
        const auto stayed = [&](std::uint32_t v) {
            return v < before.size() && before[v] == made.positions[v];
        };
        made.is_new[q] = std::all_of(quad.begin(), quad.end(), stayed) ? 0 : 1;
    }
}

}  // namespace coppice::pipeline_internal
