#pragma once

#include <atomic>
#include <mutex>
#include <stop_token>
#include <thread>

namespace coppice::cli {

/// Turns the first Ctrl-C (SIGINT), SIGTERM, SIGHUP (the terminal is gone) or SIGXCPU (`ulimit -t`) into a
/// request to stop, so that work ends in order and leaves nothing half-written. The second one ends the
/// program at once, and so does the first where the work has not ended 0.9 seconds later: what is unfinished
/// goes with it (see AtomicFile). SIGXFSZ (`ulimit -f`) is ignored, so that the write fails instead.
///
/// To be made before any other thread, because it blocks these signals in this one and its children.
class Signals {
  public:
    Signals();
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    std::stop_token token() const;

    /// Takes a request to stop back: the next Ctrl-C is a first one again. For shells, which go on after it:
    /// from now on work may take its time to end.
    void forget();

  private:
    void listen();
    bool asks_first(int signal);

    mutable std::mutex mutex_;  ///< of source_
    std::stop_source source_;
    std::atomic<bool> done_ = false;
    std::atomic<bool> goes_on_ = false;  ///< after a request to stop
    std::thread listener_;
};

}  // namespace coppice::cli
