#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <new>
#include <numeric>
#include <optional>
#include <utility>

#include "batch.h"
#include "command.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/extract/plot/plot.h"
#include "coppice/extract/tree/label_points.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/points/wood_classes.h"
#include "coppice/render/colors.h"
#include "coppice/scene/extraction.h"
#include "coppice/skeleton/architecture.h"
#include "coppice/skeleton/measure.h"
#include "extract_outputs.h"
#include "figures.h"
#include "files.h"
#include "memory.h"
#include "options.h"
#include "plots.h"
#include "results.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct ExtractFlags {
    std::vector<std::string> wood_classes;
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path input;  ///< file that is processed
    ExtractOutputs outputs;       ///< of this file
    FromMeshOptions from_mesh;
    CloudOptions from_cloud;
    PlotOptions from_plot;
    TreeRule trees_by = TreeRule::stems;
    FileUp up = FileUp::z;
    ReadPointsOptions read_points;
};

Json figures_of_orders(const std::vector<BranchOrder>& orders) {
    Json out = Json::array();
    for (std::size_t o = 0; o < orders.size(); ++o)
        out.push_back({{"order", o}, {"branches", orders[o].branches}, {"length_m", orders[o].length}});
    return out;
}

/// Adds the figures that meshes and clouds have in common.
void fill_report(Run& run, const ExtractResult& result) {
    const SkeletonMeasures m = measure(result.skeleton);
    run.counts().update(compute_figures(result.report));
    run.counts().update({{"nodes", m.nodes},
                         {"tips", m.tips},
                         {"branch_nodes", m.branch_nodes},
                         {"length_m", m.length},
                         {"volume_m3", m.volume},
                         {"orders", figures_of_orders(branch_orders(result.skeleton))}});
}

/// Runs work(context) as a stage; adds the name of the file to its errors.
template <class Work>
auto named_stage(Run& run, const char* stage, const std::filesystem::path& input, const Work& work) {
    return run.stage(stage, [&](const Context& ctx) {
        try {
            return work(ctx);
        } catch (const InvalidInput& error) {
            throw InvalidInput(fmt::format("{}: {}", input.string(), error.what()));
        }
    });
}

/// Writes the vertices of a mesh, coloured by their nodes.
void write_mapping(const std::filesystem::path& path, const FromMeshResult& result, const Context& ctx) {
    PointCloud point_cloud{result.vertices, {}, {}};
    for (const std::uint32_t node : result.nodes) point_cloud.colors.push_back(numbered_color(node));
    write_point_cloud(path, point_cloud,
                      {.note = "the vertices of each node of the skeleton in their own colour"}, ctx);
}

/// A skeleton, and for a cloud the figures of its trees.
struct Extracted {
    ExtractResult result;
    std::vector<TreeFigures> trees = {};

    bool in_doubt() const {
        return std::ranges::any_of(trees, [](const TreeFigures& t) { return !t.doubts.empty(); });
    }
};

Extracted from_mesh(Run& run, const ExtractFlags& flags, std::string& summary) {
    const PolygonMesh mesh = load_mesh(run, flags.input, flags.up);
    FromMeshResult result = named_stage(run, "extract", flags.input, [&](const Context& ctx) {
        return extract_from_mesh(mesh, flags.from_mesh, ctx);
    });
    run.add_stages("extract: ", result.stages);
    run.repairs() = compute_figures(result.repairs);
    if (const auto& path = flags.outputs.mapping; !path.empty())
        run.stage("write mapping", [&](const Context& ctx) { write_mapping(path, result, ctx); });
    summary = fmt::format(", {} loops cut", grouped(result.report.loops));
    return {std::move(result)};
}

WoodClasses wood_classes(const ExtractFlags& flags) {
    if (flags.wood_classes.empty()) return {};
    return as_usage("--wood-classes: ", [&] {
        return parse_wood_classes(fmt::format("{}", fmt::join(flags.wood_classes, ",")));
    });
}

