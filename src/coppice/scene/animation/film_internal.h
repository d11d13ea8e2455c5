#pragma once

#include <filesystem>
#include <optional>

#include "coppice/render/image.h"
#include "coppice/system/program.h"

namespace coppice {

/// Returns whether the file name has a video extension: .mp4, .mov, .mkv or .webm.
bool is_film_name(const std::filesystem::path& path);

/// Throws Unsupported if ffmpeg, which encodes videos, is not found.
void check_film_program();

/// A video that ffmpeg encodes from images that are passed one at a time. The file appears complete or not at
/// all.
class Film {
  public:
    /// `rate` is the number of images per second. ffmpeg starts with the first image.
    Film(std::filesystem::path path, double rate);
    ~Film();  ///< without finish(), terminates ffmpeg and removes the file
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    /// Throws IoError if ffmpeg does not accept the image.
    void add(const Image& picture);
    /// Waits for ffmpeg. Throws IoError if it fails.
    void finish();

  private:
    Program start(const Image& first) const;

    std::filesystem::path path_, unfinished_;
    double rate_;
    std::optional<Program> encoder_;
};

}  // namespace coppice
