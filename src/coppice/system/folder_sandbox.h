#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/system/descriptor.h"

namespace coppice {

/// Folder sandbox: restricts files named by untrusted input (scenes in the studio, HTTP requests) to a
/// folder.
///
/// Names are UTF-8 and relative to the folder. It refuses absolute names, components that begin with a dot
/// (so ".." and hidden files; "." alone is skipped), empty components, control characters, symbolic links in
/// any component, and everything that is neither a regular file nor a folder. The system enforces this where
/// it can (openat2, Linux 5.6); otherwise each component is checked. Thread-safe.
class FolderSandbox {
  public:
    /// Throws IoError if the folder cannot be opened. `allowed` lists files outside the folder that may be
    /// read, by their absolute names or by relative names that lead to them.
    explicit FolderSandbox(const std::filesystem::path& folder,
                           const std::vector<std::filesystem::path>& allowed = {});

    const std::filesystem::path& folder() const { return folder_; }  ///< absolute, without symbolic links

    /// Returns the absolute path of an existing file or folder. Throws IoError with the name and the reason
    /// if it is refused.
    std::filesystem::path to_read(std::string_view name) const;
    /// Returns the absolute path of a file that may be written: its folder exists, and an existing entry of
    /// that name is a regular file. Throws like `to_read`; files of `allowed` may not be written.
    std::filesystem::path to_write(std::string_view name) const;
    /// Opens an existing file for reading. Throws like `to_read`; ignores `allowed`.
    Descriptor open(std::string_view name) const;

  private:
    bool is_allowed(const std::filesystem::path& name) const;

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> allowed_;
    Descriptor descriptor_;
};

}  // namespace coppice
