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
#include "coppice/options/json.h"

namespace coppice::bench {

/// Common settings of all cases of one run.
struct GpuRun {
    DeviceSearch device;  ///< the GPU, or the reason why there is none: then only the CPU is measured
    int repeat = 51;      ///< maximum number of timed rounds of each case, after a few warm-up rounds
    double seconds = 10;  ///< [s] for the rounds of each case and side; at least two rounds are executed
    Context ctx;          ///< of the CPU
};

/// Work of one kernel of a case in a round, counted manually.
struct KernelCost {
    std::string name;
    double bytes = 0;  ///< read and written once each
    double flops = 0;  ///< sums, products, quotients and roots; a fused product and sum are two
};

/// Measurement of one kernel of a case.
struct KernelShare {
    std::string name;
    double seconds = 0;  ///< total of all its launches in a round
    std::uint32_t launches = 0;
    std::optional<KernelCost> cost;  ///< empty if it was not counted
};

/// Kinds of goals of a case.
enum class GoalKind {
    card,    ///< [ms] maximum of GpuResult::device
    cage,    ///< [ms] maximum of GpuResult::cage
    memory,  ///< [bytes] maximum of GpuResult::bytes_per_face
    speedup  ///< minimum of GpuResult::cpu over GpuResult::device
};
struct Goal {
    GoalKind kind;
    double wanted;
};

/// One row of the tables. Times are medians; below 0: not measured.
struct GpuResult {
    std::string name;
    std::string note;  ///< differences from the procedure of the other rows; usually empty
    std::uint64_t segments = 0, faces = 0;
    double papers = -1;  ///< [s] published time for the same work
    double device = -1;  ///< [s] from the cage, or the coarse tetrahedra, on the GPU to the surface there
    double cage = -1;    ///< [s] of the CPU from the skeleton to its cage
    double whole = -1;   ///< [s] the cage, copying it to the GPU, and the surface back to the host
    double cpu = -1;     ///< [s] of the same stages as `device` on all threads of the CPU
    double bytes_per_face = -1;
    /// number of vertices that differ from those of the CPU by more than tolerance()
    std::int64_t apart = -1;
    std::vector<KernelShare> kernels;
    std::vector<std::pair<std::string, double>> cpu_stages;  ///< [s] by stage
    std::vector<Goal> goals;
};

/// Returns the median time of a piece of work in seconds, over the number of rounds of the run, after `warm`
/// warm-up rounds.
template <class Work>
double median_time(const GpuRun& run, int warm, int rounds, const Work& work) {
    constexpr int kMin = 2;
    for (int i = 0; i < warm; ++i) work();
    std::vector<double> seconds;
    const Clock all;
    for (int i = 0; i < kMin || (i < rounds && all.seconds() < run.seconds); ++i) {
        const Clock clock;
        work();
        seconds.push_back(clock.seconds());
    }
    return median(seconds);
}

/// Returns the number of rounds for slow work: on the CPU, and including copies.
inline int few_rounds(const GpuRun& run) { return std::max(2, run.repeat / 5); }

/// Executes the GPU part of a row if there is a GPU. A failure becomes a note, so that the CPU part is still
/// reported.
template <class Work>
void on_card(const GpuRun& run, GpuResult& out, const Work& work) {
    if (!run.device.device) return;
    try {
        work();
    } catch (const DeviceError& error) {
        out.note = error.what();
    }
}

/// Sums up launches by kernel, and adds the costs. `rounds` is the number of measured rounds.
std::vector<KernelShare> compute_shares(const std::vector<cuda::KernelTime>& times, int rounds,
                                        const std::vector<KernelCost>& costs);

/// Measures the repetitions of a device: whole rounds, then each kernel.
template <class Device, class Work>
void time_on_card(Device& device, const GpuRun& run, const std::vector<KernelCost>& costs, const Work& repeat,
                  GpuResult& out) {
    constexpr int kWarm = 5, kRounds = 5;
    out.device = median_time(run, kWarm, run.repeat, repeat);
    out.bytes_per_face = static_cast<double>(device.bytes_used()) / static_cast<double>(out.faces);
    device.measure();
    for (int i = 0; i < kRounds; ++i) repeat();
    out.kernels = compute_shares(device.take_times(), kRounds, costs);
}

Json make_json(const GpuResult& result, const DeviceSearch& device);
/// Returns three tables: measurements, goals, and kernels.
std::string to_markdown(const std::vector<GpuResult>& results, const DeviceSearch& device);

}  // namespace coppice::bench
