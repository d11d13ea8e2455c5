#include <fmt/format.h>

#include "command.h"
#include "coppice/measure/surface_report.h"
#include "figures.h"
#include "files.h"
#include "messages.h"
#include "options.h"

namespace coppice::cli {
namespace {

struct CheckFlags {
    std::filesystem::path mesh, skeleton;
    bool json = false;
    CheckOptions check;
    ReadSkeletonOptions read;
};

std::string torn_off(const TreePartsReport& parts, const CheckFlags& flags) {
    return fmt::format(
        "'{}' is in {} parts, {} too many for the trees of '{}' ({}); the largest is torn off at node {}",
        flags.mesh.string(), grouped(parts.parts), grouped(parts.loose), flags.skeleton.string(),
        grouped(parts.trees), parts.largest.front().node.index());
}

ExitCode check(Run& run, const CheckFlags& flags) {
    if (flags.mesh.empty()) throw UsageError("name the mesh: coppice check MESH [--skeleton SKELETON]");
    const PolygonMesh mesh = load_mesh(run, flags.mesh);
    std::optional<SkeletonFile> skeleton;
    if (!flags.skeleton.empty()) skeleton = load_skeleton(run, flags.skeleton, flags.read);
    const SurfaceReport report = run.stage("check", [&](const Context& ctx) {
        return check_surface(mesh, skeleton ? &skeleton->skeleton : nullptr, flags.check, ctx);
    });
    const Figures figures = figures_of(report);
    fmt::print("{}", flags.json ? figures_json(figures) : figures_text(figures));
    run.counts()["figures"] = figures;
    run.finish(fmt::format("{}: {} faces, {}", flags.mesh.string(), grouped(mesh.face_count()),
                           report.sound() ? "sound" : "not sound"));
    if (!report.covers_skeleton()) {
        say(fmt::format(
            "{} of {} segments of '{}' are missing in '{}'; are both in the same units and place?",
            grouped(report.coverage->missing), grouped(report.coverage->judged), flags.skeleton.string(),
            flags.mesh.string()));
    } else if (!report.is_whole()) {
        say(torn_off(*report.parts, flags));
    } else if (!report.holds_volume()) {
        say(fmt::format("{:.3g} % of the volume of '{}' is missing in '{}', most of it at node {}",
                        report.volume->missing_percent(), flags.skeleton.string(), flags.mesh.string(),
                        report.volume->lumps.front().node.index()));
    }
    const bool good =
        report.sound() && report.covers_skeleton() && report.is_whole() && report.holds_volume();
    return good ? kDone : kCheckFailed;
}

}  // namespace

Command check_command() {
    const auto flags = std::make_shared<CheckFlags>();
    OptionList options;
    options.file("mesh", "MESH", flags->mesh, "mesh to judge (.obj, .ply, .off, .stl, .glb)");
    options.file("-s,--skeleton", "FILE", flags->skeleton, "skeleton to hold its radii against");
    options.flag("--json", flags->json, "print JSON instead of a table");
    options.fields(flags->check, "Checks");
    options.fields(flags->read, "Reading the skeleton");
    return {"check",
            "Judge a mesh: watertight, manifold, self-intersections, shape, radii; exit code 1 when it is "
            "not sound",
            options, [flags](Run& run, const GivenOptions&) { return check(run, *flags); }};
}

}  // namespace coppice::cli
