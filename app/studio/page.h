#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "coppice/studio/engine.h"

namespace coppice::server {

/// A file of the page of the studio.
struct PageFile {
    std::string_view name;  ///< "app.js"
    std::string_view bytes;
};

/// Returns the page that is embedded in the program; empty if it was built without one (see
/// app/studio/CMakeLists.txt).
std::span<const PageFile> embedded_page();

/// The files of the page: those embedded in the program, or during development those in a folder.
class Page {
  public:
    /// An empty `folder` selects the embedded files. Throws InvalidInput if there is no page.
    explicit Page(std::filesystem::path folder = {});

    /// Returns the file for a path, "/" or "/app.js"; nullopt for any other. `nonce` is inserted into the
    /// document.
    struct Found {
        std::string bytes;
        std::string_view type;
    };
    std::optional<Found> find(std::string_view path, std::string_view nonce) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace coppice::server
