#include <fmt/format.h>
#include <memory>

#include <algorithm>
#include <cmath>
#include <optional>

#include "coppice/growth/grow.h"
#include "coppice/growth/radii.h"
#include "coppice/growth/size.h"
#include "coppice/growth/sprout.h"
#include "coppice/growth/tidy.h"
#include "coppice/implicit/shape/curve.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/options/quantity.h"
#include "coppice/pipeline/displace.h"
#include "coppice/pipeline/face_budget.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/surface_verdict.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/scene/mesh_memory.h"
#include "coppice/skeleton/assemble.h"

namespace coppice {
namespace {

using namespace table;

SceneCommand in_group(std::string name, std::string help, std::string example) {
    SceneCommand c = new_command(std::move(name), "Trees", std::move(help), std::move(example));
    c.makes = ObjectKind::skeleton;
    return c;
}

Argument tree(std::string help) { return object("tree", ObjectKind::skeleton, std::move(help)); }

Argument guard() {
    return object_option("guard", ObjectKind::solid, "Solid that no segment may enter or leave.");
}

/// The guard solid in the coordinates of the guarded object.
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

std::vector<Root> find_roots(const SceneCall& call, Vec3d origin) {
    std::vector<Root> roots;
    for (const ArgumentValue& v : call.values("root")) {
        const auto& n = v.numbers;
        Root root{Vec3(Vec3d(n.at(0), n.at(1), n.at(2)) - origin), {}};
        if (n.size() == 6) root.direction = Vec3(Vec3d(n[3], n[4], n[5]));
        roots.push_back(root);
    }
    return roots;
}

/// Returns the approximate memory of growth: per attractor, the number of steps from its neighbours, plus the
/// steps across the whole extent.
double memory_of_growth(const PointSet& points, std::span<const Root> roots, const Skeleton* tree,
                        const GrowOptions& o) {
    constexpr double kBytesOfAttractor = 90, kBytesOfNode = 140, kMinSteps = 4;
    Box3 box = bounds(points);
    for (const Root& root : roots) box.extend(root.position);
    const double across = static_cast<double>(box.diagonal() / o.step);
    const double n = static_cast<double>(points.size());
    const double nodes = n * std::max(kMinSteps, across / std::cbrt(n + 1)) + across;
    const double old = tree ? tree->size() : 0;
    return n * kBytesOfAttractor + (old + std::min(nodes, static_cast<double>(o.max_nodes))) * kBytesOfNode;
}

/// Returns the points relative to another origin.
Buffer<Vec3> moved_to(Vec3d origin, const PointSet& points) {
    Buffer<Vec3> out = points.positions;
    const Vec3d shift = points.origin - origin;
    if (shift == Vec3d{}) return out;
    for (Vec3& p : out) p = Vec3(Vec3d(p) + shift);
    return out;
}

SceneCommand grow_command() {
    SceneCommand c = in_group("grow", "Grow a tree into points.",
                              "grow tree s root=0,0,-60 influence_radius=30 kill_radius=8 step=4");
    Argument root = repeated(tuple(
        "root", "0,0,0", "Start x,y,z of a tree, or x,y,z,dx,dy,dz with its initial direction.", {3, 6}));
    root.unless = "from";
    c.arguments = {
        new_name("tree", "Name of the new skeleton."),
        object("points", ObjectKind::points, "Points towards which the tree grows."), std::move(root),
        object_option(
            "from", ObjectKind::skeleton,
            "Skeleton that continues to grow: its nodes are unchanged, and new nodes are attached to them.")};
    add_options(c.arguments, GrowOptions{}, "grow");
    c.arguments.push_back(guard());
    add_options(c.arguments, GuardOptions{}, "guard");
    c.run = [](const SceneCall& call) {
        const PointSet& points = call.point_set(call.text("points"));
        const auto options = call.options<GrowOptions>("grow");
        const Skeleton* tree = call.has("from") ? &call.skeleton(call.text("from")) : nullptr;
        const Vec3d origin = tree ? tree->origin() : points.origin;
        const std::vector<Root> roots = find_roots(call, origin);
        call.reserve(memory_of_growth(points, roots, tree, options));
        const GuardOf guarded(call, origin);
        const Buffer<Vec3> attractors = moved_to(origin, points);
        const GrowInput input{attractors, roots, guarded.get(), origin, tree, call.settings().watch};
        GrowResult grown = grow(input, options, call.context());
        SceneOutcome out = makes_tree(call.text("tree"), std::move(grown.skeleton));
        if (grown.stop == StopReason::node_limit || grown.stop == StopReason::iteration_limit)
            out.text = fmt::format("growth stopped early: {}\n", name_of(grown.stop));
        out.grown = call.text("tree");
        return out;
    };
    return c;
}

SceneCommand sprout_command() {
    SceneCommand c = in_group("sprout", "Grow trees by rules: buds, branching angles, light and shade.",
                              "sprout birch seasons=5 internode=8 branching_angle=50");
    c.arguments = {new_name("tree", "Name of the new skeleton."),
                   repeated(tuple("root", "0,0,0",
                                  "Start x,y,z of a tree, or x,y,z,dx,dy,dz with its initial direction; "
                                  "several trees share the light.",
                                  {3, 6}))};
    add_options(c.arguments, SproutOptions{}, "sprout");
    c.arguments.push_back(guard());
    add_options(c.arguments, GuardOptions{}, "guard");
    c.run = [](const SceneCall& call) {
        const std::vector<Root> roots = find_roots(call, {});
        const GuardOf guarded(call, {});
        const SproutInput input{roots, guarded.get(), {}, call.memory_left(), call.settings().watch};
        SproutResult grown = sprout(input, call.options<SproutOptions>("sprout"), call.context());
        SceneOutcome out = makes_tree(call.text("tree"), std::move(grown.skeleton));
        if (grown.full) out.text = fmt::format("growth stopped at max_nodes, in season {}\n", grown.seasons);
        out.grown = call.text("tree");
        return out;
    };
    return c;
}

/// Returns a skeleton along the curve with the minimum number of segments for the spacing between consecutive
/// points.
Skeleton limb_along(const Curve& curve, double spacing, double radius, double tip_radius,
                    const SceneCall& call) {
    constexpr double kBytesOfNode = 100;
    const double length = curve.length();
    call.reserve(kBytesOfNode * (length / spacing + curve.span_count()));
    std::vector<NodeId> parents{NodeId::none()};
    std::vector<Vec3> positions{Vec3(curve.position(curve.at_index(0)))};
    std::vector<float> radii{static_cast<float>(radius)};
    for (std::uint32_t piece = 0; piece < curve.span_count(); ++piece) {
        const double part = curve.fraction(curve.at_index(piece + 1)) - curve.fraction(curve.at_index(piece));
        const int steps = std::max(1, static_cast<int>(std::ceil(part * length / spacing * (1 - 1e-9))));
        for (int i = 1; i <= steps; ++i) {
            const CurvePlace place = curve.at_index(piece + static_cast<double>(i) / steps);
            const double along = curve.fraction(place);
            parents.emplace_back(static_cast<std::uint32_t>(positions.size() - 1));
            positions.emplace_back(curve.position(place));
            radii.push_back(static_cast<float>(radius + (tip_radius - radius) * along));
        }
    }
    return Skeleton(std::move(parents), std::move(positions), std::move(radii));
}

SceneCommand limb_command() {
    SceneCommand c =
        in_group("limb", "Create a skeleton of one axis through points, such as a stem or a bough.",
                 "limb stem 0,0,0 0,0,6 radius=0.2");
    c.arguments = {new_name("tree", "Name of the new skeleton."),
                   positional(repeated(tuple(
                       "points", "", "At least two points, as x,y,z; the axis passes through all of them."))),
                   number("radius", "0.1", 1e-6, 1e4, Unit::metre, "Radius at the first point."),
                   number("tip_radius", "0", 0, 1e4, Unit::metre,
                          "Radius at the last point; 0 uses a quarter of the first radius."),
                   number("spacing", "0", 0, 1e6, Unit::metre,
                          "Maximum length of a segment; 0 uses 1/16 of the length.")};
    add_options(c.arguments, CurveOptions{}, "curve", {"closed"});
    c.run = [](const SceneCall& call) {
        constexpr double kSegments = 16;
        const Curve curve(call.points("points"), call.options<CurveOptions>("curve"));
        const double spacing = call.number("spacing"), tip = call.number("tip_radius"),
                     radius = call.number("radius");
        return makes_tree(call.text("tree"),
                          limb_along(curve, spacing > 0 ? spacing : curve.length() / kSegments, radius,
                                     tip > 0 ? tip : radius / 4, call));
    };
    return c;
}

SceneCommand join_command() {
    SceneCommand c = in_group("join", "Combine skeletons into one; edit attach connects them.",
                              "copy tree other kind=skeleton\njoin tree other stem grove");
    c.arguments = {object("parts", ObjectKind::skeleton, "At least one skeleton.", true),
                   new_name("result", "Name of the new skeleton, the last word.")};
    c.run = [](const SceneCall& call) {
        constexpr double kBytesOfNode = 100;
        std::vector<const Skeleton*> parts;
        double nodes = 0;
        for (const ArgumentValue& part : call.values("parts")) {
            parts.push_back(&call.skeleton(part.text));
            nodes += parts.back()->size();
        }
        call.reserve(kBytesOfNode * nodes);
        return makes_tree(call.text("result"), joined(parts));
    };
    return c;
}

SceneCommand radii_command() {
    SceneCommand c =
        in_group("radii", "Set the radii of a tree by the pipe model.", "radii tree tip_radius=0.2");
    c.arguments = {tree("Tree to change.")};
    add_options(c.arguments, RadiiOptions{}, "radii");
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("tree");
        return makes_tree(name, with_pipe_radii(call.skeleton(name), call.options<RadiiOptions>("radii")));
    };
    return c;
}

SceneCommand size_command() {
    SceneCommand c = in_group("size", "Scale a tree to a height, and its radii to a diameter of its stem.",
                              "copy tree other kind=skeleton\nsize other height=80 dbh=6 tip_radius=0.1");
    c.arguments = {tree("Tree to change.")};
    add_options(c.arguments, SizeOptions{}, "size");
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("tree");
        return makes_tree(name, with_size(call.skeleton(name), call.options<SizeOptions>("size")));
    };
    return c;
}

