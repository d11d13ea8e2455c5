#pragma once

#include <filesystem>
#include <string_view>

namespace coppice::studio_internal {

/// Temporary files for programs, in a private folder that is removed on destruction.
class Scratch {
  public:
    Scratch() = default;
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    /// Returns a new name with that extension. Throws IoError if the folder cannot be created.
    std::filesystem::path next(std::string_view ending);

  private:
    std::filesystem::path folder_;  ///< created on first use
    int count_ = 0;
};

}  // namespace coppice::studio_internal
