#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/cuda/tetra/device_marcher.h"
#include "coppice/pipeline/end_cuts_internal.h"
#include "coppice/pipeline/quads/quads_on_device_internal.h"
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"

namespace coppice {
namespace {

// Most cells are about half as wide as allowed, and edges are slightly shorter than the cells.
constexpr float kCellOverEdge = 2.8f;
constexpr double kMinPolyhedronEdge = 0.07;  ///< [radii] smaller edges need too many cuts

/// Shortens the axes by a radius, or a third of the segment, where a tree ends flat: there the surface passes
/// through the node. Segments are those of segment_axes().
void shorten_flat_ends(std::vector<Segment>& axes, const Skeleton& skeleton, const ControlOptions& ends) {
    std::size_t i = 0;
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n) && !skeleton.is_tip(n)) continue;
        const Segment s = axes[i];
        Segment& axis = axes[i++];
        const float l = distance(s.a, s.b);
        if (skeleton.is_root(n) || l == 0) continue;
        const auto cut = [&](Vec3& end, float& radius_at_end, Vec3 other, float radius_at_other) {
            const float part = std::min(1.0f / 3, radius_at_end / l);
            end = lerp(end, other, part);
            radius_at_end += part * (radius_at_other - radius_at_end);
        };
        if (ends_flat(skeleton, skeleton.parent(n), ends)) cut(axis.a, axis.radius_a, s.b, s.radius_b);
        if (ends_flat(skeleton, n, ends)) cut(axis.b, axis.radius_b, s.a, s.radius_a);
    }
}

/// Returns whether a flat end is wider than the extent of all other parts, so that axes are not a test of the
/// surface.
bool is_cut_away(const Skeleton& skeleton, const ControlOptions& ends) {
    Box3 box;
    float others = 0;
    for (const NodeId n : nodes(skeleton)) {
        box.extend(skeleton.position(n));
        if (!skeleton.is_root(n)) others = std::max(others, skeleton.radius(n));
    }
    for (const NodeId n : nodes(skeleton)) {
        if (ends_flat(skeleton, n, ends) && skeleton.radius(n) > box.diagonal() + others) return true;
    }
    return false;
}

/// Inputs of a surface, except for the tetrahedra.
struct Task {
    const Skeleton& prepared;
    const PointSet& constraints;
    const MeshOptions& options;
    bool with_solid;
    std::optional<GlobalWeights>& weights;
    const Context& ctx;
    Stages& stages;
};

Lattice make_lattice(const Task& task, std::span<const Segment> axes) {
    const TetraOptions& tetra = task.options.tetra;
    // Vertices of the hull stay at their positions, so the surface should keep a distance from it; tetrahedra
    // that are cut have a sufficient margin by themselves.
    const float shell = tetra.march.levels == 0 ? 0.3f : 0.2f;
    const LatticeOptions sizes{
        .cell = kCellOverEdge * tetra.edge * static_cast<float>(1 << tetra.march.levels),
        .inside = task.with_solid ? 0 : 1 - shell,
        .outside = 1 + shell};
    return task.stages.run("lattice", 0.2f, [&] { return Lattice(axes, sizes, task.ctx); });
}

Polyhedron make_polyhedron(const Task& task, std::span<const Segment> axes) {
    return task.stages.run("polyhedron", 0.2f, [&] { return Polyhedron(task.prepared, axes, {}, task.ctx); });
}

/// Marches in the tetrahedra, on a GPU if they are sent to one.
class Marcher {
  public:
    explicit Marcher(const Task& task) : task_(task) {}

    /// Returns whether they are sent to a GPU, which finds the regions of the field by itself.
    bool is_on_device(const TetraMesh& mesh, const MarchOptions& how, DeviceUse& use) const {
        const Device wanted = task_.options.device;
        if (task_.with_solid) {
            if (wanted == Device::cuda)
                note_refusal(use, "tetrahedra inside a surface are not supported on a GPU");
            return false;
        }
        const std::uint64_t fine = std::uint64_t{mesh.tetra.size()} << (3 * how.levels);
        return goes_to_device(wanted, fine / kPerFace, use);
    }
    /// Returns nullopt if the GPU fails.
    std::optional<MarchResult> on_device(const TetraMesh& mesh, const CutConvolution& field,
                                         const InsideAxes& inside, const MarchOptions& how, DeviceUse& use) {
        return coppice::on_device(use, [&] {
            if (!device_) device_.emplace(task_.ctx);
            return device_->march(mesh, field, inside, how, task_.ctx);
        });
    }
    MarchResult here(const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& inside,
                     const MarchOptions& how) const {
        const FieldRef sampled(field);
        return task_.with_solid ? march_solid(mesh, sampled, inside, how, task_.ctx)
                                : march(mesh, sampled, inside, how, task_.ctx);
    }

