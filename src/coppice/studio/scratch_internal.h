#pragma once

#include <filesystem>
#include <string_view>

namespace coppice::studio_internal {

/// Files for programs to read, in a folder of their own that nobody else sees, which goes in the end.
class Scratch {
  public:
    Scratch() = default;
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    /// A new name with that ending. Throws IoError where there can be no folder.
    std::filesystem::path next(std::string_view ending);

  private:
    std::filesystem::path folder_;  ///< made when it is needed first
    int count_ = 0;
};

}  // namespace coppice::studio_internal
