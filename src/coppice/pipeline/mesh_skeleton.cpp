#include "coppice/pipeline/mesh_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "coppice/base/check_fields.h"
#include "coppice/base/progress.h"
#include "coppice/field/list_kernel.h"
#include "coppice/pipeline/end_shapes_internal.h"
#include "coppice/pipeline/fit/fit_volume_internal.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/fit/measured_volume_internal.h"
#include "coppice/pipeline/quads/built_mesh_internal.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"
#include "coppice/pipeline/texture/atlas_internal.h"
#include "coppice/pipeline/texture/bark_texture_internal.h"
#include "coppice/pipeline/texture/flat_cuts_internal.h"
#include "coppice/pipeline/texture/texture_quality_internal.h"
#include "coppice/pipeline/texture/vertex_attributes_internal.h"

namespace coppice {
namespace {

using pipeline_internal::BarkTexture;
using pipeline_internal::BuiltMesh;
using pipeline_internal::KeptQuads;

// Use of a surface after it is built.
enum class Use {
    still,
    solid,  // with the tetrahedra inside
    posed,  // moved along with its skeleton
};

CylinderMesh mesh_by_cylinders(const Skeleton& prepared, const MeshOptions& options, const Context& ctx,
                               Stages& stages) {
    const CylinderOptions tubes{
        .sides = options.control.sides << options.levels,
        .rows = 1 << options.levels,
        .thin = options.tube_sides,
        .tips = options.control.tips,
        .tile = options.texture.coordinates == TextureCoordinates::bark ? options.texture.tile : 0,
        .base = options.control.base};
    return stages.run("cylinders", 1.0f, [&] { return cylinders(prepared, tubes, ctx); });
}

// Fits the surface to the volume of a skeleton.
struct Fitting {
    const Skeleton& skeleton;
    const ControlOptions& ends;
    const QuadBuild& build;
    const Context& ctx;

    FitVolumeReport operator()(QuadSurface& surface) const {
        if (surface.coarsened) return fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), ctx);
        KeptQuads kept(build, ctx);
        const auto search = [&](const PolygonMesh& moved, std::uint32_t limit, const Context& c) {
            return kept.crossings(moved, build.tubes, limit, c);
        };
        return pipeline_internal::fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), search,
                                             ctx);
    }
    FitVolumeReport operator()(TetraSurface& surface) const {
        return fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), ctx);
    }
    FitVolumeReport operator()(CylinderMesh&) const {
        throw InvalidInput("mesh: fit must be surface for cylinders, which intersect each other at forks");
    }
};

// Returns whether the volume decides if a surface is fitted.
bool fits_where_off(const MeshOptions& options) {
    const FieldOptions& field = options.field;
    const bool makes_quads =
        options.method == MeshMethod::quads || options.method == MeshMethod::ramifications;
    return options.fit == Fit::automatic && makes_quads && options.control.base != BaseShape::open &&
           field.kernel != Kernel::balls && field.weights == Weights::local && field.radius_scale == 0;
}

VolumeReport measured_volume(const QuadMesh& mesh, const Skeleton& skeleton, const ControlOptions& ends,
                             const Context& ctx) {
    const ConeUnion solid(skeleton, mesh.origin, base_end(ends), tip_end(ends), ctx);
    return pipeline_internal::measured_volume(mesh, solid, ctx);
}

// Relative error of the volume, which is known to half a percent or better.
constexpr double kMaxDeviation = 0.005;

bool is_off(const VolumeReport& volume) {
    return std::abs(volume.mesh - volume.cones) > kMaxDeviation * volume.cones + volume.error;
}

// Fits a surface, or leaves it unchanged if that does not improve its volume.
std::optional<FitVolumeReport> fit_where_better(QuadSurface& surface, const Fitting& fitting) {
    Buffer<Vec3> before = surface.mesh.positions;
    const FitVolumeReport report = fitting(surface);
    if (std::abs(report.after - report.cones) < std::abs(report.before - report.cones)) return report;
    surface.mesh.positions = std::move(before);
    return {};
}

void check_sides(const MeshOptions& options) {
    if (options.tube_sides == TubeSides::by_radius && options.method == MeshMethod::tetrahedra)
        throw InvalidInput("mesh: tube_sides must not be by_radius for tetrahedra, which have no tubes");
    if (options.chord_error == 0) return;
    if (options.tube_sides != TubeSides::by_radius || options.method == MeshMethod::cylinders)
        throw InvalidInput("mesh: chord_error needs quads with tube_sides by_radius");
}