  private:
    static constexpr std::uint64_t kPerFace = 8;  // approximate number of fine tetrahedra per triangle

    const Task& task_;
    std::optional<DeviceMarcher> device_;
};

/// Marches in the tetrahedra of `base`, a Lattice or a Polyhedron, which grows until the surface is enclosed.
template <class Base>
TetraSurface surface_in(Base& base, std::vector<Segment> axes, const MarchOptions& how, const Task& task) {
    const Context& ctx = task.ctx;
    TetraSurface out;
    shorten_flat_ends(axes, task.prepared, task.options.control);
    ConvolutionField field = task.stages.run("weights", 0.25f, [&] {
        const FieldOptions options = surface_field_options(task.options);
        ConvolutionField made(task.prepared, options, ctx);
        task.weights = apply_global_weights(made, task.prepared, options, task.constraints, ctx);
        return made;
    });
    Marcher marcher(task);
    for (bool again = true; again;) {
        const TetraMesh& mesh = base.mesh();
        const bool on_device = marcher.is_on_device(mesh, how, out.device);
        const std::vector<Box3> boxes = task.stages.run("regions", 0.4f, [&] {
            auto found = region_boxes(mesh, ctx);
            if (!on_device) field.set_regions(found, ctx);
            return found;
        });
        const EndCuts ends = end_cuts(task.prepared, task.options.control, boxes, ctx);
        MarchResult marched = task.stages.run("march", 0.95f, [&] {
            const CutConvolution cut{field, ends};
            const InsideAxes inside{axes, base.passing()};
            if (on_device) {
                auto done = marcher.on_device(mesh, cut, inside, how, out.device);
                if (done) return std::move(*done);
                field.set_regions(boxes, ctx);
            }
            return marcher.here(mesh, cut, inside, how);
        });
        out.march = marched.report;
        out.coarse = static_cast<std::uint32_t>(mesh.tetra.size());
        out.mesh = std::move(marched.mesh);
        out.solid = std::move(marched.solid);
        again = !marched.open.empty();
        if (again) {
            ++out.grown;
            if (!base.grow(marched.open, ctx)) throw Error("mesh: the surface leaves the tetrahedra");
        }
    }
    return out;
}

TetraSurface surface_by_tetrahedra(const Task& task) {
    const MeshOptions& options = task.options;
    check_fields(options.tetra, "tetra");
    if (options.control.base == BaseShape::open) {
        throw InvalidInput("mesh: tetrahedra make closed surfaces only; choose base flat or round");
    }
    const std::vector<Segment> axes = segment_axes(task.prepared);
    TetraSurface out;
    if (options.tetra.base == TetraBase::polyhedron) {
        MarchOptions how = options.tetra.march;
        how.levels = polyhedron_levels(options.tetra);
        Polyhedron polyhedron = make_polyhedron(task, axes);
        out = surface_in(polyhedron, axes, how, task);
        out.polyhedron = polyhedron.report();
    } else {
        Lattice lattice = make_lattice(task, axes);
        out = surface_in(lattice, axes, options.tetra.march, task);
    }
    if (out.march.inside == 0 && is_cut_away(task.prepared, options.control)) {
        throw InvalidInput(
            "mesh: no surface is left because it is thinner than the tetrahedra everywhere; choose base "
            "round where a trunk is wider than long, a smaller edge, or method quads");
    }
    out.mesh.origin = out.solid.origin = task.prepared.origin();
    task.ctx.report(1);
    return out;
}

}  // namespace

int polyhedron_levels(const TetraOptions& options) {
    constexpr int kMax = 5;
    const double times = PolyhedronOptions{}.section / double{options.edge};
    const int levels = std::max(1, static_cast<int>(std::lround(std::log2(times))));
    if (levels > kMax) {
        throw InvalidInput(fmt::format(
            "mesh: tetra_edge must be at least {} with tetra_base polyhedron, which is cut at most {} "
            "times; raise it, or use tetra_base octree",
            kMinPolyhedronEdge, kMax));
    }
    return levels;
}

TetraSurface mesh_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                const Context& ctx, Stages& stages) {
    return surface_by_tetrahedra({prepared, constraints, options, false, weights, ctx, stages});
}

TetraSurface solid_by_tetrahedra(const Skeleton& prepared, const PointSet& constraints,
                                 const MeshOptions& options, std::optional<GlobalWeights>& weights,
                                 const Context& ctx, Stages& stages) {
    return surface_by_tetrahedra({prepared, constraints, options, true, weights, ctx, stages});
}

}  // namespace coppice
