#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/scene/reference.h"
#include "coppice/scene/save.h"
#include "files.h"
#include "options.h"
#include "results.h"
#include "scene_files.h"

namespace coppice::cli {
namespace {

struct RunFlags {
    std::vector<std::filesystem::path> scenes, outputs;
    SceneFlags given;
    bool reference = false;
};

ExitCode run_scenes(Run& run, const RunFlags& flags) {
    if (flags.reference) {
        run.print(scene_reference());
        run.finish("reference printed");
        return kDone;
    }
    if (flags.scenes.empty()) throw UsageError("name the scene: coppice run SCENE [-o FILE]");
    const std::vector<SceneFile> files = read_scenes(run, flags.scenes);
    const auto commands = commands_of_scenes(files);
    for (const auto& output : flags.outputs) {
        check_output_folder(output);
        if (commands) check_scene_output(*commands, output);
    }
    Scene scene(scene_settings(run, flags.given, files));
    for (const SceneFile& file : files) run_scene(run, scene, file);
    run.stage("write", [&](const Context& ctx) {
        std::vector<ObjectPtr> objects;
        for (const auto& output : flags.outputs)
            objects.push_back(object_for_file(scene.state(), {}, output));
        for (std::size_t i = 0; i < objects.size(); ++i)
            store_object(run, flags.outputs[i], *objects[i], InstanceStorage::instanced, ctx);
    });
    count_objects(run, scene);
    run.finish(fmt::format("{}: {} objects", flags.scenes.back().string(), scene.state().objects.size()));
    return kDone;
}

struct GrowFlags {
    std::filesystem::path scene;
    std::vector<std::filesystem::path> outputs;
    SceneFlags given;
};

[[noreturn]] void refuse_without_tree(const std::filesystem::path& scene) {
    throw InvalidInput(fmt::format(
        "{}: the scene grows no tree; add a line: grow TREE POINTS, or sprout TREE", scene.string()));
}

ExitCode grow_scene(Run& run, const GrowFlags& flags) {
    for (const auto& output : flags.outputs) check_skeleton_output(output);
    std::vector<SceneFile> files;  // read first: an invalid scene is reported before a missing output
    if (!flags.scene.empty()) files = read_scenes(run, {&flags.scene, 1});
    if (files.empty() || flags.outputs.empty())
        throw UsageError("name the scene and the skeleton: coppice grow SCENE -o SKELETON");
    const auto commands = commands_of_scenes(files);
    const auto grows = [](const SceneCommand* c) { return c->name == "grow" || c->name == "sprout"; };
    if (commands && std::ranges::none_of(*commands, grows)) refuse_without_tree(flags.scene);
    SceneSettings settings = scene_settings(run, flags.given, files);
    settings.outputs = false;
    Scene scene(std::move(settings));
    run_scene(run, scene, files.front());
    const auto grown = scene.state().objects.find({ObjectKind::skeleton, scene.state().last_grown});
    if (grown == scene.state().objects.end()) refuse_without_tree(flags.scene);
    run.stage("write", [&](const Context& ctx) {
        for (const auto& output : flags.outputs)
            store_object(run, output, *grown->second, InstanceStorage::instanced, ctx);
    });
    const Skeleton& tree = std::get<Skeleton>(grown->second->value);
    run.count_skeleton(tree);
    run.finish(fmt::format("{}: {} nodes", flags.scene.string(), grouped(tree.size())));
    return kDone;
}

}  // namespace

Command run_command() {
    const auto flags = std::make_shared<RunFlags>();
    OptionList options;
    options.files("scenes", "SCENE", flags->scenes, "Scenes to run in this order (.coppice).");
    options.outputs(
        "-o,--output", "FILE", flags->outputs,
        "File for the last mesh, skeleton or points made, selected by the extension; may be repeated.");
    add_scene_options(options, flags->given);
    options.flag("--reference", flags->reference, "Print the reference page of all scene commands.");
    return {"run", "Run scenes: crowns, points, growth and meshes by commands, one per line.", options,
            [flags](Run& run, const GivenOptions&) { return run_scenes(run, *flags); }};
}

Command grow_command() {
    const auto flags = std::make_shared<GrowFlags>();
    OptionList options;
    options.file("scene", "SCENE", flags->scene, "Scene to run (.coppice).");
    options.outputs("-o,--output", "SKELETON", flags->outputs,
                    "Skeleton to write (.swc, .json, .csv, .ply, .obj); may be repeated.");
    add_scene_options(options, flags->given);
    return {"grow",
            "Run a scene and write the last tree that it grows; the scene itself writes no images and files.",
            options, [flags](Run& run, const GivenOptions&) { return grow_scene(run, *flags); }};
}

}  // namespace coppice::cli
