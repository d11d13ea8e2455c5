#include "gpu_pairs.h"

#include <fmt/format.h>

#include "coppice/base/median.h"
#include "coppice/cuda/field/device_field.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::bench {
namespace {

constexpr std::uint32_t kSegments = 256;
constexpr std::size_t kPoints = std::size_t{1} << 22;

/// Counted in segment_kernel.h and the kernel's own header: sums, products, quotients and roots.
double flops_per_pair(Kernel kernel) { return kernel == Kernel::cauchy ? 122 : 98; }

}  // namespace

PairsResult measure_pairs(Kernel kernel, const GpuRun& run) {
    PairsResult out{kernel == Kernel::cauchy ? "cauchy" : "quartic"};
    out.pairs = static_cast<double>(kPoints) * kSegments;
    out.flops_per_pair = flops_per_pair(kernel);
    if (!run.device.device) return out;
    const Skeleton tree = random_tree(kSegments - 1, 1);
    ConvolutionField field(tree, {.kernel = kernel, .blend = 1}, run.ctx);
    Box3 all;
    for (const Vec3 p : tree.positions()) all.extend(p);
    field.set_regions(std::span<const Box3>(&all, 1), run.ctx);
    std::vector<Vec3> points(kPoints);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = tree.positions()[i % tree.size()] + Vec3{1e-7f * static_cast<float>(i), 0, 0};
    out.pairs = static_cast<double>(kPoints) * static_cast<double>(field.candidates(0).size());
    out.seconds = median(time_field(field, points, run.repeat));
    return out;
}

nlohmann::ordered_json json_of(const PairsResult& r, const DeviceSearch& device) {
    nlohmann::ordered_json out{
        {"kernel", r.kernel}, {"pairs", r.pairs}, {"flops_per_pair", r.flops_per_pair}};
    if (r.seconds < 0) return out;
    out["seconds"] = r.seconds;
    out["pairs_per_second"] = r.pairs / r.seconds;
    out["arithmetic_share"] = r.pairs * r.flops_per_pair / r.seconds / device.device->flops;
    return out;
}

std::string markdown_of(const std::vector<PairsResult>& results, const DeviceSearch& device) {
    std::string out =
        "| kernel | papers, G pairs/s | goal | card, G pairs/s | of the arithmetic limit |\n"
        "| --- | ---: | ---: | ---: | ---: |\n";
    for (const PairsResult& r : results) {
        const bool has = r.seconds > 0;
        out += fmt::format(
            "| {} | 0.21 | 300 | {} | {} |\n", r.kernel,
            has ? fmt::format("{:.0f}", 1e-9 * r.pairs / r.seconds) : "-",
            has ? fmt::format("{:.0f} %", 100 * r.pairs * r.flops_per_pair / r.seconds / device.device->flops)
                : "-");
    }
    return out;
}

}  // namespace coppice::bench
