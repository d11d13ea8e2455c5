#include <fmt/format.h>

#include "command.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/view/view_surface.h"
#include "files.h"
#include "options.h"
#include "pictures.h"
#include "results.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct ViewFlags {
    std::filesystem::path tree, output;
    ViewOptions view;
    MeshOptions mesh;
    ReadSkeletonOptions read;
};

ExitCode view(Run& run, const ViewFlags& flags) {
    if (flags.tree.empty() || flags.output.empty())
        throw UsageError("name the tree and the image: coppice view TREE -o PNG");
    check_picture_output(flags.output);
    const SkeletonFile file = load_skeleton(run, flags.tree, flags.read);
    const MeshResult made =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(file.skeleton, flags.mesh, ctx); });
    const ViewResult result =
        run.stage("draw", [&](const Context&) { return view_surface(to_polygons(made), flags.view); });
    run.stage("write", [&](const Context&) { store_picture(run, flags.output, result.picture); });
    tell_device(run, made);
    run.counts().update(
        {{"renderer", result.renderer}, {"opengl", result.opengl}, {"pixels", result.picture.pixels.size()}});
    run.finish(fmt::format("{}: {} x {} pixels by {}", flags.output.string(), result.picture.width,
                           result.picture.height, result.renderer));
    return kDone;
}

}  // namespace

Command view_command() {
    const auto flags = std::make_shared<ViewFlags>();
    OptionList options;
    options.file("tree", "TREE", flags->tree, "Skeleton with the surface to draw.");
    options.output("-o,--output", "PNG", flags->output, "Image to write (.png).");
    options.fields(flags->view, "Picture");
    options.fields(flags->mesh, "Surface", surface_flag_names(MemberNames{"method", "levels"}));
    options.fields(flags->read, "Reading the skeleton");
    return {"view", "Draw the surface of a tree by OpenGL without a window.", options,
            [flags](Run& run, const GivenOptions&) { return view(run, *flags); }};
}

}  // namespace coppice::cli
