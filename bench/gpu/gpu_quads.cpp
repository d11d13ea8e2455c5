#include "gpu_quads.h"

#include <algorithm>
#include <deque>
#include <string_view>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/cuda/quads/device_quads.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "device_printed_quads.h"
#include "gpu_apart.h"
#include "gpu_costs.h"
#include "measure.h"
#include "printed_quad_stages.h"

namespace coppice::bench {
namespace {

MeshOptions quad_options() {
    MeshOptions options;
    options.device = Device::cpu;
    options.remesh_rounds = 0;
    return options;
}

double compute_sum(const std::vector<std::pair<std::string, double>>& stages,
                   std::initializer_list<std::string_view> names) {
    double sum = 0;
    for (const auto& [name, seconds] : stages) {
        if (std::ranges::find(names, name) != names.end()) sum += seconds;
    }
    return sum;
}

/// All input of the GPU.
struct Given {
    QuadBuild build;
    ConvolutionField field;
    PatchRefinement patches;

    Given(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx)
        : build(build_quads(skeleton, options, ctx)),
          field(build.skeleton, build.field, ctx),
          patches(build.cage.cage.quads, static_cast<std::uint32_t>(build.cage.cage.positions.size()),
                  options.levels, ctx) {}

    cuda::QuadJob job(const MeshOptions& o) const {
        const ControlMesh& c = build.cage;
        return {patches.cage(), patches.levels(), c.cage.positions, c.anchors,
                c.region,       c.clip,           o.project,        o.untangle};
    }
    cuda::ContactInput contacts() const {
        return {build.skeleton, {build.tubes, build.tube}, field, build.cage};
    }
    /// Returns the field with the regions of the surface.
    ConvolutionField with_regions(const Context& ctx) const {
        ConvolutionField out = field;
        set_regions(out, build, ctx);
        return out;
    }
};

/// Weights each region by its number of quads.
FieldWork count_work(const ConvolutionField& field, const Given& given) {
    std::vector<double> weight(field.region_count());
    for (const std::uint32_t r : given.build.cage.region) ++weight[r];
    return {field, weight};
}

/// [m] Returns the accepted distance between vertices, based on the distance to their anchors.
std::vector<float> compute_tolerances(std::span<const Vec3> positions, std::span<const Vec3> anchors) {
    std::vector<float> out(positions.size());
    for (std::size_t v = 0; v < out.size(); ++v)
        out[v] = tolerance(positions[v], distance(positions[v], anchors[v]));
    return out;
}

std::uint32_t count_segments(const Skeleton& tree) { return tree.size() - tree.tree_count(); }

/// Several trees on a GPU at once.
class Batch {
  public:
    Batch(const std::deque<Given>& trees, const MeshOptions& options, const Context& ctx)
        : trees_(trees), made_(trees.size()) {
        for (const Given& tree : trees) {
            jobs_.push_back(tree.job(options));
            contacts_.push_back(tree.contacts());
            fields_.push_back(tree.with_regions(ctx));
        }
    }

    void unfold(const UntangleOptions& how) {
        for (cuda::QuadJob& job : jobs_) job.untangle = how;
    }
    /// Creates the surfaces, including copies of all input and of the results.
    void make(DeviceQuads& device, GpuResult& out) {
        if (!device.begin(jobs_, contacts_)) {
            out.note = "the lists of the field are too long for the GPU and were computed on the CPU";
            std::vector<cuda::QuadTask> tasks;
            for (std::size_t i = 0; i < jobs_.size(); ++i) tasks.push_back({jobs_[i], &fields_[i]});
            device.begin(tasks);
        }
        std::vector<cuda::QuadPlaces> places;
        for (Made& made : made_) places.push_back({&made.positions, &made.anchors});
        reports_ = device.finish(places);
    }
    /// Returns the number of vertices that differ from those of the models at rest.
    std::int64_t apart() const {
        std::int64_t count = 0;
        for (std::size_t i = 0; i < made_.size(); ++i) {
            const Buffer<Vec3>& rest = trees_[i].build.refined;
            count += bench::apart(rest, made_[i].positions, compute_tolerances(rest, made_[i].anchors));
        }
        return count;
    }
    std::vector<KernelCost> costs() const {
        std::vector<KernelCost> sum;
        for (std::size_t i = 0; i < jobs_.size(); ++i) {
            const auto each = quad_costs(jobs_[i], count_work(fields_[i], trees_[i]),
                                         static_cast<double>(reports_[i].projected.evaluations));
            if (sum.empty()) {
                sum = each;
                continue;
            }
            for (std::size_t k = 0; k < sum.size(); ++k) {
                sum[k].bytes += each[k].bytes;
                sum[k].flops += each[k].flops;
            }
        }
        return sum;
    }

