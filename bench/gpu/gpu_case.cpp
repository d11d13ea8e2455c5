#include "gpu_case.h"

#include <fmt/format.h>

#include <functional>

namespace coppice::bench {
namespace {

std::string milliseconds(double seconds) { return seconds < 0 ? "-" : fmt::format("{:.3g}", 1e3 * seconds); }

std::string percent(double part, double whole) {
    return whole <= 0 || part <= 0 ? "-" : fmt::format("{:.0f} %", 100 * part / whole);
}

std::string count(std::int64_t n) { return n < 0 ? "-" : fmt::format("{}", n); }

double limit(const DeviceSearch& search, double DeviceInfo::*which) {
    return search.device ? (*search.device).*which : 0;
}

double speedup(const GpuResult& r) { return r.cpu < 0 || r.device <= 0 ? -1 : r.cpu / r.device; }

/// A goal with the measured value.
struct Judged {
    const char* figure;
    double wanted, measured;  ///< below 0: not measured
    bool at_least = false;

    bool reached() const { return at_least ? measured >= wanted : measured <= wanted; }
    std::string verdict() const { return measured < 0 ? "-" : reached() ? "yes" : "no"; }
};

Judged judged(const Goal& goal, const GpuResult& r) {
    const auto in_ms = [](double seconds) { return seconds < 0 ? -1 : 1e3 * seconds; };
    switch (goal.kind) {
        case GoalKind::card:
            return {"GPU, ms", goal.wanted, in_ms(r.device)};
        case GoalKind::cage:
            return {"cage on the CPU, ms", goal.wanted, in_ms(r.cage)};
        case GoalKind::memory:
            return {"bytes per face", goal.wanted, r.bytes_per_face};
        case GoalKind::speedup:
            break;
    }
    return {"CPU / GPU", goal.wanted, speedup(r), true};
}

Json make_json(const KernelShare& k, const DeviceSearch& device) {
    Json out{{"seconds", k.seconds}, {"launches", k.launches}};
    if (!k.cost) return out;
    out["bytes"] = k.cost->bytes;
    out["flops"] = k.cost->flops;
    if (k.seconds <= 0 || !device.device) return out;
    out["bandwidth_share"] = k.cost->bytes / k.seconds / device.device->bandwidth;
    out["arithmetic_share"] = k.cost->flops / k.seconds / device.device->flops;
    return out;
}

std::string figures(const std::vector<GpuResult>& results) {
    std::string out =
        "| case | segments | faces | papers, ms | GPU, ms | CPU, ms | CPU / GPU | cage on the CPU, ms | "
        "total, ms | bytes per face | differing vertices |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: "
        "| ---: | ---: | ---: | ---: |\n";
    for (const GpuResult& r : results) {
        const double ratio = speedup(r);
        out += fmt::format(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", r.name, r.segments, r.faces,
            milliseconds(r.papers), milliseconds(r.device), milliseconds(r.cpu),
            ratio < 0 ? "-" : fmt::format("{:.1f}", ratio), milliseconds(r.cage), milliseconds(r.whole),
            r.bytes_per_face < 0 ? "-" : fmt::format("{:.0f}", r.bytes_per_face), count(r.apart));
    }
    return out;
}

std::string goals(const std::vector<GpuResult>& results) {
    std::string out = "| case | figure | goal | measured | reached |\n| --- | --- | ---: | ---: | --- |\n";
    for (const GpuResult& r : results) {
        for (const Goal& goal : r.goals) {
            const Judged j = judged(goal, r);
            out += fmt::format("| {} | {} | {} {:.3g} | {} | {} |\n", r.name, j.figure,
                               j.at_least ? "at least" : "at most", j.wanted,
                               j.measured < 0 ? "-" : fmt::format("{:.3g}", j.measured), j.verdict());
        }
    }
    return out;
}

/// Returns the kernels that use at least a fiftieth of the time of a row, in descending order of time.
std::vector<KernelShare> main_kernels(const GpuResult& r) {
    constexpr double kMin = 1.0 / 50;
    double all = 0;
    for (const KernelShare& k : r.kernels) all += k.seconds;
    std::vector<KernelShare> out = r.kernels;
    std::erase_if(out, [&](const KernelShare& k) { return k.seconds < kMin * all; });
    std::ranges::stable_sort(out, std::greater<>(), &KernelShare::seconds);
    return out;
}

std::string kernels(const std::vector<GpuResult>& results, const DeviceSearch& device) {
    std::string out =
        "| case | kernel | launches | ms | MB | Mflop | of the memory limit | of the arithmetic limit |\n| "
        "--- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for (const GpuResult& r : results) {
        for (const KernelShare& k : main_kernels(r)) {
            out += fmt::format("| {} | {} | {} | {} | ", r.name, k.name, k.launches, milliseconds(k.seconds));
            if (!k.cost) {
                out += "- | - | - | - |\n";
                continue;
            }
            out += fmt::format("{:.1f} | {:.1f} | {} | {} |\n", 1e-6 * k.cost->bytes, 1e-6 * k.cost->flops,
                               percent(k.cost->bytes / k.seconds, limit(device, &DeviceInfo::bandwidth)),
                               percent(k.cost->flops / k.seconds, limit(device, &DeviceInfo::flops)));
        }
    }
    return out;
}

}  // namespace

std::vector<KernelShare> compute_shares(const std::vector<cuda::KernelTime>& times, int rounds,
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

Json make_json(const GpuResult& r, const DeviceSearch& device) {
    Json out{{"name", r.name}, {"segments", r.segments}, {"faces", r.faces}};
    const auto put = [&](const char* name, double value) {
        if (value >= 0) out[name] = value;
    };
    if (!r.note.empty()) out["note"] = r.note;
    put("papers_s", r.papers);
    put("device_s", r.device);
    put("cpu_s", r.cpu);
    put("cage_s", r.cage);
    put("whole_s", r.whole);
    put("bytes_per_face", r.bytes_per_face);
    if (r.apart >= 0) out["vertices_apart"] = r.apart;
    for (const Goal& goal : r.goals) {
        const Judged j = judged(goal, r);
        Json one{{"figure", j.figure}, {j.at_least ? "at_least" : "at_most", j.wanted}};
        if (j.measured >= 0) {
            one["measured"] = j.measured;
            one["reached"] = j.reached();
        }
        out["goals"].push_back(one);
    }
    for (const auto& [stage, seconds] : r.cpu_stages) out["cpu_stages_s"][stage] = seconds;
    for (const KernelShare& k : r.kernels) out["kernels"][k.name] = make_json(k, device);
    return out;
}

std::string to_markdown(const std::vector<GpuResult>& results, const DeviceSearch& device) {
    std::string out = figures(results);
    for (const GpuResult& r : results) {
        if (!r.note.empty()) out += fmt::format("\n{}: {}.\n", r.name, r.note);
    }
    out.append("\n").append(goals(results));
    const auto has_kernels = [](const GpuResult& r) { return !r.kernels.empty(); };
    if (std::ranges::any_of(results, has_kernels)) out.append("\n").append(kernels(results, device));
    return out;
}

}  // namespace coppice::bench
