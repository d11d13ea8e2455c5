#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "coppice/base/progress.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/io/file_up.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/io_points/reader.h"
#include "coppice/options/quantity.h"
#include "coppice/points/wood_classes.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/scene/extraction.h"
#include "coppice/scene/file_kind.h"
#include "coppice/skeleton/assemble.h"

namespace coppice {
namespace {

using namespace table;

const std::string kMesh = "extract_mesh", kCloud = "extract_cloud", kFile = "extract_file",
                  kReadPoints = "read_points";

constexpr float kShareOfReading = 0.1f;  // fraction of the progress

/// Type and name of the input.
struct Source {
    std::string name;  ///< of the file or object
    bool cloud = false;
};

bool is_default(const SceneCall& call, const Argument& a) {
    const auto values = call.values(a.name);
    return values.empty() || (values.size() == 1 && typed(a, values.front()) == a.initial);
}

Context reading(const SceneCall& call) { return narrow_progress(call.context(), 0, kShareOfReading); }
Context extracting(const SceneCall& call) { return narrow_progress(call.context(), kShareOfReading, 1); }

bool is_for_mesh(const Argument& a) { return a.field.starts_with(kMesh + ".") && a.name != "root"; }
/// Returns whether an argument applies only to files, because objects contain this information.
bool is_for_file(const Argument& a) { return a.field == kFile || a.field.starts_with(kReadPoints + "."); }
bool is_for_cloud(const Argument& a) {
    return a.field.starts_with(kCloud + ".") || a.field.starts_with(kReadPoints + ".") ||
           a.name == kWoodClassesField.name || a.name == kTreesByField.name;
}

/// Throws InvalidInput for options without effect.
void check_options(const SceneCall& call, const Source& source) {
    for (const Argument& a : call.command().arguments) {
        const bool for_mesh = is_for_mesh(a), for_cloud = is_for_cloud(a);
        if ((source.cloud ? !for_mesh : !for_cloud) || is_default(call, a)) continue;
        throw InvalidInput(fmt::format("{}= is for {}, and '{}' is taken for {}", a.name,
                                       for_mesh ? "meshes" : "clouds of points", source.name,
                                       for_mesh ? "a cloud of points" : "a mesh"));
    }
    for (const Argument& a : call.command().arguments) {
        if (!is_for_file(a) || call.has("file") || is_default(call, a)) continue;
        throw InvalidInput(fmt::format("{}= is for files, and '{}' is an object", a.name, source.name));
    }
    const bool by_ids = call.text(kTreesByField.name) == name_of(TreeRule::ids);
    for (const Argument& a : call.command().arguments) {
        constexpr std::array<std::string_view, 4> kOfOneTree{"root", "ground", "ground_height", "max_trees"};
        if (by_ids && std::ranges::find(kOfOneTree, a.name) != kOfOneTree.end() && !is_default(call, a))
            throw InvalidInput(fmt::format("{}= has no effect with {}=ids", a.name, kTreesByField.name));
    }
    if (call.text("ground") != name_of(GroundRule::height) && call.number("ground_height") != 0)
        throw InvalidInput("ground_height= applies only to the rule height; add ground=height");
}

SceneOutcome outcome(const SceneCall& call, const Source& source, const ExtractResult& result,
                     const std::string& found, std::vector<NodeAttribute> more = {}) {
    std::vector<NodeAttribute> attributes = node_attributes(result.confidence, source.cloud);
    std::ranges::move(more, std::back_inserter(attributes));
    SceneOutcome out = makes_tree(call.text("tree"), result.skeleton, std::move(attributes));
    out.text = fmt::format("{} taken for {}: {} nodes in {} {}{}\n", source.name,
                           source.cloud ? "a cloud of points" : "a mesh", grouped(result.skeleton.size()),
                           grouped(result.report.trees), result.report.trees == 1 ? "tree" : "trees", found);
    return out;
}

SceneOutcome from_mesh(const SceneCall& call, const Source& source, const PolygonMesh& mesh) {
    constexpr double kBytesOfVertex = 250, kBytesOfContracted = 1100;  // per vertex, as measured
    const auto options = call.options<FromMeshOptions>(kMesh);
    const bool contracts = options.method == MeshSkeletonMethod::contraction;
    call.reserve((contracts ? kBytesOfContracted : kBytesOfVertex) *
                 static_cast<double>(mesh.positions.size()));
    const FromMeshResult result = extract_from_mesh(mesh, options, extracting(call));
    return outcome(call, source, result, fmt::format(", {} loops cut", grouped(result.report.loops)));
}

/// Returns the options for a cloud of this number of points, and reserves its memory.
CloudOptions cloud_options(const SceneCall& call, std::size_t points) {
    constexpr double kBytesOfPoint = 500, kBytesOfGivenPoint = 40;  // per used point; per input point
    auto options = call.options<CloudOptions>(kCloud);
    options.root = call.options<FromMeshOptions>(kMesh).root;
    const double given = static_cast<double>(points);
    call.reserve(kBytesOfGivenPoint * given +
                 kBytesOfPoint * std::min(given, static_cast<double>(options.max_points)));
    return options;
}

SceneOutcome from_cloud(const SceneCall& call, const Source& source, const PointSet& points,
                        const std::string& left_out) {
    const CloudExtraction result =
        extract_from_cloud(points, cloud_options(call, points.size()), extracting(call));
    std::string details = left_out + text_of_points_left_out(result.cleaning);
    for (const TreeFigures& tree : result.trees) {
        if (result.trees.size() == 1) details += text_of_tree(tree);
        for (const std::string& doubt : tree.doubts) details += fmt::format("; in doubt: {}", doubt);
    }
    return outcome(call, source, result, details);
}

/// Extracts the trees with ids in the points as one skeleton, in the order of the ids, which are stored in
/// the node attribute `tree`.
SceneOutcome from_ids(const SceneCall& call, const Source& source, const PointCloud& scan,
                      const std::string& left_out) {
    const PlotExtraction plot =
        extract_trees_by_ids(scan, cloud_options(call, scan.points.size()), extracting(call));
    std::vector<const Skeleton*> skeletons;
    std::vector<NodeConfidence> confidence;
    NodeAttribute ids{"tree", {}};
    std::string details = left_out;
    for (std::size_t t = 0; t < plot.trees.size(); ++t) {
        const PlotTree& tree = plot.trees[t];
        for (const std::string& warning : tree.warnings)
            details += fmt::format("; tree {}: {}", plot.segments.ids[t], warning);
        if (!tree.result) continue;
        skeletons.push_back(&tree.result->skeleton);
        std::ranges::copy(tree.result->confidence, std::back_inserter(confidence));
        ids.values.resize(confidence.size(), static_cast<float>(plot.segments.ids[t]));
    }
    if (skeletons.empty())
        throw InvalidInput(fmt::format("{}: no tree has a skeleton{}", source.name, details));
    ExtractResult all{joined(skeletons), std::move(confidence), {}};
    all.report.trees = all.skeleton.tree_count();
    return outcome(call, source, all, details, {std::move(ids)});
}

/// Adds the type of input to the help of each option.
void name_kinds(std::vector<Argument>& arguments) {
    for (Argument& a : arguments) {
        const bool for_mesh = is_for_mesh(a), for_cloud = is_for_cloud(a);
        if (for_mesh == for_cloud) continue;
        a.help = (for_mesh ? "For meshes: " : "For clouds: ") + a.help;
    }
}

FileUp read_up(const SceneCall& call) {
    const auto found = std::ranges::find(EnumNames<FileUp>::names, call.text("up"));
    return static_cast<FileUp>(found - EnumNames<FileUp>::names.begin());
}

SceneOutcome from_mesh_file(const SceneCall& call, const Source& source, const std::filesystem::path& path) {
    PolygonMesh mesh = read_mesh(path, reading(call));
    if (mesh_format_of_name(path) != MeshFormat::glb) turn_from_file(mesh, read_up(call));
    return from_mesh(call, source, mesh);
}

WoodClasses wood_classes(const SceneCall& call) {
    std::vector<std::string> words;
    for (const ArgumentValue& v : call.values(kWoodClassesField.name)) words.push_back(v.text);
    return words.empty() ? WoodClasses{} : parse_wood_classes(fmt::format("{}", fmt::join(words, ",")));
}

PointFile read_cloud(const SceneCall& call, const std::filesystem::path& path, const PointColumns& columns) {
    try {
        return read_point_file(path, columns, call.options<ReadPointsOptions>(kReadPoints), reading(call));
    } catch (const TruncatedFile& error) {
        throw InvalidInput(
            fmt::format("{}; allow_truncated=yes reads the points that are there", error.what()));
    }
}

SceneOutcome from_cloud_file(const SceneCall& call, const Source& source, const std::filesystem::path& path) {
    WoodClasses wood = wood_classes(call);
    PointColumns columns = kNoColumns;
    columns.classes = true;
    columns.tree_ids = call.text(kTreesByField.name) == name_of(TreeRule::ids);
    wood.ground = columns.tree_ids;
    PointFile file = read_cloud(call, path, columns);
    PointCloud& scan = file.point_cloud;
    turn_from_file(scan.points, read_up(call));
    const std::size_t all = scan.points.size();
    const ClassSelection out =
        keep_wood_classes(scan, wood, {.threads = call.context().threads, .stop = call.context().stop});
    std::string left_out;
    if (out.count > 0)
        left_out = fmt::format(", {} of {} points left out by their class", grouped(out.count), grouped(all));
    if (file.missing > 0)
        left_out += fmt::format(", {} points missing from a truncated file", grouped(file.missing));
    SceneOutcome made = columns.tree_ids ? from_ids(call, source, scan, left_out)
                                         : from_cloud(call, source, scan.points, left_out);
    if (out.doubt) made.text += *out.doubt + "\n";
    return made;
}

SceneOutcome from_file(const SceneCall& call, const std::filesystem::path& path) {
    constexpr double kBytesOfByte = 4;
    const auto kind = kind_of_file(path);
    Source source{call.text("file"), kind == FileKind::points};
    if (!kind) {
        throw InvalidInput(
            fmt::format("'{}' is neither a mesh nor points, according to its name and content", source.name));
    }
    if (*kind == FileKind::skeleton) {
        throw InvalidInput(fmt::format("'{0}' is a skeleton already; read it with: loadtree {1} {0}",
                                       source.name, call.text("tree")));
    }
    check_options(call, source);
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (!error) call.reserve(kBytesOfByte * static_cast<double>(size));
    return source.cloud ? from_cloud_file(call, source, path) : from_mesh_file(call, source, path);
}

SceneOutcome from_object(const SceneCall& call) {
    const std::string& name = call.text("from");
    const auto mesh = call.state().objects.find({ObjectKind::mesh, name});
    const Source source{name, mesh == call.state().objects.end()};
    check_options(call, source);
    if (source.cloud) return from_cloud(call, source, call.point_set(name), {});
    const Surface& surface = std::get<Surface>(mesh->second->value);
    call.reserve(static_cast<double>(compute_memory(surface)));
    return from_mesh(call, source, make_polygons(surface));
}

}  // namespace

SceneCommand extract_command() {
    SceneCommand c{.name = "extract",
                   .group = "Trees",
                   .help = "Extract a skeleton with radii from the mesh or the scan of a tree."};
    c.example = "extract again from=tree";
    c.makes = ObjectKind::skeleton;
    Argument from = object_option("from", ObjectKind::mesh, "Mesh or points of the scene instead of a file.");
    from.also = {ObjectKind::points};
    auto default_up = FileUp::z;
    auto default_rule = TreeRule::stems;
    std::vector<std::string> no_classes;
    Argument up = to_argument({kFileUpField, choice_of(default_up)});
    up.field = kFile;
    Argument wood = to_argument({kWoodClassesField, &no_classes});
    wood.field = kFile;
    Argument trees_by = to_argument({kTreesByField, choice_of(default_rule)});
    trees_by.field = kFile;
    c.arguments = {new_name("tree", "Name of the new skeleton."),
                   positional(file("file", ArgumentType::input_file,
                                   "Mesh (.ply, .obj, .off, .stl, .glb) or points (.xyz, .txt, .asc, .csv, "
                                   ".pts, .ptx, .ply, .pcd, .las, .laz)."),
                              false),
                   std::move(from), std::move(up)};
    add_options(c.arguments, FromMeshOptions{}, kMesh, {"up"});
    add_options(c.arguments, CloudOptions{}, kCloud, {"root"});
    add_options(c.arguments, ReadPointsOptions{}, kReadPoints);
    c.arguments.push_back(std::move(wood));
    c.arguments.push_back(std::move(trees_by));
    name_kinds(c.arguments);
    c.run = [](const SceneCall& call) {
        std::optional<std::filesystem::path> path;
        if (call.has("file")) path = call.input("file");
        if (path.has_value() == call.has("from"))
            throw InvalidInput(
                "a file or from=OBJECT is the source of the skeleton; give exactly one of them");
        return path ? from_file(call, *path) : from_object(call);
    };
    return c;
}

}  // namespace coppice
