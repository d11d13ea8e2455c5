#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "command.h"
#include "coppice/io_mesh/format.h"
#include "coppice/scene/animation/animation.h"
#include "files.h"
#include "options.h"
#include "scene_files.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct AnimateFlags {
    std::filesystem::path tree;
    std::vector<std::filesystem::path> outputs;
    std::filesystem::path keys;
    MaterialPrefixes materials;
    std::vector<std::filesystem::path> more_keys;  // texts, not files
    AnimationOptions how;
    ReadSkeletonOptions read;
};

bool has_no_material(const std::filesystem::path& output) {
    const auto format = mesh_format_of_name(output);
    return format == MeshFormat::ply || format == MeshFormat::stl;
}

bool has_one_texture(const std::filesystem::path& output) {
    const auto format = mesh_format_of_name(output);
    return format == MeshFormat::obj || format == MeshFormat::stl;
}

void check_flags(const AnimateFlags& flags) {
    if (flags.tree.empty() || flags.outputs.empty())
        throw UsageError("name the tree and the frames: coppice animate TREE -o FRAMES");
    const bool has_keys = !flags.keys.empty() || !flags.more_keys.empty();
    as_usage("", [&] {
        for (const auto& output : flags.outputs) check_frames_name(output, !flags.how.grow);
        check_animation(flags.how, has_keys);
    });
    for (const auto& output : flags.outputs) check_output_folder(output);
    check_materials(flags.materials);
    if (flags.how.grow && flags.materials.has_slots())
        throw UsageError("--twig-material and --cut-material do not apply to --grow; leave them out");
    if (!flags.materials.bark.empty() && std::ranges::all_of(flags.outputs, has_no_material))
        throw UsageError("--material requires another output than .ply and .stl, which have no materials");
    if (flags.how.mesh.texture.blend && std::ranges::all_of(flags.outputs, has_one_texture))
        throw UsageError("--uv-blend requires another output than .obj and .stl, which have no second set");
}

/// Returns the keys of the file and of the command line; nullopt if there are none.
std::optional<Keyframes> load_keys(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    std::string text, source = "--key";
    if (!flags.keys.empty()) {
        source = flags.keys.string();
        text = run.stage("read", [&](const Context&) { return read_commands(flags.keys, "a list of keys"); });
    }
    for (const auto& key : flags.more_keys) text.append(key.string()).append(1, '\n');
    if (text.empty() && flags.keys.empty()) return {};
    return run.stage("keys", [&](const Context& ctx) { return Keyframes(tree, text, source, {}, ctx); });
}

FrameSinks open_sinks(const AnimateFlags& flags, const FrameSeries& series) {
    FrameSinks sinks;
    for (const auto& output : flags.outputs) sinks.push_back(open_sink(output, series));
    return sinks;
}

/// Deforms one surface for all frames.
ExitCode animate_motion(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    std::optional<Keyframes> keys = load_keys(run, flags, tree);
    const Motion motion = as_usage("", [&] { return Motion(tree, std::move(keys), flags.how); });
    const std::size_t count_of_frames = motion.frames();
    SkinnedMesh mesh =
        run.stage("mesh", [&](const Context& ctx) { return SkinnedMesh(tree, flags.how.mesh, ctx); });
    const FrameSeries series = make_series(mesh, motion, flags.how);
    const FrameSinks sinks = open_sinks(flags, series);
    const MotionReport report =
        run.stage("frames", [&](const Context& ctx) { return make_frames(mesh, motion, sinks, ctx); });
    run.add_stage("frames: carry", report.carrying);
    count_surface(run, mesh.made());
    run.counts().update({{"keys", motion.keys()},
                         {"frames", count_of_frames},
                         {"seconds_per_frame", report.carrying / static_cast<double>(count_of_frames)}});
    run.counts().update(compute_figures(report));
    run.finish(fmt::format("{}: {}", flags.tree.string(),
                           to_text(report, count_of_frames, series.rest->quads.size())));
    return kDone;
}

/// Computes a new surface for each frame.
ExitCode animate_growth(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    const GrowthFrames frames = as_usage("", [&] { return growth_frames(flags.how.run); });
    const MeshResult last =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(tree, flags.how.mesh, ctx); });
    const QuadMesh& surface = last.quads().mesh;
    const FrameSinks sinks = open_sinks(flags, make_series(surface, frames, flags.how));
    const std::uint64_t crossings = run.stage(
        "frames", [&](const Context& ctx) { return make_frames(tree, frames, flags.how, sinks, ctx); });
    count_surface(run, last);
    run.counts().update({{"frames", frames.frames}, {"crossings", crossings}});
    run.finish(
        fmt::format("{}: {}", flags.tree.string(), text_of_growth(frames.frames, surface.quads.size())));
    return kDone;
}

ExitCode animate(Run& run, const GivenOptions& given, AnimateFlags flags) {
    check_flags(flags);
    check_texture(given, flags.how.mesh.texture);
    flags.how.materials = find_materials(flags.materials);
    flags.how.mesh.slots = make_slots(flags.materials, flags.how.mesh.slots);
    if (!flags.how.materials.empty())
        use_tile_of_image(run, given, flags.how.materials.front().color, flags.how.mesh.texture);
    const SkeletonFile file = load_skeleton(run, flags.tree, flags.read);
    return flags.how.grow ? animate_growth(run, flags, file.skeleton)
                          : animate_motion(run, flags, file.skeleton);
}

}  // namespace

Command animate_command() {
    const auto flags = std::make_shared<AnimateFlags>();
    OptionList options;
    options.file("tree", "TREE", flags->tree, "Skeleton to animate.");
    options.outputs("-o,--output", "FRAMES", flags->outputs,
                    "Animation to write: .gif, .mp4 (by ffmpeg), .glb, .usda, or one file per frame: .png, "
                    ".ply, .obj, .stl (NAME_0000.png); may be repeated.");
    options.file("--keys", "FILE", flags->keys,
                 "File of keys, one per line: seconds, an optional easing, a colon and edits, as in 2 out: "
                 "bend near(0,0,3) 20.");
    options.files("--key", "KEY", flags->more_keys,
                  "One key as text, added after those of --keys; may be repeated.");
    options.may_replace("--output", "tree");  // frames have numbered files
    options.flag("--grow", flags->how.grow,
                 "Let the tree grow from its root, with a new surface in every frame.");
    options.fields(flags->how.run, "Time");
    options.fields(flags->how.growing, "Growth", {.prefix = "grow"});
    options.fields(flags->how.wind, "Wind", {.prefix = "wind"});
    options.fields(flags->how.mesh, "Surface", surface_flag_names(MemberNames{}));
    options.fields(flags->how.mesh.texture, "Texture", {.common = MemberNames{}});
    add_material_options(options, flags->materials, {.common = false});
    options.fields(flags->how.mesh.slots, "Texture", {.common = MemberNames{}});
    options.fields(flags->how.picture, "Picture",
                   {.common = MemberNames{"width", "height", "azimuth", "elevation"}});
    options.fields(flags->read, "Reading the skeleton", {.common = MemberNames{}});
    return {"animate", "Animate a tree by keys, wind or growth.", options,
            [flags](Run& run, const GivenOptions& given) { return animate(run, given, *flags); }};
}

}  // namespace coppice::cli
