#pragma once

#include <chrono>
#include <filesystem>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "figures.h"
#include "options.h"
#include "signals.h"

namespace coppice::cli {

/// What every command takes.
struct CommonFlags {
    int threads = 0;
    int max_memory = 0;  ///< [MiB] 0 = what the machine has, for scenes their default
    std::filesystem::path report;
    bool quiet = false;
};
void add_common_options(OptionList& options, CommonFlags& flags);

/// One run of a command: hands each stage its context, shows its progress, keeps the time, and writes the
/// report.
class Run {
  public:
    Run(std::string command, CommonFlags flags, Signals& signals);

    /// Runs stage(context) and returns what it returns; throws Cancelled when a stop was asked for meanwhile.
    template <class Stage>
    auto stage(const std::string& name, Stage&& stage) {
        const Clock clock(*this, name);
        return std::forward<Stage>(stage)(context(name));
    }

    /// What the stages from here on work on, for the progress: "3 of 20, oak.las".
    void set_subject(std::string subject) { subject_ = std::move(subject); }

    /// A stage that another part of the program has timed.
    void add_stage(const std::string& name, double seconds) { stages_.emplace_back(name, seconds); }

    /// What was to stop does not stop what comes after it.
    void forget_interrupt() { signals_.forget(); }

    /// Asked to stop by Ctrl-C, for work that has no end of its own.
    std::stop_token stop_token() const { return signals_.token(); }

    /// [MiB] that the process may take: what --max-memory says, or else `otherwise`, at least kLeastMemory.
    /// It is held to that from now on.
    int max_memory(int otherwise);

    Figures& counts() { return counts_; }
    Figures& repairs() { return repairs_; }

    /// Says on stderr, unless --quiet, and in the report what looks wrong but may be meant.
    void warn(const std::string& text);

    /// Writes the report, if one was asked for, and two lines for people: what came out, and how long it
    /// took.
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

    Figures report(double seconds) const;
    Context context(const std::string& stage);
    void show_progress(const std::string& stage, float fraction);
    void clear_progress();

    std::string command_;
    CommonFlags flags_;
    Signals& signals_;
    bool terminal_;
    std::string subject_;
    int shown_percent_ = -1;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::vector<std::pair<std::string, double>> stages_;
    Figures counts_;
    Figures repairs_;
    Figure::List warnings_;
};

}  // namespace coppice::cli
