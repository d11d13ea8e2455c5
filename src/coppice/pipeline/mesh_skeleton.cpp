#include "coppice/pipeline/mesh_skeleton.h"

#include <fmt/format.h>

#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"
#include "coppice/field/list_kernel.h"
#include "coppice/pipeline/end_shapes_internal.h"
#include "coppice/pipeline/fit/fit_volume_internal.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/fit/measured_volume_internal.h"
#include "coppice/pipeline/quads/quad_origin_internal.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"

namespace coppice {
namespace {

using pipeline_internal::KeptQuads;
using pipeline_internal::QuadOrigin;
using pipeline_internal::QuadRows;

CylinderMesh mesh_by_cylinders(const Skeleton& prepared, const MeshOptions& options, const Context& ctx,
                               Stages& stages) {
    const CylinderOptions tubes{.sides = options.control.sides << options.levels,
                                .rows = 1 << options.levels,
                                .thin = options.tube_sides,
                                .tips = options.control.tips,
                                .base = options.control.base};
    return stages.run("cylinders", 1.0f, [&] { return cylinders(prepared, tubes, ctx); });
}

// Fits the surface; `rows` belong to quads, but not to ramifications.
struct Fitting {
    const Skeleton& skeleton;
    const ControlOptions& ends;
    std::optional<QuadRows>& rows;
    const Context& ctx;

