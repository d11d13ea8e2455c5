#include "coppice/pipeline/displace.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/fit/limit_offsets_internal.h"
#include "coppice/pipeline/fit/local_radii_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/texture/height_filter_internal.h"

namespace coppice {
namespace {

using pipeline_internal::HeightFilter;
using pipeline_internal::LocalRadii;

constexpr std::size_t kDisplaceGrain = 2048;

/// A surface with texture coordinates, to be moved.
struct TexturedSurface {
    PolygonMesh start;
    std::span<const TexturePoint> texture;
    std::span<const std::uint32_t> slots;  ///< of the faces; may be empty
    CompressedRows<std::uint32_t> faces_of;

    std::size_t vertex_count() const { return start.positions.size(); }
    /// Returns whether the coordinates of a face are those of bark.
    bool is_bark(std::uint32_t face) const {
        return slots.empty() || slots[face] != static_cast<std::uint32_t>(MaterialSlot::cut);
    }
};

/// Returns the distances in the texture from a corner to its neighbours in the face, along u and v.
TexturePoint corner_spacing(std::span<const TexturePoint> face, std::size_t k) {
    const TexturePoint at = face[k];
    TexturePoint out;
    for (const std::size_t other : {(k + 1) % face.size(), (k + face.size() - 1) % face.size()}) {
        out.u = std::max(out.u, std::fabs(face[other].u - at.u));
        out.v = std::max(out.v, std::fabs(face[other].v - at.v));
    }
    return out;
}

/// Returns the mean height at the corners of a vertex, except those of flat ends.
double height_at(const TexturedSurface& surface, const HeightFilter& heights, std::uint32_t v) {
    double sum = 0, count = 0;
    for (const std::uint32_t f : surface.faces_of[v]) {
        if (!surface.is_bark(f)) continue;
        const auto face = surface.start.face(f);
        const auto points = surface.texture.subspan(surface.start.first[f], face.size());
        const auto k = static_cast<std::size_t>(std::ranges::find(face, v) - face.begin());
        sum += heights.mean(points[k], corner_spacing(points, k));
        ++count;
    }
    return count > 0 ? sum / count : heights.mean();
}

/// Returns the unit vector along which a vertex must not move: that of the axis at flat bases and beyond
/// tips; 0 elsewhere.
Vec3d held_axis(const Skeleton& skeleton, const CapsuleTree& capsules, std::uint32_t capsule, Vec3d p) {
    constexpr double kSlack = 1e-3;  // [segments] rounding of positions in the plane of an end
    const RoundCone& cone = capsules.cone(capsule);
    const NodeId node = capsules.node(capsule);
    const double t = cone.line_parameter(p);
    const bool is_beyond_tip = t >= 1 - kSlack && skeleton.is_tip(node);
    const bool is_at_base = t <= kSlack && !skeleton.is_root(node) && skeleton.is_root(skeleton.parent(node));
    return is_beyond_tip || is_at_base ? normalized(cone.axis, {0, 0, 0}) : Vec3d();
}

/// Returns the direction of each vertex: its normal, without the component along the axis at ends.
std::vector<Vec3> find_directions(const TexturedSurface& surface, const Skeleton& skeleton,
                                  const CapsuleTree& capsules, const LocalRadii& local, const Context& ctx) {
    std::vector<Vec3> out(surface.vertex_count());
    parallel_for(ctx, out.size(), kDisplaceGrain, [&](std::size_t v) {
        if (local.capsule[v] == kNoIndex) return;
        Vec3d sum;
        for (const std::uint32_t f : surface.faces_of[v])
            sum += pipeline_internal::area_vector(surface.start.face(f), surface.start.positions);
        const Vec3d normal = normalized(sum, {0, 0, 0});
        const Vec3d held = held_axis(skeleton, capsules, local.capsule[v], Vec3d(surface.start.positions[v]));
        out[v] = Vec3(normal - held * dot(normal, held));
    });
    return out;
}

/// Returns the displacement of each vertex before it is limited; `scale` [m] is that of thick branches.
std::vector<float> find_offsets(const TexturedSurface& surface, const HeightFilter& heights,
                                std::span<const float> radius, double scale, double share,
                                const Context& ctx) {
    std::vector<float> out(surface.vertex_count(), 0);
    const double largest = scale * heights.amplitude();
    parallel_for(ctx, out.size(), kDisplaceGrain, [&](std::size_t v) {
        const double allowed = share * double{radius[v]};
        const double local_scale = largest > allowed ? scale * allowed / largest : scale;
        const double height = height_at(surface, heights, static_cast<std::uint32_t>(v));
        out[v] = static_cast<float>(local_scale * (height - heights.mean()));
    });
    return out;
}

void report_offsets(std::span<const float> wanted, const pipeline_internal::MovingSurface& moving,
                    std::span<const float> offsets, DisplaceReport& report) {
    for (std::size_t v = 0; v < offsets.size(); ++v) {
        const double offset = std::fabs(double{offsets[v]}) * double{length(moving.direction[v])};
        report.displaced += offset > 0 ? 1 : 0;
        report.pulled_back += wanted[v] != offsets[v] ? 1 : 0;
        report.mean_offset += offset / static_cast<double>(offsets.size());
        report.max_offset = std::max(report.max_offset, offset);
    }
}

DisplaceReport displace(TexturedSurface surface, Buffer<Vec3>& positions, const Skeleton& skeleton,
                        const HeightFilter& heights, double scale, double share, const Context& ctx) {
    constexpr std::uint32_t kHalvings = 6;
    DisplaceReport report{.scale = scale};
    const CapsuleTree capsules(skeleton, surface.start.origin, ctx);
    const LocalRadii local =
        pipeline_internal::find_local_radii(surface.start, surface.faces_of, skeleton, capsules, ctx);
    const std::vector<Vec3> directions = find_directions(surface, skeleton, capsules, local, ctx);
    std::vector<float> offsets = find_offsets(surface, heights, local.radius, scale, share, ctx);
    ctx.report(0.4f);
    const std::vector<float> wanted = offsets;
    const pipeline_internal::MovingSurface moving{surface.start, surface.faces_of, directions};
    const auto limited = pipeline_internal::limit_offsets(moving, offsets, kHalvings, ctx);
    if (!limited.complete)
        throw InvalidInput(
            "the surface intersects itself too often to be displaced; repair its skeleton first");
    report.rounds = limited.rounds;
    pipeline_internal::apply_offsets(moving, offsets, positions, ctx);
    report_offsets(wanted, moving, offsets, report);
    report.volume_before = signed_volume(surface.start, ctx);
    surface.start.positions = positions;
    report.volume_after = signed_volume(surface.start, ctx);
    ctx.report(1);
    return report;
}

void check_surface(const MeshResult& surface) {
    if (!surface.texture || surface.atlas)
        throw InvalidInput("displace: the surface needs texture coordinates of bark");
    if (std::holds_alternative<CylinderMesh>(surface.surface))
        throw InvalidInput("displace: cylinders intersect each other; displace a surface of another method");
    const auto* triangles = std::get_if<TetraSurface>(&surface.surface);
    if (triangles != nullptr && !triangles->solid.tetra.empty())
        throw InvalidInput("displace: the tetrahedra inside the surface would not move along");
}

}  // namespace

DisplaceReport displace_surface(MeshResult& surface, const Skeleton& skeleton, const HeightTexture& texture,
                                const DisplaceOptions& options, const Context& ctx) {
    check_fields(options, "displace");
    check_surface(surface);
    const float scale = options.displace_height > 0 ? options.displace_height : texture.scale;
    if (!(scale > 0))
        throw InvalidInput("displace: the heights have no scale; give displace_height in metres");
    TexturedSurface textured{to_polygons(surface), surface.texture->points, surface.slots, {}};
    textured.faces_of = pipeline_internal::faces_by_vertex(textured.start);
    const HeightFilter heights(texture);
    const DisplaceReport report = std::visit(
        [&](auto& made) {
            return displace(std::move(textured), made.mesh.positions, skeleton, heights, double{scale},
                            double{options.displace_share}, ctx);
        },
        surface.surface);
    const double gained = report.volume_after - report.volume_before;
    if (surface.measured) surface.measured->mesh += gained;
    if (surface.fitted) surface.fitted->after += gained;
    return report;
}

void list_fields(DisplaceOptions& o, FieldList& list) {
    list.add(
        Field{"displace_height",
              "Difference in height of black and white in the image of heights; 0 uses that of the file.",
              Unit::metre, 0, 1000},
        o.displace_height);
    list.add(
        Field{"displace_share", "Maximum displacement by heights, which are scaled down on thin branches.",
              Unit::radius, 0.001, 0.5},
        o.displace_share);
}

}  // namespace coppice
