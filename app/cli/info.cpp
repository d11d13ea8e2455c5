#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "clouds.h"
#include "command.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
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

Json numbers(Vec3d v) { return {v.x, v.y, v.z}; }

void add_size(Json& out, const Box3& box, Vec3d origin) {
    out["size_m"] = numbers(Vec3d(box.size()));
    out["low_m"] = numbers(Vec3d(box.low) + origin);
    out["high_m"] = numbers(Vec3d(box.high) + origin);
}

/// Of the truncated cone along a segment; the balls at its ends are not counted.
double cone_volume(const Segment& s) {
    const double a = s.radius_a, b = s.radius_b;
    return std::numbers::pi / 3 * distance(Vec3d(s.a), Vec3d(s.b)) * (a * a + a * b + b * b);
}

Json describe(const SkeletonFile& file) {
    const Skeleton& s = file.skeleton;
    std::uint64_t tips = 0, forks = 0;
    double length = 0, volume = 0;
    for (const NodeId n : nodes(s)) {
        const std::size_t children = s.children(n).size();
        tips += children == 0 ? 1 : 0;
        forks += children > 1 ? 1 : 0;
        if (s.is_root(n)) continue;
        const Segment g = s.segment(n);
        length += distance(Vec3d(g.a), Vec3d(g.b));
        volume += cone_volume(g);
    }
    const auto [thinnest, thickest] = std::ranges::minmax(s.radii());
    Json out{{"kind", "skeleton"},
             {"format", file.format},
             {"trees", s.tree_count()},
             {"nodes", s.size()},
             {"segments", s.size() - s.tree_count()},
             {"tips", tips},
             {"branch_nodes", forks},
             {"length_m", length},
             {"volume_m3", volume},
             {"radius_min_m", shortest(thinnest)},
             {"radius_max_m", shortest(thickest)}};
    add_size(out, s.bounds(), s.origin());
    out["repairs"] = file.report.total();
    const Json repairs = repairs_of(file.report);
    for (const auto& [name, count] : repairs.items()) {
        if (count != 0) out["repairs_" + name] = count;
    }
    if (!file.notes.empty()) out["notes"] = file.notes;
    return out;
}

Json describe(const PolygonMesh& mesh, const Context& ctx) {
    validate(mesh);
    const TopologyReport t = topology(mesh, ctx);
    const ShapeReport s = shape(mesh, ctx);
    Box3 box;
    for (const std::uint32_t v : mesh.corners) box.extend(mesh.positions[v]);
    Json out{{"kind", "mesh"},     {"vertices", t.vertices},     {"faces", t.faces},
             {"quads", t.quads},   {"components", t.components}, {"euler", t.euler},
             {"sound", t.sound()}, {"area_m2", s.area},          {"volume_m3", s.signed_volume}};
    if (!box.empty()) add_size(out, box, mesh.origin);
    return out;
}

Json describe(const PointSet& points, const Context& ctx) {
    Json out{{"kind", "points"}, {"points", points.size()}, {"spacing_m", median_spacing(points, ctx)}};
    add_size(out, bounds(points), points.origin);
    return out;
}

ExitCode info(Run& run, const InfoFlags& flags) {
    if (flags.file.empty()) throw UsageError("name the file: coppice info FILE");
    Json figures;
    const FileKind kind = kind_of_input(flags.file);
    if (kind == FileKind::skeleton) {
        figures = describe(load_skeleton(run, flags.file, flags.read));
    } else if (kind == FileKind::points) {
        const PointSet points = load_points(run, flags.file);
        figures = run.stage("measure", [&](const Context& ctx) { return describe(points, ctx); });
    } else {
        const PolygonMesh mesh = load_mesh(run, flags.file);
        figures = run.stage("measure", [&](const Context& ctx) { return describe(mesh, ctx); });
    }
    fmt::print("{}", flags.json ? figures.dump(2) + "\n" : figures_text(figures));
    run.finish(flags.file.string() + " read");
    return kDone;
}

}  // namespace

Command info_command(CLI::App& app) {
    auto [command, flags] =
        new_command<InfoFlags>(app, "info", "Say what a file of a skeleton, a mesh or points holds");
    command.app->add_option("file", flags->file, "skeleton, mesh or points")->type_name("FILE");
    command.app->add_flag("--json", flags->json, "print JSON instead of a table");
    add_options(*command.app, flags->read, "Reading a skeleton");
    command.run = [flags = flags](Run& run) { return info(run, *flags); };
    return command;
}

}  // namespace coppice::cli
