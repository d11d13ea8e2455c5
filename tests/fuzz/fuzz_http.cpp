// Sends arbitrary bytes as the header of a request to the studio's server, with unknown token and port: they
// are invalid, are refused, or get the page, but never a blob, a file or a connection. With the token
// (selected by the first byte) names never lead out of the folder.

#include <boost/beast/http/parser.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "http_head.h"
#include "router.h"

namespace {

namespace http = boost::beast::http;
using namespace coppice;

constexpr const char* kToken = "0123456789012345678901234567890123456789012";

void require(bool condition) {
    if (!condition) std::abort();
}

/// A folder with a page, and an empty subfolder.
std::filesystem::path make_folder() {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "coppice fuzz http";
    std::filesystem::create_directories(folder / "work");
    for (const char* name : {"index.html", "app.js", "app.css", "worker.js"})
        write_file(folder / name, "page");
    return folder;
}

/// A server in an empty folder, used by all runs.
struct Fixture {
    std::filesystem::path folder = make_folder();
    std::shared_ptr<const FolderSandbox> sandbox = std::make_shared<const FolderSandbox>(folder / "work");
    StudioEngine engine{StudioOptions{.scene = {.folder = folder / "work", .sandbox = sandbox}}};
    server::Router router{
        {.port = 4000, .token = kToken, .max_upload = 1000}, server::Page(folder), sandbox, engine};
};

void check(const Fixture& fixture, const server::HttpHead& head, bool knows_token) {
    const server::Plan plan = fixture.router.plan(head);
    if (const auto* reply = std::get_if<server::HttpReply>(&plan)) {
        require(reply->status == 200 || (reply->status >= 400 && reply->status < 500));
        return;
    }
    require(knows_token || std::holds_alternative<server::OpenSocket>(plan));
    if (const auto* wanted = std::get_if<server::SendFile>(&plan)) {
        require(fixture.router.file(*wanted).status == 404);  // missing
    } else if (const auto* blob = std::get_if<server::SendBlob>(&plan)) {
        require(fixture.router.blob(*blob).status == 404);
    } else if (const auto* file = std::get_if<server::TakeFile>(&plan)) {
        try {
            const server::Router::Upload upload(fixture.router, *file);
        } catch (const Error&) {  // the name is refused
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Fixture fixture;
    if (size == 0) return 0;
    http::request_parser<http::empty_body> parser;
    parser.header_limit(server::kMaxHead);
    parser.eager(false);
    boost::beast::error_code failure;
    parser.put(boost::asio::buffer(data + 1, size - 1), failure);
    if (failure || !parser.is_header_done()) return 0;
    server::HttpHead head = server::to_http_head(parser.get());
    const bool knows_token = data[0] % 2 == 1;
    if (knows_token) {
        std::erase_if(head.fields, [](const auto& field) {
            return field.first == "authorization" || field.first == "host";
        });
        head.fields.emplace_back("authorization", std::string("Bearer ") + kToken);
        head.fields.emplace_back("host", "127.0.0.1:4000");
    }
    check(fixture, head, knows_token);
    return 0;
}
