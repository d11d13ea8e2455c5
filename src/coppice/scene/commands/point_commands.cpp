#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/implicit/polygonize/cached_field.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_points/writer.h"
#include "coppice/points/edit_points.h"
#include "coppice/points/quality.h"
#include "coppice/points/sampling/near_mesh.h"
#include "coppice/scene/commands/density_internal.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

using namespace table;

constexpr double kMebibyte = 1 << 20;
constexpr std::array<std::string_view, 4> kKernelShorthands{"distance", "spacing", "cluster_reach",
                                                            "cluster_gain"};

SceneCommand in_group(const std::string& name, std::string help, std::string example) {
    SceneCommand c = new_command("pointset " + name, "Points", std::move(help), std::move(example));
    c.makes = ObjectKind::points;
    return c;
}

Argument points(std::string help) { return object("points", ObjectKind::points, std::move(help)); }

/// Returns a new name that is given as name=.
Argument name_option(std::string initial) {
    Argument a = new_name("name", "Name of the new points.", std::move(initial));
    a.positional = false;
    return a;
}

void make_positional(std::vector<Argument>& arguments, std::string_view name, bool required) {
    Argument& a = *std::ranges::find(arguments, name, &Argument::name);
    a.positional = true;
    a.required = required;
}

SceneOutcome makes_points(const std::string& name, PointSet set) {
    const std::uint64_t bytes = compute_memory(set);
    return makes(name, std::move(set), bytes);
}

/// Returns the remaining memory, at most the requested amount.
int memory_left(const SceneCall& call, int requested) {
    const double left = call.settings().max_memory - static_cast<double>(call.state().bytes) / kMebibyte;
    return std::clamp(static_cast<int>(left), 1, requested);
}

/// Returns the maximum difference between field values at points and at the surface, for a field that is
/// cached only in this band.
float compute_band(const SceneCall& call, const GenerateOptions& options, float level) {
    constexpr float kMax = 10;
    CacheOptions plain;
    if (call.has("curve")) {
        for (const auto& knot : read_knots<DensityCurve::Knot>(call, "curve"))
            plain.band = std::max(plain.band, 1.1f * std::abs(knot.value - level));
        return std::min(plain.band, kMax);
    }
    if (options.density == PointDensity::uniform) return plain.band;
    const bool whole =
        options.density == PointDensity::proportional || options.density == PointDensity::inverse;
    return whole ? kMax : std::clamp(1.1f * options.width, plain.band, kMax);
}

/// Generates points in a field, directly or cached on a grid.
GenerateResult generate_in(const SceneCall& call, const PointRegion& region, const GenerateOptions& options) {
    if (!call.has("kernel")) return generate(region, options, call.context());
    const bool by_lane =
        options.pattern == PointPattern::poisson_disk || options.pattern == PointPattern::clustered;
    if (!by_lane)
        throw InvalidInput(
            fmt::format("kernel= is for points that interact, not for {}; leave the pattern out",
                        name_of(options.pattern)));
    for (const std::string_view name : kKernelShorthands) {
        if (call.has(name))
            throw InvalidInput(fmt::format("kernel= defines the interaction of points; leave out {}=", name));
    }
    DartThrowingOptions lane;
    lane.count = options.count;
    lane.resolution = options.resolution;
    lane.seed = options.seed;
    lane.max_memory = options.max_memory;
    DartThrowingResult placed = sample_dart_throwing(region, make_kernel(call), lane, call.context());
    return {std::move(placed.points), placed.stop, placed.distance, placed.tries};
}

GenerateResult generated(const SceneCall& call, const SolidField& field) {
    auto options = call.options<GenerateOptions>("generate");
    options.max_memory = memory_left(call, options.max_memory);
    const DensityCurve density = compute_density(call, options, field.level());
    const Box3 box = density_box(call, options, field);
    if (call.flag("cached")) {
        CacheOptions cache;
        cache.cell = static_cast<float>(call.number("cell"));
        cache.band = compute_band(call, options, field.level());
        const CachedField cached(field, cache, call.context());
        return generate_in(call, {FieldRef(cached), box, density}, options);
    }
    if (call.number("cell") > 0)
        throw InvalidInput("cell= is the cell size of the grid of cached=true; give both");
    return generate_in(call, {FieldRef(field), box, density}, options);
}