/// Returns the points that may be wood according to their classes, with their classes and tree ids; adds the
/// number of the others to the report and to `summary`.
PointFile load_wood(Run& run, const ExtractFlags& flags, const WoodClasses& wood, std::string& summary) {
    PointColumns columns = kNoColumns;
    columns.classes = columns.tree_ids = true;
    columns.intensities = columns.returns = !flags.outputs.tree_points.empty();
    const std::filesystem::path& input = flags.input;
    PointFile file = load_point_file(run, input, columns, flags.up, flags.read_points);
    PointCloud& scan = file.point_cloud;
    const std::size_t all = scan.points.size();
    summary += text_of_rays_left_out(file);
    const ClassSelection out = named_stage(
        run, "classes", input, [&](const Context& ctx) { return keep_wood_classes(scan, wood, ctx); });
    if (out.doubt) run.warn(fmt::format("{}: {}", input.string(), *out.doubt));
    if (out.count == 0) return file;
    Json left_out = Json::object();
    for (std::size_t c = 0; c < out.left_out.size(); ++c)
        if (out.left_out[c] > 0) left_out[fmt::format("{}", c)] = out.left_out[c];
    run.counts()["left_out_by_class"] = left_out;
    summary += fmt::format(", {} of {} points left out by their class", grouped(out.count), grouped(all));
    return file;
}

/// Adds the figures of every tree, and warns if they are implausible.
void report_trees(Run& run, const ExtractFlags& flags, const std::vector<TreeFigures>& trees,
                  std::string& summary) {
    Json list = Json::array();
    for (std::size_t k = 0; k < trees.size(); ++k) {
        list.push_back(compute_figures(trees[k]));
        for (const std::string& doubt : trees[k].doubts) {
            run.warn(trees.size() == 1 ? fmt::format("{}: {}", flags.input.string(), doubt)
                                       : fmt::format("{}: tree {}: {}", flags.input.string(), k + 1, doubt));
        }
    }
    run.counts()["tree_figures"] = std::move(list);
    if (trees.size() == 1) summary += text_of_tree(trees[0]);
}

/// Writes the points with the labels that the skeleton assigns, wood coloured by branch order.
void write_labelled_points(const std::filesystem::path& path, PointFile& file, const CloudExtraction& result,
                           const Context& ctx) {
    PointCloud& scan = file.point_cloud;
    std::vector<std::uint32_t> all(scan.points.size());
    std::iota(all.begin(), all.end(), 0u);
    label_points(scan, all, result, result.cleaning.spacing, ctx);
    scan.colors.resize(all.size(), kNoTreeColor);
    for (const std::uint32_t p : all)
        if (scan.wood[p] != 0) scan.colors[p] = numbered_color(scan.branch_orders[p]);
    write_point_cloud(path, scan, {.note = "wood coloured by branch order", .system = file.system}, ctx);
}

Extracted from_cloud(Run& run, const ExtractFlags& flags, std::string& summary) {
    PointFile file = load_wood(run, flags, wood_classes(flags), summary);
    CloudExtraction result = named_stage(run, "extract", flags.input, [&](const Context& ctx) {
        return extract_from_cloud(file.point_cloud.points, flags.from_cloud, ctx);
    });
    run.repairs() = compute_figures(result.cleaning);
    summary += text_of_points_left_out(result.cleaning);
    report_trees(run, flags, result.trees, summary);
    if (const auto& path = flags.outputs.leaf_points; !path.empty() && !result.leaves.empty()) {
        run.stage("write leaves", [&](const Context& ctx) {
            write_point_cloud(path, {result.leaves, {}, {}}, {.system = file.system}, ctx);
        });
    }
    if (const auto& path = flags.outputs.tree_points; !path.empty())
        run.stage("write points",
                  [&](const Context& ctx) { write_labelled_points(path, file, result, ctx); });
    std::vector<TreeFigures> trees = std::move(result.trees);
    return {std::move(result), std::move(trees)};
}

/// Throws UsageError for an option that has no effect on this kind of input.
void check_groups(const GivenOptions& given, const std::filesystem::path& input, FileKind kind) {
    const bool cloud = kind == FileKind::points;
    if (const Option* option = first_of_groups(given, {cloud ? kMeshGroup : kCloudGroup})) {
        throw UsageError(fmt::format("{} is for {}, and '{}' is a {}", option->name,
                                     cloud ? "meshes" : "clouds of points", input.string(),
                                     cloud ? "cloud of points" : "mesh"));
    }
}

