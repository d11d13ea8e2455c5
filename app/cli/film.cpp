#include "film.h"

#include <fmt/format.h>
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
#include <string>
#include <vector>

#include "coppice/base/error.h"

extern char** environ;

namespace coppice::cli {
namespace {

const std::string kProgram = "ffmpeg";

}  // namespace

bool is_film_name(const std::filesystem::path& path) {
    constexpr std::array<const char*, 4> kEndings{".mp4", ".mov", ".mkv", ".webm"};
    return std::ranges::find(kEndings, path.extension().string()) != kEndings.end();
}

void check_film_program() {
    const char* folders = std::getenv("PATH");
    std::istringstream list(folders != nullptr ? folders : "");
    for (std::string folder; std::getline(list, folder, ':');) {
        if (access((std::filesystem::path(folder) / kProgram).c_str(), X_OK) == 0) return;
    }
    throw Unsupported(
        "films are made by ffmpeg, which is not found; install it (Debian: apt install ffmpeg), or write "
        ".gif, or .png "
        "for a file each frame");
}

Film::Film(std::filesystem::path path, double rate) : path_(std::move(path)), rate_(rate) {
    unfinished_ = path_.parent_path() /
                  fmt::format(".{}.{}{}", path_.stem().string(), ::getpid(), path_.extension().string());
}

Film::~Film() {
    if (input_ >= 0) ::close(input_);
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        wait();
    }
    std::error_code ignored;
    std::filesystem::remove(unfinished_, ignored);
}

void Film::start(const Image& first) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw IoError(fmt::format("cannot write {}: no socket to ffmpeg can be made", path_.string()));
    input_ = ends[0];
    // Codecs of films take even widths and heights only.
    std::vector<std::string> words{kProgram,
                                   "-loglevel",
                                   "error",
                                   "-y",
                                   "-f",
                                   "rawvideo",
                                   "-pix_fmt",
                                   "rgba",
                                   "-s",
                                   fmt::format("{}x{}", first.width, first.height),
                                   "-r",
                                   fmt::format("{}", rate_),
                                   "-i",
                                   "-",
                                   "-vf",
                                   "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                   "-pix_fmt",
                                   "yuv420p",
                                   std::filesystem::absolute(unfinished_).string()};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    // This program has signals blocked, which its children would be born with.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    const int error =
        ::posix_spawnp(&process_, kProgram.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (error != 0) {
        process_ = -1;
        throw IoError(fmt::format("cannot write {}: ffmpeg cannot be started", path_.string()));
    }
}

void Film::add(const Image& picture) {
    if (process_ < 0) start(picture);
    const char* at = reinterpret_cast<const char*>(picture.pixels.data());
    std::size_t left = picture.pixels.size() * sizeof(Image::Pixel);
    while (left > 0) {
        const ssize_t sent = ::send(input_, at, left, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) throw IoError(fmt::format("cannot write {}: ffmpeg ended too early", path_.string()));
        at += sent;
        left -= static_cast<std::size_t>(sent);
    }
}

int Film::wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
}

void Film::finish() {
    ::close(input_);
    input_ = -1;
    const int status = wait();
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw IoError(fmt::format("cannot write {}: ffmpeg failed", path_.string()));
    std::error_code error;
    std::filesystem::rename(unfinished_, path_, error);
    if (error) throw IoError(fmt::format("cannot write {}: {}", path_.string(), error.message()));
}

}  // namespace coppice::cli
