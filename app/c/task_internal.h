#pragma once

#include <atomic>
#include <mutex>
#include <stop_token>
#include <string>

#include "catch_errors.h"
#include "coppice_c.h"
#include "held_objects.h"
#include "host.h"

/// An object as C sees it.
struct coppice_object {
    coppice::cli::HeldObject held;
};

/// A task as C sees it: the host of the commands that it runs.
struct coppice_task : public coppice::cli::Host {
  public:
    std::stop_token stop_token() const override;
    void forget_stop() override {}
    void print(std::string_view text) override { output += text; }
    void say(std::string_view text) override;
    bool shows_progress() const override { return progress != nullptr; }
    void show_progress(const std::string& subject, const std::string& stage, float fraction) override;
    void clear_progress() override {}
    void finish(const std::string&, const std::string&) override {}
    void limit_memory(int, unsigned) override {}  // the process belongs to the caller
    coppice::cli::HeldObjects* held_objects() override { return &held; }

    /// Requests a stop of the current or next run.
    void cancel();
    /// Clears the results of the previous call and returns the exit code of work(); for an exception, stores
    /// its sentence.
    template <class Work>
    coppice_status call(const Work& work);

    coppice_progress progress = nullptr;
    void* progress_user = nullptr;
    std::string message, output, report;
    coppice::cli::HeldObjects held;

  private:
    mutable std::mutex mutex_;  ///< guards source_
    std::stop_source source_;
    std::atomic<bool> is_busy_ = false;
};

template <class Work>
coppice_status coppice_task::call(const Work& work) {
    if (is_busy_.exchange(true)) return COPPICE_WRONG_USAGE;
    message.clear();
    output.clear();
    report.clear();
    const coppice::cli::ExitCode code =
        coppice::cli::catch_errors(work, [&](const char* sentence) { message = sentence; });
    {
        const std::scoped_lock lock(mutex_);
        if (source_.stop_requested()) source_ = std::stop_source();
    }
    is_busy_ = false;
    return static_cast<coppice_status>(code);
}
