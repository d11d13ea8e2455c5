#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/render/png.h"
#include "coppice/view/edit_demo.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "pictures.h"
#include "streams.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct ViewFlags {
    std::filesystem::path tree, output, sheet;
    bool edit_demo = false;
    EditDemoOptions demo;
    ViewOptions view;
    MeshOptions mesh;
    ReadSkeletonOptions read;
};

void check_flags(const ViewFlags& flags, const GivenOptions& given) {
    if (flags.tree.empty() || (flags.output.empty() && !flags.edit_demo))
        throw UsageError(
            "name the tree and the image: coppice view TREE -o PNG, or coppice view TREE --edit-demo");
    check_picture_output(flags.output);
    check_picture_output(flags.sheet);
    if (flags.edit_demo) return;
    for (const Option* o : given) {
        if (o->name == "--sheet" || o->group == "Dragging")
            throw UsageError(fmt::format("{} applies to the dragging of a branch; add --edit-demo", o->name));
    }
}

/// Returns the median and the 95 % quantile of the times of frames and their steps.
Json to_milliseconds(const FrameTimes& times) {
    Json out;
    visit_figures(times, [&](std::string_view name, const Statistics& s) {
        out[fmt::format("{}_ms", name)] = {{"median", 1e3 * s.p50}, {"p95", 1e3 * s.p95}};
    });
    return out;
}

ExitCode drag_branch(Run& run, const ViewFlags& flags, const Skeleton& tree) {
    const QuadBuild build =
        run.stage("mesh", [&](const Context& ctx) { return build_quads(tree, flags.mesh, ctx); });
    const auto backend = surface_backend(flags.mesh.device);
    const EditDemoResult result = run.stage("frames", [&](const Context& ctx) {
        return edit_demo(build, flags.demo, flags.view, *backend, ctx);
    });
    run.stage("write", [&](const Context&) {
        if (!flags.output.empty()) write_picture(flags.output, result.pictures.back());
        if (!flags.sheet.empty()) write_sheet(flags.sheet, result.pictures);
    });
    if (!result.note.empty()) run.warn(result.note);
    Json figures = compute_figures(result);
    run.counts().update(figures);
    run.counts()["seconds"] = compute_figures(result.seconds);
    figures.update(to_milliseconds(result.seconds));
    print(figures_text(figures));
    run.finish(fmt::format("{}: {} frames of a branch of {} segments, {:.1f} per second", flags.tree.string(),
                           grouped(result.frames), grouped(result.segments), result.frames_per_second));
    return kDone;
}

ExitCode draw_once(Run& run, const ViewFlags& flags, const Skeleton& tree) {
    const MeshResult made =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(tree, flags.mesh, ctx); });
    const ViewResult result =
        run.stage("draw", [&](const Context&) { return view_surface(to_polygons(made), flags.view); });
    run.stage("write", [&](const Context&) { write_picture(flags.output, result.picture); });
    tell_device(run, made);
    run.counts().update(
        {{"renderer", result.renderer}, {"opengl", result.opengl}, {"pixels", result.picture.pixels.size()}});
    run.finish(fmt::format("{}: {} x {} pixels by {}", flags.output.string(), result.picture.width,
                           result.picture.height, result.renderer));
    return kDone;
}

ExitCode view(Run& run, const GivenOptions& given, const ViewFlags& flags) {
    check_flags(flags, given);
    const SkeletonFile file = load_skeleton(run, flags.tree, flags.read);
    return flags.edit_demo ? drag_branch(run, flags, file.skeleton) : draw_once(run, flags, file.skeleton);
}

}  // namespace

Command view_command() {
    const auto flags = std::make_shared<ViewFlags>();
    OptionList options;
    options.file("tree", "TREE", flags->tree, "Skeleton with the surface to draw.");
    options.output("-o,--output", "PNG", flags->output,
                   "Image to write (.png); with --edit-demo that of the last frame.");
    options.flag(
        "--edit-demo", flags->edit_demo,
        "Drag a branch back and forth, compute the surface in every frame, and print the time per frame.");
    options.output("--sheet", "PNG", flags->sheet, "Also write four frames of --edit-demo on one sheet.",
                   {.common = false});
    options.fields(flags->demo, "Dragging");
    options.fields(flags->view, "Picture");
    options.fields(flags->mesh, "Surface", surface_flag_names(MemberNames{"method", "levels"}));
    options.fields(flags->read, "Reading the skeleton");
    return {"view",
            "Draw the surface of a tree by OpenGL without a window, or time the dragging of a branch.",
            options, [flags](Run& run, const GivenOptions& given) { return view(run, given, *flags); }};
}

}  // namespace coppice::cli