void check_ground(const GivenOptions& given, const ExtractFlags& flags) {
    if (is_given(given, "--ground-height") && flags.from_cloud.ground != GroundRule::height)
        throw UsageError("--ground-height requires --ground height");
}

/// Throws UsageError for options of one tree: a plot has its own ground and roots.
void refuse_options_of_one_tree(const GivenOptions& given, const ExtractFlags& flags) {
    const std::filesystem::path& folder = flags.outputs.skeleton;
    for (const char* name : {"--root", "--ground", "--ground-height", "--max-trees"}) {
        if (!is_given(given, name)) continue;
        throw UsageError(fmt::format(
            "{} is for one tree, and '{}' names a folder, as for a plot of many trees; name the skeleton, as "
            "{}.swc",
            name, folder.string(), folder.has_filename() ? folder.string() : "tree"));
    }
}

void check_plot_options(const Run& run, const GivenOptions& given, const ExtractFlags& flags) {
    refuse_options_of_one_tree(given, flags);
    if (kind_of_input(run, flags.input) == FileKind::points) return;
    throw UsageError(
        fmt::format("'{}' names a folder, as for a plot of many trees, and '{}' is no cloud of points; name "
                    "the skeleton, as tree.swc",
                    flags.outputs.skeleton.string(), flags.input.string()));
}

/// Extracts and writes the trees of one plot.
WrittenPlot extract_plot_file(Run& run, const ExtractFlags& flags, std::string& summary) {
    std::string found;
    WoodClasses wood = wood_classes(flags);
    wood.ground = true;
    const PointFile file = load_wood(run, flags, wood, found);
    const bool by_ids = flags.trees_by == TreeRule::ids;
    PlotExtraction plot = named_stage(run, "extract", flags.input, [&](const Context& ctx) {
        return by_ids ? extract_trees_by_ids(file.point_cloud, flags.from_cloud, ctx)
                      : extract_plot(file.point_cloud.points, flags.from_plot, flags.from_cloud, ctx);
    });
    if (plot.trees.empty()) {
        throw InvalidInput(fmt::format(
            "{0}: extract: no stem of a tree is visible from 0.3 to 3.9 m above the ground; reduce "
            "--min-diameter, or read a cloud of one tree by coppice extract {0} -o tree.swc",
            flags.input.string()));
    }
    WrittenPlot out = write_plot(run, file, std::move(plot), flags.outputs);
    summary = out.summary + found;
    return out;
}

bool in_doubt(const PlotExtraction& plot) {
    return std::ranges::any_of(plot.trees, [](const PlotTree& t) { return !t.figures.doubts.empty(); });
}

ExitCode from_plot(Run& run, const GivenOptions& given, const ExtractFlags& flags) {
    check_plot_options(run, given, flags);
    check_groups(given, flags.input, FileKind::points);
    check_plot_outputs(flags.outputs);
    std::string summary;
    const WrittenPlot written = extract_plot_file(run, flags, summary);
    run.finish(summary);
    return in_doubt(written.plot) ? kCheckFailed : kDone;
}

/// Returns the kind of the input; throws for a skeleton.
FileKind kind_to_extract(const Run& run, const ExtractFlags& flags) {
    const FileKind kind = kind_of_input(run, flags.input);
    if (kind != FileKind::skeleton) return kind;
    throw UsageError(fmt::format("'{}' is a skeleton already; a mesh or a cloud of points is needed",
                                 flags.input.string()));
}

/// Extracts and writes the skeleton of one file.
Extracted extract_skeleton(Run& run, const ExtractFlags& flags, FileKind kind, std::string& summary) {
    std::string found;
    Extracted made = kind == FileKind::mesh ? from_mesh(run, flags, found) : from_cloud(run, flags, found);
    run.stage("write", [&](const Context& ctx) {
        store_skeleton(run, flags.outputs.skeleton, made.result.skeleton, flags.outputs.write,
                       node_attributes(made.result.confidence, kind == FileKind::points), ctx);
    });
    fill_report(run, made.result);
    summary = fmt::format("{}: {} nodes in {} trees{}", flags.outputs.skeleton.string(),
                          grouped(made.result.skeleton.size()), grouped(made.result.report.trees), found);
    return made;
}

