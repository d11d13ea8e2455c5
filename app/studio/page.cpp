#include "page.h"

#include <algorithm>
#include <array>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/system/file.h"

namespace coppice::server {
namespace {

constexpr std::string_view kNonce = "__NONCE__";  // placeholder in index.html

/// The possible files of a page; no others are searched.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kFiles{
    {{"index.html", "text/html; charset=utf-8"},
     {"app.js", "text/javascript; charset=utf-8"},
     {"app.css", "text/css; charset=utf-8"},
     {"worker.js", "text/javascript; charset=utf-8"}}};

void put_nonce(std::string& text, std::string_view nonce) {
    for (std::size_t at = text.find(kNonce); at != text.npos; at = text.find(kNonce, at))
        text.replace(at, kNonce.size(), nonce);
}

}  // namespace

Page::Page(std::filesystem::path folder) : folder_(std::move(folder)) {
    if (!folder_.empty()) {
        for (const auto& [name, type] : kFiles) {
            if (!std::filesystem::is_regular_file(folder_ / name))
                throw InvalidInput("there is no page in " + folder_.string() +
                                   "; build it: npm run build --prefix web -- --outdir=FOLDER");
        }
    } else if (embedded_page().empty()) {
        throw InvalidInput(
            "this program was built without the page of the studio, because Node or the packages of web/ "
            "were missing; run script/bootstrap and build again");
    }
}

std::optional<Page::Found> Page::find(std::string_view path, std::string_view nonce) const {
    if (!path.starts_with('/')) return std::nullopt;
    const std::string_view name = path == "/" ? std::string_view("index.html") : path.substr(1);
    const auto known = std::ranges::find(kFiles, name, [](const auto& file) { return file.first; });
    if (known == kFiles.end()) return std::nullopt;
    Found found{.bytes = {}, .type = known->second};
    if (folder_.empty()) {
        const auto file = std::ranges::find(embedded_page(), name, &PageFile::name);
        if (file == embedded_page().end()) return std::nullopt;
        found.bytes = file->bytes;
    } else {
        found.bytes = read_file(folder_ / name);
    }
    if (name == "index.html") put_nonce(found.bytes, nonce);
    return found;
}

}  // namespace coppice::server