bool has_slots(const SlotOptions& slots) { return slots.twigs || slots.cuts; }

void check_slots(const MeshOptions& options) {
    if (has_slots(options.slots) && options.texture.coordinates != TextureCoordinates::bark)
        throw InvalidInput("mesh: slots of twigs and cuts need bark coordinates");
    if (options.slots.twigs && options.method == MeshMethod::cylinders)
        throw InvalidInput("mesh: twigs must not have a slot for cylinders, which intersect each other");
}

// Returns texture coordinates for the surface of a prepared skeleton.
struct Texturing {
    const Skeleton& prepared;
    const MeshOptions& options;
    const QuadBuild& build;
    const Context& ctx;

    BarkTexture operator()(const QuadSurface& surface) const {
        return pipeline_internal::bark_texture(surface.mesh, build, options.texture, options.slots, ctx);
    }
    // Triangles get the coordinates of quads around the same skeleton.
    BarkTexture operator()(const TetraSurface& surface) const {
        MeshOptions quads = options;
        quads.method = MeshMethod::quads;
        quads.levels = 1;
        quads.tube_sides = TubeSides::equal;
        quads.remesh_rounds = 0;
        quads.device = Device::cpu;
        std::vector<std::pair<std::string, double>> seconds;
        Stages stages(ctx, seconds);
        const BuiltQuads carrier = mesh_by_quads(prepared, {}, quads, {}, ctx, stages);
        return pipeline_internal::bark_texture(surface.mesh, carrier.build, options.texture, options.slots,
                                               ctx);
    }
    BarkTexture operator()(CylinderMesh& surface) const {
        Texture out{std::move(surface.texture), {.axes = surface.report.tubes}};
        pipeline_internal::measure_texture(surface.mesh, out.points, {options.texture.tile}, out.report, ctx);
        return {std::move(out), {}};
    }
};

// Calls use(faces) for the faces of a surface of any method.
template <class Use>
auto with_faces(const MeshResult& made, const Use& use) {
    if (const auto* triangles = std::get_if<TetraSurface>(&made.surface))
        return use(FaceView(to_polygons(triangles->mesh)));
    if (const auto* tubes = std::get_if<CylinderMesh>(&made.surface)) return use(FaceView(tubes->mesh));
    return use(FaceView(made.quads().mesh));
}

// Returns the options of bark coordinates with one tile around every branch.
MeshOptions with_one_tile(const Skeleton& prepared, MeshOptions options) {
    const float widest = std::ranges::max(prepared.radii());
    options.texture.tile = 4 * 2 * std::numbers::pi_v<float> * widest;
    options.texture.blend = false;
    return options;
}

// Returns attributes for the vertices of the surface of a prepared skeleton.
struct Attributing {
    const Skeleton& prepared;
    const QuadBuild& build;
    const Context& ctx;

    std::vector<VertexAttribute> operator()(const QuadSurface& surface) const {
        return pipeline_internal::vertex_attributes(surface.mesh, build, prepared, ctx);
    }
    std::vector<VertexAttribute> operator()(const auto& surface) const {
        return pipeline_internal::vertex_attributes(surface.mesh.positions, surface.mesh.origin, prepared,
                                                    ctx);
    }
};

// Makes tiles of another height than their width.
void set_tile_height(Texture& texture, const TextureOptions& options) {
    if (options.tile_height == 0) return;
    const float ratio = options.tile / options.tile_height;
    for (TexturePoint& point : texture.points) point.v *= ratio;
    for (TextureBlend& blend : texture.blends) blend.second.v *= ratio;
}

// Sets the slots of the faces, and the coordinates of those that close flat ends. `radii`: see BarkTexture.
void add_slots(BuiltMesh& built, const MeshOptions& options, std::span<const float> radii,
               const Context& ctx) {
    MeshResult& out = built.result;
    const auto set = [&](const FaceView& faces, Vec3d origin) {
        out.slots.assign(faces.size(), static_cast<std::uint32_t>(MaterialSlot::bark));
        for (std::size_t f = 0; f < radii.size(); ++f) {
            if (radii[f] >= 0 && 2 * radii[f] < options.slots.twig_diameter)
                out.slots[f] = static_cast<std::uint32_t>(MaterialSlot::twig);
        }
        if (!options.slots.cuts) return;
        const pipeline_internal::FlatCuts cuts(built.prepared, options.control, origin, ctx);
        const std::vector<std::uint32_t> end_of_face = cuts.find(faces, ctx);
        for (std::size_t f = 0; f < end_of_face.size(); ++f) {
            if (end_of_face[f] != kNoIndex) out.slots[f] = static_cast<std::uint32_t>(MaterialSlot::cut);
        }
        cuts.map(faces, end_of_face, *out.texture);
    };
    const Vec3d origin = std::visit([](const auto& surface) { return surface.mesh.origin; }, out.surface);
    with_faces(out, [&](const FaceView& faces) { set(faces, origin); });
}