SceneCommand tidy_command() {
    SceneCommand c =
        in_group("tidy", "Smooth a grown tree and remove very short segments.", "tidy tree smooth_passes=3");
    c.example = "tidy tree axis_passes=3";
    c.arguments = {tree("Tree to smooth.")};
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
    SceneCommand c = in_group("loadtree", "Read a skeleton from a file.", "loadtree oak oak.swc");
    c.arguments = {
        new_name("tree", "Name of the new skeleton."),
        file("file", ArgumentType::input_file, "Skeleton file, such as .swc, .json, .csv or .ply.")};
    add_options(c.arguments, ReadSkeletonOptions{}, "read");
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.input("file");
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        if (!error) call.reserve(8.0 * static_cast<double>(size));
        SkeletonFile read = read_skeleton(path, call.options<ReadSkeletonOptions>("read"), call.context());
        return makes_tree(call.text("tree"), std::move(read.skeleton), std::move(read.attributes));
    };
    return c;
}

/// Displaces a surface by the heights of its material; returns a line about it.
std::string displace(const SceneCall& call, MeshResult& result) {
    const HeightTexture heights = load_heights(call.material(call.text("material")), call.context());
    const DisplaceReport report = displace_surface(result, call.skeleton(call.text("tree")), heights,
                                                   call.options<DisplaceOptions>("displace"), call.context());
    return fmt::format("displaced by up to {:.2g} mm, {:.2g} mm on average, {} vertices held back\n",
                       1e3 * report.max_offset, 1e3 * report.mean_offset, grouped(report.pulled_back));
}

