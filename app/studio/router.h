#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "coppice/system/file.h"
#include "coppice/system/folder_sandbox.h"
#include "http.h"
#include "page.h"

namespace coppice::server {

/// Rules of access.
struct Rules {
    std::uint16_t port = 0;                             ///< port of the server
    std::string token = {};                             ///< grants full access
    std::uint64_t max_upload = std::uint64_t{2} << 30;  ///< [bytes] maximum size of one file
};

/// Actions for a request, decided from its head.
/// @{
struct SendBlob {
    std::string key;
};
struct SendFile {
    std::string name;
};
struct TakeFile {
    std::string name;
    std::uint64_t bytes = 0;  ///< size of the body
    bool overwrite = false;
};
struct OpenSocket {};
using Plan = std::variant<HttpReply, SendBlob, SendFile, TakeFile, OpenSocket>;
/// @}

/// Decides how requests are answered: docs/library/studio-protocol.md. Independent of sockets, so that every
/// rule can be tested; thread-safe.
class Router {
  public:
    Router(Rules rules, Page page, std::shared_ptr<const FolderSandbox> sandbox, const StudioEngine& engine);

    /// Returns the action for a request: a response if it is refused or for the page, else the requested
    /// transfer.
    Plan plan(const HttpHead& head) const;
    HttpReply blob(const SendBlob& wanted) const;  ///< may take as long as computing the geometry
    HttpReply file(const SendFile& wanted) const;
    bool knows(std::string_view token) const;  ///< returns whether the token is correct

    /// An upload of a file: bytes in order, then commit(), which makes the file visible.
    class Upload {
      public:
        Upload(const Router& router, TakeFile wanted);  ///< throws IoError, and Exists
        void write(std::string_view bytes) { file_.write(bytes); }
        HttpReply commit();

      private:
        TakeFile wanted_;
        AtomicFile file_;
    };
    /// An upload would replace a file without permission.
    class Exists : public IoError {
      public:
        using IoError::IoError;
    };

  private:
    Plan plan_page(const HttpHead& head) const;
    Plan plan_file(const HttpHead& head, std::string_view name) const;
    std::filesystem::path find_place(const TakeFile& wanted) const;

    Rules rules_;
    Page page_;
    std::shared_ptr<const FolderSandbox> sandbox_;
    const StudioEngine& engine_;
};

}  // namespace coppice::server
