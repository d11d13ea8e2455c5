#include "gpu_quads.h"

#include <algorithm>
#include <string_view>

#include "coppice/cuda/exec/host_executor.h"
#include "coppice/cuda/field/upload_field.h"
#include "coppice/cuda/quads/device_printed_quads.h"
#include "coppice/cuda/quads/device_quads.h"
#include "coppice/cuda/quads/printed_quad_stages.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "gpu_apart.h"
#include "gpu_costs.h"
#include "measure.h"

namespace coppice::bench {
namespace {

MeshOptions quad_options() {
    MeshOptions options;
    options.device = Device::cpu;
    options.remesh_rounds = 0;
    return options;
}

double sum_of(const std::vector<std::pair<std::string, double>>& stages,
              std::initializer_list<std::string_view> names) {
    double sum = 0;
    for (const auto& [name, seconds] : stages) {
        if (std::ranges::find(names, name) != names.end()) sum += seconds;
    }
    return sum;
}

/// All that a card is given.
struct Given {
    QuadModel model;
    ConvolutionField field;
    PatchRefinement patches;

    Given(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx)
        : model(quad_model(skeleton, options, ctx)),
          field(model.skeleton, model.field, ctx),
          patches(model.control.cage.quads, static_cast<std::uint32_t>(model.control.cage.positions.size()),
                  options.levels, ctx) {}

    cuda::QuadJob job(const MeshOptions& o) const {
        const ControlMesh& c = model.control;
        return {patches.cage(), patches.levels(), c.cage.positions, c.anchors,
                c.region,       c.clip,           o.project,        o.untangle};
    }
    cuda::ContactInput contacts() const {
        return {model.skeleton, {model.tubes, model.tube}, field, model.control};
    }
    /// The field with the regions of the surface.
    ConvolutionField with_regions(const Context& ctx) const {
        ConvolutionField out = field;
        set_regions(out, model, ctx);
        return out;
    }
};

/// As many points in each region as it has quads.
FieldWork work_of(const ConvolutionField& field, const Given& given) {
    std::vector<double> weight(field.region_count());
    for (const std::uint32_t r : given.model.control.region) ++weight[r];
    return {field, weight};
}

/// [m] How far vertices may lie apart, by the distance to their anchors.
std::vector<float> tolerances_of(std::span<const Vec3> positions, std::span<const Vec3> anchors) {
    std::vector<float> out(positions.size());
    for (std::size_t v = 0; v < out.size(); ++v) out[v] = 1e-4f * distance(positions[v], anchors[v]);
    return out;
}

void measure_on_card(const Given& given, const MeshOptions& options, const GpuRun& run, GpuResult& out) {
    const ConvolutionField field = given.with_regions(run.ctx);
    DeviceQuads device(run.ctx);
    const auto make = [&](const cuda::QuadJob& job, Buffer<Vec3>& positions, Buffer<Vec3>* anchors) {
        if (!device.begin(job, given.contacts())) {
            out.note = "the field's lists, too long for the card, come from the CPU";
            device.begin(job, field);
        }
        return device.finish(positions, anchors);
    };
    cuda::QuadJob job = given.job(options);
    job.untangle.passes = 0;  // as the model at rest
    Buffer<Vec3> positions, anchors;
    const cuda::QuadReport report = make(job, positions, &anchors);
    const Buffer<Vec3>& rest = given.model.rest.positions;
    out.apart = apart(rest, positions, tolerances_of(rest, anchors));
    job.untangle = options.untangle;
    out.whole = out.cage + median_time(run, 1, few_rounds(run), [&] { make(job, positions, nullptr); });
    const auto costs =
        quad_costs(job, work_of(field, given), static_cast<double>(report.projected.evaluations));
    time_on_card(
        device, run, costs, [&] { device.repeat(); }, out);
}

/// What [Zhu2015] prints, on the CPU by the kernels of the card.
class PrintedOnCpu {
  public:
    PrintedOnCpu(const cuda::QuadJob& job, const ConvolutionField& field, const Context& ctx)
        : exec_(ctx), stages_(exec_, job), kernel_(field.kernel()), field_(upload_field(exec_, field)) {}

    void run() {
        stages_.refine();
        cuda::with_formula(
            kernel_, [&](const auto& formula) { stages_.evolve(cuda::FieldView(formula, field_), how_); });
    }
    std::span<const Vec3> positions() const { return stages_.positions(); }
    std::uint32_t faces() const { return stages_.mesh().face_count(); }
    int steps() const { return how_.steps; }

  private:
    cuda::HostExecutor exec_;
    cuda::PrintedQuadStages<cuda::HostExecutor> stages_;
    KernelConstants kernel_;
    cuda::FieldArrays field_;
    cuda::Evolution how_;
};

GpuResult measure_printed(const QuadCase& what, const Given& given, const GpuRun& run) {
    const ConvolutionField field = given.with_regions(run.ctx);
    const cuda::QuadJob job = given.job(quad_options());
    PrintedOnCpu cpu(job, field, run.ctx);
    GpuResult out;
    out.cpu = median_time(run, 1, few_rounds(run), [&] { cpu.run(); });
    out.name = what.name + ", as printed";
    out.segments = what.skeleton.size() - what.skeleton.tree_count();
    out.faces = cpu.faces();
    out.papers = what.papers;
    on_card(run, out, [&] {
        DevicePrintedQuads device(run.ctx);
        const QuadMesh made = device.make(job, field);
        out.apart = apart(cpu.positions(), made.positions,
                          tolerances(cpu.positions(), given.model.skeleton, run.ctx));
        const auto costs = printed_quad_costs(job, work_of(field, given), cpu.steps());
        time_on_card(
            device, run, costs, [&] { device.repeat(); }, out);
    });
    return out;
}

}  // namespace

std::vector<GpuResult> measure_quads(const QuadCase& what, const GpuRun& run) {
    const MeshOptions options = quad_options();
    GpuResult out;
    out.name = what.name;
    out.papers = what.papers;
    out.goals = what.goals;
    out.segments = what.skeleton.size() - what.skeleton.tree_count();
    std::vector<Measure> stages;
    median_time(run, 0, few_rounds(run), [&] {
        const MeshResult made = mesh_skeleton(what.skeleton, options, run.ctx);
        for (const auto& [name, seconds] : made.stages) Measures(stages).add(name, seconds);
        out.faces = made.quads().mesh.quads.size();
    });
    for (const Measure& m : stages) out.cpu_stages.emplace_back(m.name, m.median());
    out.cpu = sum_of(out.cpu_stages, {"field", "quads", "refine", "anchors", "project", "untangle"});
    out.cage = sum_of(out.cpu_stages, {"prepare", "graft", "part", "cage", "weights", "topology"});
    if (!run.device.device && !what.as_printed) return {out};
    const Given given(what.skeleton, options, run.ctx);
    on_card(run, out, [&] { measure_on_card(given, options, run, out); });
    std::vector<GpuResult> all{out};
    if (what.as_printed) all.push_back(measure_printed(what, given, run));
    return all;
}

}  // namespace coppice::bench
