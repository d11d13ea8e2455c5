#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
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
constexpr int kLook = 50;  // [ms] interval of checks whether a program has ended

/// A file descriptor that is closed on destruction.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    ~Descriptor() { close(); }
    void close() {
        if (number_ >= 0) ::close(std::exchange(number_, -1));
    }
    int get() const { return number_; }

  private:
    int number_;
};

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

/// Ignores SIGPIPE during its lifetime, so that programs do not end when their output is no longer read.
class WithoutPipeSignal {
  public:
    WithoutPipeSignal() {
        struct sigaction ignore {};
        ignore.sa_handler = SIG_IGN;
        ::sigaction(SIGPIPE, &ignore, &before_);
    }
    ~WithoutPipeSignal() { ::sigaction(SIGPIPE, &before_, nullptr); }
    WithoutPipeSignal(const WithoutPipeSignal&) = delete;
    WithoutPipeSignal& operator=(const WithoutPipeSignal&) = delete;

  private:
    struct sigaction before_ {};
};

/// Waits for input and reads it; returns false at the end of the input.
bool read_some(int from, std::string& text, int wait) {
    pollfd ready{.fd = from, .events = POLLIN, .revents = 0};
    if (::poll(&ready, 1, wait) <= 0) return true;
    std::array<char, 4096> piece{};
    const ssize_t n = ::read(from, piece.data(), piece.size());
    if (n <= 0) return n < 0 && (errno == EINTR || errno == EAGAIN);
    const std::size_t room = kMaxText - std::min(kMaxText, text.size());
    text.append(piece.data(), std::min(room, static_cast<std::size_t>(n)));
    return true;
}

int status_of(int waited) { return WIFEXITED(waited) ? WEXITSTATUS(waited) : 128 + WTERMSIG(waited); }

}  // namespace

struct Programs::Reader {
    Reader(pid_t program, Descriptor output)
        : thread([this, program, from = std::move(output)](const std::stop_token& end) mutable {
              take(end, program, from);
              ended = true;
          }) {}

    static void take(const std::stop_token& end, pid_t program, Descriptor& from) {
        bool open = true;
        while (!end.stop_requested() && !ended_program(program)) {
            std::string unread;
            if (open && !read_some(from.get(), unread, kLook)) {
                open = false;
                from.close();
            }
            if (!open) std::this_thread::sleep_for(std::chrono::milliseconds(kLook));
        }
    }

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
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw IoError("cannot create a pipe to a program");
    Descriptor output(ends[0]), input(ends[1]);
    const pid_t program = [&] {
        const WithoutPipeSignal ignored;
        return start_program({.words = std::move(words),
                              .output = input.get(),
                              .folder = folder,
                              .environment = plain_environment(),
                              .apart = true});
    }();
    input.close();
    ProgramResult out;
    const auto until = Clock::now() + patience;
    bool open = true;
    while (!out.status && Clock::now() < until) {
        if (ctx.stop.stop_requested()) {
            ::kill(-program, SIGKILL);
            wait_for_program(program);
            throw Cancelled();
        }
        if (open) open = read_some(output.get(), out.text, kLook);
        if (!open) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (const auto ended = ended_program(program)) out.status = status_of(*ended);
    }
    while (out.status && open && out.text.size() < kMaxText) {
        const std::size_t before = out.text.size();
        open = read_some(output.get(), out.text, 0);
        if (out.text.size() == before) break;  // its own child processes may keep the pipe open
    }
    if (!out.status) readers_.emplace_back(program, std::move(output));
    return out;
}

}  // namespace coppice::studio_internal
