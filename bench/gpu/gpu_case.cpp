#include "gpu_case.h"

#include <fmt/format.h>

#include <algorithm>

namespace coppice::bench {
namespace {

std::string milliseconds(double seconds) { return seconds < 0 ? "-" : fmt::format("{:.3g}", 1e3 * seconds); }

std::string ratio(double of, double to) { return of < 0 || to < 0 ? "-" : fmt::format("{:.1f}", of / to); }

std::string percent(double part, double whole) {
    return whole <= 0 || part <= 0 ? "-" : fmt::format("{:.0f} %", 100 * part / whole);
}

double limit(const DeviceSearch& search, double DeviceInfo::*which) {
    return search.device ? (*search.device).*which : 0;
}

}  // namespace

std::vector<KernelShare> shares_of(const std::vector<cuda::KernelTime>& times, int rounds,
                                   const std::vector<KernelCost>& costs) {
    std::vector<KernelShare> out;
    for (const cuda::KernelTime& t : times) {
        auto found = std::ranges::find(out, t.name, &KernelShare::name);
        if (found == out.end()) {
            out.push_back({t.name, 0, 0, {}});
            found = out.end() - 1;
        }
        found->seconds += t.seconds / rounds;
        ++found->launches;
    }
    for (KernelShare& share : out) {
        share.launches /= static_cast<std::uint32_t>(rounds);
        const auto cost = std::ranges::find(costs, share.name, &KernelCost::name);
        if (cost != costs.end()) share.cost = *cost;
    }
    return out;
}

nlohmann::ordered_json json_of(const GpuResult& r, const DeviceSearch& device) {
    nlohmann::ordered_json out{{"name", r.name}, {"segments", r.segments}, {"faces", r.faces}};
    const auto put = [&](const char* name, double value) {
        if (value >= 0) out[name] = value;
    };
    put("papers_s", r.papers);
    put("goal_s", r.goal);
    put("device_s", r.device);
    put("with_cage_s", r.with_cage);
    put("cpu_s", r.cpu);
    put("bytes_per_face", r.bytes_per_face);
    if (r.apart >= 0) out["vertices_apart"] = r.apart;
    for (const KernelShare& k : r.kernels) {
        nlohmann::ordered_json kernel{{"seconds", k.seconds},
                                      {"launches", k.launches},
                                      {"bytes", k.cost.bytes},
                                      {"flops", k.cost.flops}};
        if (k.seconds > 0 && device.device) {
            kernel["bandwidth_share"] = k.cost.bytes / k.seconds / device.device->bandwidth;
            kernel["arithmetic_share"] = k.cost.flops / k.seconds / device.device->flops;
        }
        out["kernels"][k.name] = kernel;
    }
    return out;
}

std::string markdown_of(const std::vector<GpuResult>& results, const DeviceSearch& device) {
    std::string out =
        "| what | segments | faces | papers, ms | goal, ms | card, ms | with the cage on the CPU, ms | CPU, "
        "ms | "
        "CPU / card | bytes a face | vertices apart |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | "
        "---: | "
        "---: | ---: | ---: |\n";
    for (const GpuResult& r : results) {
        out += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", r.name, r.segments,
                           r.faces, milliseconds(r.papers), milliseconds(r.goal), milliseconds(r.device),
                           milliseconds(r.with_cage), milliseconds(r.cpu), ratio(r.cpu, r.device),
                           r.bytes_per_face < 0 ? "-" : fmt::format("{:.0f}", r.bytes_per_face),
                           r.apart < 0 ? "-" : fmt::format("{}", r.apart));
    }
    out +=
        "\n| what | kernel | launches | ms | MB | Mflop | of the memory's limit | of the arithmetic limit |\n"
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for (const GpuResult& r : results) {
        for (const KernelShare& k : r.kernels) {
            out += fmt::format("| {} | {} | {} | {} | {:.1f} | {:.1f} | {} | {} |\n", r.name, k.name,
                               k.launches, milliseconds(k.seconds), 1e-6 * k.cost.bytes, 1e-6 * k.cost.flops,
                               percent(k.cost.bytes / k.seconds, limit(device, &DeviceInfo::bandwidth)),
                               percent(k.cost.flops / k.seconds, limit(device, &DeviceInfo::flops)));
        }
    }
    return out;
}

}  // namespace coppice::bench
