#include <fmt/format.h>

#include <cstdio>

#include "command.h"
#include "coppice/scene/reference.h"
#include "coppice/scene/scene.h"
#include "line_editor.h"
#include "memory.h"
#include "messages.h"
#include "options.h"
#include "scene_files.h"

namespace coppice::cli {
namespace {

struct ShellFlags {
    std::vector<std::filesystem::path> scenes;
};

/// The exit code of an error, which the last failing line decides when lines come from a file or a pipe.
ExitCode run_line(Run& run, Scene& scene, const std::string& line) {
    try {
        const auto lines = scene_lines(line, "the line");
        if (lines.empty()) return kDone;
        run.forget_interrupt();
        renew_memory_limit();
        fmt::print("{}", run.stage("command", [&](const Context& ctx) { return scene.run(line, {}, ctx); }));
        std::fflush(stdout);
        return kDone;
    } catch (const Cancelled& error) {
        fmt::print(stderr, "{}\n", printable(error.what()));
        return kInterrupted;
    } catch (const IoError& error) {
        fmt::print(stderr, "{}\n", printable(error.what()));
        return kFileTrouble;
    } catch (const Error& error) {
        fmt::print(stderr, "{}\n", printable(error.what()));
        return kBadInput;
    }
}

ExitCode shell(Run& run, const ShellFlags& flags) {
    Scene scene({.max_memory = run.max_memory(SceneSettings{}.max_memory)});
    for (const auto& path : flags.scenes) run_scene_file(run, scene, path);
    scene.set_folder({});
    LineEditor editor("coppice> ", [&](std::string_view line) { return completions(line, scene.state()); });
    if (editor.interactive())
        fmt::print(
            "help lists the commands, tab completes words, Ctrl-C stops a command, quit or Ctrl-D leaves\n");
    ExitCode code = kDone;
    while (const auto line = editor.next()) {
        if (*line == "quit" || *line == "exit") break;
        const ExitCode now = run_line(run, scene, *line);
        if (now == kDone) continue;
        if (!editor.interactive() && now == kInterrupted) return now;
        if (!editor.interactive()) code = now;
    }
    if (editor.interactive()) fmt::print("\n");
    count_objects(run, scene);
    return code;
}

}  // namespace

Command shell_command() {
    const auto flags = std::make_shared<ShellFlags>();
    OptionList options;
    options.files("scenes", "SCENE", flags->scenes, "scenes to run first (.coppice)");
    return {"shell", "Take commands of scenes one by one, with history and completion", options,
            [flags](Run& run, const GivenOptions&) { return shell(run, *flags); }};
}

}  // namespace coppice::cli
