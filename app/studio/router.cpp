#include "router.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <system_error>

#include "coppice/base/error.h"
#include "token.h"

namespace coppice::server {
namespace {

constexpr std::size_t kLongestTarget = 4096;

HttpReply wrong_method(const char* allowed) {
    HttpReply reply = sentence(405, fmt::format("this accepts only {}", allowed));
    reply.fields.emplace_back("Allow", allowed);
    return reply;
}

/// Requests by foreign pages are recognised by their host name (DNS rebinding) and their origin.
bool is_own_host(std::string_view host, std::uint16_t port) {
    return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
}

bool has_own_origin(const HttpHead& head) {
    const auto host = head.field("host"), origin = head.field("origin");
    return host && origin && *origin == fmt::format("http://{}", *host);
}

bool has_body(const HttpHead& head) {
    const auto length = head.field("content-length");
    return std::ranges::any_of(head.fields, [](const auto& f) { return f.first == "transfer-encoding"; }) ||
           (std::ranges::any_of(head.fields, [](const auto& f) { return f.first == "content-length"; }) &&
            length != "0");
}

bool is_upgrade(const HttpHead& head) {
    const auto upgrade = head.field("upgrade");
    return upgrade && std::ranges::equal(*upgrade, std::string_view("websocket"), [](char a, char b) {
               return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b;
           });
}

/// Returns whether a target is only a path: without a host, a query, a fragment or control characters.
bool is_plain_path(std::string_view target) {
    return !target.empty() && target.front() == '/' && target.size() <= kLongestTarget &&
           std::ranges::none_of(target,
                                [](unsigned char c) { return c <= ' ' || c >= 127 || c == '?' || c == '#'; });
}

/// Browsers decode images only of a type that is stated.
std::string_view find_type(std::string_view bytes) {
    if (bytes.starts_with("\x89PNG")) return "image/png";
    if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
    return "application/octet-stream";
}

}  // namespace

Router::Router(Rules rules, Page page, std::shared_ptr<const FolderSandbox> sandbox,
               const StudioEngine& engine)
    : rules_(std::move(rules)), page_(std::move(page)), sandbox_(std::move(sandbox)), engine_(engine) {}

bool Router::knows(std::string_view token) const { return same_token(token, rules_.token); }

Plan Router::plan(const HttpHead& head) const {
    const auto host = head.field("host");
    if (!host || !is_own_host(*host, rules_.port))
        return sentence(421, "this server only answers requests to its own address");
    if (!is_plain_path(head.target)) return sentence(400, "the address is not a plain path");
    if (head.target == "/ws") {
        if (head.method != "GET") return wrong_method("GET");
        if (has_body(head)) return sentence(400, "a request for a connection must not have a body");
        if (!is_upgrade(head)) return sentence(426, "this address is only for connections of the page");
        if (!has_own_origin(head)) return sentence(403, "pages of other origins may not connect");
        return OpenSocket{};
    }
    const std::string_view target = head.target;
    const bool is_blob = target.starts_with("/blob/");
    if (!is_blob && !target.starts_with("/file/")) return plan_page(head);
    constexpr std::string_view kBearer = "Bearer ";
    const auto authorization = head.field("authorization");
    if (!authorization || !authorization->starts_with(kBearer) ||
        !knows(authorization->substr(kBearer.size())))
        return sentence(401, "this requires the token of the studio");
    const auto name = percent_decoded(target.substr(std::string_view("/blob/").size()));
    if (!name || name->empty()) return sentence(400, "the address contains no valid name");
    if (!is_blob) return plan_file(head, *name);
    if (head.method != "GET") return wrong_method("GET");
    if (has_body(head)) return sentence(400, "a request for geometry must not have a body");
    return SendBlob{*name};
}

Plan Router::plan_page(const HttpHead& head) const {
    const std::string nonce = make_token();
    auto found = page_.find(head.target, nonce);
    if (!found) return sentence(404, "there is no such page");
    if (head.method != "GET") return wrong_method("GET");
    if (has_body(head)) return sentence(400, "a request for the page must not have a body");
    HttpReply reply{.type = std::string(found->type), .body = std::move(found->bytes)};
    reply.fields.emplace_back(
        "Content-Security-Policy",
        fmt::format(
            "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{}'; connect-src 'self'; "
            "img-src 'self' blob: data:; worker-src 'self'; form-action 'none'; frame-ancestors 'none'; "
            "base-uri 'none'",
            nonce));
    return reply;
}

Plan Router::plan_file(const HttpHead& head, std::string_view name) const {
    if (head.method == "GET") {
        if (has_body(head)) return sentence(400, "a request for a file must not have a body");
        return SendFile{std::string(name)};
    }
    if (head.method != "PUT") return wrong_method("GET, PUT");
    if (!has_own_origin(head)) return sentence(403, "pages of other origins may not write");
    const auto length = head.field("content-length");
    if (!length || head.field("transfer-encoding"))
        return sentence(411, "an upload must state the length of the file");
    TakeFile out{.name = std::string(name), .bytes = 0, .overwrite = head.field("x-overwrite") == "yes"};
    const auto [end, error] = std::from_chars(length->data(), length->data() + length->size(), out.bytes);
    if (error != std::errc() || end != length->data() + length->size())
        return sentence(400, "the length of the file is not a number");
    if (out.bytes > rules_.max_upload)
        return sentence(413, fmt::format("the file is larger than {} MiB, the limit of --max-upload",
                                         rules_.max_upload >> 20));
    return out;
}

HttpReply Router::blob(const SendBlob& wanted) const {
    StudioBytes bytes = engine_.blob(wanted.key);
    if (!bytes) return sentence(404, "this geometry no longer exists; request it again");
    std::string type(find_type(*bytes));
    return {.type = std::move(type), .body = std::move(bytes)};
}

HttpReply Router::file(const SendFile& wanted) const {
    try {
        HttpReply reply{.type = "application/octet-stream", .body = sandbox_->open(wanted.name)};
        // Sent without a file name: names chosen by users are not safe in a header.
        reply.fields.emplace_back("Content-Disposition", "attachment");
        return reply;
    } catch (const IoError& error) {
        return sentence(404, error.what());
    }
}

std::filesystem::path Router::find_place(const TakeFile& wanted) const {
    std::filesystem::path path = sandbox_->to_write(wanted.name);
    std::error_code ignored;
    if (!wanted.overwrite && std::filesystem::exists(path, ignored))
        throw Exists(
            fmt::format("'{}' already exists; allow it to be replaced, or choose another name", wanted.name));
    return path;
}

Router::Upload::Upload(const Router& router, TakeFile wanted)
    : wanted_(std::move(wanted)), file_(router.find_place(wanted_)) {}

HttpReply Router::Upload::commit() {
    file_.commit();
    return {.type = "application/json",
            .body = nlohmann::json{{"file", wanted_.name}, {"bytes", wanted_.bytes}}.dump(
                -1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace coppice::server
