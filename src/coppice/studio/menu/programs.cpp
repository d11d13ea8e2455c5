#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <stop_token>
#include <string_view>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/studio/menu/programs_internal.h"
#include "coppice/system/program.h"

extern char** environ;

namespace coppice::studio_internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxText = std::size_t{64} << 10;
constexpr std::size_t kMaxGoingOn = 8;
constexpr std::chrono::milliseconds kCheckInterval{50};  // of checks whether a program has ended

/// Environment variables that programs need to find their files, display and language; secrets are not passed
/// on.
std::vector<std::string> plain_environment() {
    constexpr std::array<std::string_view, 18> kNames{"PATH",
                                                      "HOME",
                                                      "USER",
                                                      "LOGNAME",
                                                      "SHELL",
                                                      "LANG",
                                                      "LANGUAGE",
                                                      "TZ",
                                                      "TERM",
                                                      "TMPDIR",
                                                      "DISPLAY",
                                                      "WAYLAND_DISPLAY",
                                                      "XAUTHORITY",
                                                      "XDG_RUNTIME_DIR",
                                                      "XDG_DATA_DIRS",
                                                      "XDG_CONFIG_HOME",
                                                      "XDG_SESSION_TYPE",
                                                      "DBUS_SESSION_BUS_ADDRESS"};
    std::vector<std::string> out;
    for (char** at = environ; *at != nullptr; ++at) {
        const std::string_view entry(*at), name = entry.substr(0, entry.find('='));
        if (name.starts_with("LC_") || std::ranges::find(kNames, name) != kNames.end())
            out.emplace_back(entry);
    }
    return out;
}

}  // namespace

struct Programs::Reader {
    explicit Reader(Program program)
        : thread([this, program = std::move(program)](const std::stop_token& end) mutable {
              while (!end.stop_requested() && !program.status()) {
                  std::string dropped;
                  if (!program.receive(dropped, 0, kCheckInterval))
                      std::this_thread::sleep_for(kCheckInterval);
              }
              ended = true;
          }) {}

    std::atomic<bool> ended = false;
    std::jthread thread;
};

Programs::Programs() = default;
Programs::~Programs() = default;

std::size_t Programs::going_on() {
    readers_.remove_if([](const Reader& reader) { return reader.ended.load(); });
    return readers_.size();
}

ProgramResult Programs::run(std::vector<std::string> words, const std::filesystem::path& folder,
                            std::chrono::milliseconds patience, const Context& ctx) {
    const auto path = find_program(words.front());
    if (!path) {
        throw InvalidInput(fmt::format(
            "there is no program '{}'; install it, or specify its absolute path in the menu", words.front()));
    }
    if (going_on() >= kMaxGoingOn)
        throw InvalidInput(fmt::format("{} programs are still running; close one of them", kMaxGoingOn));
    words.front() = path->string();
    Program program({.words = std::move(words),
                     .output = ProgramOutput::received,
                     .folder = folder,
                     .environment = plain_environment(),
                     .apart = true});
    ProgramResult out;
    const auto until = Clock::now() + patience;
    bool open = true;
    while (!out.status && Clock::now() < until) {
        if (ctx.stop.stop_requested()) {
            program.kill();
            program.wait();
            throw Cancelled();
        }
        open = program.receive(out.text, kMaxText, kCheckInterval);
        if (!open) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        out.status = program.status();
    }
    while (out.status && open && out.text.size() < kMaxText) {
        const std::size_t before = out.text.size();
        open = program.receive(out.text, kMaxText, std::chrono::milliseconds(0));
        if (out.text.size() == before) break;  // its own child processes may keep the pipe open
    }
    if (!out.status) readers_.emplace_back(std::move(program));
    return out;
}

}  // namespace coppice::studio_internal
