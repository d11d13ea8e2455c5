#include "gpu_pairs.h"

#include <fmt/format.h>

#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/cuda/field/device_field.h"
#include "coppice/skeleton/random_tree.h"
#include "gpu_costs.h"

namespace coppice::bench {
namespace {

constexpr std::uint32_t kSegments = 256;
constexpr std::size_t kPoints = std::size_t{1} << 22;

/// [1/s] Returns the rate of pairs on all threads of the CPU, measured on a fraction of the points.
double pairs_on_cpu(const ConvolutionField& field, std::span<const Vec3> points, const GpuRun& run) {
    constexpr std::size_t kBatch = 1024;
    points = points.first(points.size() / 16);
    std::vector<FieldSample> out(points.size());
    const double seconds = median_time(run, 1, few_rounds(run), [&] {
        parallel_for(run.ctx, points.size() / kBatch, 1, [&](std::size_t i) {
            field.sample(0, points.subspan(i * kBatch, kBatch), std::span(out).subspan(i * kBatch, kBatch));
        });
    });
    return static_cast<double>(points.size()) * static_cast<double>(field.candidates(0).size()) / seconds;
}

}  // namespace

PairsResult measure_pairs(Kernel kernel, const GpuRun& run) {
    PairsResult out{kernel == Kernel::cauchy ? "cauchy" : "quartic"};
    out.pairs = static_cast<double>(kPoints) * kSegments;
    out.flops_per_pair = flops_per_pair(kernel);
    const Skeleton tree = random_tree(kSegments - 1, 1);
    ConvolutionField field(tree, {.kernel = kernel, .blend = 1}, run.ctx);
    Box3 all;
    for (const Vec3 p : tree.positions()) all.extend(p);
    field.set_regions(std::span<const Box3>(&all, 1), run.ctx);
    std::vector<Vec3> points(kPoints);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = tree.positions()[i % tree.size()] + Vec3{1e-7f * static_cast<float>(i), 0, 0};
    out.pairs = static_cast<double>(kPoints) * static_cast<double>(field.candidates(0).size());
    out.cpu_rate = pairs_on_cpu(field, points, run);
    if (run.device.device) out.seconds = median(time_field(field, points, run.repeat));
    return out;
}

Json make_json(const PairsResult& r, const DeviceSearch& device) {
    Json out{{"kernel", r.kernel},
             {"pairs", r.pairs},
             {"flops_per_pair", r.flops_per_pair},
             {"cpu_pairs_per_second", r.cpu_rate}};
    if (r.seconds < 0) return out;
    out["seconds"] = r.seconds;
    out["pairs_per_second"] = r.pairs / r.seconds;
    out["arithmetic_share"] = r.pairs * r.flops_per_pair / r.seconds / device.device->flops;
    return out;
}

std::string to_markdown(const std::vector<PairsResult>& results, const DeviceSearch& device) {
    constexpr double kGiga = 1e-9, kGoal = 300;
    std::string out =
        "| kernel | papers, G pairs/s | CPU, G pairs/s | GPU, G pairs/s | goal | reached | of the arithmetic "
        "limit |\n| --- | ---: | ---: | ---: | ---: | --- | ---: |\n";
    for (const PairsResult& r : results) {
        out += fmt::format("| {} | 0.21 | {:.2f} | ", r.kernel, kGiga * r.cpu_rate);
        if (r.seconds <= 0) {
            out += fmt::format("- | {} | - | - |\n", kGoal);
            continue;
        }
        const double rate = kGiga * r.pairs / r.seconds;
        out += fmt::format("{:.0f} | {} | {} | {:.0f} % |\n", rate, kGoal, rate >= kGoal ? "yes" : "no",
                           100 * r.pairs * r.flops_per_pair / r.seconds / device.device->flops);
    }
    return out;
}

}  // namespace coppice::bench
