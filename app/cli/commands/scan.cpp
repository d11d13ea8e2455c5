#include "coppice/render/scan.h"

#include <fmt/format.h>

#include "command.h"
#include "coppice/io_points/writer.h"
#include "coppice/mesh/topology.h"
#include "files.h"
#include "options.h"
#include "results.h"

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
    run.stage("write", [&](const Context& ctx) {
        store_points(run, flags.output, PointCloud{points, {}, {}}, {}, ctx);
    });
    run.counts()["points"] = points.size();
    run.finish(fmt::format("{}: {} points", flags.output.string(), grouped(points.size())));
    return kDone;
}

}  // namespace

Command scan_command() {
    const auto flags = std::make_shared<ScanFlags>();
    OptionList options;
    options.file("mesh", "MESH", flags->mesh, "Mesh to scan.");
    options.output("-o,--output", "POINTS", flags->output,
                   "Points to write; the extension selects the format.");
    options.fields(flags->scan, "Scan");
    return {"scan", "Simulate a laser scan of a mesh.", options,
            [flags](Run& run, const GivenOptions&) { return scan_file(run, *flags); }};
}

}  // namespace coppice::cli
