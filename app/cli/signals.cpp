#include "signals.h"

#include <csignal>

namespace coppice::cli {
namespace {

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    return set;
}

}  // namespace

Signals::Signals() {
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
    const std::scoped_lock lock(mutex_);
    if (source_.stop_requested()) source_ = std::stop_source();
}

void Signals::listen() {
    const sigset_t set = stop_signals();
    int signal = 0;
    for (;;) {
        while (sigwait(&set, &signal) != 0) {
        }
        if (done_) return;
        const std::scoped_lock lock(mutex_);
        if (!source_.request_stop()) break;
    }
    std::signal(signal, SIG_DFL);  // it may have been ignored when the program was started
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    std::raise(signal);
}

}  // namespace coppice::cli
