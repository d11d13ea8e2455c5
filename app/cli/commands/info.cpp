#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/json.h"
#include "coppice/points/spacing.h"
#include "coppice/skeleton/measure.h"
#include "figures.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {
namespace {

struct InfoFlags {
    std::filesystem::path file;
    bool json = false;
    ReadSkeletonOptions read;
};

Figure::List numbers(Vec3d v) { return {v.x, v.y, v.z}; }

void add_size(Figures& out, const Box3& box, Vec3d origin) {
    out["size_m"] = numbers(Vec3d(box.size()));
    out["low_m"] = numbers(Vec3d(box.low) + origin);
    out["high_m"] = numbers(Vec3d(box.high) + origin);
}

Figures describe(const SkeletonFile& file) {
    const Skeleton& s = file.skeleton;
    const SkeletonMeasures m = measure(s);
    const auto [thinnest, thickest] = std::ranges::minmax(s.radii());
    Figures out;
    out["kind"] = "skeleton";
    out["format"] = file.format;
    out["trees"] = m.trees;
    out["nodes"] = m.nodes;
    out["segments"] = m.segments;
    out["tips"] = m.tips;
    out["branch_nodes"] = m.branch_nodes;
    out["length_m"] = m.length;
    out["volume_m3"] = m.volume;
    out["radius_min_m"] = shortest(thinnest);
    out["radius_max_m"] = shortest(thickest);
    add_size(out, s.bounds(), s.origin());
    out["repairs"] = file.report.total();
    const Figures repairs = repairs_of(file.report);
    for (const auto& [name, count] : repairs.entries())
        if (std::get<std::uint64_t>(count.value) != 0) out["repairs_" + name] = count;
    const Figures joints = joints_of(file.report);
    for (const auto& [name, count] : joints.entries())
        if (std::get<std::uint64_t>(count.value) != 0) out[name] = count;
    if (!file.notes.empty()) out["notes"] = Figure::List(file.notes.begin(), file.notes.end());
    return out;
}

Figures describe(const PolygonMesh& mesh, const Context& ctx) {
    validate(mesh);
    const TopologyReport t = topology(mesh, ctx);
    const ShapeReport s = shape(mesh, ctx);
    Box3 box;
    for (const std::uint32_t v : mesh.corners) box.extend(mesh.positions[v]);
    Figures out;
    out["kind"] = "mesh";
    out["vertices"] = t.vertices;
    out["faces"] = t.faces;
    out["quads"] = t.quads;
    out["components"] = t.components;
    out["euler"] = t.euler;
    out["sound"] = t.sound();
    out["area_m2"] = s.area;
    out["volume_m3"] = s.signed_volume;
    if (!box.empty()) add_size(out, box, mesh.origin);
    return out;
}

Figures describe(const PointSet& points, const Context& ctx) {
    Figures out;
    out["kind"] = "points";
    out["points"] = points.size();
    out["spacing_m"] = median_spacing(points, ctx);
    add_size(out, bounds(points), points.origin);
    return out;
}

ExitCode info(Run& run, const InfoFlags& flags) {
    if (flags.file.empty()) throw UsageError("name the file: coppice info FILE");
    Figures figures;
    const FileKind kind = kind_of_input(flags.file, flags.read.format);
    if (kind == FileKind::skeleton) {
        figures = describe(load_skeleton(run, flags.file, flags.read));
    } else if (kind == FileKind::points) {
        const PointSet points = load_points(run, flags.file);
        figures = run.stage("measure", [&](const Context& ctx) { return describe(points, ctx); });
    } else {
        const PolygonMesh mesh = load_mesh(run, flags.file);
        figures = run.stage("measure", [&](const Context& ctx) { return describe(mesh, ctx); });
    }
    fmt::print("{}", flags.json ? figures_json(figures) : figures_text(figures));
    run.finish(flags.file.string() + " read");
    return kDone;
}

}  // namespace

Command info_command() {
    const auto flags = std::make_shared<InfoFlags>();
    OptionList options;
    options.file("file", "FILE", flags->file, "skeleton, mesh or points");
    options.flag("--json", flags->json, "print JSON instead of a table");
    options.fields(flags->read, "Reading a skeleton");
    return {"info", "Say what a file of a skeleton, a mesh or points holds", options,
            [flags](Run& run, const GivenOptions&) { return info(run, *flags); }};
}

}  // namespace coppice::cli
