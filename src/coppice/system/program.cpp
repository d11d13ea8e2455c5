#include "coppice/system/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <sstream>

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
    explicit FileActions(const ProgramStart& start) {
        posix_spawn_file_actions_init(&actions_);
        if (start.input >= 0) {
            posix_spawn_file_actions_adddup2(&actions_, start.input, STDIN_FILENO);
        } else {
            posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        }
        if (start.output >= 0) {
            posix_spawn_file_actions_adddup2(&actions_, start.output, STDOUT_FILENO);
            posix_spawn_file_actions_adddup2(&actions_, start.output, STDERR_FILENO);
        }
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

pid_t start_program(const ProgramStart& start) {
    std::vector<std::string> words = start.words, environment = start.environment;
    const FileActions actions(start);
    const Attributes attributes(start);
    pid_t program = -1;
    const int error =
        ::posix_spawn(&program, words.front().c_str(), actions.get(), attributes.get(),
                      pointers(words).data(), environment.empty() ? environ : pointers(environment).data());
    if (error != 0) {
        throw IoError(
            fmt::format("{} cannot be started: {}", words.front(), std::generic_category().message(error)));
    }
    return program;
}

int wait_for_program(pid_t program) {
    int status = 0;
    while (::waitpid(program, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

std::optional<int> ended_program(pid_t program) {
    int status = 0;
    if (::waitpid(program, &status, WNOHANG) != program) return std::nullopt;
    return status;
}

}  // namespace coppice
