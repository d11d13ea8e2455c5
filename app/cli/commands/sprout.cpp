#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "command.h"
#include "coppice/base/quote.h"
#include "coppice/growth/radii.h"
#include "coppice/growth/sprout.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/options/quantity.h"
#include "coppice/skeleton/measure.h"
#include "files.h"
#include "memory.h"
#include "options.h"
#include "results.h"
#include "scene_files.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct SproutFlags {
    std::vector<std::filesystem::path> outputs;
    std::vector<std::string> roots;
    std::filesystem::path guard, mesh_output;
    SproutOptions sprout;
    RadiiOptions radii;
    GuardOptions guarded;
    MeshOptions mesh = options_of_written_surface();
};

void check_flags(const SproutFlags& flags, const GivenOptions& given) {
    if (flags.outputs.empty() && flags.mesh_output.empty())
        throw UsageError("name the skeleton: coppice sprout -o SKELETON");
    for (const auto& output : flags.outputs) check_skeleton_output(output);
    if (!flags.mesh_output.empty()) check_mesh_output(flags.mesh_output);
    for (const Option* o : given) {
        if (flags.guard.empty() && o->name.starts_with("--guard-"))
            throw UsageError(fmt::format("{} requires a solid; add --guard SCENE", o->name));
    }
}

/// Parses "1,2,0" as a position, "1,2,0,0,0,1" as a position and a direction.
Root find_root(const std::string& text) {
    std::vector<float> n;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        const std::string word = text.substr(at, end - at);
        const auto value = parse_finite(word);
        if (!value) break;
        n.push_back(static_cast<float>(*value));
        at = end + 1;
    }
    const auto commas = static_cast<std::size_t>(std::ranges::count(text, ','));
    if (n.size() != commas + 1 || (n.size() != 3 && n.size() != 6))
        throw UsageError(fmt::format("--root takes X,Y,Z, or X,Y,Z,DX,DY,DZ, not {}", quote(text)));
    Root root{{n[0], n[1], n[2]}, {}};
    if (n.size() == 6) root.direction = {n[3], n[4], n[5]};
    return root;
}

ExitCode sprout_trees(Run& run, const SproutFlags& flags, const GivenOptions& given) {
    check_flags(flags, given);
    std::vector<Root> roots;
    for (const std::string& text : flags.roots) roots.push_back(find_root(text));
    if (roots.empty()) roots.emplace_back();
    std::optional<SolidField> solid;
    std::optional<Guard> guard;
    if (!flags.guard.empty()) {
        solid.emplace(solid_of_scene(run, flags.guard.string()));
        guard.emplace(FieldRef(*solid), flags.guarded);
    }
    const double mebibytes = run.max_memory(memory_of_machine());
    const SproutInput input{
        .roots = roots, .guard = guard ? &*guard : nullptr, .origin = {}, .max_bytes = mebibytes * (1 << 20)};
    const SproutResult grown =
        run.stage("sprout", [&](const Context& ctx) { return sprout(input, flags.sprout, ctx); });
    const Skeleton tree =
        run.stage("radii", [&](const Context&) { return with_pipe_radii(grown.skeleton, flags.radii); });
    run.stage("write", [&](const Context& ctx) {
        for (const auto& output : flags.outputs) store_skeleton(run, output, tree, {}, {}, ctx);
    });
    const std::string surface = then_mesh(run, flags.mesh_output, tree, flags.mesh);
    if (grown.full) run.warn(fmt::format("growth stopped at --max-nodes, in season {}", grown.seasons));
    run.count_skeleton(tree);
    run.counts().update({{"tips", measure(tree).tips},
                         {"seasons", grown.seasons},
                         {"shed", grown.shed},
                         {"barred", grown.barred}});
    run.finish(fmt::format("{} nodes after {} seasons, {} shed{}", grouped(tree.size()), grown.seasons,
                           grouped(grown.shed), surface));
    return kDone;
}

}  // namespace

Command sprout_command() {
    const auto flags = std::make_shared<SproutFlags>();
    OptionList options;
    options.outputs("-o,--output", "SKELETON", flags->outputs,
                    "Skeleton to write (.swc, .json, .csv, .ply, .obj); may be repeated.");
    options.value({common_field("root",
                                "Start of a tree as X,Y,Z, or X,Y,Z,DX,DY,DZ with its direction; may be "
                                "repeated for trees that share the light; by default 0,0,0."),
                   &flags->roots});
    options.file("--guard", "SCENE", flags->guard,
                 "Scene with a solid, the last one or FILE:NAME, that no segment may enter, or leave with "
                 "--guard-side inside.");
    options.output("--then-mesh", "MESH", flags->mesh_output, "Also write the surface of the trees.");
    options.fields(flags->sprout, "Rules");
    options.fields(flags->radii, "Radii by the pipe model");
    options.fields(flags->guarded, "Limits of a solid");
    options.fields(flags->mesh, "Surface of --then-mesh", then_mesh_flag_names());
    return {"sprout", "Grow trees by rules: buds, branching angles, light and shade, season by season.",
            options,
            [flags](Run& run, const GivenOptions& given) { return sprout_trees(run, *flags, given); }};
}

}  // namespace coppice::cli