void add_texture(BuiltMesh& built, const MeshOptions& options, const Context& ctx) {
    if (options.texture.coordinates == TextureCoordinates::none) return;
    MeshResult& out = built.result;
    const bool is_atlas = options.texture.coordinates == TextureCoordinates::atlas;
    const MeshOptions bark = is_atlas ? with_one_tile(built.prepared, options) : options;
    const Texturing texturing{built.prepared, bark, built.build, ctx};
    Stages stages(ctx, out.stages);
    BarkTexture made = stages.run("texture", 1.0f, [&] { return std::visit(texturing, out.surface); });
    out.texture = std::move(made.texture);
    if (!is_atlas) {
        set_tile_height(*out.texture, options.texture);
        if (has_slots(options.slots)) add_slots(built, options, made.radii, ctx);
        return;
    }
    auto atlas = stages.run("atlas", 1.0f, [&] {
        return with_faces(out, [&](const FaceView& faces) {
            return pipeline_internal::make_atlas(faces, *out.texture, options.texture.atlas_size, ctx);
        });
    });
    out.texture = std::move(atlas.texture);
    out.atlas = atlas.report;
}

// Adds the texture coordinates and the attributes that the options request.
void add_data(BuiltMesh& built, const MeshOptions& options, const Context& ctx) {
    add_texture(built, options, ctx);
    if (!options.attributes) return;
    MeshResult& out = built.result;
    const Attributing attributing{built.prepared, built.build, ctx};
    out.attributes =
        Stages(ctx, out.stages).run("attributes", 1.0f, [&] { return std::visit(attributing, out.surface); });
}

BuiltMesh make_surface(const Skeleton& given_skeleton, const PointSet& constraints, const MeshOptions& given,
                       Use use, const Context& ctx) {
    const bool may_use_device = given.method != MeshMethod::cylinders && use != Use::solid;
    if (may_use_device && given.device == Device::cuda) require_device();  // before any work
    MeshOptions options = given.method == MeshMethod::bmesh ? on_metaballs(given) : given;
    const bool may_fit = fits_where_off(options) && use != Use::posed;
    const bool fits = options.fit == Fit::volume;
    BuiltMesh built;
    MeshResult& out = built.result;
    const Context meshing = fits ? narrow_progress(ctx, 0, 0.5f) : ctx;
    Stages stages(meshing, out.stages);
    std::optional<Skeleton> bent;
    if (options.overlaps == Overlaps::apart && given_skeleton.tree_count() > 1) {
        bent = stages.run("apart", 0.03f, [&] {
            BendApartResult result = bend_apart(given_skeleton, {}, ctx);
            out.bent_apart = result.report;
            return std::move(result.skeleton);
        });
    }
    const Skeleton& skeleton = bent ? *bent : given_skeleton;
    PrepareResult prepared = stages.run("prepare", 0.05f, [&] { return prepare(skeleton, options.prepare); });
    out.prepared = prepared.report;
    if (options.method != MeshMethod::cylinders) check_branches(prepared.skeleton);
    if (options.method == MeshMethod::quads || options.method == MeshMethod::ramifications) {
        BuiltQuads quads =
            options.method == MeshMethod::quads
                ? mesh_by_quads(prepared.skeleton, constraints, options, {.is_posed = use == Use::posed},
                                meshing, stages)
                : mesh_by_ramifications(prepared.skeleton, constraints, options, meshing, stages);
        out.surface = std::move(quads.surface);
        built.build = std::move(quads.build);
        out.weights = built.build.weights;
    } else if (options.method == MeshMethod::cylinders) {
        out.surface = mesh_by_cylinders(prepared.skeleton, options, meshing, stages);
    } else {
        const auto make = use == Use::solid ? solid_by_tetrahedra : mesh_by_tetrahedra;
        out.surface = make(prepared.skeleton, constraints, options, out.weights, meshing, stages);
    }
    if (may_fit) {
        out.measured = stages.run("volume", 1.0f, [&] {
            return measured_volume(out.quads().mesh, skeleton, options.control, meshing);
        });
    }
    if (fits || (out.measured && is_off(*out.measured))) {
        const Context fitting_ctx = narrow_progress(ctx, fits ? 0.5f : 1, 1);
        const Fitting fitting{skeleton, options.control, built.build, fitting_ctx};
        out.fitted = Stages(fitting_ctx, out.stages).run("fit", 1.0f, [&] {
            return fits ? std::visit(fitting, out.surface) : fit_where_better(out.quads(), fitting);
        });
    }
    built.prepared = std::move(prepared.skeleton);
    if (use == Use::posed) {
        add_texture(built, options, ctx);
    } else {
        add_data(built, options, ctx);
    }
    return built;
}

