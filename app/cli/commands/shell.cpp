#include <fmt/format.h>

#include "command.h"
#include "coppice/scene/reference.h"
#include "coppice/scene/scene.h"
#include "line_editor.h"
#include "memory.h"
#include "messages.h"
#include "options.h"
#include "scene_files.h"
#include "streams.h"

namespace coppice::cli {
namespace {

struct ShellFlags {
    std::vector<std::filesystem::path> scenes;
    SceneFlags given;
};

constexpr const char* kPrompt = "coppice> ";
constexpr const char* kPromptInBlock = "     ... ";  // until the block is complete

/// Runs the work and prints its errors. Returns the exit code of the error; when lines come from a file or a
/// pipe, that of the last failing line is the exit code of the shell.
template <class Work>
ExitCode run_guarded(Work&& work) {
    try {
        std::forward<Work>(work)();
        return kDone;
    } catch (const Cancelled& error) {
        print_error(one_line(error.what()) + "\n");
        return kInterrupted;
    } catch (const IoError& error) {
        print_error(one_line(error.what()) + "\n");
        return kFileTrouble;
    } catch (const Error& error) {
        print_error(one_line(error.what()) + "\n");
        return kBadInput;
    }
}

ExitCode run_line(Run& run, Scene& scene, const std::string& line) {
    return run_guarded([&] {
        const auto lines = scene_lines(line, "the line");
        if (lines.empty()) return;
        run.forget_interrupt();
        renew_memory_limit();
        print(run.stage("command", [&](const Context& ctx) { return scene.run(line, {}, ctx); }));
        flush_output();
    });
}

ExitCode shell(Run& run, const ShellFlags& flags) {
    const std::vector<SceneFile> files = read_scenes(run, flags.scenes);
    Scene scene(scene_settings(run, flags.given, files));
    for (const SceneFile& file : files) run_scene(run, scene, file);
    scene.set_folder({});
    LineEditor editor(kPrompt, [&](std::string_view line) { return completions(line, scene.state()); });
    if (editor.interactive())
        print(
            "help lists the commands, tab completes words, Ctrl-C stops a command, quit or Ctrl-D leaves\n");
    ExitCode code = kDone;
    while (const auto line = editor.next()) {
        if (*line == "quit" || *line == "exit") break;
        const ExitCode now = run_line(run, scene, *line);
        editor.set_prompt(scene.waits() ? kPromptInBlock : kPrompt);
        if (now == kDone) continue;
        if (!editor.interactive() && now == kInterrupted) return now;
        if (!editor.interactive()) code = now;
    }
    if (editor.interactive()) print("\n");
    if (!editor.interactive() && scene.waits()) code = run_guarded([&] { scene.finish(); });
    count_objects(run, scene);
    return code;
}

}  // namespace

Command shell_command() {
    const auto flags = std::make_shared<ShellFlags>();
    OptionList options;
    options.files("scenes", "SCENE", flags->scenes, "Scenes to run first (.coppice).");
    add_scene_options(options, flags->given);
    return {"shell", "Run scene commands interactively, with history and completion.", options,
            [flags](Run& run, const GivenOptions&) { return shell(run, *flags); }};
}

}  // namespace coppice::cli
