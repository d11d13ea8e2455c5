#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/studio/engine.h"
#include "coppice/system/descriptor.h"

namespace coppice::server {

/// The head of a request.
struct HttpHead {
    std::string method, target;
    std::vector<std::pair<std::string, std::string>>
        fields;  ///< in the order of the request; names in lower case

    /// Returns the value of a field; nullopt if it is missing or repeated, which no supported client does.
    std::optional<std::string_view> field(std::string_view name) const;
};

/// A response. The fields that are common to all responses are added when it is sent.
struct HttpReply {
    int status = 200;
    std::string type = "text/plain; charset=utf-8";
    std::variant<std::string, StudioBytes, Descriptor> body = {};
    std::vector<std::pair<std::string, std::string>> fields = {};
};

/// Returns a response of one sentence.
HttpReply sentence(int status, const std::string& text);

/// Decodes `%20` and other escapes; returns nullopt if they are malformed.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace coppice::server
