#include "run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "coppice/system/file.h"
#include "coppice/system/process.h"
#include "coppice/version.h"
#include "files.h"
#include "memory.h"

namespace coppice::cli {
namespace {

constexpr Field kThreads =
    common_field("threads", "Number of threads; 0 uses all cores.", Unit::none, 0, 1024);
constexpr Field kMaxMemory{
    "max_memory", "Maximum memory in MiB; 0 allows all memory of the machine, or 4096 MiB for scenes.",
    Unit::none, 0, 1e6};

unsigned threads_of_machine() { return std::max(1u, std::thread::hardware_concurrency()); }

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double rounded(double seconds) { return std::round(seconds * 1e6) / 1e6; }

}  // namespace

void add_batch_options(OptionList& options, BatchFlags& flags) {
    const std::string group = kManyFilesGroup;
    options.file(
        "--name", "TEMPLATE", flags.name,
        "Names of the outputs of many files: {stem} is the name of the input without extension, {file} "
        "with it, {folder} the name of its folder, {number} its place in the list.",
        {.group = group, .common = false});
    options.flag("--resume", flags.resume,
                 "Process only files with missing results, or with changed content or options.",
                 {.group = group, .common = false});
    options.flag("--dry-run", flags.dry_run, "List the outputs without writing them.",
                 {.group = group, .common = false});
}

void add_common_options(OptionList& options, CommonFlags& flags) {
    const std::string group = "Running";
    options.value({kThreads, &flags.threads}, group);
    options.value({kMaxMemory, &flags.max_memory}, group);
    options.output("--report", "FILE", flags.report,
                   "Write times, counts, repairs and peak memory to this file as JSON.", {.group = group});
    options.flag("--quiet", flags.quiet, "Print neither progress nor a summary.",
                 {.group = group, .common = false});
}

Run::Run(std::string command, CommonFlags flags, Host& host)
    : command_(std::move(command)),
      flags_(std::move(flags)),
      host_(host),
      shows_progress_(!flags_.quiet && host.shows_progress()) {
    if (!flags_.report.empty()) check_output_folder(flags_.report);
    if (flags_.max_memory != 0 && flags_.max_memory < kMinMemory) {
        throw UsageError(fmt::format("--max-memory takes 0 or a whole number from {}, not '{}'", kMinMemory,
                                     flags_.max_memory));
    }
    max_memory(memory_of_machine());
}

int Run::max_memory(int otherwise) {
    const int most = flags_.max_memory != 0 ? flags_.max_memory : otherwise;
    host_.limit_memory(most, threads_of_machine());
    return most;
}

unsigned Run::threads() const {
    return flags_.threads == 0 ? threads_of_machine()
                               : std::min(static_cast<unsigned>(flags_.threads), threads_of_machine());
}

Context Run::context(const std::string& stage) {
    Context ctx;
    ctx.threads = std::min(static_cast<unsigned>(flags_.threads), threads_of_machine());
    ctx.stop = host_.stop_token();
    ctx.throw_if_cancelled();
    if (shows_progress_) {
        ctx.progress = [this, stage](float fraction) { host_.show_progress(subject_, stage, fraction); };
        ctx.progress(0);
    }
    return ctx;
}

// Allocated before the work, so that nothing is allocated when it ends, possibly because memory is exhausted.
Run::Clock::Clock(Run& run, const std::string& name) : run_(run), stage_(run.stages_.size()) {
    run.stages_.emplace_back(name, 0);
}

Run::Clock::~Clock() {
    run_.stages_[stage_].second = seconds_since(start_);
    if (run_.shows_progress_) run_.host_.clear_progress();
}

Json Run::report() const {
    const double seconds = seconds_since(start_);
    Json stages = Json::array();
    for (const auto& [name, took] : stages_) stages.push_back({{"name", name}, {"seconds", rounded(took)}});
    return {{"coppice", kVersion},         {"command", command_},
            {"seconds", rounded(seconds)}, {"stages", stages},
            {"counts", counts_},           {"repairs", repairs_},
            {"warnings", warnings_},       {"peak_memory_bytes", measure_memory().peak}};
}

void Run::warn(const std::string& text) {
    warnings_.emplace_back(text);
    if (flags_.quiet) return;
    if (shows_progress_) host_.clear_progress();
    host_.say("warning: " + text);
}

void Run::finish(const std::string& summary) {
    const double total = seconds_since(start_);
    if (!flags_.report.empty()) write_file(flags_.report, figures_json(report()));
    if (!shows_progress_) return;
    std::vector<std::pair<std::string_view, double>> sums;  // for stages with the same name, as of many files
    for (const auto& [name, seconds] : stages_) {
        const auto known =
            std::ranges::find(sums, std::string_view(name), [](const auto& s) { return s.first; });
        if (known == sums.end())
            sums.emplace_back(name, seconds);
        else
            known->second += seconds;
    }
    std::vector<std::string> parts;
    for (const auto& [name, seconds] : sums) parts.push_back(fmt::format("{} {:.2f}", name, seconds));
    host_.finish(summary, fmt::format("{:.2f} s ({}), peak memory {} MB", total, fmt::join(parts, ", "),
                                      measure_memory().peak / 1'000'000));
}

}  // namespace coppice::cli
