#include <fmt/format.h>

#include "command.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/scene/edit_session.h"
#include "coppice/scene/reference.h"
#include "coppice/system/file.h"
#include "files.h"
#include "options.h"
#include "results.h"
#include "scene_files.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct EditFlags {
    std::filesystem::path tree;
    std::vector<std::filesystem::path> commands;  // texts, not files
    std::vector<std::filesystem::path> scenes, scripts, edits, outputs;
    std::filesystem::path save_edits, mesh_output;
    bool reference = false;
    ReadSkeletonOptions read;
    MeshOptions mesh = options_of_written_surface();
};

void check_outputs(const EditFlags& flags) {
    for (const auto& output : flags.outputs) {
        if (kind_to_write(output, FileKind::skeleton) != FileKind::skeleton)
            throw UsageError(
                fmt::format("'{}' is not the name of a skeleton; use .json, which keeps the ids, .swc, .csv, "
                            ".ply or .obj",
                            output.string()));
        check_output_folder(output);
    }
    if (!flags.save_edits.empty()) check_output_folder(flags.save_edits);
    if (!flags.mesh_output.empty()) check_mesh_output(flags.mesh_output);
}

/// Applies saved edits; returns the number of edits that cannot be bound to the tree, each with a warning.
std::size_t replay(Run& run, EditSession& session, const std::filesystem::path& path) {
    const EditSession::Replayed replayed = run.stage("edits", [&](const Context& ctx) {
        return session.replay(read_file(path, kLargestScene), path.string(), ctx);
    });
    for (const EditSession::Unbound& edit : replayed.unbound) {
        run.warn(fmt::format("{}: edit {} of {}, '{}', was left out: {}", path.string(), edit.index + 1,
                             replayed.edits, edit.command, edit.reason));
    }
    return replayed.unbound.size();
}

void write_results(Run& run, const EditFlags& flags, const SkeletonFile& file, const EditSession& session) {
    run.stage("write", [&](const Context& ctx) {
        const Skeleton edited = session.tree().skeleton();
        const auto attributes = kept_attributes(file.attributes, file.skeleton, edited);
        for (const auto& output : flags.outputs) {
            store_skeleton(run, output, edited, {.units = file.units}, attributes, ctx);
        }
        if (flags.save_edits.empty()) return;
        write_file(flags.save_edits, session.saved());
    });
}

ExitCode edit(Run& run, const EditFlags& flags) {
    if (flags.reference) {
        run.print(scene_reference("Editing trees"));
        run.finish("reference printed");
        return kDone;
    }
    if (flags.tree.empty()) throw UsageError("name the tree: coppice edit TREE 'COMMANDS' -o OUT");
    check_outputs(flags);
    const SkeletonFile file = load_skeleton(run, flags.tree, flags.read);
    EditSession session(file.skeleton, {.max_memory = run.max_memory(SceneSettings{}.max_memory)});
    const auto run_files = [&](const std::vector<std::filesystem::path>& files, const char* stage,
                               std::string_view subject, auto&& text) {
        for (const auto& path : files)
            run.print(run.stage(stage, [&](const Context& ctx) {
                return text(read_commands(path, subject), path.string(), ctx);
            }));
    };
    run_files(flags.scenes, "scene", "a scene",
              [&](const auto&... all) { return session.run_scene(all...); });
    std::size_t unbound = 0;
    for (const auto& path : flags.edits) unbound += replay(run, session, path);
    run_files(flags.scripts, "edit", "a list of edits",
              [&](const auto&... all) { return session.run_text(all...); });
    for (const auto& commands : flags.commands) {
        run.print(run.stage("edit", [&](const Context& ctx) {
            return session.run_text(commands.string(), "COMMANDS", ctx);
        }));
    }
    write_results(run, flags, file, session);
    const std::string surface = then_mesh(run, flags.mesh_output, session.tree().skeleton(), flags.mesh);
    run.counts().update({{"edits", session.history().size()},
                         {"unbound_edits", unbound},
                         {"nodes_after", session.tree().size()}});
    run.finish(fmt::format("{}: {} edits, {} nodes{}", flags.tree.string(), session.history().size(),
                           grouped(session.tree().size()), surface));
    return unbound == 0 ? kDone : kCheckFailed;
}

}  // namespace

Command edit_command() {
    const auto flags = std::make_shared<EditFlags>();
    OptionList options;
    options.file("tree", "TREE", flags->tree, "Skeleton to edit.");
    options.files("commands", "COMMANDS", flags->commands,
                  "Edits as text, separated by semicolons: 'bend subtree(12) 30; prune radius=0.002'.");
    options.outputs("-o,--output", "OUT", flags->outputs,
                    "Skeleton to write (.json keeps the ids; .swc, .csv, .ply, .obj); may be repeated.");
    options.files("--script", "FILE", flags->scripts,
                  "File of edits, one per line, applied before COMMANDS; may be repeated.");
    options.files("--scene", "SCENE", flags->scenes, "Scene to run first, for the solids that edits name.",
                  {.common = false});
    options.files("--edits", "FILE", flags->edits,
                  "Saved edits to apply first; edits that cannot be bound to the tree are skipped with a "
                  "warning and exit code 1.",
                  {.common = false});
    options.output("--save-edits", "FILE", flags->save_edits,
                   "Write all edits with the positions of the nodes they name.", {.common = false});
    options.output("--then-mesh", "MESH", flags->mesh_output, "Also write the surface of the edited tree.");
    options.flag("--reference", flags->reference, "Print the reference page of the edits.");
    options.may_replace("--output", "tree");
    options.may_replace("--save-edits", "--edits");
    options.fields(flags->read, "Reading a skeleton");
    options.fields(flags->mesh, "Surface of --then-mesh", then_mesh_flag_names());
    return {"edit",
            "Edit a tree by commands: cut, bend, graft, draw and thicken branches; node ids are kept.",
            options, [flags](Run& run, const GivenOptions&) { return edit(run, *flags); }};
}

}  // namespace coppice::cli
