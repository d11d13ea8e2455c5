#pragma once

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clock.h"
#include "coppice/base/context.h"
#include "coppice/base/median.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"

namespace coppice::bench {

/// What all cases of one run have in common.
struct GpuRun {
    DeviceSearch device;  ///< the card, or why there is none: then only the CPU is measured
    int repeat = 51;      ///< timed rounds of each case at most, after a few that are not
    double seconds = 10;  ///< [s] for the rounds of each case and side; two are made at least
    Context ctx;          ///< of the CPU
};

/// What one kernel of a case does in a round, counted by hand.
struct KernelCost {
    std::string name;
    double bytes = 0;  ///< read and written once each
    double flops = 0;  ///< sums, products, quotients and roots; a fused product and sum are two
};

/// One kernel of a case as measured.
struct KernelShare {
    std::string name;
    double seconds = 0;  ///< of all its launches in a round
    std::uint32_t launches = 0;
    std::optional<KernelCost> cost;  ///< none where it was not counted
};

/// What is asked of a case.
enum class GoalKind {
    card,    ///< [ms] GpuResult::device at most
    cage,    ///< [ms] GpuResult::cage at most
    memory,  ///< [bytes] GpuResult::bytes_per_face at most
    speedup  ///< GpuResult::cpu over GpuResult::device at least
};
struct Goal {
    GoalKind kind;
    double wanted;
};

/// One row of the tables. Times are medians; below 0: not measured.
struct GpuResult {
    std::string name;
    std::string note;  ///< what was done otherwise than in the other rows; mostly empty
    std::uint64_t segments = 0, faces = 0;
    double papers = -1;  ///< [s] printed for the same work
    double device = -1;  ///< [s] from the cage, or the coarse tetrahedra, on the card to the surface there
    double cage = -1;    ///< [s] of the CPU from the skeleton to its cage
    double whole = -1;   ///< [s] the cage, copying it to the card, and the surface back to the host
    double cpu = -1;     ///< [s] of the same stages as `device` on all threads of the CPU
    double bytes_per_face = -1;
    std::int64_t apart = -1;  ///< vertices farther than tolerance() from where the CPU has them
    std::vector<KernelShare> kernels;
    std::vector<std::pair<std::string, double>> cpu_stages;  ///< [s] by the stage
    std::vector<Goal> goals;
};

/// The median seconds of a piece of work, as often as the run says, after `warm` rounds that do not count.
template <class Work>
double median_time(const GpuRun& run, int warm, int rounds, const Work& work) {
    constexpr int kFewest = 2;
    for (int i = 0; i < warm; ++i) work();
    std::vector<double> seconds;
    const Clock all;
    for (int i = 0; i < kFewest || (i < rounds && all.seconds() < run.seconds); ++i) {
        const Clock clock;
        work();
        seconds.push_back(clock.seconds());
    }
    return median(seconds);
}

/// Rounds of the CPU, which is slow, and of what copies.
inline int few_rounds(const GpuRun& run) { return std::max(2, run.repeat / 5); }

/// Does the card's part of a row, where there is a card. What it fails at becomes a note, so that the CPU's
/// part is told all the same.
template <class Work>
void on_card(const GpuRun& run, GpuResult& out, const Work& work) {
    if (!run.device.device) return;
    try {
        work();
    } catch (const DeviceError& error) {
        out.note = error.what();
    }
}

/// Sums up launches by the kernel, and puts the costs beside them. `rounds` were measured.
std::vector<KernelShare> shares_of(const std::vector<cuda::KernelTime>& times, int rounds,
                                   const std::vector<KernelCost>& costs);

/// Times what a device repeats: whole rounds, then kernel by kernel.
template <class Device, class Work>
void time_on_card(Device& device, const GpuRun& run, const std::vector<KernelCost>& costs, const Work& repeat,
                  GpuResult& out) {
    constexpr int kWarm = 5, kRounds = 5;
    out.device = median_time(run, kWarm, run.repeat, repeat);
    out.bytes_per_face = static_cast<double>(device.bytes_used()) / static_cast<double>(out.faces);
    device.measure();
    for (int i = 0; i < kRounds; ++i) repeat();
    out.kernels = shares_of(device.take_times(), kRounds, costs);
}

nlohmann::ordered_json json_of(const GpuResult& result, const DeviceSearch& device);
/// Three tables: what was measured, the goals, and the kernels.
std::string markdown_of(const std::vector<GpuResult>& results, const DeviceSearch& device);

}  // namespace coppice::bench
