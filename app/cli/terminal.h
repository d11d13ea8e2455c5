#pragma once

#include "host.h"
#include "signals.h"

namespace coppice::cli {

/// The terminal of the program: Ctrl-C stops, data is printed on stdout, messages and progress on stderr.
class Terminal : public Host {
  public:
    /// Progress is shown if stderr is a terminal. Stores a reference to the signals.
    explicit Terminal(Signals& signals);

    std::stop_token stop_token() const override { return signals_.token(); }
    void forget_stop() override { signals_.forget(); }
    void print(std::string_view text) override;
    void say(std::string_view message) override;
    bool shows_progress() const override { return is_terminal_; }
    void show_progress(const std::string& subject, const std::string& stage, float fraction) override;
    void clear_progress() override;
    void finish(const std::string& summary, const std::string& seconds) override;
    void limit_memory(int mebibytes, unsigned threads) override;
    HeldObjects* held_objects() override { return nullptr; }

  private:
    Signals& signals_;
    bool is_terminal_;
    int shown_percent_ = -1;
};

}  // namespace coppice::cli
