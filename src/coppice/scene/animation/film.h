#pragma once

#include <sys/types.h>

#include <filesystem>

#include "coppice/render/image.h"

namespace coppice {

/// Whether the name is that of a film: .mp4, .mov, .mkv or .webm.
bool is_film_name(const std::filesystem::path& path);

/// Throws Unsupported where there is no ffmpeg to make films with.
void check_film_program();

/// A film that ffmpeg makes of pictures, which are handed to it one by one. The file appears whole or not at
/// all.
class Film {
  public:
    /// `rate`: pictures a second. Starts with the first picture.
    Film(std::filesystem::path path, double rate);
    ~Film();  ///< without finish() ffmpeg is ended, and nothing is left
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    /// Throws IoError where ffmpeg does not take it.
    void add(const Image& picture);
    /// Waits for ffmpeg. Throws IoError where it fails.
    void finish();

  private:
    void start(const Image& first);

    std::filesystem::path path_, unfinished_;
    double rate_;
    pid_t process_ = -1;
    int input_ = -1;  ///< a socket, so that a program that ended is an error and no signal
};

}  // namespace coppice
