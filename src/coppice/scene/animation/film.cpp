#include "coppice/scene/animation/film_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/system/process.h"

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
    unfinished_ = path_.parent_path() / fmt::format(".{}.{}{}", path_.stem().string(), get_process_id(),
                                                    path_.extension().string());
}

Film::~Film() {
    if (encoder_) {
        encoder_->kill();
        encoder_->wait();
    }
    std::error_code ignored;
    std::filesystem::remove(unfinished_, ignored);
}

Program Film::start(const Image& first) const {
    // Video codecs require even widths and heights.
    return Program({.words = {film_program().string(), "-loglevel", "error", "-y", "-f", "rawvideo",
                              "-pix_fmt", "rgba", "-s", fmt::format("{}x{}", first.width, first.height), "-r",
                              fmt::format("{}", rate_), "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                              "-pix_fmt", "yuv420p", std::filesystem::absolute(unfinished_).string()},
                    .sends_input = true});
}

void Film::add(const Image& picture) {
    if (!encoder_) encoder_ = start(picture);
    const auto bytes = std::as_bytes(std::span(picture.pixels));
    if (!encoder_->send({reinterpret_cast<const char*>(bytes.data()), bytes.size()}))
        throw IoError(fmt::format("cannot write {}: ffmpeg ended too early", path_.string()));
}

void Film::finish() {
    encoder_->close_input();
    const int status = encoder_->wait();
    encoder_.reset();
    if (status != 0) throw IoError(fmt::format("cannot write {}: ffmpeg failed", path_.string()));
    std::error_code error;
    std::filesystem::rename(unfinished_, path_, error);
    if (error) throw IoError(fmt::format("cannot write {}: {}", path_.string(), error.message()));
}

}  // namespace coppice
