#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "coppice/system/descriptor.h"

namespace coppice {

/// A file that this process has locked, until the object is destroyed or the process ends.
class FileLock {
  public:
    /// Creates the file if it does not exist, readable by its owner only. Throws IoError if it cannot be
    /// opened. Returns nullopt if another process or another object has locked it.
    static std::optional<FileLock> try_lock(const std::filesystem::path& path);

  private:
    explicit FileLock(Descriptor file) : file_(std::move(file)) {}

    Descriptor file_;
};

}  // namespace coppice
