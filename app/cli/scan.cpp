#include "coppice/render/scan.h"

#include <fmt/format.h>

#include "command.h"
#include "coppice/io/points/writer.h"
#include "coppice/mesh/topology.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {
namespace {

struct ScanFlags {
    std::filesystem::path mesh, output;
    ScanOptions scan;
};

ExitCode scan_file(Run& run, const ScanFlags& flags) {
    if (flags.mesh.empty() || flags.output.empty())
        throw UsageError("name the mesh and the points: coppice scan MESH -o POINTS");
    check_points_output(flags.output);
    const PolygonMesh mesh = load_mesh(run, flags.mesh);
    const PointSet points = run.stage("scan", [&](const Context& ctx) {
        validate(mesh);
        return scan(mesh, flags.scan, ctx);
    });
    run.stage("write", [&](const Context& ctx) { write_points(flags.output, points, ctx); });
    run.counts()["points"] = points.size();
    run.finish(fmt::format("{}: {} points", flags.output.string(), grouped(points.size())));
    return kDone;
}

}  // namespace

Command scan_command(CLI::App& app) {
    auto [command, flags] =
        new_command<ScanFlags>(app, "scan", "Make the points that a laser scanner would see of a mesh");
    command.app->add_option("mesh", flags->mesh, "mesh to look at")->type_name("MESH");
    command.app->add_option("-o,--output", flags->output, "points to write; the ending tells the format")
        ->type_name("POINTS");
    add_options(*command.app, flags->scan, "Scan");
    command.run = [flags = flags](Run& run) { return scan_file(run, *flags); };
    return command;
}

}  // namespace coppice::cli
