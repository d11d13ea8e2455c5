#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// A folder that files named from outside do not lead out of: by scenes in the studio, by its requests.
///
/// Names are relative to the folder, in UTF-8. Refused are absolute ones, parts that begin with a dot (so
/// ".." and hidden files; "." alone is passed over), empty parts, control characters, symbolic links on the
/// way or at its end, wherever they lead, and what is neither a file nor a folder. The system itself keeps
/// watch where it can (openat2, Linux 5.6); elsewhere every step is looked at. May be used by several
/// threads.
class Jail {
  public:
    /// Throws IoError where the folder cannot be opened. `allowed` are files elsewhere that may be read,
    /// under their absolute names or relative ones that lead to them.
    explicit Jail(const std::filesystem::path& folder,
                  const std::vector<std::filesystem::path>& allowed = {});
    ~Jail();
    Jail(const Jail&) = delete;
    Jail& operator=(const Jail&) = delete;

    const std::filesystem::path& folder() const { return folder_; }  ///< absolute, without links

    /// The absolute path of a file or folder that is there. Throws IoError naming it and why it is refused.
    std::filesystem::path to_read(std::string_view name) const;
    /// Where a file may be written, absolute: its folder is there, and what has its name already is a file.
    /// Throws as `to_read`; what `allowed` names may not be written.
    std::filesystem::path to_write(std::string_view name) const;
    /// A descriptor of a file that is there, to read from and to be closed by the caller. Throws as
    /// `to_read`; knows nothing of `allowed`.
    int open(std::string_view name) const;

  private:
    bool is_allowed(const std::filesystem::path& name) const;

    std::filesystem::path folder_;
    std::vector<std::filesystem::path> allowed_;
    int descriptor_ = -1;
};

}  // namespace coppice
