#include "gpu_quads.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "clock.h"
#include "coppice/base/median.h"
#include "coppice/cuda/quads/device_quads.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::bench {
namespace {

constexpr double kFlopsPerPair = 98;  // value and gradient of the quartic kernel at one point for one segment
constexpr int kWarm = 5;

double stage_seconds(const MeshResult& made, std::initializer_list<std::string_view> names) {
    double sum = 0;
    for (const auto& [name, seconds] : made.stages) {
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
};

/// Vertices of two surfaces that lie apart, by the distance to their anchors.
std::int64_t apart(const Buffer<Vec3>& a, const Buffer<Vec3>& anchors, const Buffer<Vec3>& b) {
    std::int64_t count = 0;
    for (std::size_t v = 0; v < a.size(); ++v)
        count += !(distance(a[v], b[v]) <= 1e-4f * distance(a[v], anchors[v]));
    return count;
}

double mean_list(const Given& given, const Context& ctx) {
    ConvolutionField field = given.field;
    set_regions(field, given.model, ctx);
    double sum = 0;
    for (const std::uint32_t r : given.model.control.region)
        sum += static_cast<double>(field.candidates(r).size() + field.rivals(r).size());
    return sum / static_cast<double>(given.model.control.region.size());
}

std::vector<KernelCost> costs_of(const Given& given, const ProjectReport& projected, double list) {
    const double vertices = given.patches.vertex_count(), quads = given.patches.quad_count();
    const double pairs = static_cast<double>(projected.evaluations) * list;
    constexpr double kPoint = sizeof(Vec3);
    return {{"refine", 2 * kPoint * 1.6 * vertices, 2 * 3 * 25 * 1.3 * vertices},
            {"project", 3 * kPoint * vertices, kFlopsPerPair * pairs},
            {"find folds", 2 * kPoint * vertices, 150 * quads},
            {"normals", 2 * kPoint * vertices, 4 * 20 * vertices},
            {"quads", sizeof(Quad) * quads, 0}};
}

void measure_on_card(const Given& given, const MeshOptions& options, const GpuRun& run, double cage_seconds,
                     GpuResult& out) {
    DeviceQuads device(run.ctx);
    cuda::QuadJob job = given.job(options);
    job.untangle.passes = 0;  // as the model at rest
    Buffer<Vec3> positions, anchors;
    if (!device.begin(job, given.contacts())) throw Error("gpu: lists are too long for the card");
    cuda::QuadReport report = device.finish(positions, &anchors);
    out.apart = apart(given.model.rest.positions, anchors, positions);
    job.untangle = options.untangle;
    std::vector<double> whole, card;
    for (int i = 0; i < std::max(3, run.repeat / 5); ++i) {
        const Clock clock;
        device.begin(job, given.contacts());
        report = device.finish(positions);
        whole.push_back(clock.seconds());
    }
    for (int i = 0; i < run.repeat + kWarm; ++i) {
        const Clock clock;
        device.repeat();
        if (i >= kWarm) card.push_back(clock.seconds());
    }
    out.device = median(card);
    out.with_cage = cage_seconds + median(whole);
    out.bytes_per_face = static_cast<double>(device.bytes_used()) / static_cast<double>(out.faces);
    device.measure();
    constexpr int kRounds = 5;
    for (int i = 0; i < kRounds; ++i) device.repeat();
    out.kernels =
        shares_of(device.take_times(), kRounds, costs_of(given, report.projected, mean_list(given, run.ctx)));
}

}  // namespace

GpuResult measure_quads(const QuadCase& what, const GpuRun& run) {
    MeshOptions options;
    options.device = Device::cpu;
    options.remesh_rounds = 0;
    GpuResult out{what.name};
    out.papers = what.papers;
    out.goal = what.goal;
    std::vector<double> cpu, cage;
    for (int i = 0; i < std::max(3, run.repeat / 5); ++i) {
        const MeshResult made = mesh_skeleton(what.skeleton, options, run.ctx);
        cpu.push_back(stage_seconds(made, {"field", "quads", "refine", "anchors", "project", "untangle"}));
        cage.push_back(stage_seconds(made, {"prepare", "graft", "part", "cage", "weights", "topology"}));
        out.faces = made.quads().mesh.quads.size();
    }
    out.segments = what.skeleton.size() - what.skeleton.tree_count();
    out.cpu = median(cpu);
    if (!run.device.device) return out;
    const Given given(what.skeleton, options, run.ctx);
    measure_on_card(given, options, run, median(cage), out);
    return out;
}

}  // namespace coppice::bench