  private:
    struct Made {
        Buffer<Vec3> positions, anchors;
    };
    const std::deque<Given>& trees_;
    std::vector<cuda::QuadJob> jobs_;
    std::vector<cuda::ContactInput> contacts_;
    std::vector<ConvolutionField> fields_;
    std::vector<Made> made_;
    std::vector<cuda::QuadReport> reports_;
};

void measure_on_card(const std::deque<Given>& trees, const MeshOptions& options, const GpuRun& run,
                     GpuResult& out) {
    DeviceQuads device(run.ctx);
    Batch batch(trees, options, run.ctx);
    batch.unfold({.passes = 0});  // as for the models at rest
    batch.make(device, out);
    out.apart = batch.apart();
    batch.unfold(options.untangle);
    out.whole = out.cage + median_time(run, 1, few_rounds(run), [&] { batch.make(device, out); });
    time_on_card(
        device, run, batch.costs(), [&] { device.repeat(); }, out);
}

/// Measures the stages of all trees in sequence on the CPU, in all rounds.
void measure_on_cpu(const std::vector<Skeleton>& trees, const MeshOptions& options, const GpuRun& run,
                    GpuResult& out) {
    std::vector<Measure> stages;
    median_time(run, 0, few_rounds(run), [&] {
        std::vector<std::pair<std::string, double>> sums;
        out.faces = 0;
        for (const Skeleton& tree : trees) {
            const MeshResult made = mesh_skeleton(tree, options, run.ctx);
            out.faces += made.quads().mesh.quads.size();
            for (const auto& [name, seconds] : made.stages) {
                auto at = std::ranges::find(sums, name, &std::pair<std::string, double>::first);
                if (at == sums.end()) at = sums.insert(at, {name, 0});
                at->second += seconds;
            }
        }
        for (const auto& [name, seconds] : sums) Measures(stages).add(name, seconds);
    });
    for (const Measure& m : stages) out.cpu_stages.emplace_back(m.name, m.median());
    out.cpu = compute_sum(out.cpu_stages, {"field", "quads", "refine", "anchors", "project", "untangle"});
    out.cage = compute_sum(out.cpu_stages, {"prepare", "graft", "part", "cage", "weights", "topology"});
}

/// The method as published in [Zhu2015], on the CPU with the kernels for the GPU.
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
    PrintedQuadStages<cuda::HostExecutor> stages_;
    KernelConstants kernel_;
    cuda::FieldArrays field_;
    Evolution how_;
};

GpuResult measure_printed(const QuadCase& what, const Given& given, const GpuRun& run) {
    const ConvolutionField field = given.with_regions(run.ctx);
    const cuda::QuadJob job = given.job(quad_options());
    PrintedOnCpu cpu(job, field, run.ctx);
    GpuResult out;
    out.cpu = median_time(run, 1, few_rounds(run), [&] { cpu.run(); });
    out.name = what.name + ", as printed";
    out.segments = count_segments(what.trees.front());
    out.faces = cpu.faces();
    out.papers = what.papers;
    on_card(run, out, [&] {
        DevicePrintedQuads device(run.ctx);
        const QuadMesh made = device.make(job, field);
        out.apart = apart(cpu.positions(), made.positions,
                          tolerances(cpu.positions(), given.build.skeleton, run.ctx));
        const auto costs = printed_quad_costs(job, count_work(field, given), cpu.steps());
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
    for (const Skeleton& tree : what.trees) out.segments += count_segments(tree);
    measure_on_cpu(what.trees, options, run, out);
    if (!run.device.device && !what.as_printed) return {out};
    std::deque<Given> trees;
    for (const Skeleton& tree : what.trees) trees.emplace_back(tree, options, run.ctx);
    on_card(run, out, [&] { measure_on_card(trees, options, run, out); });
    std::vector<GpuResult> all{out};
    if (what.as_printed) all.push_back(measure_printed(what, trees.front(), run));
    return all;
}

}  // namespace coppice::bench
