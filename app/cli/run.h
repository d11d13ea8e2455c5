#pragma once

#include <chrono>
#include <filesystem>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/skeleton/skeleton.h"
#include "figures.h"
#include "host.h"
#include "options.h"

namespace coppice::cli {

/// Options of commands that process many files.
struct BatchFlags {
    std::filesystem::path name;  ///< template of the names of outputs; empty: that of the command
    bool resume = false;
    bool dry_run = false;
};
/// Heading of these options.
inline constexpr const char* kManyFilesGroup = "Many files";
void add_batch_options(OptionList& options, BatchFlags& flags);

/// Options of every command.
struct CommonFlags {
    int threads = 0;
    int max_memory = 0;  ///< [MiB] 0 = all memory of the machine, or the default of scenes
    std::filesystem::path report;
    bool quiet = false;
    BatchFlags batch;
};
void add_common_options(OptionList& options, CommonFlags& flags);

/// One run of a command: provides the context of each stage, shows progress, measures times, and writes the
/// report.
class Run {
  public:
    /// Stores a reference to the host.
    Run(std::string command, CommonFlags flags, Host& host);

    /// Runs stage(context) and returns its result; throws Cancelled if a stop was requested.
    template <class Stage>
    auto stage(const std::string& name, Stage&& stage) {
        const Clock clock(*this, name);
        return std::forward<Stage>(stage)(context(name));
    }

    /// Sets the item that the following stages process, for the progress: "3 of 20, oak.las".
    void set_subject(std::string subject) { subject_ = std::move(subject); }

    /// Returns the number of threads that the command may use.
    unsigned threads() const;

    /// Adds a stage that was timed elsewhere.
    void add_stage(const std::string& name, double seconds) { stages_.emplace_back(name, seconds); }
    /// Adds the stages of a result, each with this prefix.
    void add_stages(const std::string& prefix, const auto& stages) {
        for (const auto& [name, seconds] : stages) add_stage(prefix + std::string(name), seconds);
    }

    /// Clears a stop request, so that later work is not stopped.
    void forget_interrupt() { host_.forget_stop(); }

    /// Returns whether Ctrl-C requested a stop; for work without an end.
    std::stop_token stop_token() const { return host_.stop_token(); }

    /// [MiB] Limits the memory of the process to the value of --max-memory, or else to `otherwise`, at least
    /// kMinMemory; returns the limit.
    int max_memory(int otherwise);

    const CommonFlags& flags() const { return flags_; }  ///< options that all commands share
    Host& host() const { return host_; }                 ///< surroundings of the command
    /// Outputs data. Throws IoError on failure.
    void print(std::string_view text) { host_.print(text); }
    /// Outputs a message of one line.
    void say(const std::string& message) { host_.say(message); }

    Json& counts() { return counts_; }
    const Json& warnings() const { return warnings_; }
    Json& repairs() { return repairs_; }
    /// Adds the numbers of nodes and trees of a skeleton to the counts.
    void count_skeleton(const Skeleton& skeleton) {
        counts_.update({{"nodes", skeleton.size()}, {"trees", skeleton.tree_count()}});
    }

    /// Prints a warning on stderr, unless --quiet, and adds it to the report.
    void warn(const std::string& text);

    /// Returns the report: stages, counts, repairs and warnings until now.
    Json report() const;

    /// Writes the report, if requested, and prints a summary of the result and the elapsed time.
    void finish(const std::string& summary);

  private:
    class Clock {
      public:
        Clock(Run& run, const std::string& name);
        ~Clock();
        Clock(const Clock&) = delete;
        Clock& operator=(const Clock&) = delete;

      private:
        Run& run_;
        std::size_t stage_;
        std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    };

    Context context(const std::string& stage);

    std::string command_;
    CommonFlags flags_;
    Host& host_;
    bool shows_progress_;
    std::string subject_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::vector<std::pair<std::string, double>> stages_;
    Json counts_ = Json::object();
    Json repairs_ = Json::object();
    Json warnings_ = Json::array();
};

}  // namespace coppice::cli
