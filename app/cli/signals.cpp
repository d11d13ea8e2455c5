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

void Signals::listen() {
    const sigset_t set = stop_signals();
    int signal = 0;
    while (sigwait(&set, &signal) != 0) {
    }
    if (done_) return;
    source_.request_stop();
    while (sigwait(&set, &signal) != 0) {
    }
    if (done_) return;
    std::signal(signal, SIG_DFL);  // it may have been ignored when the program was started
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
    std::raise(signal);
}

}  // namespace coppice::cli
