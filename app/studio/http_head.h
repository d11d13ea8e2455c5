#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <cstddef>
#include <string>
#include <utility>

#include "http.h"

namespace coppice::server {

inline constexpr std::size_t kMaxHead = 8 << 10;  ///< [bytes] maximum size of the head of a request

/// Converts the head of a request to the type that the router uses.
inline HttpHead to_http_head(const boost::beast::http::request<boost::beast::http::empty_body>& request) {
    HttpHead head{.method = std::string(request.method_string()),
                  .target = std::string(request.target()),
                  .fields = {}};
    for (const auto& field : request) {
        std::string name(field.name_string());
        for (char& c : name) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
        head.fields.emplace_back(std::move(name), std::string(field.value()));
    }
    return head;
}

}  // namespace coppice::server
