#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/studio/engine.h"

namespace coppice::server {

/// The head of a request.
struct HttpHead {
    std::string method, target;
    std::vector<std::pair<std::string, std::string>> fields;  ///< as they came; names in lower case

    /// The value of a field; none where it is missing or comes twice, which no client of ours does.
    std::optional<std::string_view> field(std::string_view name) const;
};

/// A file that is open for reading, closed by whoever has it last.
class OpenFile {
  public:
    explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
    OpenFile(OpenFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    OpenFile& operator=(OpenFile&& other) noexcept;
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    ~OpenFile();

    int release() { return std::exchange(descriptor_, -1); }  ///< hands it over

  private:
    int descriptor_;
};

/// What is answered. Fields that every answer has are added when it is sent.
struct HttpReply {
    int status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::variant<std::string, StudioBytes, OpenFile> body = {};
    std::vector<std::pair<std::string, std::string>> fields = {};
};

/// An answer of one sentence.
HttpReply sentence(int status, const std::string& text);

/// `%20` and the like as the bytes that they stand for; none where it is not well-formed.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace coppice::server