/// Returns the options of textures; the tile is that of the material unless it is given. Throws InvalidInput
/// for options without the others that they need.
TextureOptions texture_options(const SceneCall& call, MeshMethod method) {
    auto texture = call.options<TextureOptions>("texture");
    if (call.has("material") && texture.coordinates != TextureCoordinates::bark)
        throw InvalidInput("material= needs uv=bark");
    if (texture.blend && (texture.coordinates != TextureCoordinates::bark || method == MeshMethod::cylinders))
        throw InvalidInput("uv_blend= needs uv=bark, and another method than cylinders");
    if (call.flag("displace") && !call.has("material"))
        throw InvalidInput("displace= needs a material with heights; add material=");
    if (!call.has("material") || call.has("tile") || call.has("tile_height")) return texture;
    if (const auto tile = call.material(call.text("material")).tile) {
        texture.tile = tile->width;
        texture.tile_height = tile->height;
    }
    return texture;
}

/// Returns the slots that the materials of twigs and cuts require. Throws InvalidInput for options without
/// the others that they need.
SlotOptions slot_options(const SceneCall& call, MeshMethod method) {
    auto slots = call.options<SlotOptions>("slots");
    slots.twigs = call.has("twig_material");
    slots.cuts = call.has("cut_material");
    if ((slots.twigs || slots.cuts) && !call.has("material"))
        throw InvalidInput("twig_material= and cut_material= need material= for the other faces");
    if (slots.twigs && method == MeshMethod::cylinders)
        throw InvalidInput("twig_material= needs another method than cylinders");
    if (!slots.twigs && slots.twig_diameter != SlotOptions{}.twig_diameter)
        throw InvalidInput("twig_diameter= needs twig_material=");
    if (!slots.twigs && slots.twig_tile > 0) throw InvalidInput("twig_tile= needs twig_material=");
    return slots;
}

