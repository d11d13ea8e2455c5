#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "coppice/growth/grow.h"
#include "coppice/growth/radii.h"
#include "coppice/growth/tidy.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/io/skeleton/reader.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/scene/commands/tables_internal.h"

namespace coppice {
namespace {

using namespace table;

SceneCommand in_group(std::string name, std::string help, std::string example) {
    SceneCommand c{.name = std::move(name), .group = "Trees", .help = std::move(help)};
    c.example = std::move(example);
    c.makes = ObjectKind::skeleton;
    return c;
}

Argument tree(std::string help) { return object("tree", ObjectKind::skeleton, std::move(help)); }

Argument guard() {
    return object_option("guard", ObjectKind::solid, "a solid that no segment may enter, or leave");
}

/// The solid that guards, in the coordinates of what is guarded.
class GuardOf {
  public:
    GuardOf(const SceneCall& call, Vec3d origin) {
        if (!call.has("guard")) return;
        field_.emplace(call.field(call.text("guard"), origin));
        guard_.emplace(FieldRef(*field_), call.options<GuardOptions>("guard"));
    }
    const Guard* get() const { return guard_ ? &*guard_ : nullptr; }

  private:
    std::optional<SolidField> field_;
    std::optional<Guard> guard_;
};

std::vector<Root> roots_of(const SceneCall& call, Vec3d origin) {
    std::vector<Root> roots;
    for (const ArgumentValue& v : call.values("root")) {
        const auto& n = v.numbers;
        Root root{Vec3(Vec3d(n.at(0), n.at(1), n.at(2)) - origin), {}};
        if (n.size() == 6) root.direction = Vec3(Vec3d(n[3], n[4], n[5]));
        roots.push_back(root);
    }
    return roots;
}

/// About what growth takes: as many steps to each attractor as lie between it and its neighbours, and those
/// across the whole.
double memory_of_growth(const PointSet& points, std::span<const Root> roots, const GrowOptions& o) {
    constexpr double kBytesOfAttractor = 90, kBytesOfNode = 140, kLeastSteps = 4;
    Box3 box = bounds(points);
    for (const Root& root : roots) box.extend(root.position);
    const double across = static_cast<double>(box.diagonal() / o.step);
    const double n = static_cast<double>(points.size());
    const double nodes = n * std::max(kLeastSteps, across / std::cbrt(n + 1)) + across;
    return n * kBytesOfAttractor + std::min(nodes, static_cast<double>(o.max_nodes)) * kBytesOfNode;
}

SceneCommand grow_command() {
    SceneCommand c = in_group("grow", "grows a tree into points",
                              "grow tree s root=0,0,-60 influence_radius=30 kill_radius=8 step=4");
    c.arguments = {new_name("tree", "name of the new skeleton"),
                   object("points", ObjectKind::points, "what it grows towards"),
                   repeated(tuple("root", "0,0,0",
                                  "x,y,z where a tree starts, or x,y,z,dx,dy,dz to say which way", {3, 6}))};
    add_options(c.arguments, GrowOptions{}, "grow");
    c.arguments.push_back(guard());
    add_options(c.arguments, GuardOptions{}, "guard");
    c.run = [](const SceneCall& call) {
        const PointSet& points = call.point_set(call.text("points"));
        const auto options = call.options<GrowOptions>("grow");
        const std::vector<Root> roots = roots_of(call, points.origin);
        call.reserve(memory_of_growth(points, roots, options));
        const GuardOf guarded(call, points.origin);
        const GrowInput input{points.positions, roots, guarded.get(), points.origin};
        GrowResult grown = grow(input, options, call.context());
        SceneOutcome out = makes_tree(call.text("tree"), std::move(grown.skeleton));
        if (grown.stop == StopReason::node_limit || grown.stop == StopReason::iteration_limit)
            out.text = fmt::format("growth stopped early: {}\n", name_of(grown.stop));
        out.grown = call.text("tree");
        return out;
    };
    return c;
}

SceneCommand radii_command() {
    SceneCommand c = in_group("radii", "gives a tree radii by the pipe model", "radii tree tip_radius=0.2");
    c.arguments = {tree("what gets them")};
    add_options(c.arguments, RadiiOptions{}, "radii");
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("tree");
        return makes_tree(name, with_pipe_radii(call.skeleton(name), call.options<RadiiOptions>("radii")));
    };
    return c;
}

SceneCommand tidy_command() {
    SceneCommand c =
        in_group("tidy", "smooths a grown tree and takes tiny steps away", "tidy tree smooth_passes=3");
    c.example = "tidy tree axis_passes=3";
    c.arguments = {tree("what is smoothed")};
    add_options(c.arguments, TidyOptions{}, "tidy");
    c.arguments.push_back(guard());
    add_options(c.arguments, GuardOptions{}, "guard");
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("tree");
        const Skeleton& skeleton = call.skeleton(name);
        const GuardOf guarded(call, skeleton.origin());
        return makes_tree(
            name, tidy(skeleton, call.options<TidyOptions>("tidy"), guarded.get(), call.context()).skeleton);
    };
    return c;
}

