#pragma once

#include <atomic>
#include <mutex>
#include <stop_token>
#include <thread>

namespace coppice::cli {

/// Converts the first Ctrl-C (SIGINT), SIGTERM, SIGHUP (the terminal was closed) or SIGXCPU (`ulimit -t`)
/// into a request to stop, so that work ends in order and leaves no incomplete files. The second one ends the
/// program at once, as does the first if the work has not ended 0.9 seconds later; incomplete files are
/// removed (see AtomicFile). SIGXFSZ (`ulimit -f`) is ignored, so that the write fails instead.
///
/// Must be created before any other thread, because it blocks these signals in this thread and its children.
class Signals {
  public:
    Signals();
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    std::stop_token token() const;

    /// Clears a request to stop: the next Ctrl-C counts as a first one again. For shells, which continue
    /// after it: from now on work has no time limit for its end.
    void forget();

  private:
    void listen();
    bool asks_first(int signal);

    mutable std::mutex mutex_;  ///< guards source_
    std::stop_source source_;
    std::atomic<bool> done_ = false;
    std::atomic<bool> goes_on_ = false;  ///< after a request to stop
    std::thread listener_;
};

}  // namespace coppice::cli
