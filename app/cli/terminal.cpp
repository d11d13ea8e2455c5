#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "memory.h"
#include "messages.h"
#include "streams.h"

namespace coppice::cli {
namespace {

constexpr int kBarWidth = 30;

}  // namespace

Terminal::Terminal(Signals& signals) : signals_(signals), is_terminal_(isatty(STDERR_FILENO) != 0) {}

void Terminal::print(std::string_view text) { cli::print(text); }

void Terminal::say(std::string_view message) { cli::say(message); }

void Terminal::show_progress(const std::string& subject, const std::string& stage, float fraction) {
    const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0f, 1.0f));
    if (percent == shown_percent_) return;
    shown_percent_ = percent;
    const std::string bar(static_cast<std::size_t>(percent * kBarWidth / 100), '#');
    const std::string begin = subject.empty() ? "" : one_line(subject) + ": ";
    print_error(fmt::format("\r\033[K{}{:<10} [{:<{}}] {:>3} %", begin, stage, bar, kBarWidth, percent));
}

void Terminal::clear_progress() {
    if (shown_percent_ < 0) return;
    print_error("\r\033[K");
    shown_percent_ = -1;
}

void Terminal::finish(const std::string& summary, const std::string& seconds) {
    print_error(fmt::format("{}\n{}\n", one_line(summary), seconds));
}

void Terminal::limit_memory(int mebibytes, unsigned threads) { cli::limit_memory(mebibytes, threads); }

}  // namespace coppice::cli
