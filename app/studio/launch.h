#pragma once

#include <filesystem>
#include <string>

namespace coppice::server {

/// A page of one line that leads the browser to the studio. The address holds the token, which no list of
/// processes and no other user may see: so the browser is given this file, which only its owner may read.
/// It is removed with this object.
class Doorway {
  public:
    explicit Doorway(const std::string& address);  ///< throws IoError
    ~Doorway();
    Doorway(const Doorway&) = delete;
    Doorway& operator=(const Doorway&) = delete;

    const std::filesystem::path& file() const { return file_; }

    /// Opens it in the user's browser ($BROWSER, xdg-open). Returns whether something was started.
    bool open() const;

  private:
    std::filesystem::path file_;
};

}  // namespace coppice::server
