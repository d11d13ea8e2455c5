#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/lists/touching_stages.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/cuda/tetra/extract_stages.h"
#include "coppice/cuda/tetra/parts_stages.h"
#include "coppice/cuda/tetra/samples_stages.h"
#include "coppice/cuda/tetra/unsnap_stages.h"
#include "coppice/tetra/march/march.h"

// march() of coppice/tetra on an executor, for any field that kernels can sample. The coarse mesh and the
// axes go there, and nothing but counts comes back until the triangles do.

namespace coppice::cuda {

/// What marching makes on an executor.
struct DeviceMarch {
    DeviceSurface surface;        ///< nothing where it leaves the mesh
    std::vector<TetraFace> open;  ///< see MarchResult
    MarchReport report;           ///< what was done
};

/// The surface that a field makes in a refined mesh about axes: see march(). The arrays of the field lie on
/// the executor. What comes out has the same bits where the field gives the same samples. Throws DeviceError.
/// Memory of the executor: some 20 bytes per fine vertex, 1.5 bits per fine edge and fine tetrahedron, 400
/// bytes per coarse one, and what the surface takes; it is not reset. Waits.
template <class Exec, class Field>
DeviceMarch march(Exec& exec, const DeviceRefinement& refinement, const PassingAxes& axes,
                  const SnapField<Field>& at, int refinements, const Context& ctx = {}) {
    DeviceMarch out;
    out.report.tetra = refinement.tetra_count;
    out.report.vertices = refinement.vertex_count;
    const DeviceHeld held = hold_axes(exec, axes, refinement);
    const DeviceSamples samples = sample_vertices(exec, refinement, at, held);
    const auto count = [&](std::span<const std::uint64_t> words) { return rank_bits(exec, words).count; };
    out.report.inside = count(samples.above.words);
    out.open = open_faces(exec, refinement, samples);
    if (!out.open.empty()) return out;
    const std::uint32_t near = count(samples.on);
    const FineCrossings crossings{refinement, samples.view,
                                  exec.upload(std::span<const tetra_kernel::Cut>(tetra_kernel::kCuts))};
    const Unsnapped unsnapped = unsnap(exec, crossings, samples);
    out.surface = extract(exec, crossings, at, refinements, unsnapped);
    out.report.crossed = out.surface.crossed;
    out.report.snapped = count(samples.on);
    out.report.freed = near - out.report.snapped;
    if (!axes.segments.empty()) {
        const std::vector<Vec3> places = held_places(exec, held, refinement, samples.view);
        out.report.dropped = drop_parts(exec, out.surface, places, ctx);
    }
    return out;
}

/// All that the surface of a field of segments is made of, on an executor.
struct MarchJob {
    DeviceRefinement coarse;  ///< what upload_coarse() knows of it
    PassingAxes axes;
    DeviceSegments segments;
    KernelConstants kernel;
    CutFieldView<DeviceSegments> ends;  ///< where it is cut off
    MarchOptions options;
};

/// Copies it there. Throws what march() throws of what is seen at once.
template <class Exec>
MarchJob upload_march(Exec& exec, const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& axes,
                      const MarchOptions& options, const Context& ctx = {}) {
    check(options);
    const DeviceRefinement coarse = upload_coarse(exec, mesh, options.levels, ctx);
    const DeviceSegments segments = upload_segments(exec, field.field);
    return {coarse,
            upload_axes(exec, axes, coarse),
            segments,
            field.field.kernel(),
            upload_cuts(exec, segments, field.ends, field.level()),
            options};
}

/// March from there; nothing where TetraRefinement would refuse the mesh. Waits.
template <class Exec>
std::optional<DeviceMarch> march(Exec& exec, const MarchJob& job, const Context& ctx = {}) {
    DeviceRefinement refinement = job.coarse;
    if (!refine(exec, refinement)) return {};
    const FieldArrays arrays = set_regions(exec, job.segments, region_boxes(exec, refinement));
    std::optional<DeviceMarch> out;
    with_formula(job.kernel, [&](const auto& formula) {
        const FieldView whole(formula, arrays);
        using Field = CutFieldView<std::remove_const_t<decltype(whole)>>;
        const Field field{whole, job.ends.cuts, job.ends.first, job.ends.of_region, job.ends.level};
        const SnapField<Field> at{field, tetra_kernel::Profile(field.level), job.options.snap};
        out = march(exec, refinement, job.axes, at, job.options.refinements, ctx);
    });
    return out;
}

/// Copies what marching made back. Waits.
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
