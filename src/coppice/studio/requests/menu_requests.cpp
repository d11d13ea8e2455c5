#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "coppice/base/error.h"
#include "coppice/studio/session_internal.h"
#include "coppice/system/file.h"

namespace coppice::studio_internal {
namespace {

constexpr std::uint64_t kLargestMenu = 1 << 20;     // [bytes]
constexpr std::chrono::seconds kProgramTimeout{2};  // time to wait for a program, which may run on

/// Reads the built-in menu and the current files of the user.
Json menu(Studio& studio, const Request& request) {
    Menu menu;
    Json faults = Json::array(), files = Json::array();
    for (const std::filesystem::path& path : studio.options.menus) {
        std::error_code ignored;
        files.push_back(path.string());
        if (!std::filesystem::exists(path, ignored)) continue;
        for (const std::string& fault : menu.add(read_file(path, kLargestMenu, request.ctx), path.string()))
            faults.push_back(fault);
    }
    Json items = Json::array();
    for (const MenuItem& item : menu.items()) {
        items.push_back({{"number", items.size()},
                         {"menu", item.menu},
                         {"label", item.label},
                         {"does", name_of(item.does)},
                         {"text", item.text}});
    }
    studio.menu = std::move(menu);
    return {{"items", items}, {"files", files}, {"faults", faults}, {"built_in", built_in_menu()}};
}

/// Replaces the placeholders in the words of a program; writes the files that they refer to.
class Filling {
  public:
    Filling(Studio& studio, const Request& request) : studio_(studio), request_(request) {}

    std::string filled(std::string_view word) {
        std::string out;
        for (std::size_t at = 0; at < word.size();) {
            const std::size_t hole = std::min(word.find("${", at), word.size());
            out += word.substr(at, hole - at);
            if (hole == word.size()) break;
            const std::size_t end = word.find('}', hole);
            out += find_value(word.substr(hole + 2, end - hole - 2));
            at = end + 1;
        }
        return out;
    }

  private:
    std::string find_value(std::string_view name) {
        if (name == "folder") return studio_.sandbox().folder().string();
        if (name == "object") return request_.text("name");
        const bool exports = request_.fields.contains("name");
        if (name == "file" && !exports) return scene_file();
        const std::string_view ending = name == "file" ? default_ending() : name.substr(name.find('.'));
        return exported_file(ending);
    }

    std::string_view default_ending() const {
        return request_.kind() == ObjectKind::points ? ".ply" : ".glb";
    }

    /// Returns the saved scene, or a copy of the unsaved one.
    std::string scene_file() {
        const std::string& file = studio_.document.file();
        if (!file.empty() && studio_.is_saved()) return studio_.sandbox().to_read(file).string();
        const std::filesystem::path path = studio_.scratch.next(".coppice");
        write_file(path, studio_.document.text());
        return path.string();
    }

    std::string exported_file(std::string_view ending) {
        const std::filesystem::path path = studio_.scratch.next(ending);
        const ExportRequest export_request{
            .kind = request_.kind(), .name = request_.text("name"), .path = path};
        export_to(studio_, export_request, request_.ctx);
        return path.string();
    }

    Studio& studio_;
    const Request& request_;
};

/// Starts a program of the menu that was sent last.
Json program(Studio& studio, const Request& request) {
    const std::size_t number = request.count("item", 0);
    const auto items = studio.menu.items();
    if (number >= items.size() || items[number].does != MenuAction::program)
        throw InvalidInput(
            fmt::format("item {} of the menu starts no program; request the menu again", number));
    Filling filling(studio, request);
    std::vector<std::string> words;
    for (const std::string& word : items[number].words) words.push_back(filling.filled(word));
    const ProgramResult result =
        studio.programs.run(std::move(words), studio.sandbox().folder(), kProgramTimeout, request.ctx);
    Json out{{"text", result.text}, {"status", nullptr}};
    if (result.status) out["status"] = *result.status;
    return out;
}

}  // namespace

std::map<std::string, Handler> menu_requests() { return {{"menu", menu}, {"program", program}}; }

}  // namespace coppice::studio_internal
