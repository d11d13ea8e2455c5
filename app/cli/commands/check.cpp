#include <fmt/format.h>

#include "command.h"
#include "coppice/io_points/writer.h"
#include "coppice/measure/match/cloud_distance.h"
#include "coppice/measure/surface_report.h"
#include "coppice/render/colors.h"
#include "coppice/system/file.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

constexpr const char* kCloudGroup = "Measuring points";

struct CheckFlags {
    std::filesystem::path mesh, output, skeleton, cloud, distances;
    bool json = false;
    CheckOptions check;
    CloudDistanceOptions cloud_options;
    ReadSkeletonOptions read;
    ReadPointsOptions read_points;
};

std::string torn_off(const TreeComponentsReport& parts, const CheckFlags& flags) {
    return fmt::format(
        "'{}' has {} components, {} too many for the trees of '{}' ({}); the largest is torn off at node {}",
        flags.mesh.string(), grouped(parts.parts), grouped(parts.loose), flags.skeleton.string(),
        grouped(parts.trees), parts.largest.front().node.index());
}

std::string name_of(const CrossingPlace& place) {
    if (!place.node)
        return fmt::format("({:.6g}, {:.6g}, {:.6g})", place.place.x, place.place.y, place.place.z);
    if (place.node == place.other_node) return fmt::format("node {}", place.node.index());
    return fmt::format("nodes {} and {}", place.node.index(), place.other_node.index());
}

std::string crosses_itself(const SurfaceReport& report, const CheckFlags& flags) {
    constexpr std::size_t kMaxListed = 3;
    const CrossingPlaces& places = *report.crossing_places;
    std::string text =
        fmt::format("'{}' intersects itself at {} place{}{}", flags.mesh.string(), grouped(places.total),
                    places.total == 1 ? "" : "s", report.intersections->complete ? "" : " or more");
    const std::size_t listed = std::min(kMaxListed, places.largest.size());
    for (std::size_t k = 0; k < listed; ++k) {
        const CrossingPlace& place = places.largest[k];
        text += fmt::format("{} {} ({}{})", k == 0 ? ":" : ",", name_of(place), grouped(place.pairs),
                            k > 0              ? ""
                            : place.pairs == 1 ? " pair of faces"
                                               : " pairs of faces");
    }
    if (listed > 0 && listed < places.total)
        text += fmt::format(", and {} more", grouped(places.total - listed));
    return text;
}

std::string missing_segments(const AxesReport& axes, const CheckFlags& flags) {
    return fmt::format("{} of {} segments of '{}' are missing in '{}'; are both in the same units and place?",
                       grouped(axes.missing), grouped(axes.segments), flags.skeleton.string(),
                       flags.mesh.string());
}

std::string wrong_volume(const VolumeReport& volume, const CheckFlags& flags) {
    if (volume.complete())
        return fmt::format("'{}' has {:.1f} % of the volume of '{}'", flags.mesh.string(),
                           100 * volume.ratio(), flags.skeleton.string());
    return fmt::format("{:.3g} % of the volume of '{}' is missing in '{}', most of it at node {}",
                       volume.missing_percent(), flags.skeleton.string(), flags.mesh.string(),
                       volume.lumps.front().node.index());
}

std::string additional_handles(const HandlesReport& handles, const CheckFlags& flags) {
    return fmt::format("'{}' has {} handle{}, the branches of '{}' make {}", flags.mesh.string(),
                       grouped(handles.surface), handles.surface == 1 ? "" : "s", flags.skeleton.string(),
                       grouped(handles.cones));
}

/// Returns one sentence for each defect. If most segments are missing, no other defect of the skeleton is
/// reported.
std::vector<std::string> all_faults(const SurfaceReport& report, const CheckFlags& flags) {
    std::vector<std::string> out;
    if (report.crossing_places && report.crossing_places->total > 0)
        out.push_back(crosses_itself(report, flags));
    if (!report.axes) return out;
    if (report.shape.signed_volume < 0) {
        out.push_back(fmt::format("'{}' is inside out: its faces look inward", flags.mesh.string()));
        return out;
    }
    if (!report.covers_skeleton()) {
        out.push_back(missing_segments(*report.axes, flags));
        return out;
    }
    if (!report.is_whole()) out.push_back(torn_off(*report.parts, flags));
    for (std::string& fault : find_faults(*report.axes)) out.push_back(std::move(fault));
    if (report.handles && report.handles->surface > report.handles->cones)
        out.push_back(additional_handles(*report.handles, flags));
    if (!report.holds_volume()) out.push_back(wrong_volume(*report.volume, flags));
    return out;
}

std::string_view format_verdict(const SurfaceReport& report) {
    if (!report.sound()) return "not sound";
    return report.intersections ? "sound" : "watertight, crossings not checked";
}

