#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "command.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/io/points/writer.h"
#include "coppice/io/skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/measure.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

constexpr const char* kMeshGroup = "From a mesh";
constexpr const char* kCloudGroup = "From a cloud of points";

struct ExtractFlags {
    std::filesystem::path input, output, mesh_output, leaf_output;
    FromMeshOptions from_mesh;
    CloudOptions from_cloud;
    WriteSkeletonOptions write;
    MeshOptions mesh;
};

void check_flags(ExtractFlags& flags) {
    if (flags.input.empty() || flags.output.empty())
        throw UsageError("name both files: coppice extract FILE -o SKELETON");
    if (flags.write.format == SkeletonFormat::automatic &&
        kind_to_write(flags.output, FileKind::skeleton) != FileKind::skeleton) {
        throw UsageError(
            fmt::format("'{}' is the name of a mesh; name the skeleton, and the mesh with --then-mesh",
                        flags.output.string()));
    }
    check_output_folder(flags.output);
    if (!flags.mesh_output.empty()) check_mesh_output(flags.mesh_output);
    if (!flags.leaf_output.empty()) check_points_output(flags.leaf_output);
    flags.from_cloud.root = flags.from_mesh.root;
}

Figure::List figures_of_orders(const std::vector<BranchOrder>& orders) {
    Figure::List out;
    for (std::size_t o = 0; o < orders.size(); ++o) {
        Figures figures;
        figures["order"] = o;
        figures["branches"] = orders[o].branches;
        figures["length_m"] = orders[o].length;
        out.emplace_back(figures);
    }
    return out;
}

/// The figures that meshes and clouds have in common.
void fill_report(Run& run, const ExtractResult& result) {
    const SkeletonMeasures m = measure(result.skeleton);
    Figures& counts = run.counts();
    counts.append(figures_of(result.report));
    counts["nodes"] = m.nodes;
    counts["tips"] = m.tips;
    counts["branch_nodes"] = m.branch_nodes;
    counts["length_m"] = m.length;
    counts["volume_m3"] = m.volume;
    counts["orders"] = figures_of_orders(branch_orders(result.skeleton));
}

/// Runs extract(context); what it refuses is told with the name of the file.
template <class Extract>
auto extract_stage(Run& run, const std::filesystem::path& input, const Extract& extract) {
    return run.stage("extract", [&](const Context& ctx) {
        try {
            return extract(ctx);
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("{}: {}", input.string(), error.what()));
        }
    });
}

ExtractResult from_mesh(Run& run, const ExtractFlags& flags, std::string& summary) {
    const PolygonMesh mesh = load_mesh(run, flags.input);
    FromMeshResult result = extract_stage(
        run, flags.input, [&](const Context& ctx) { return extract_from_mesh(mesh, flags.from_mesh, ctx); });
    for (const auto& [name, seconds] : result.stages)
        run.add_stage(fmt::format("extract: {}", name), seconds);
    run.repairs() = figures_of(result.repairs);
    summary = fmt::format(", {} loops cut", grouped(result.report.loops));
    return result;
}

/// What the summary says of leaves: they are the points that a user misses first.
std::string leaves_left_out(const CloudReport& cleaning) {
    if (cleaning.leaves == 0) return "";
    return fmt::format(", {} of {} points left out as leaves", grouped(cleaning.leaves),
                       grouped(cleaning.points));
}

ExtractResult from_cloud(Run& run, const ExtractFlags& flags, std::string& summary) {
    const PointSet points = load_points(run, flags.input);
    CloudExtraction result = extract_stage(run, flags.input, [&](const Context& ctx) {
        return extract_from_cloud(points, flags.from_cloud, ctx);
    });
    run.repairs() = figures_of(result.cleaning);
    summary = leaves_left_out(result.cleaning);
    if (!flags.leaf_output.empty() && !result.leaves.empty()) {
        run.stage("write leaves",
                  [&](const Context& ctx) { write_points(flags.leaf_output, result.leaves, ctx); });
    }
    return result;
}

/// An option for the other kind of input would do nothing.
void check_groups(const GivenOptions& given, const std::filesystem::path& input, FileKind kind) {
    const bool cloud = kind == FileKind::points;
    for (const Option* option : given) {
        if (option->group != (cloud ? kMeshGroup : kCloudGroup)) continue;
        throw UsageError(fmt::format("{} is for {}, and '{}' is a {}", option->name,
                                     cloud ? "meshes" : "clouds of points", input.string(),
                                     cloud ? "cloud of points" : "mesh"));
    }
}

void write(Run& run, const ExtractFlags& flags, const ExtractResult& result) {
    std::array<NodeAttribute, 2> attributes{{{"samples", {}}, {"residual", {}}}};
    for (const NodeConfidence& c : result.confidence) {
        attributes[0].values.push_back(static_cast<float>(c.samples));
        attributes[1].values.push_back(c.residual);
    }
    run.stage("write", [&](const Context&) {
        write_skeleton(flags.output, result.skeleton, flags.write, attributes);
    });
}

ExitCode extract(Run& run, const GivenOptions& given, ExtractFlags& flags) {
    check_flags(flags);
    const FileKind kind = kind_of_input(flags.input);
    if (kind == FileKind::skeleton) {
        throw UsageError(fmt::format("'{}' is a skeleton already; a mesh or a cloud of points is needed",
                                     flags.input.string()));
    }
    check_groups(given, flags.input, kind);
    const auto is_height = [](const Option* option) { return option->name == "--ground-height"; };
    if (std::ranges::any_of(given, is_height) && flags.from_cloud.ground != GroundRule::height)
        throw UsageError("--ground-height is for the rule of that name; add --ground height");
    std::string found;
    const ExtractResult result =
        kind == FileKind::mesh ? from_mesh(run, flags, found) : from_cloud(run, flags, found);
    write(run, flags, result);
    fill_report(run, result);
    const std::string surface = then_mesh(run, flags.mesh_output, result.skeleton, flags.mesh);
    run.finish(fmt::format("{}: {} nodes in {} trees{}{}", flags.output.string(),
                           grouped(result.skeleton.size()), grouped(result.report.trees), found, surface));
    return kDone;
}

}  // namespace

Command extract_command() {
    const auto flags = std::make_shared<ExtractFlags>();
    OptionList options;
    options.file(
        "input", "FILE", flags->input,
        "mesh (.ply, .obj, .off, .stl, .glb) or points (.xyz, .txt, .asc, .csv, .ply, .pcd, .las, .laz)");
    options.file("-o,--output", "SKELETON", flags->output, "skeleton to write; its ending tells the format");
    options.file("--then-mesh", "MESH", flags->mesh_output,
                 "also turn the skeleton into a surface, and write that");
    // Of both kinds of input, and so not among the options of either.
    options.value({{"root", "the root is where the tree is nearest to this place; else it is the lowest end",
                    Unit::metre},
                   &flags->from_mesh.root});
    options.fields(flags->from_mesh, kMeshGroup, {.without = {"root"}});
    options.fields(flags->from_cloud, kCloudGroup, {.without = {"root"}});
    options.file("--leaf-points", "POINTS", flags->leaf_output,
                 "also write the points that are left out as leaves, if any", kCloudGroup);
    options.fields(flags->write, "Writing the skeleton");
    options.fields(flags->mesh, "Surface of --then-mesh", then_mesh_flag_names());
    return {"extract", "Read a skeleton with radii off the mesh or the scan of a tree", options,
            [flags](Run& run, const GivenOptions& given) { return extract(run, given, *flags); }};
}

}  // namespace coppice::cli