SceneCommand loadtree_command() {
    SceneCommand c = in_group("loadtree", "reads a skeleton from a file", "loadtree oak oak.swc");
    c.arguments = {
        new_name("tree", "name of the new skeleton"),
        file("file", ArgumentType::input_file, "a file of a skeleton, such as .swc, .json, .csv or .ply")};
    add_options(c.arguments, ReadSkeletonOptions{}, "read");
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.input("file");
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        if (!error) call.reserve(8.0 * static_cast<double>(size));
        return makes_tree(
            call.text("tree"),
            read_skeleton(path, call.options<ReadSkeletonOptions>("read"), call.context()).skeleton);
    };
    return c;
}

double memory_of_quads(const Skeleton& skeleton, int levels) {
    constexpr double kCageQuads = 5, kBytesOfQuad = 120;  // for each segment; for each quad
    double quads = kCageQuads * skeleton.size();
    for (int i = 0; i < levels; ++i) quads *= 4;
    return quads * kBytesOfQuad;
}

/// By the area of the tubes in triangles of the edge that is asked for.
double memory_of_tetrahedra(const Skeleton& skeleton, const TetraOptions& options) {
    constexpr double kTrianglesOfSquare = 6, kBytesOfTriangle = 200;  // of radius by radius; measured
    double squares = 0;
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n)) continue;
        const Segment s = skeleton.segment(n);
        squares += 2 * distance(Vec3d(s.a), Vec3d(s.b)) / (double{s.radius_a} + s.radius_b);
    }
    return (squares + skeleton.tree_count()) * kTrianglesOfSquare * kBytesOfTriangle /
           (double{options.edge} * options.edge);
}

/// Of quads, as much for cylinders, which have fewer vertices and more sides, and twice as much for
/// ramifications, which have rings of their own.
double memory_of_mesh(const Skeleton& skeleton, const MeshOptions& options) {
    if (options.method == MeshMethod::tetrahedra) return memory_of_tetrahedra(skeleton, options.tetra);
    const double quads = memory_of_quads(skeleton, options.levels);
    if (options.method == MeshMethod::cylinders) return quads * options.control.sides / 4;
    return options.method == MeshMethod::ramifications ? 2 * quads : quads;
}

SceneCommand mesh_command() {
    SceneCommand c = in_group("mesh", "wraps a tree in one closed surface", "mesh tree levels=1");
    c.makes = ObjectKind::mesh;
    c.arguments = {tree("what is wrapped"),
                   positional(new_name("name", "name of the new mesh", "@tree"), false)};
    add_options(c.arguments, MeshOptions{}, "mesh", {},
                {{"mesh.project.method", "project_method"}, {"mesh.project.tolerance", "project_tolerance"}});
    c.run = [](const SceneCall& call) {
        const Skeleton& skeleton = call.skeleton(call.text("tree"));
        const auto options = call.options<MeshOptions>("mesh");
        call.reserve(memory_of_mesh(skeleton, options));
        MeshResult result = mesh_skeleton(skeleton, options, call.context());
        Surface surface;
        std::visit([&](auto& made) { surface.mesh = std::move(made.mesh); }, result.surface);
        const std::uint64_t bytes = memory_of(surface);
        return makes(call.text("name"), std::move(surface), bytes);
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> tree_commands() {
    return {grow_command(), radii_command(), tidy_command(), loadtree_command(), mesh_command()};
}

}  // namespace coppice
