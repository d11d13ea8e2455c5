#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/lists/touching_stages_internal.h"
#include "coppice/cuda/tetra/components_stages_internal.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/cuda/tetra/extract_stages_internal.h"
#include "coppice/cuda/tetra/march_input_internal.h"
#include "coppice/cuda/tetra/samples_stages_internal.h"
#include "coppice/cuda/tetra/unsnap_stages_internal.h"
#include "coppice/tetra/march/march.h"

// march() of coppice/tetra on an executor, for any field that kernels can sample. The coarse mesh and the
// axes are uploaded, and only counts are downloaded until the triangles are.

namespace coppice::cuda {

/// Result of marching on an executor.
struct DeviceMarch {
    DeviceSurface surface;        ///< empty if it leaves the mesh
    SurfaceVertices vertices;     ///< its vertices, until components are removed
    std::vector<TetraFace> open;  ///< see MarchResult
    std::vector<Vec3> places;     ///< [m] a point inside for each set of axes: see held_places()
    MarchReport report;           ///< counts
    int rounds = 0;               ///< see Unsnapped
};

/// Marches without removing components of the surface; for a tile only the contribution of its own
/// tetrahedra. Waits.
template <class Exec, class Field>
DeviceMarch march_own(Exec& exec, const DeviceRefinement& refinement, const PassingAxes& axes,
                      const SnapField<Field>& at, int refinements) {
    DeviceMarch out;
    out.report.tetra = refinement.tetra_count;
    out.report.vertices = refinement.vertex_count;
    const DeviceHeld held = hold_axes(exec, axes, refinement);
    const DeviceSamples samples = sample_vertices(exec, refinement, at, held);
    out.report.inside = count_own(exec, refinement, samples.above.words);
    out.open = open_faces(exec, refinement, samples);
    if (!out.open.empty()) return out;
    const std::uint32_t near = count_own(exec, refinement, samples.on);
    const FineCrossings crossings{refinement, samples.view,
                                  exec.upload(std::span<const tetra_kernel::Cut>(tetra_kernel::kCuts))};
    const Unsnapped unsnapped = unsnap(exec, crossings, samples);
    out.rounds = unsnapped.rounds;
    if (refinement.is_tile())
        exec.each("own tetrahedra", unsnapped.crossed.size(), KeepOwnTetra{refinement, unsnapped.crossed});
    const auto crossed = list_bits(exec, unsnapped.crossed);
    out.vertices = place_vertices(exec, crossings, crossed, at, refinements);
    out.surface = write_triangles(exec, crossings, crossed, out.vertices);
    out.report.crossed = crossed.size();
    out.report.snapped = count_own(exec, refinement, samples.on);
    out.report.freed = near - out.report.snapped;
    if (!axes.segments.empty()) out.places = held_places(exec, held, refinement, samples.view);
    return out;
}

/// Creates the surface of a field in a refined mesh around axes: see march(). The arrays of the field are on
/// the executor. The result is bit-identical for identical samples of the field. Throws DeviceError. Memory
/// of the executor: see bytes_of_march(), plus the surface; it is not reset. Waits.
template <class Exec, class Field>
DeviceMarch march(Exec& exec, const DeviceRefinement& refinement, const PassingAxes& axes,
                  const SnapField<Field>& at, int refinements, const Context& ctx = {}) {
    DeviceMarch out = march_own(exec, refinement, axes, at, refinements);
    if (out.open.empty() && !axes.segments.empty())
        out.report.dropped = drop_parts(exec, out.surface, out.places, ctx);
    return out;
}

/// All input of the surface of a field of segments, on an executor.
struct MarchJob {
    DeviceRefinement coarse;  ///< as returned by upload_coarse()
    PassingAxes axes;
    DeviceSegments segments;
    KernelConstants kernel;
    CutFieldView<DeviceSegments> ends;  ///< flat ends that truncate it
    std::span<const Box3> boxes;        ///< of the regions; empty: those of the tetrahedra
    std::size_t longest;                ///< maximum length of the lists of the field
    MarchOptions options;
};

/// Copies the input to the executor. Throws the exceptions of march() for errors that are found immediately.
template <class Exec>
MarchJob upload_march(Exec& exec, const MarchInput& in, const Context& ctx = {}) {
    check(in.options);
    const DeviceRefinement coarse = upload_coarse(exec, in.mesh, in.options.levels, ctx);
    const DeviceSegments segments = upload_segments(exec, in.field.field);
    return {coarse,
            upload_axes(exec, in.axes, coarse),
            segments,
            in.field.field.kernel(),
            upload_cuts(exec, segments, in.field.ends, in.field.level()),
            {},
            longest_list(in.mesh.region_count()),
            in.options};
}

/// Calls use(refinement, field) with the refined mesh and the field of a job; returns false if
/// TetraRefinement would reject the mesh. Waits.
template <class Exec, class Use>
bool with_march_field(Exec& exec, const MarchJob& job, const Use& use) {
    DeviceRefinement refinement = job.coarse;
    if (!refine(exec, refinement)) return false;
    const std::span<const Box3> boxes = job.boxes.empty() ? region_boxes(exec, refinement) : job.boxes;
    const FieldArrays arrays = set_regions(exec, job.segments, boxes, job.longest);
    with_formula(job.kernel, [&](const auto& formula) {
        const FieldView whole(formula, arrays);
        using Field = CutFieldView<std::remove_const_t<decltype(whole)>>;
        const Field field{whole, job.ends.cuts, job.ends.first, job.ends.of_region, job.ends.level};
        use(refinement, SnapField<Field>{field, tetra_kernel::Profile(field.level), job.options.snap});
    });
    return true;
}

/// Marches a job; returns no value if TetraRefinement would reject the mesh. Waits.
template <class Exec>
std::optional<DeviceMarch> march(Exec& exec, const MarchJob& job, const Context& ctx = {}) {
    std::optional<DeviceMarch> out;
    with_march_field(exec, job, [&](const DeviceRefinement& refinement, const auto& at) {
        out = march(exec, refinement, job.axes, at, job.options.refinements, ctx);
    });
    return out;
}

/// Copies the result of marching to the host. Waits.
template <class Exec>
MarchResult downloaded(Exec& exec, const DeviceMarch& made) {
    MarchResult out;
    out.report = made.report;
    out.open = made.open;
    out.mesh.positions.resize(made.surface.positions.size());
    out.mesh.triangles.resize(made.surface.triangles.size());
    exec.download(made.surface.positions, std::span(out.mesh.positions));
    exec.download(made.surface.triangles, std::span(out.mesh.triangles));
    return out;
}

}  // namespace coppice::cuda
