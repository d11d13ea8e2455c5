#include "launch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/system/program.h"

namespace coppice::server {
namespace {

/// Returns a folder that only its owner can read, if there is one.
std::filesystem::path private_folder() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    std::error_code ignored;
    if (runtime != nullptr && std::filesystem::is_directory(runtime, ignored)) return runtime;
    return std::filesystem::temp_directory_path();
}

/// Starts a program, if it exists; it may run for hours, and its output is discarded.
bool start(std::string_view name, const std::string& argument) {
    const auto program = find_program(name);
    if (!program) return false;
    try {
        Program child(
            {.words = {program->string(), argument}, .output = ProgramOutput::discarded, .apart = true});
        std::thread([child = std::move(child)]() mutable { child.wait(); }).detach();
        return true;
    } catch (const IoError&) {
        return false;  // the user opens the address
    }
}

}  // namespace

Doorway::Doorway(const std::string& address) {
    std::string name = (private_folder() / "coppice-studio-XXXXXX.html").string();
    const int descriptor = mkstemps(name.data(), 5);  // mode 0600
    if (descriptor < 0) throw IoError(fmt::format("{}: cannot be written", name));
    file_ = name;
    const std::string text = fmt::format(
        "<!doctype html><meta charset=\"utf-8\"><title>Coppice studio</title>"
        "<meta http-equiv=\"refresh\" content=\"0; url={0}\"><a href=\"{0}\">The studio</a>\n",
        address);
    const bool is_written =
        ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    ::close(descriptor);
    if (!is_written) throw IoError(fmt::format("{}: cannot be written", name));
}

Doorway::~Doorway() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

bool Doorway::open() const {
    const char* chosen = std::getenv("BROWSER");
    if (chosen != nullptr && start(chosen, file_.string()))
        return true;  // a list of several browsers cannot be started
    return start("xdg-open", file_.string());
}

}  // namespace coppice::server
