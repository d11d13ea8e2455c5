#include "gpu_tetra.h"

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/cuda/tetra/device_marcher.h"
#include "coppice/skeleton/prepare.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/polyhedron/polyhedron.h"
#include "device_printed_march.h"
#include "gpu_apart.h"
#include "gpu_costs.h"
#include "printed_march_stages.h"

namespace coppice::bench {
namespace {

/// All input of marching: tetrahedra that enclose the surface, and the field in their regions.
struct Given {
    Skeleton skeleton;
    std::vector<Segment> axes;
    ConvolutionField field;
    EndCuts ends;  ///< empty: all ends are round
    TetraMesh mesh;
    CompressedRows<std::uint32_t> passing;
    MarchOptions how;
    Context ctx;

    Given(const TetraCase& what, const Context& context)
        : skeleton(prepare(what.skeleton).skeleton),
          axes(segment_axes(skeleton)),
          field(skeleton, {}, context),
          how{.levels = what.levels},
          ctx(context) {
        if (what.in_polyhedron) {
            enclose(Polyhedron(skeleton, axes, {}, ctx));
        } else {
            constexpr float kCellOverEdge = 2.8f, kShell = 0.2f;  // as in mesh_skeleton()
            const float cell = kCellOverEdge * what.edge * static_cast<float>(1 << what.levels);
            enclose(Lattice(axes, {.cell = cell, .inside = 1 - kShell, .outside = 1 + kShell}, ctx));
        }
    }
    Given(const Given&) = delete;

    CutConvolution cut() const { return {field, ends}; }
    InsideAxes inside() const { return {axes, passing}; }
    MarchResult march() const { return coppice::march(mesh, FieldRef(cut()), inside(), how, ctx); }

  private:
    template <class Base>
    void enclose(Base base) {
        for (;;) {
            mesh = base.mesh();
            passing = base.passing();
            field.set_regions(region_boxes(mesh, ctx), ctx);
            const std::vector<TetraFace> open = march().open;
            if (open.empty()) return;
            if (!base.grow(open, ctx)) throw Error("gpu: the surface leaves the tetrahedra");
        }
    }
};

/// Weights each region by its number of tetrahedra.
FieldWork count_work(const Given& given) {
    std::vector<double> weight(given.mesh.region_count());
    for (std::size_t r = 0; r < weight.size(); ++r)
        weight[r] = static_cast<double>(given.mesh.first[r + 1]) - given.mesh.first[r];
    return {given.field, weight};
}

GpuResult row(const TetraCase& what, const Given& given, const char* how) {
    GpuResult out;
    const std::uint64_t tetra = std::uint64_t{given.mesh.tetra.size()} << (3 * what.levels);
    out.name =
        fmt::format("{}, {:.1f} million tetrahedra{}", what.name, 1e-6 * static_cast<double>(tetra), how);
    out.segments = what.skeleton.size() - what.skeleton.tree_count();
    out.papers = what.papers;
    out.goals = what.goals;
    return out;
}

/// Marching as published, on the CPU with the kernels for the GPU.
class PrintedOnCpu {
  public:
    explicit PrintedOnCpu(const Given& given)
        : given_(given),
          exec_(given.ctx),
          field_(cuda::upload_field(exec_, given.field)),
          coarse_(upload_explicit(exec_, given.mesh, given.ctx)) {}

    /// Returns the triangles if `weld` requests welded ones.
    TriMesh run(bool weld) {
        const auto before = exec_.mark();
        TriMesh out;
        cuda::with_formula(given_.field.kernel(), [&](const auto& formula) {
            const auto field =
                cuda::upload_cuts(exec_, cuda::FieldView(formula, field_), given_.ends, given_.field.level());
            const PrintedSurface made =
                march_as_printed(exec_, coarse_, given_.how.levels, field, given_.field.level(), weld);
            triangles_ = made.triangles.size();
            out.positions.assign(made.positions.begin(), made.positions.end());
            out.triangles.assign(made.welded.begin(), made.welded.end());
        });
        exec_.rewind(before);
        return out;
    }
    std::size_t triangles() const { return triangles_; }
    TetraCounts counts() const {
        const auto size = [](const auto& span) { return static_cast<double>(span.size()); };
        return {size(coarse_.positions), size(coarse_.edges), size(coarse_.faces), size(coarse_.tetra)};
    }

  private:
    const Given& given_;
    cuda::HostExecutor exec_;
    cuda::FieldArrays field_;
    ExplicitTetra coarse_;
    std::size_t triangles_ = 0;
};

}  // namespace

GpuResult measure_printed_tetra(const TetraCase& what, const GpuRun& run) {
    const Given given(what, run.ctx);
    GpuResult out = row(what, given, " as printed");
    PrintedOnCpu cpu(given);
    out.cpu = median_time(run, 0, few_rounds(run), [&] { cpu.run(false); });
    out.faces = cpu.triangles();
    on_card(run, out, [&] {
        DevicePrintedMarch device(run.ctx);
        const TriMesh made = device.make(given.mesh, what.levels, given.cut(), run.ctx);
        const Buffer<Vec3>& found = made.positions;
        out.apart = strays(found, cpu.run(true).positions, tolerances(found, given.skeleton, run.ctx));
        const auto costs = printed_tetra_costs(cpu.counts(), what.levels,
                                               static_cast<double>(made.triangles.size()), count_work(given));
        time_on_card(
            device, run, costs, [&] { device.repeat(); }, out);
    });
    return out;
}

GpuResult measure_tetra(const TetraCase& what, const GpuRun& run) {
    const Given given(what, run.ctx);
    GpuResult out = row(what, given, "");
    MarchResult cpu;
    out.cpu = median_time(run, 1, few_rounds(run), [&] { cpu = given.march(); });
    out.faces = cpu.mesh.triangles.size();
    on_card(run, out, [&] {
        DeviceMarcher device(run.ctx);
        const MarchResult made = device.march(given.mesh, given.cut(), given.inside(), given.how, run.ctx);
        const Buffer<Vec3>& found = made.mesh.positions;
        out.apart = strays(found, cpu.mesh.positions, tolerances(found, given.skeleton, run.ctx));
        time_on_card(
            device, run, march_costs(cpu.report, count_work(given)), [&] { device.repeat(); }, out);
    });
    return out;
}

}  // namespace coppice::bench