/// Throws UsageError for options that have no effect without points.
void check_cloud_options(const GivenOptions& given, const CheckFlags& flags) {
    if (!flags.cloud.empty()) return;
    if (const Option* option = first_of_groups(given, {kCloudGroup}))
        throw UsageError(fmt::format("{} requires points: coppice check MESH --cloud POINTS", option->name));
}

/// Measures the cloud; writes it with its distances if requested.
CloudDistanceReport measure_cloud(Run& run, const PolygonMesh& mesh, PointSet cloud, const Skeleton* skeleton,
                                  const CheckFlags& flags) {
    CloudDistances found = run.stage("distances", [&](const Context& ctx) {
        return cloud_distances(mesh, cloud, skeleton, flags.cloud_options, ctx);
    });
    if (!flags.distances.empty()) {
        run.stage("write", [&](const Context& ctx) {
            const float range = usual_range(found.of_points);
            PointCloud point_cloud{std::move(cloud), {}, distance_colors(found.of_points, range)};
            point_cloud.distances = std::move(found.of_points);
            const std::string note =
                fmt::format("distance in metres: blue inside, red outside, full at {:.4g}", range);
            write_point_cloud(flags.distances, point_cloud, {.note = note}, ctx);
            run.counts()["full_color_m"] = range;
        });
    }
    return found.report;
}

ExitCode check(Run& run, const GivenOptions& given, const CheckFlags& flags) {
    if (flags.mesh.empty())
        throw UsageError("name the mesh: coppice check MESH [--skeleton SKELETON] [--cloud POINTS]");
    check_cloud_options(given, flags);
    if (!flags.distances.empty()) check_cloud_output(flags.distances);
    if (!flags.output.empty()) check_output_folder(flags.output);
    const PolygonMesh mesh = load_mesh(run, flags.mesh, flags.read.up);
    std::optional<SkeletonFile> skeleton;
    if (!flags.skeleton.empty()) skeleton = load_skeleton(run, flags.skeleton, flags.read);
    std::optional<PointSet> cloud;
    if (!flags.cloud.empty()) cloud = load_points(run, flags.cloud, flags.read.up, flags.read_points);
    const Skeleton* nodes = skeleton ? &skeleton->skeleton : nullptr;
    const SurfaceReport report =
        run.stage("check", [&](const Context& ctx) { return check_surface(mesh, nodes, flags.check, ctx); });
    Json figures;
    if (skeleton) figures["units"] = name_of(skeleton->units);
    figures["sound"] = nullptr;  // unless the report contains it
    figures.update(compute_figures(report));
    if (cloud) figures.update(compute_figures(measure_cloud(run, mesh, std::move(*cloud), nodes, flags)));
    run.print(flags.json ? figures_json(figures) : figures_text(figures, "unknown: crossings not checked"));
    if (!flags.output.empty()) write_file(flags.output, figures_json(figures));
    run.counts()["figures"] = figures;
    run.finish(fmt::format("{}: {} faces, {}", flags.mesh.string(), grouped(mesh.face_count()),
                           format_verdict(report)));
    for (const std::string& fault : all_faults(report, flags)) run.say(fault);
    return report.passes() ? kDone : kCheckFailed;
}

}  // namespace

Command check_command() {
    const auto flags = std::make_shared<CheckFlags>();
    OptionList options;
    options.file("mesh", "MESH", flags->mesh, "Mesh to check (.obj, .ply, .off, .stl, .glb).");
    options.file("-s,--skeleton", "FILE", flags->skeleton,
                 "Skeleton to compare the radii and the volume with.");
    options.file("--cloud", "POINTS", flags->cloud,
                 "Points to compare the mesh with, in both directions (.ply, .las, .laz, .xyz, .pcd).");
    options.output("-o,--output", "JSON", flags->output, "Also write the figures to this file as JSON.",
                   {.common = false});
    options.flag("--json", flags->json, "Print JSON instead of a table.");
    options.fields(flags->check, "Checks");
    options.output("--distances", "PLY", flags->distances,
                   "Also write the points with their distances from the mesh as values and colours.",
                   {.group = kCloudGroup});
    options.fields(flags->cloud_options, kCloudGroup, {.prefix = "cloud"});
    options.fields(flags->read, "Reading the skeleton");
    options.fields(flags->read_points, kReadPointsGroup);
    return {"check",
            "Check a mesh: watertight, manifold, self-intersections, face shape, radii, volume, branches and "
            "tips; exit code 1 reports a defect.",
            options, [flags](Run& run, const GivenOptions& given) { return check(run, given, *flags); },
            ManyFiles{check_command, "mesh", ".json", {FileKind::mesh}}};
}

}  // namespace coppice::cli
