#include "signals.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <string_view>

#include "command.h"

namespace coppice::cli {
namespace {

bool is_ignored(int signal) {
    struct sigaction action {};
    return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGXCPU);
    if (!is_ignored(SIGHUP)) sigaddset(&set, SIGHUP);  // nohup ignores it
    return set;
}

constexpr timespec kSignalWait{0, 900'000'000};

int next_signal(const sigset_t& set) {
    int signal = 0;
    while (sigwait(&set, &signal) != 0) {
    }
    return signal;
}

/// Returns -1 at a time-out.
int next_signal(const sigset_t& set, timespec patience) {
    for (;;) {
        const int signal = sigtimedwait(&set, nullptr, &patience);
        if (signal >= 0 || errno != EINTR) return signal;
    }
}

/// The same as main does for Cancelled, without waiting.
[[noreturn]] void end_now() {
    constexpr std::string_view kText = "coppice: interrupted\n";
    constexpr std::string_view kClear = "\r\033[K";  // clears the progress bar
    if (isatty(STDERR_FILENO) != 0) static_cast<void>(!write(STDERR_FILENO, kClear.data(), kClear.size()));
    static_cast<void>(!write(STDERR_FILENO, kText.data(), kText.size()));
    _exit(kInterrupted);
}

}  // namespace

Signals::Signals() {
    std::signal(SIGXFSZ, SIG_IGN);  // so that a file that becomes too large is a write error
    const sigset_t set = stop_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    listener_ = std::thread([this] { listen(); });
}

Signals::~Signals() {
    done_ = true;
    pthread_kill(listener_.native_handle(), SIGTERM);
    listener_.join();
}

std::stop_token Signals::token() const {
    const std::scoped_lock lock(mutex_);
    return source_.get_token();
}

void Signals::forget() {
    goes_on_ = true;
    const std::scoped_lock lock(mutex_);
    if (source_.stop_requested()) source_ = std::stop_source();
}

void Signals::listen() {
    const sigset_t set = stop_signals();
    int signal = next_signal(set);
    while (!done_ && asks_first(signal)) {
        // The work polls the token and ends; a shell continues after it.
        const int next = goes_on_ ? next_signal(set) : next_signal(set, kSignalWait);
        if (next < 0) end_now();
        signal = next;
    }
    if (done_) return;
    std::signal(signal, SIG_DFL);  // it may have been ignored when the program was started
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    std::raise(signal);
}

/// Returns true for the first request to stop, and if there is no request.
bool Signals::asks_first(int signal) {
    const std::scoped_lock lock(mutex_);
    return source_.request_stop() || signal == SIGXCPU;  // which arrives every second
}

}  // namespace coppice::cli
