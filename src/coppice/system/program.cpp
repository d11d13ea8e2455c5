#include "coppice/system/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "coppice/base/error.h"

extern char** environ;

namespace coppice {
namespace {

/// Returns the words as argv; they must outlive the result.
std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> out;
    for (std::string& word : words) out.push_back(word.data());
    out.push_back(nullptr);
    return out;
}

class FileActions {
  public:
    /// `input` and `output` are descriptors of the streams if these are sent and received.
    FileActions(const ProgramStart& start, int input, int output) {
        posix_spawn_file_actions_init(&actions_);
        if (start.sends_input) {
            posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
        } else {
            posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        }
        if (start.output == ProgramOutput::received) {
            posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
        } else if (start.output == ProgramOutput::discarded) {
            posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        }
        if (start.output != ProgramOutput::inherited)
            posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
        // The child must not inherit sockets and files of this process.
        posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
        if (!start.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions_, start.folder.c_str());
    }
    ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
    const posix_spawn_file_actions_t* get() const { return &actions_; }

  private:
    posix_spawn_file_actions_t actions_;
};

class Attributes {
  public:
    explicit Attributes(const ProgramStart& start) {
        posix_spawnattr_init(&attributes_);
        // This process blocks signals; the child would inherit the mask.
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes_, &none);
        const int apart = start.apart ? POSIX_SPAWN_SETSID : 0;
        posix_spawnattr_setflags(&attributes_, static_cast<short>(POSIX_SPAWN_SETSIGMASK | apart));
    }
    ~Attributes() { posix_spawnattr_destroy(&attributes_); }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    const posix_spawnattr_t* get() const { return &attributes_; }

  private:
    posix_spawnattr_t attributes_;
};

/// Ignores SIGPIPE during its lifetime; programs that are started in it do the same.
class IgnoredPipeSignal {
  public:
    IgnoredPipeSignal() {
        struct sigaction ignore {};
        ignore.sa_handler = SIG_IGN;
        ::sigaction(SIGPIPE, &ignore, &before_);
    }
    ~IgnoredPipeSignal() { ::sigaction(SIGPIPE, &before_, nullptr); }
    IgnoredPipeSignal(const IgnoredPipeSignal&) = delete;
    IgnoredPipeSignal& operator=(const IgnoredPipeSignal&) = delete;

  private:
    struct sigaction before_ {};
};

/// Starts a program with these descriptors as its streams; returns the id of the process.
int spawn(const ProgramStart& start, int input, int output) {
    std::vector<std::string> words = start.words, environment = start.environment;
    const FileActions actions(start, input, output);
    const Attributes attributes(start);
    std::optional<IgnoredPipeSignal> ignored;
    if (start.output == ProgramOutput::received) ignored.emplace();
    pid_t process = -1;
    const int error =
        ::posix_spawn(&process, words.front().c_str(), actions.get(), attributes.get(),
                      pointers(words).data(), environment.empty() ? environ : pointers(environment).data());
    if (error != 0) {
        throw IoError(
            fmt::format("{} cannot be started: {}", words.front(), std::generic_category().message(error)));
    }
    return process;
}

int exit_code(int waited) { return WIFEXITED(waited) ? WEXITSTATUS(waited) : 128 + WTERMSIG(waited); }

bool is_program(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

std::optional<std::filesystem::path> find_program(std::string_view name) {
    const std::filesystem::path path(name);
    if (path.is_absolute()) return is_program(path) ? std::optional(path) : std::nullopt;
    if (name.empty() || name.find('/') != name.npos) return std::nullopt;
    const char* folders = std::getenv("PATH");
    std::istringstream list(folders != nullptr ? folders : "");
    for (std::string folder; std::getline(list, folder, ':');) {
        if (folder.starts_with('/') && is_program(folder / path)) return folder / path;
    }
    return std::nullopt;
}

Program::Program(const ProgramStart& start) : apart_(start.apart) {
    Descriptor read_end, write_end;  // the ends of the program
    std::array<int, 2> ends{};
    const auto fail = [&] {
        throw IoError(fmt::format("{} cannot be started: {}", start.words.front(),
                                  std::generic_category().message(errno)));
    };
    if (start.sends_input) {
        // A socket, because writing to one can fail without a signal.
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail();
        input_ = Descriptor(ends[0]);
        read_end = Descriptor(ends[1]);
    }
    if (start.output == ProgramOutput::received) {
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail();
        output_ = Descriptor(ends[0]);
        write_end = Descriptor(ends[1]);
    }
    process_ = spawn(start, read_end.get(), write_end.get());
}

bool Program::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(input_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
}

bool Program::receive(std::string& text, std::size_t max_size, std::chrono::milliseconds wait) {
    if (!output_) return false;
    pollfd ready{.fd = output_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&ready, 1, static_cast<int>(wait.count())) <= 0) return true;
    std::array<char, 4096> piece{};
    const ssize_t size = ::read(output_.get(), piece.data(), piece.size());
    if (size < 0 && (errno == EINTR || errno == EAGAIN)) return true;
    if (size <= 0) {
        output_.close();
        return false;
    }
    const std::size_t room = max_size - std::min(max_size, text.size());
    text.append(piece.data(), std::min(room, static_cast<std::size_t>(size)));
    return true;
}

std::optional<int> Program::status() {
    int waited = 0;
    if (!status_ && ::waitpid(process_, &waited, WNOHANG) == process_) status_ = exit_code(waited);
    return status_;
}

int Program::wait() {
    int waited = 0;
    while (!status_) {
        if (::waitpid(process_, &waited, 0) == process_ || errno != EINTR) status_ = exit_code(waited);
    }
    return *status_;
}

void Program::kill() {
    if (!status_) ::kill(apart_ ? -process_ : process_, SIGKILL);
}

}  // namespace coppice