SceneCommand generate_command() {
    SceneCommand c = in_group("generate", "Fill a solid, or a shell at its surface, with points.",
                              "pointset generate s poisson count=500");
    c.aliases = {"pointset gen"};
    c.arguments = {object("solid", ObjectKind::solid, "Solid to fill.")};
    add_options(c.arguments, GenerateOptions{}, "generate");
    make_positional(c.arguments, "pattern", false);
    for (Argument& a : c.arguments) {
        if (std::ranges::find(kKernelShorthands, a.name) != kKernelShorthands.end()) a.unless = "kernel";
    }
    Argument properties = positional(file("properties", ArgumentType::properties,
                                          "File of options, which apply unless given in the command."),
                                     false);
    const auto pattern = std::ranges::find(c.arguments, "pattern", &Argument::name);
    c.arguments.insert(pattern + 1, std::move(properties));
    Argument cached{.name = "cached", .help = "Cache the field on a grid, for solids of many parts."};
    cached.type = ArgumentType::flag;
    cached.initial = "false";
    c.arguments.push_back(std::move(cached));
    c.arguments.push_back(number("cell", "0", 0, 1e6, Unit::metre,
                                 "Edge length of the cells of that grid; 0 uses 1/64 of the longest side."));
    c.arguments.push_back(curve_argument());
    c.arguments.push_back(
        kernel_argument("DISTANCE,FACTOR: a point of the curve by which a point changes the density around "
                        "it, 0 below the first distance; replaces the disks and clusters of the pattern."));
    c.arguments.push_back(name_option("@solid"));
    c.run = [](const SceneCall& call) {
        const SolidField field = call.field(call.text("solid"));
        GenerateResult result = generated(call, field);
        const int requested = static_cast<int>(call.number("count"));
        const std::size_t placed = result.points.size();
        SceneOutcome out = makes_points(call.text("name"), std::move(result.points));
        if (requested > 0 && result.stop != PointStop::count_reached)
            out.text = fmt::format("{} of {} points were placed\n", placed, requested);
        return out;
    };
    return c;
}

SceneCommand near_command() {
    SceneCommand c = in_group("near", "Generate points near a mesh, within limits along its normals.",
                              "pointset near rest_mesh count=300 high=2 name=ivy");
    c.arguments = {object("mesh", ObjectKind::mesh, "Mesh near which points are generated.")};
    add_options(c.arguments, NearMeshOptions{}, "near");
    c.arguments.push_back(name_option("@mesh"));
    c.run = [](const SceneCall& call) {
        auto options = call.options<NearMeshOptions>("near");
        options.max_memory = memory_left(call, options.max_memory);
        const Surface& surface = call.surface(call.text("mesh"));
        call.reserve(4.0 * static_cast<double>(compute_memory(surface)));
        return makes_points(call.text("name"), near_mesh(to_triangles(surface), options, call.context()));
    };
    return c;
}

SceneCommand thin_command() {
    SceneCommand c = in_group("thin", "Remove a random fraction of the points inside a solid.",
                              "sphere secondary radius=40\npointset thin s secondary 80");
    c.arguments = {points("Points to thin."),
                   object("solid", ObjectKind::solid, "Solid that limits the change.")};
    add_options(c.arguments, RemoveRandomOptions{}, "thin");
    make_positional(c.arguments, "percent", true);
    c.run = [](const SceneCall& call) {
        const SolidField field = call.field(call.text("solid"));
        const std::string& name = call.text("points");
        return makes_points(name, remove_random(call.point_set(name), FieldRef(field),
                                                call.options<RemoveRandomOptions>("thin"), call.context()));
    };
    return c;
}