/// Returns the outcome of a mesh command; `output` is its output.
SceneOutcome makes_surface(const SceneCall& call, const Skeleton& skeleton, const ControlOptions& ends,
                           MeshResult result, std::string output) {
    if (call.flag("displace")) output += displace(call, result);
    Surface surface;
    if (call.settings().judge) {
        if (const auto verdict = judge_surface(result, skeleton, ends, call.context()))
            surface.verdict = std::make_shared<const SurfaceVerdict>(*verdict);
    }
    std::visit([&](auto& made) { surface.mesh = std::move(made.mesh); }, result.surface);
    if (result.texture) {
        surface.texture = std::move(result.texture->points);
        surface.texture_blends = std::move(result.texture->blends);
    }
    if (call.has("material")) {
        for (const char* slot : {"material", "twig_material", "cut_material"})
            surface.materials.push_back(call.has(slot) ? call.material(call.text(slot)) : SurfaceMaterial{});
        surface.slots = std::move(result.slots);
    }
    const std::uint64_t bytes = compute_memory(surface);
    SceneOutcome out = makes(call.text("name"), std::move(surface), bytes);
    out.text = std::move(output);
    return out;
}

SceneOutcome makes_surface_of_faces(const SceneCall& call, const Skeleton& skeleton,
                                    const MeshOptions& options, std::uint64_t faces) {
    if (options.levels != MeshOptions{}.levels)
        throw InvalidInput("faces= determines the levels; leave levels= out");
    const double refined = options.tube_sides == TubeSides::equal ? 1 : kMaxRefinedFaces;
    call.reserve(memory_of_faces(refined * static_cast<double>(faces), options.fit));
    BudgetedMesh made = mesh_with_faces(skeleton, {}, options, faces, call.context());
    const std::string missed = text_of_missed_faces(made, faces);
    return makes_surface(call, made.budget.skeleton, options.control, std::move(made.result),
                         to_text(made.budget) + '\n' + (missed.empty() ? missed : missed + '\n'));
}

SceneCommand mesh_command() {
    SceneCommand c = in_group("mesh", "Create a closed surface around a tree.", "mesh tree levels=1");
    c.makes = ObjectKind::mesh;
    c.arguments = {tree("Tree to mesh."),
                   positional(new_name("name", "Name of the new mesh.", "@tree"), false)};
    add_options(c.arguments, FaceNumber{}, "number");
    add_options(c.arguments, options_of_written_surface(), "mesh", {},
                {{"mesh.project.method", "project_method"}, {"mesh.project.tolerance", "project_tolerance"}});
    add_options(c.arguments, TextureOptions{}, "texture");
    // The default is the tile of the material, if it is known.
    for (Argument& a : c.arguments) {
        if (a.name == "tile" || a.name == "tile_height") a.initial.clear();
    }
    c.arguments.push_back(
        object_option("material", ObjectKind::material, "Material of the bark; needs uv=bark."));
    c.arguments.push_back(object_option("twig_material", ObjectKind::material,
                                        "Material of the bark of twigs; needs material=."));
    add_options(c.arguments, SlotOptions{}, "slots");
    c.arguments.push_back(object_option("cut_material", ObjectKind::material,
                                        "Material of flat ends, of which the colour is a picture of a cut "
                                        "that fills it; needs material=."));
    c.arguments.push_back({.name = "displace",
                           .help = "Displace the surface by the heights of the material.",
                           .type = ArgumentType::flag,
                           .initial = "false"});
    add_options(c.arguments, DisplaceOptions{}, "displace");
    c.run = [](const SceneCall& call) {
        const Skeleton& skeleton = call.skeleton(call.text("tree"));
        auto options = call.options("mesh", options_of_written_surface());
        options.texture = texture_options(call, options.method);
        options.slots = slot_options(call, options.method);
        const int faces = call.options<FaceNumber>("number").faces;
        if (faces > 0)
            return makes_surface_of_faces(call, skeleton, options, static_cast<std::uint64_t>(faces));
        call.reserve(memory_of_mesh(skeleton, options));
        return makes_surface(call, skeleton, options.control,
                             mesh_skeleton(skeleton, options, call.context()), {});
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> tree_commands() {
    return {grow_command(),   sprout_command(),  limb_command(),     radii_command(),
            size_command(),   tidy_command(),    loadtree_command(), mesh_command(),
            leaves_command(), extract_command(), sketch_command(),   join_command()};
}

}  // namespace coppice