/// Returns the error of work(), which the table then reports for the file.
template <class Work>
std::string find_trouble(const BatchFile& file, const Work& work) {
    try {
        work();
        return {};
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        return error.what();
    } catch (const std::filesystem::filesystem_error& error) {
        return error.what();
    } catch (const std::bad_alloc&) {
        renew_memory_limit();
        return fmt::format("{}: {}", file.input.string(), out_of_memory_text());
    }
}

ExitCode to_exit_code(const std::string& trouble, bool in_doubt) {
    return !trouble.empty() ? kFileTrouble : in_doubt ? kCheckFailed : kDone;
}

/// Extracts the tree of one of many files. Its figures are kept if the surface fails.
ExitCode extract_of_batch(Run& run, const ExtractFlags& flags, const BatchFile& file, BatchTable& table) {
    std::optional<Extracted> made;
    FileKind kind = FileKind::points;
    const std::string trouble = find_trouble(file, [&] {
        kind = kind_to_extract(run, flags);
        std::string summary;
        made = extract_skeleton(run, flags, kind, summary);
        then_mesh(run, flags.outputs.mesh, made->result.skeleton, flags.outputs.surface);
    });
    if (!trouble.empty()) run.warn(trouble);
    if (!made) {
        table.add_failure(file, trouble);
        return kFileTrouble;
    }
    const bool of_points = kind == FileKind::points;
    if (!of_points) made->trees = tree_figures(made->result.skeleton, made->result.confidence, {});
    table.add(file, made->result, made->trees, of_points, trouble);
    return to_exit_code(trouble, of_points && made->in_doubt());
}

/// Extracts the trees of one of many plots.
ExitCode extract_plot_of_batch(Run& run, const ExtractFlags& flags, const BatchFile& file,
                               BatchTable& table) {
    std::optional<WrittenPlot> made;
    const std::string trouble = find_trouble(file, [&] {
        if (kind_to_extract(run, flags) == FileKind::mesh)
            throw InvalidInput(
                fmt::format("{}: it is a mesh; a plot must be a cloud of points", flags.input.string()));
        std::string summary;
        made = extract_plot_file(run, flags, summary);
    });
    if (made) {
        table.add(file, *made);
    } else {
        run.warn(trouble);
        table.add_failure(file, trouble);
    }
    return to_exit_code(trouble, made && in_doubt(made->plot));
}

/// Throws UsageError for options of single files, of one tree, or of a kind of input that no file has.
void check_batch_options(const GivenOptions& given, const ExtractFlags& flags, const Batch& batch) {
    const BatchFile& first = batch.files.front();
    if (batch.columns.of_plots) {
        refuse_options_of_one_tree(given, flags);
        check_groups(given, first.input, FileKind::points);
        return;
    }
    const auto same = [&](const BatchFile& f) { return f.kind == first.kind; };
    if (first.kind && std::ranges::all_of(batch.files, same)) check_groups(given, first.input, *first.kind);
}

/// Extracts each of many files separately. Finished files are kept if a later one fails.
ExitCode extract_batch(Run& run, const GivenOptions& given, ExtractFlags& flags) {
    if (!is_plot_folder(flags.outputs))
        throw UsageError("many files need a folder for their skeletons: coppice extract FILES... -o FOLDER/");
    flags.from_cloud.root = flags.from_mesh.root;
    check_ground(given, flags);
    (void)wood_classes(flags);  // so that errors are reported before any work
    const bool of_plots = first_of_groups(given, {kPlotGroup}) != nullptr;
    const Batch batch =
        plan_batch(flags.inputs, flags.outputs,
                   {.of_files = true, .of_plots = of_plots, .with_ids = flags.trees_by == TreeRule::ids});
    check_batch_options(given, flags, batch);
    BatchTable table(batch);
    std::array<std::size_t, kFileTrouble + 1> files_of_code{};
    Json reports = Json::array();
    try {
        for (std::size_t i = 0; i < batch.files.size(); ++i) {
            const BatchFile& file = batch.files[i];
            run.set_subject(fmt::format("{} of {}, {:.40}", grouped(i + 1), grouped(batch.files.size()),
                                        file.input.filename().string()));
            flags.input = file.input;
            flags.outputs = file.outputs;
            ++files_of_code[of_plots ? extract_plot_of_batch(run, flags, file, table)
                                     : extract_of_batch(run, flags, file, table)];
            reports.push_back({{"input", file.input.string()},
                               {"counts", std::exchange(run.counts(), Json::object())},
                               {"repairs", std::exchange(run.repairs(), Json::object())}});
        }
    } catch (const Cancelled&) {
        if (!table.rows().empty()) table.commit();
        throw;
    }
    table.commit();
    const std::size_t failed = files_of_code[kFileTrouble], in_doubt = files_of_code[kCheckFailed];
    run.counts() = {{"failed", failed},
                    {"in_doubt", in_doubt},
                    {"passed_over", batch.passed_over},
                    {"trees_found", table.rows()},
                    {"files", std::move(reports)}};
    run.finish(fmt::format("{}: {} files, {} of them failed, {} implausible",
                           (batch.folder / kTreeTable).string(), grouped(batch.files.size()), grouped(failed),
                           grouped(in_doubt)));
    return failed > 0 ? kFileTrouble : in_doubt > 0 ? kCheckFailed : kDone;
}

