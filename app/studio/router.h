#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "coppice/io/file.h"
#include "coppice/io/jail.h"
#include "http.h"
#include "page.h"

namespace coppice::server {

/// Who may ask for what.
struct Rules {
    std::uint16_t port = 0;                              ///< that the server listens at
    std::string token = {};                              ///< whoever has it may do everything
    std::uint64_t most_upload = std::uint64_t{2} << 30;  ///< [bytes] of one file
};

/// What is to be done for a request, by its head alone.
/// @{
struct SendBlob {
    std::string key;
};
struct SendFile {
    std::string name;
};
struct TakeFile {
    std::string name;
    std::uint64_t bytes = 0;  ///< that follow
    bool overwrite = false;
};
struct OpenSocket {};
using Plan = std::variant<HttpReply, SendBlob, SendFile, TakeFile, OpenSocket>;
/// @}

/// Decides what requests get: docs/library/studio-protocol.md. Knows nothing of sockets, so that every rule
/// can be tested, and may be used by several threads.
class Router {
  public:
    Router(Rules rules, Page page, std::shared_ptr<const Jail> jail, const StudioEngine& engine);

    /// What a request gets: an answer where it is refused or is about the page, else what it may have.
    Plan plan(const HttpHead& head) const;
    HttpReply blob(const SendBlob& wanted) const;  ///< may take as long as making it does
    HttpReply file(const SendFile& wanted) const;
    bool knows(std::string_view token) const;  ///< whether it is the one

    /// A file that is being uploaded: bytes in order, then commit(), after which it is there.
    class Upload {
      public:
        Upload(const Router& router, TakeFile wanted);  ///< throws IoError, and Exists
        void write(std::string_view bytes) { file_.write(bytes); }
        HttpReply commit();

      private:
        TakeFile wanted_;
        AtomicFile file_;
    };
    /// An upload would replace a file, which nobody allowed.
    class Exists : public IoError {
      public:
        using IoError::IoError;
    };

  private:
    Plan plan_page(const HttpHead& head) const;
    Plan plan_file(const HttpHead& head, std::string_view name) const;
    std::filesystem::path place_of(const TakeFile& wanted) const;

    Rules rules_;
    Page page_;
    std::shared_ptr<const Jail> jail_;
    const StudioEngine& engine_;
};

}  // namespace coppice::server
