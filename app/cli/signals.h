#pragma once

#include <atomic>
#include <mutex>
#include <stop_token>
#include <thread>

namespace coppice::cli {

/// Turns the first Ctrl-C (SIGINT) or SIGTERM into a request to stop, so that work ends in order; the second
/// one ends the program at once. To be made before any other thread, because it blocks both signals in this
/// one and its children.
class Signals {
  public:
    Signals();
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    std::stop_token token() const;

    /// Takes a request to stop back: the next Ctrl-C is a first one again.
    void forget();

  private:
    void listen();

    mutable std::mutex mutex_;  ///< of source_
    std::stop_source source_;
    std::atomic<bool> done_ = false;
    std::thread listener_;
};

}  // namespace coppice::cli