ExitCode extract(Run& run, const GivenOptions& given, ExtractFlags& flags) {
    if (is_batch(flags.inputs)) return extract_batch(run, given, flags);
    if (!flags.inputs.empty()) flags.input = flags.inputs.front();
    if (!flags.input.empty() && is_plot_folder(flags.outputs)) return from_plot(run, given, flags);
    if (const Option* option = first_of_groups(given, {kPlotGroup}))
        throw UsageError(
            fmt::format("{} is for plots of many trees; name a folder for them, as -o trees/", option->name));
    if (flags.input.empty() || flags.outputs.skeleton.empty())
        throw UsageError("name both files: coppice extract FILE -o SKELETON");
    check_tree_outputs(flags.outputs);
    flags.from_cloud.root = flags.from_mesh.root;
    const FileKind kind = kind_to_extract(run, flags);
    check_groups(given, flags.input, kind);
    check_ground(given, flags);
    std::string summary;
    const Extracted made = extract_skeleton(run, flags, kind, summary);
    summary += then_mesh(run, flags.outputs.mesh, made.result.skeleton, flags.outputs.surface);
    run.finish(summary);
    return made.in_doubt() ? kCheckFailed : kDone;
}

}  // namespace

Command extract_command() {
    const auto flags = std::make_shared<ExtractFlags>();
    OptionList options;
    options.files("input", "FILES", flags->inputs,
                  "Mesh (.ply, .obj, .off, .stl, .glb) or points (.xyz, .txt, .asc, .csv, .pts, .ptx, .ply, "
                  ".pcd, .las, .laz, .e57) to read; several files, or folders, are processed separately.");
    add_output_options(options, flags->outputs);
    // For both kinds of input, and therefore in neither group.
    options.value({common_field("root",
                                "Position of the root, which is moved to the closest point of the tree; by "
                                "default the lowest end.",
                                Unit::metre),
                   &flags->from_mesh.root});
    options.value({kFileUpField, choice_of(flags->up)});
    options.fields(flags->from_mesh, kMeshGroup, {.without = {"root", "up"}});
    add_output_options(options, flags->outputs, kMeshGroup);
    options.fields(flags->from_cloud, kCloudGroup, {.without = {"root"}});
    options.fields(flags->read_points, kCloudGroup);
    options.value({kWoodClassesField, &flags->wood_classes}, kCloudGroup);
    add_output_options(options, flags->outputs, kCloudGroup);
    options.fields(flags->from_plot, kPlotGroup);
    options.value({kTreesByField, choice_of(flags->trees_by)}, kPlotGroup);
    add_output_options(options, flags->outputs, kPlotGroup);
    options.fields(flags->outputs.write, "Writing the skeleton", {.names = {{"up", "--output-up"}}});
    options.fields(flags->outputs.surface, "Surface of --then-mesh", then_mesh_flag_names());
    return {"extract",
            "Extract a skeleton with radii from the mesh or scan of a tree, or of each tree of a plot.",
            options, [flags](Run& run, const GivenOptions& given) { return extract(run, given, *flags); }};
}

}  // namespace coppice::cli
