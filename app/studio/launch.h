#pragma once

#include <filesystem>
#include <string>

namespace coppice::server {

/// A page of one line that redirects the browser to the studio. The address contains the token, which must
/// not appear in the process list or be readable by other users; therefore the browser opens this file, which
/// only its owner may read. The file is removed with this object.
class Doorway {
  public:
    explicit Doorway(const std::string& address);  ///< throws IoError
    ~Doorway();
    Doorway(const Doorway&) = delete;
    Doorway& operator=(const Doorway&) = delete;

    const std::filesystem::path& file() const { return file_; }

    /// Opens it in the user's browser ($BROWSER, xdg-open). Returns whether a program was started.
    bool open() const;

  private:
    std::filesystem::path file_;
};

}  // namespace coppice::server