SceneCommand densify_command() {
    SceneCommand c =
        in_group("densify", "Add points inside a solid with a minimum distance from all other points.",
                 "pointset densify s secondary count=50 distance=2");
    c.arguments = {points("Points to extend."),
                   object("solid", ObjectKind::solid, "Solid that limits the change.")};
    add_options(c.arguments, DartThrowingOptions{}, "lane", {"max_factor"});
    c.arguments.push_back(
        number("distance", "0", 0, 1e9, Unit::metre, "Minimum distance of the new points."));
    c.arguments.back().unless = "kernel";
    c.arguments.push_back(
        kernel_argument("DISTANCE,FACTOR: a point of the curve of a kernel, as in pointset generate."));
    c.run = [](const SceneCall& call) {
        const SolidField field = call.field(call.text("solid"));
        const PointRegion region{FieldRef(field), field.surface_bounds(),
                                 DensityCurve(PointDensity::uniform, field.level())};
        auto options = call.options<DartThrowingOptions>("lane");
        options.max_memory = memory_left(call, options.max_memory);
        const std::string& name = call.text("points");
        if (call.has("kernel") && call.has("distance"))
            throw InvalidInput("kernel= begins with the minimum distance; leave out distance=");
        const auto kernel = call.has("kernel")
                                ? make_kernel(call)
                                : RadialKernel::disk(static_cast<float>(call.number("distance")));
        return makes_points(name, densified(call.point_set(name), region, kernel, options, call.context()));
    };
    return c;
}

SceneCommand add_command() {
    SceneCommand c = in_group("add", "Add the points of one set to another.", "pointset add s ivy");
    c.arguments = {points("Points to extend."), object("more", ObjectKind::points, "Points to add.")};
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("points");
        const PointSet &a = call.point_set(name), &b = call.point_set(call.text("more"));
        call.reserve(static_cast<double>(compute_memory(a) + compute_memory(b)));
        return makes_points(name, merged(a, b));
    };
    return c;
}

SceneCommand load_command() {
    SceneCommand c = in_group("load", "Read points from a file.", "pointset load stored points.xyz");
    c.arguments = {new_name("name", "Name of the new points."),
                   file("file", ArgumentType::input_file,
                        "Point file: .xyz, .txt, .csv, .asc, .pts, .ptx, .ply, .pcd, .las or .laz.")};
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.input("file");
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        if (!error) call.reserve(4.0 * static_cast<double>(size));
        return makes_points(call.text("name"), read_points(path, call.context()));
    };
    return c;
}

SceneCommand save_command() {
    SceneCommand c = in_group("save", "Write points to a file.", "pointset save s points.xyz");
    c.records = false;
    c.makes.reset();
    c.arguments = {points("Points to write."), file("file", ArgumentType::output_file,
                                                    "Point file: .las, .ply, .xyz, .txt, .csv or .asc.")};
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("file");
        if (!point_format_of_name(path))
            throw InvalidInput(fmt::format("'{}' is not a valid file name for points; {}", path.string(),
                                           remedy_for_points_name(path)));
        if (call.settings().outputs) write_points(path, call.point_set(call.text("points")), call.context());
        return SceneOutcome{};
    };
    return c;
}

SceneCommand quality_command() {
    SceneCommand c = in_group("quality", "Measure the uniformity of points, and draw its curves as SVG.",
                              "pointset quality s");
    c.records = false;
    c.makes.reset();
    Argument picture = file("file", ArgumentType::output_file, "Image to write (.svg).");
    picture.required = false;
    c.arguments = {points("Points to measure."), std::move(picture)};
    c.run = [](const SceneCall& call) {
        const QualityReport report = quality(call.point_set(call.text("points")), {}, call.context());
        if (call.has("file")) {
            const std::filesystem::path path = call.output("file");
            if (path.extension() != ".svg")
                throw InvalidInput(
                    fmt::format("'{}' is not a valid name for this image; use .svg", path.string()));
            if (call.settings().outputs) write_file(path, quality_svg(report));
        }
        SceneOutcome out;
        out.text = fmt::format(
            "min_distance_m  {:.6g}\nmean_distance_m   {:.6g}\nmean_spacing_m    {:.6g}\nlow_power         "
            "{:.4g}\n",
            report.min_distance, report.mean_distance, report.mean_spacing, report.low_power);
        return out;
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> point_commands() {
    return {generate_command(), near_command(), thin_command(), densify_command(),
            add_command(),      save_command(), load_command(), quality_command()};
}

}  // namespace coppice
