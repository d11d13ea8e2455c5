#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "coppice/studio/engine.h"

namespace coppice::server {

/// A file of the studio's page.
struct PageFile {
    std::string_view name;  ///< "app.js"
    std::string_view bytes;
};

/// The page that was built into the program; none where it was built without (see app/studio/CMakeLists.txt).
std::span<const PageFile> embedded_page();

/// The files of the page: those in the program, or while the page is being worked on those in a folder.
class Page {
  public:
    /// `folder` empty: those in the program. Throws InvalidInput where there is no page.
    explicit Page(std::filesystem::path folder = {});

    /// What is sent for a path, "/" or "/app.js"; none for anything else. `nonce` goes into the document.
    struct Found {
        std::string bytes;
        std::string_view type;
    };
    std::optional<Found> find(std::string_view path, std::string_view nonce) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace coppice::server