    FitVolumeReport operator()(QuadSurface& surface) const {
        if (!rows) return fit_volume(surface.mesh, skeleton, base_end(ends), tip_end(ends), ctx);
        KeptQuads kept(std::move(*rows), surface.cage, surface.mesh);
        const auto search = [&](const PolygonMesh& moved, std::uint32_t limit, const Context& c) {
            return kept.crossings(moved, limit, c);
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

MeshResult make_surface(const Skeleton& given_skeleton, const PointSet& constraints, const MeshOptions& given,
                        bool with_solid, QuadOrigin* origin, const Context& ctx) {
    const bool may_use_device = given.method != MeshMethod::cylinders && !with_solid;
    if (may_use_device && given.device == Device::cuda) require_device();  // before any work
    MeshOptions options = given.method == MeshMethod::bmesh ? on_metaballs(given) : given;
    const bool may_fit = fits_where_off(options) && origin == nullptr;
    const bool fits = options.fit == Fit::volume;
    MeshResult out;
    const Context meshing = fits ? part_of(ctx, 0, 0.5f) : ctx;
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
    const PrepareResult prepared =
        stages.run("prepare", 0.05f, [&] { return prepare(skeleton, options.prepare); });
    out.prepared = prepared.report;
    if (options.method != MeshMethod::cylinders) check_branches(prepared.skeleton);
    std::optional<QuadRows> rows;
    if (options.method == MeshMethod::quads) {
        const QuadExtras extras{out.weights, fits || may_fit ? &rows : nullptr, origin};
        out.surface = mesh_by_quads(prepared.skeleton, constraints, options, extras, meshing, stages);
    } else if (options.method == MeshMethod::ramifications) {
        const QuadExtras extras{out.weights, fits || may_fit ? &rows : nullptr};
        out.surface = mesh_by_ramifications(prepared.skeleton, constraints, options, extras, meshing, stages);
    } else if (options.method == MeshMethod::cylinders) {
        out.surface = mesh_by_cylinders(prepared.skeleton, options, meshing, stages);
    } else {
        const auto make = with_solid ? solid_by_tetrahedra : mesh_by_tetrahedra;
        out.surface = make(prepared.skeleton, constraints, options, out.weights, meshing, stages);
    }
    if (may_fit) {
        out.measured = stages.run("volume", 1.0f, [&] {
            return measured_volume(out.quads().mesh, skeleton, options.control, meshing);
        });
    }
    if (fits || (out.measured && is_off(*out.measured))) {
        const Context fitting_ctx = part_of(ctx, fits ? 0.5f : 1, 1);
        const Fitting fitting{skeleton, options.control, rows, fitting_ctx};
        out.fitted = Stages(fitting_ctx, out.stages).run("fit", 1.0f, [&] {
            return fits ? std::visit(fitting, out.surface) : fit_where_better(out.quads(), fitting);
        });
    }
    return out;
}

// [share of the cones' volume] Returns the deviation of a surface, if it was measured.
double deviation(const MeshResult& made) {
    const double cones = made.fitted ? made.fitted->cones : made.measured->cones;
    return std::abs((made.fitted ? made.fitted->after : made.measured->mesh) / cones - 1);
}

// A surface without levels gets the correct volume if possible: its few sides have it for straight branches
// only, so it is always fitted; but where much is cut off, the result can be far from it.
MeshResult make_coarsest(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                         const Context& ctx) {
    MeshOptions fitting = options;
    fitting.fit = Fit::volume;
    MeshResult fitted = make_surface(skeleton, constraints, fitting, false, nullptr, part_of(ctx, 0, 0.5f));
    if (deviation(fitted) <= kMaxDeviation) return fitted;
    MeshResult other = make_surface(skeleton, constraints, options, false, nullptr, part_of(ctx, 0.5f, 1));
    return deviation(other) < deviation(fitted) ? std::move(other) : std::move(fitted);
}

MeshResult make_mesh(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                     bool with_solid, QuadOrigin* origin, const Context& ctx) {
    check_fields(options, "mesh");
    check_sides(options);
    if (options.levels == 0 && origin == nullptr && fits_where_off(options))
        return make_coarsest(skeleton, constraints, options, ctx);
    return make_surface(skeleton, constraints, options, with_solid, origin, ctx);
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
    return make_mesh(skeleton, constraints, options, false, nullptr, ctx);
}

MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                      const Context& ctx) {
    if (options.method != MeshMethod::tetrahedra)
        throw InvalidInput("mesh: method must be tetrahedra for the tetrahedra inside");
    if (options.fit == Fit::volume)
        throw InvalidInput(
            "mesh: fit must not be volume for the tetrahedra inside, which would not move along");
    return make_mesh(skeleton, constraints, options, true, nullptr, ctx);
}

namespace pipeline_internal {

void complete(std::vector<FieldRegion>& regions, std::span<const NodeId> seeds, const Skeleton& skeleton) {
    for (std::size_t r = 0; r < regions.size(); ++r) {
        regions[r].seed = seeds[r];
        regions[r].box = region_box(regions[r].box, skeleton.radius(seeds[r]));
    }
}

MeshResult mesh_with_origin(const Skeleton& skeleton, const MeshOptions& options, QuadOrigin& origin,
                            const Context& ctx) {
    return make_mesh(skeleton, {}, options, false, &origin, ctx);
}

}  // namespace pipeline_internal

void list_fields(TetraOptions& o, FieldList& list) {
    list.add(
        Field{"tetra_base",
              "Initial tetrahedra: those of an octree around the branches, or of a polyhedron with a few "
              "for each segment, which are cut into eight as often as edge requires."},
        o.base);
    list.add(common_field("tetra_edge", "Approximate edge length of the triangles of the method tetrahedra.",
                          Unit::radius, 0.05, 4),
             o.edge);
    list.add(Field{"tetra_levels", "Number of times that the tetrahedra of an octree are cut into eight.",
                   Unit::none, 0, 4},
             o.march.levels);
    list_accuracy_fields(o.march, list);
}

void list_fields(MeshOptions& o, FieldList& list) {
    list.add(
        common_field("method",
                     "Kind of surface: quads along the branches, triangles of the level set, one tube per "
                     "axis, quads of ramification units, or quads on metaballs."),
        o.method);
    list.add(
        common_field("levels", "Number of subdivisions of the control cage; each divides a quad into four.",
                     Unit::none, 0, 6),
        o.levels);
    list.add(common_field(
                 "fit",
                 "Property that the surface preserves: the areas of sections of branches, the volume of the "
                 "rounded cones of the skeleton, or automatically the volume for quads if it would deviate."),
             o.fit);
    list.add(
        common_field("overlaps",
                     "Treatment of branches that intersect each other: they are merged into one body, one "
                     "is cut off and grafted onto the other, trees are bent apart, or they are kept."),
        o.overlaps);
    list.add(Field{"graft",
                   "Maximum distance between the axes of overlapping branches, as a multiple of the sum of "
                   "their radii; 0 disables the detection of overlaps.",
                   Unit::none, 0, 1},
             o.graft);
    list.add(Field{"prepare", "Preparation of the skeleton"}, o.prepare);
    list.add(Field{"control", "Control cage"}, o.control);
    list.add(Field{"field", "Convolution field"}, o.field);
    list.add(Field{"project", "Projection onto the field"}, o.project);
    list.add(Field{"untangle", "Unfolding"}, o.untangle);
    list.add(Field{"remesh_rounds",
                   "Maximum number of rounds that find and remesh crossing quads; 0 disables the remeshing.",
                   Unit::none, 0, 100},
             o.remesh_rounds);
    list.add(Field{"tetra", "Tetrahedra"}, o.tetra);
    list.add(Field{"ramification", "Ramifications"}, o.ramification);
    list.add(
        Field{"tube_sides",
              "Number of faces around thin branches: the same as around thick ones, proportional to the "
              "root of the radius (at least 4), or automatically by radius if a number of faces is given."},
        o.tube_sides);
    list.add(
        Field{"chord_error",
              "Maximum distance of the sides of sections from their circles with tube_sides by_radius; 0 "
              "uses the distance at the thickest axis, where the levels determine the number of sides.",
              Unit::metre, 0, 1e6},
        o.chord_error);
    list.add(
        Field{"device",
              "Device that computes the surface: a GPU if there is one and the surface is large, the CPU, "
              "or a GPU with CUDA."},
        o.device);
}

}  // namespace coppice
