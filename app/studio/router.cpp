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
    HttpReply reply = sentence(405, fmt::format("this takes {} alone", allowed));
    reply.fields.emplace_back("Allow", allowed);
    return reply;
}

/// Pages elsewhere are told by the name under which the browser asks (DNS rebinding), and by their origin.
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

/// A target is a path and nothing else: no address before it, nothing to ask behind it, no control signs.
bool is_plain_path(std::string_view target) {
    return !target.empty() && target.front() == '/' && target.size() <= kLongestTarget &&
           std::ranges::none_of(target,
                                [](unsigned char c) { return c <= ' ' || c >= 127 || c == '?' || c == '#'; });
}

}  // namespace

Router::Router(Rules rules, Page page, std::shared_ptr<const Jail> jail, const StudioEngine& engine)
    : rules_(std::move(rules)), page_(std::move(page)), jail_(std::move(jail)), engine_(engine) {}

bool Router::knows(std::string_view token) const { return same_token(token, rules_.token); }

Plan Router::plan(const HttpHead& head) const {
    const auto host = head.field("host");
    if (!host || !is_own_host(*host, rules_.port))
        return sentence(421, "this server is asked under its own address alone");
    if (!is_plain_path(head.target)) return sentence(400, "the address is no plain path");
    if (head.target == "/ws") {
        if (head.method != "GET") return wrong_method("GET");
        if (has_body(head)) return sentence(400, "a request for a connection has no body");
        if (!is_upgrade(head)) return sentence(426, "this is for connections of the page");
        if (!has_own_origin(head)) return sentence(403, "pages of others may not connect");
        return OpenSocket{};
    }
    const std::string_view target = head.target;
    const bool is_blob = target.starts_with("/blob/");
    if (!is_blob && !target.starts_with("/file/")) return plan_page(head);
    constexpr std::string_view kBearer = "Bearer ";
    const auto said = head.field("authorization");
    if (!said || !said->starts_with(kBearer) || !knows(said->substr(kBearer.size())))
        return sentence(401, "this needs the token of the studio");
    const auto name = percent_decoded(target.substr(std::string_view("/blob/").size()));
    if (!name || name->empty()) return sentence(400, "the address has no name that can be read");
    if (!is_blob) return plan_file(head, *name);
    if (head.method != "GET") return wrong_method("GET");
    if (has_body(head)) return sentence(400, "a request for geometry has no body");
    return SendBlob{*name};
}

Plan Router::plan_page(const HttpHead& head) const {
    const std::string nonce = make_token();
    auto found = page_.find(head.target, nonce);
    if (!found) return sentence(404, "there is nothing of that name");
    if (head.method != "GET") return wrong_method("GET");
    if (has_body(head)) return sentence(400, "a request for the page has no body");
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
        if (has_body(head)) return sentence(400, "a request for a file has no body");
        return SendFile{std::string(name)};
    }
    if (head.method != "PUT") return wrong_method("GET, PUT");
    if (!has_own_origin(head)) return sentence(403, "pages of others may not write");
    const auto length = head.field("content-length");
    if (!length || head.field("transfer-encoding")) return sentence(411, "a file is sent with its length");
    TakeFile out{.name = std::string(name), .bytes = 0, .overwrite = head.field("x-overwrite") == "yes"};
    const auto [end, error] = std::from_chars(length->data(), length->data() + length->size(), out.bytes);
    if (error != std::errc() || end != length->data() + length->size())
        return sentence(400, "the length of the file is no number");
    if (out.bytes > rules_.most_upload)
        return sentence(413, fmt::format("the file is larger than {} MiB, which --max-upload allows",
                                         rules_.most_upload >> 20));
    return out;
}

HttpReply Router::blob(const SendBlob& wanted) const {
    StudioBytes bytes = engine_.blob(wanted.key);
    if (!bytes) return sentence(404, "there is no such geometry any more; ask for it again");
    return {.type = "application/octet-stream", .body = std::move(bytes)};
}

HttpReply Router::file(const SendFile& wanted) const {
    try {
        HttpReply reply{.type = "application/octet-stream", .body = OpenFile(jail_->open(wanted.name))};
        // Without a name: those of users could not be trusted in a header.
        reply.fields.emplace_back("Content-Disposition", "attachment");
        return reply;
    } catch (const IoError& error) {
        return sentence(404, error.what());
    }
}

std::filesystem::path Router::place_of(const TakeFile& wanted) const {
    std::filesystem::path path = jail_->to_write(wanted.name);
    std::error_code ignored;
    if (!wanted.overwrite && std::filesystem::exists(path, ignored))
        throw Exists(
            fmt::format("'{}' is there already; allow it to be replaced, or take another name", wanted.name));
    return path;
}

Router::Upload::Upload(const Router& router, TakeFile wanted)
    : wanted_(std::move(wanted)), file_(router.place_of(wanted_)) {}

HttpReply Router::Upload::commit() {
    file_.commit();
    return {.type = "application/json",
            .body = nlohmann::json{{"file", wanted_.name}, {"bytes", wanted_.bytes}}.dump(
                -1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace coppice::server
