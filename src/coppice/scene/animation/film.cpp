#include "coppice/scene/animation/film_internal.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/system/program.h"

namespace coppice {
namespace {

std::filesystem::path film_program() {
    if (auto found = find_program("ffmpeg")) return *std::move(found);
    throw Unsupported(
        "films are made by ffmpeg, which is not found; install it (Debian: apt install ffmpeg), or write "
        ".gif, or .png "
        "for a file each frame");
}

}  // namespace

bool is_film_name(const std::filesystem::path& path) {
    constexpr std::array<const char*, 4> kEndings{".mp4", ".mov", ".mkv", ".webm"};
    return std::ranges::find(kEndings, path.extension().string()) != kEndings.end();
}

void check_film_program() { film_program(); }

Film::Film(std::filesystem::path path, double rate) : path_(std::move(path)), rate_(rate) {
    unfinished_ = path_.parent_path() /
                  fmt::format(".{}.{}{}", path_.stem().string(), ::getpid(), path_.extension().string());
}

Film::~Film() {
    if (input_ >= 0) ::close(input_);
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        wait_for_program(process_);
    }
    std::error_code ignored;
    std::filesystem::remove(unfinished_, ignored);
}

void Film::start(const Image& first) {
    ProgramStart program;
    // Video codecs require even widths and heights.
    program.words = {film_program().string(),
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
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw IoError(
            fmt::format("cannot write {}: a socket to ffmpeg could not be created", path_.string()));
    input_ = ends[0];
    program.input = ends[1];
    try {
        process_ = start_program(program);
    } catch (...) {
        ::close(ends[1]);
        throw;
    }
    ::close(ends[1]);
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

void Film::finish() {
    ::close(input_);
    input_ = -1;
    const int status = wait_for_program(std::exchange(process_, -1));
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw IoError(fmt::format("cannot write {}: ffmpeg failed", path_.string()));
    std::error_code error;
    std::filesystem::rename(unfinished_, path_, error);
    if (error) throw IoError(fmt::format("cannot write {}: {}", path_.string(), error.message()));
}

}  // namespace coppice
