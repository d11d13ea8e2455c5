#include <fmt/format.h>

#include "command.h"
#include "coppice/measure/surface_report.h"
#include "figures.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {
namespace {

struct CheckFlags {
    std::filesystem::path mesh, skeleton;
    bool json = false;
    CheckOptions check;
    ReadSkeletonOptions read;
};

ExitCode check(Run& run, const CheckFlags& flags) {
    if (flags.mesh.empty()) throw UsageError("name the mesh: coppice check MESH [--skeleton SKELETON]");
    const PolygonMesh mesh = load_mesh(run, flags.mesh);
    std::optional<SkeletonFile> skeleton;
    if (!flags.skeleton.empty()) skeleton = load_skeleton(run, flags.skeleton, flags.read);
    const SurfaceReport report = run.stage("check", [&](const Context& ctx) {
        return check_surface(mesh, skeleton ? &skeleton->skeleton : nullptr, flags.check, ctx);
    });
    const Json figures = figures_json(report);
    fmt::print("{}", flags.json ? figures.dump(2) + "\n" : figures_text(figures));
    run.counts()["figures"] = figures;
    run.finish(fmt::format("{}: {} faces, {}", flags.mesh.string(), grouped(mesh.face_count()),
                           report.sound() ? "sound" : "not sound"));
    return report.sound() ? kDone : kCheckFailed;
}

}  // namespace

Command check_command(CLI::App& app) {
    auto [command, flags] = new_command<CheckFlags>(
        app, "check",
        "Judge a mesh: closed, manifold, crossing faces, shape, radii; exit code 1 when it is not sound");
    command.app->add_option("mesh", flags->mesh, "mesh to judge (.obj, .ply, .off, .stl, .glb)")
        ->type_name("MESH");
    command.app->add_option("--skeleton,-s", flags->skeleton, "skeleton to hold its radii against")
        ->type_name("FILE");
    command.app->add_flag("--json", flags->json, "print JSON instead of a table");
    add_options(*command.app, flags->check, "Checks");
    add_options(*command.app, flags->read, "Reading the skeleton");
    command.run = [flags = flags](Run& run) { return check(run, *flags); };
    return command;
}

}  // namespace coppice::cli