// [share of the cones' volume] Returns the deviation of a surface, if it was measured.
double deviation(const MeshResult& made) {
    const double cones = made.fitted ? made.fitted->cones : made.measured->cones;
    return std::abs((made.fitted ? made.fitted->after : made.measured->mesh) / cones - 1);
}

// Computes a surface with one fit, and with another one if its volume deviates by more than `tolerance`;
// returns the closer result.
BuiltMesh make_closer(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                      std::array<Fit, 2> fits, double tolerance, const Context& ctx) {
    MeshOptions plain = options;
    plain.texture = {};  // added to the better one
    plain.slots = {};
    plain.attributes = false;
    const auto make = [&](Fit fit, const Context& part) {
        plain.fit = fit;
        return make_surface(skeleton, constraints, plain, Use::still, part);
    };
    BuiltMesh best = make(fits[0], narrow_progress(ctx, 0, 0.9f));
    if (deviation(best.result) > tolerance) {
        BuiltMesh other = make(fits[1], narrow_progress(ctx, 0.9f, 1));
        if (deviation(other.result) < deviation(best.result)) best = std::move(other);
    }
    add_data(best, options, ctx);
    return best;
}

// Returns a surface without the cage of its quads.
BuiltMesh make_mesh(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                    Use use, const Context& ctx) {
    check_fields(options, "mesh");
    check_fields(options.texture, "mesh");
    check_fields(options.slots, "mesh");
    check_sides(options);
    check_slots(options);
    if (use == Use::posed || !fits_where_off(options))
        return make_surface(skeleton, constraints, options, use, ctx);
    // The few sides of a cage have the correct volume for straight branches only, so it is fitted first.
    if (options.levels == 0)
        return make_closer(skeleton, constraints, options, {Fit::volume, Fit::automatic}, kMaxDeviation, ctx);
    return make_closer(skeleton, constraints, options, {Fit::automatic, Fit::volume},
                       VolumeReport::kMaxDeviation, ctx);
}

PolygonMesh make_polygons(const PolygonMesh& mesh) { return mesh; }
template <class Mesh>
PolygonMesh make_polygons(const Mesh& mesh) {
    return to_polygons(mesh);
}

}  // namespace

PolygonMesh to_polygons(const MeshResult& result) {
    return std::visit([](const auto& surface) { return make_polygons(surface.mesh); }, result.surface);
}

MeshResult mesh_skeleton(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx) {
    return mesh_skeleton(skeleton, PointSet{}, options, ctx);
}

MeshResult mesh_skeleton(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                         const Context& ctx) {
    BuiltMesh built = make_mesh(skeleton, constraints, options, Use::still, ctx);
    if (auto* quads = std::get_if<QuadSurface>(&built.result.surface))
        quads->cage = std::move(built.build.cage);
    return std::move(built.result);
}

MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                      const Context& ctx) {
    if (options.method != MeshMethod::tetrahedra)
        throw InvalidInput("mesh: method must be tetrahedra for the tetrahedra inside");
    if (options.fit == Fit::volume)
        throw InvalidInput(
            "mesh: fit must not be volume for the tetrahedra inside, which would not move along");
    return make_mesh(skeleton, constraints, options, Use::solid, ctx).result;
}

namespace pipeline_internal {

BuiltMesh build_mesh(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx) {
    BuiltMesh out = make_mesh(skeleton, {}, options, Use::posed, ctx);
    if (auto* quads = std::get_if<QuadSurface>(&out.result.surface)) quads->cage = out.build.cage;
    return out;
}

}  // namespace pipeline_internal

}  // namespace coppice
