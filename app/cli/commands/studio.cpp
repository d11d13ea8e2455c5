#include <fmt/format.h>

#include <cctype>
#include <cstdlib>

#include "command.h"
#include "coppice/base/error.h"
#include "coppice/system/folder_sandbox.h"
#include "files.h"
#include "journal.h"
#include "launch.h"
#include "router.h"
#include "server.h"
#include "streams.h"
#include "token.h"

namespace coppice::cli {
namespace {

struct StudioFlags {
    std::filesystem::path opened;
    std::filesystem::path page;
    std::vector<std::filesystem::path> menus;
    int port = 0;
    int max_upload = 2048;  ///< [MiB]
    bool no_browser = false;
    bool print_address = false;
};

/// Files to open: a folder, and optionally a scene or another file in it.
struct Opened {
    std::filesystem::path folder;
    std::string scene;  ///< name in the folder
    std::string other;  ///< the same for a file that is to be imported
};

Opened opened_by(const std::filesystem::path& path) {
    if (path.empty()) return {.folder = ".", .scene = {}, .other = {}};
    if (std::filesystem::is_directory(path)) return {.folder = path, .scene = {}, .other = {}};
    if (!std::filesystem::is_regular_file(path)) {
        throw IoError(fmt::format(
            "{}: there is no such file or folder; name a scene (.coppice), or the folder to work in",
            path.string()));
    }
    Opened out{.folder = path.has_parent_path() ? path.parent_path() : ".", .scene = {}, .other = {}};
    (path.extension() == ".coppice" ? out.scene : out.other) = path.filename().string();
    return out;
}

/// Loads the user's own menu, and the given ones.
std::vector<std::filesystem::path> find_menus(const StudioFlags& flags) {
    std::vector<std::filesystem::path> out;
    const char* config = std::getenv("XDG_CONFIG_HOME");
    const char* home = std::getenv("HOME");
    const std::filesystem::path own = "coppice/studio.menu";
    if (config != nullptr && *config == '/') {
        out.push_back(config / own);
    } else if (home != nullptr && *home == '/') {
        out.push_back(home / (".config" / own));
    }
    for (const auto& menu : flags.menus) {
        if (!std::filesystem::is_regular_file(menu))
            throw IoError(fmt::format("{}: there is no such menu file", menu.string()));
        out.push_back(std::filesystem::absolute(menu));
    }
    return out;
}

std::string percent_encoded(std::string_view text) {
    std::string out;
    for (const unsigned char c : text) {
        if (std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-') {
            out += static_cast<char>(c);
        } else {
            out += fmt::format("%{:02X}", c);
        }
    }
    return out;
}

void tell_where(const server::Doorway& doorway, const std::string& address, const StudioFlags& flags) {
    const bool started = !flags.no_browser && doorway.open();
    if (flags.print_address) {
        print(address + "\n");
    } else if (started) {
        print(fmt::format("The studio opens in the browser; if it does not, open {} there.\n",
                          doorway.file().string()));
    } else {
        print(fmt::format("Open this address in the browser: {}\n", doorway.file().string()));
    }
    print("Ctrl-C ends the studio; unsaved work is restored at the next start.\n");
    flush_output();
}

ExitCode run_studio(Run& run, const StudioFlags& flags) {
    const Opened opened = opened_by(flags.opened);
    StudioOptions options;
    options.scene.max_memory = run.max_memory(SceneSettings{}.max_memory);
    options.scene.folder = opened.folder;
    options.scene.sandbox = std::make_shared<const FolderSandbox>(opened.folder);
    options.file = opened.scene;
    options.menus = find_menus(flags);
    const server::JournalPlace journal(opened.scene.empty() ? opened.folder : opened.folder / opened.scene);
    options.journal = journal.file();

    server::Page page(flags.page);
    server::Listener listener(static_cast<std::uint16_t>(flags.port));
    StudioEngine engine(options);
    const server::Rules rules{.port = listener.port(),
                              .token = server::make_token(),
                              .max_upload = static_cast<std::uint64_t>(flags.max_upload) << 20};
    const server::Router router(rules, std::move(page), options.scene.sandbox, engine);
    std::string address = fmt::format("http://127.0.0.1:{}/#token={}", rules.port, rules.token);
    if (!opened.other.empty()) address += "&import=" + percent_encoded(opened.other);
    const server::Doorway doorway(address);
    server::Server serving(listener, router, engine);
    tell_where(doorway, address, flags);
    serving.run(run.stop_token());
    run.finish("the studio has ended");
    return kDone;
}

}  // namespace

Command studio_command() {
    const auto flags = std::make_shared<StudioFlags>();
    OptionList options;
    options.file("opened", "FOLDER|FILE", flags->opened,
                 "Folder to work in, scene in it (.coppice), or another file to start with; by default the "
                 "current folder.");
    options.value(
        {common_field("port", "Port of the server of the page; 0 selects a free one.", Unit::none, 0, 65535),
         &flags->port});
    options.flag("--no-browser", flags->no_browser,
                 "Print the address to open instead of starting a browser.");
    options.flag("--print-address", flags->print_address,
                 "Print the address with its token, for a browser that connects through a tunnel.");
    options.files("--menu", "FILE", flags->menus,
                  "Menu file, added to coppice/studio.menu of the configuration folder; may be repeated.");
    options.value({common_field("max_upload", "Maximum size in MiB of a file that is dropped onto the page.",
                                Unit::none, 1, 1e6),
                   &flags->max_upload});
    options.file("--page", "FOLDER", flags->page, "Serve the page from a folder, during its development.",
                 {.common = false});
    return {"studio", "Model trees by hand in a browser: crowns, growth, branches, sketches.", options,
            [flags](Run& run, const GivenOptions&) { return run_studio(run, *flags); }};
}

}  // namespace coppice::cli
