#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_sketch/colmap_internal.h"
#include "coppice/io_sketch/json_value_internal.h"
#include "coppice/io_sketch/phenomenal_internal.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/sketch/snapshot.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

using namespace io_internal;

constexpr std::uint64_t kLargestSketch = std::uint64_t{256} << 20;

/// A view as in the file; the camera of a snapshot is computed from the strokes.
struct ReadView {
    SketchView view;
    std::optional<Snapshot> snapshot;
};

DrawingSide parse_side(const Value& value) {
    return value.choice<DrawingSide>({{"front", DrawingSide::front},
                                      {"back", DrawingSide::back},
                                      {"side", DrawingSide::side},
                                      {"left", DrawingSide::left},
                                      {"top", DrawingSide::top}});
}

ReadView parse_drawing(const Value& value) {
    value.expect_members({"name", "image", "width", "height", "orthographic", "pixels_per_metre", "origin"});
    const DrawingSide side = parse_side(value.member("orthographic"));
    if (!value.has("pixels_per_metre") && !value.has("origin"))
        return {.view = {}, .snapshot = Snapshot{.side = side}};
    const auto [x, y] = value.member("origin").get_numbers<2>();
    const Value scale = value.member("pixels_per_metre");
    if (!(scale.number() > 0)) scale.fail("must be above 0");
    return {.view = drawing_view(side, scale.number(), {x, y}), .snapshot = {}};
}

ReadView parse_photograph(const Value& value) {
    value.expect_members({"name", "image", "width", "height", "photograph", "field_of_view"});
    const Value angle = value.member("field_of_view");
    if (!(angle.number() > 0 && angle.number() < 180)) angle.fail("must be between 0 and 180 degrees");
    return {.view = {},
            .snapshot = Snapshot{.side = parse_side(value.member("photograph")),
                                 .field_of_view = angle.number() * std::numbers::pi / 180}};
}

/// Returns the path of a file that a sketch names; throws if it may not be read.
using FindFile = std::function<std::filesystem::path(const std::filesystem::path& name)>;

FindFile files_in(const std::filesystem::path& folder) {
    return [folder](const std::filesystem::path& name) { return folder / name; };
}

SketchView parse_colmap_view(const Value& value, const FindFile& find) {
    value.expect_members({"name", "image", "colmap"});
    const std::filesystem::path model = value.member("colmap").text();
    find(model / "cameras.txt");
    return read_colmap_view(find(model / "images.txt").parent_path(), value.member("image").text());
}

SketchView parse_phenomenal_view(const Value& value, const FindFile& find) {
    value.expect_members({"name", "image", "phenomenal", "camera", "angle"});
    return read_phenomenal_view(find(value.member("phenomenal").text()), value.member("camera").text(),
                                value.member("angle").number() * std::numbers::pi / 180);
}

SketchView parse_camera(const Value& value) {
    value.expect_members(
        {"name", "image", "width", "height", "projection", "K", "R", "rvec", "t", "distortion"});
    SketchView view;
    if (value.has("projection")) {
        view.projection = value.member("projection")
                              .choice<Projection>({{"perspective", Projection::perspective},
                                                   {"orthographic", Projection::orthographic}});
    }
    view.k = value.member("K").matrix();
    if (value.has("rvec") && !value.has("R")) {
        const auto [a, b, c] = value.member("rvec").get_numbers<3>();
        view.r = rotation_about({a, b, c});
    } else {
        view.r = value.member("R").matrix();
    }
    const auto [x, y, z] = value.member("t").get_numbers<3>();
    view.t = {x, y, z};
    if (value.has("distortion")) {
        const Value distortion = value.member("distortion");
        if (view.projection == Projection::orthographic) distortion.fail("is for perspective views");
        const std::vector<double> numbers = distortion.numbers();
        if (numbers.size() != 4 && numbers.size() != 5)
            distortion.fail("must be k1, k2, p1, p2 and, if known, k3");
        std::ranges::copy(numbers, view.distortion.begin());
    }
    return view;
}

ReadView parse_view(const Value& value, const FindFile& find) {
    ReadView out;
    if (value.has("orthographic")) {
        out = parse_drawing(value);
    } else if (value.has("photograph")) {
        out = parse_photograph(value);
    } else if (value.has("colmap")) {
        out.view = parse_colmap_view(value, find);
    } else if (value.has("phenomenal")) {
        out.view = parse_phenomenal_view(value, find);
    } else if (value.has("K")) {
        out.view = parse_camera(value);
    } else {
        value.fail("needs the camera's K, R and t, or colmap, phenomenal, photograph or orthographic");
    }
    out.view.name = value.member("name").text();
    if (value.has("image")) out.view.image = value.member("image").text();
    if (value.has("width")) out.view.width = value.member("width").pixels();
    if (value.has("height")) out.view.height = value.member("height").pixels();
    return out;
}

/// Transformation between the world in which cameras were calibrated and ours: Z up, in metres.
struct World {
    Matrix3 turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< from our world to theirs
    double metres_per_unit = 1;
};

World parse_world(const Value& value) {
    value.expect_members({"up", "metres_per_unit"});
    World world;
    if (value.has("up")) {
        const auto [x, y, z] = value.member("up").get_numbers<3>();
        const Vec3d up = normalized(Vec3d{x, y, z}, {0, 0, 0});
        if (up == Vec3d{}) value.member("up").fail("must have a direction");
        // The smallest rotation that maps z to up; half a turn about x if up points down.
        world.turn = up.z > -1 + 1e-9 ? compute_rotation(1 + up.z, {-up.y, up.x, 0})
                                      : Matrix3{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    }
    if (value.has("metres_per_unit")) {
        const Value scale = value.member("metres_per_unit");
        if (!(scale.number() > 0)) scale.fail("must be above 0");
        world.metres_per_unit = scale.number();
    }
    return world;
}

void bring_home(SketchView& view, const World& world) {
    view.r = view.r * world.turn;
    view.t = view.t * world.metres_per_unit;
}

using Names = std::map<std::string, std::uint32_t, std::less<>>;

std::uint32_t index_of(const Names& names, const std::string& name, const Value& value, const char* subject) {
    const auto found = names.find(name);
    if (found == names.end()) value.fail(fmt::format("names no {}: {}", subject, in_quotes(name)));
    return found->second;
}

Stroke make_stroke(const Value& value) {
    value.expect_members({"points", "widths"});
    Stroke stroke;
    for (const Value& point : value.member("points").items()) {
        const auto [x, y] = point.get_numbers<2>();
        stroke.points.push_back({x, y});
    }
    if (value.has("widths")) stroke.widths = value.member("widths").numbers();
    return stroke;
}

SketchBranch find_branch(const Value& value, const Names& views, const Names& branches) {
    value.expect_members({"name", "parent", "attach", "strokes", "diameters"});
    SketchBranch branch;
    branch.name = value.member("name").text();
    if (value.has("parent")) {
        const Value parent = value.member("parent");
        branch.parent = index_of(branches, parent.text(), parent, "branch");
    }
    if (value.has("attach")) branch.attach = value.member("attach").number();
    if (value.has("diameters")) branch.diameters = value.member("diameters").get_numbers<2>();
    for (const auto& [view, stroke] : value.member("strokes").members()) {
        branch.strokes.push_back(make_stroke(stroke));
        branch.strokes.back().view = index_of(views, view, stroke, "view");
    }
    std::ranges::sort(branch.strokes, {}, &Stroke::view);
    return branch;
}

Names collect_names(const std::vector<Value>& values) {
    Names names;
    for (const Value& value : values)
        names.emplace(value.member("name").text(), static_cast<std::uint32_t>(names.size()));
    return names;
}

void check_format(const SortedJson& json, const Value& file, const std::string& source) {
    if (!json.is_object() || json.value("format", SortedJson()) != "coppice-sketch")
        throw InvalidInput(source + ": this JSON is not a sketch: it needs \"format\": \"coppice-sketch\"");
    file.expect_members({"format", "version", "height", "world", "views", "branches"});
    if (const double version = file.member("version").number(); version > 1)
        throw Unsupported(
            fmt::format("{}: version {} of coppice-sketch is newer than this program", source, version));
}

SketchCameras make_cameras(const Value& file, const FindFile& find) {
    SketchCameras out;
    const World world = file.has("world") ? parse_world(file.member("world")) : World();
    if (file.has("height")) {
        const Value height = file.member("height");
        out.height = height.number();
        if (!(out.height > 0)) height.fail("must be above 0");
    }
    for (const Value& value : file.member("views").items()) {
        ReadView read = parse_view(value, find);
        if (value.has("K") || value.has("colmap")) bring_home(read.view, world);
        if (read.snapshot && out.height == 0) file.member("height");
        out.views.push_back(std::move(read.view));
        out.snapshots.push_back(read.snapshot);
    }
    return out;
}

Sketch make_sketch(std::string_view text, const std::string& source, const FindFile& find) {
    const SortedJson json = parse_json(text, source);
    const Value file(json, source + ":");
    check_format(json, file, source);
    SketchCameras cameras = make_cameras(file, find);
    Sketch sketch;
    sketch.views = std::move(cameras.views);
    const std::vector<Value> branches = file.member("branches").items();
    const Names view_names = collect_names(file.member("views").items()),
                branch_names = collect_names(branches);
    for (const Value& branch : branches)
        sketch.branches.push_back(find_branch(branch, view_names, branch_names));
    for (std::uint32_t v = 0; v < cameras.snapshots.size(); ++v) {
        if (const auto& snapshot = cameras.snapshots[v])
            sketch.views[v] =
                snapshot_view(sketch, v, *snapshot, cameras.height, fmt::format("{}: views[{}]", source, v));
    }
    validate(sketch, source);
    return sketch;
}

}  // namespace

bool is_sketch_name(const std::filesystem::path& path) {
    return path.filename().string().ends_with(".sketch.json");
}

namespace {

template <class FindFileIn>
SketchCameras cameras_in(std::string_view text, const std::string& source, const FindFileIn& files) {
    const SortedJson json = parse_json(text, source);
    const Value file(json, source + ":");
    check_format(json, file, source);
    return make_cameras(file, files);
}

}  // namespace

SketchCameras read_cameras(const std::filesystem::path& path, const Context& ctx) {
    return cameras_in(read_file(path, kLargestSketch, ctx), path.string(), files_in(path.parent_path()));
}

SketchCameras parse_cameras(std::string_view text, const std::string& source, const FolderSandbox& sandbox) {
    return cameras_in(text, source,
                      [&](const std::filesystem::path& name) { return sandbox.to_read(name.string()); });
}

TraceResult trace_views(const SketchCameras& cameras, std::span<const Mask> silhouettes,
                        const std::string& source, const Context& ctx) {
    Sketch extent{.views = cameras.views,
                  .branches = {{.name = "stem", .parent = {}, .strokes = {}, .attach = {}, .diameters = {}}}};
    for (std::uint32_t v = 0; v < cameras.views.size(); ++v) {
        if (!cameras.snapshots[v]) continue;
        const std::string where = fmt::format("{}: views[{}]", source, v);
        extent.branches[0].strokes.push_back(compute_extent(silhouettes[v], where));
        extent.branches[0].strokes.back().view = v;
        extent.views[v] = snapshot_view(extent, v, *cameras.snapshots[v], cameras.height, where);
    }
    return trace(extent.views, silhouettes, ctx);
}

Sketch parse_sketch(std::string_view text, const std::string& source, const std::filesystem::path& folder) {
    return make_sketch(text, source, files_in(folder));
}

Sketch parse_sketch(std::string_view text, const std::string& source, const FolderSandbox& sandbox) {
    return make_sketch(text, source,
                       [&](const std::filesystem::path& name) { return sandbox.to_read(name.string()); });
}

Sketch read_sketch(const std::filesystem::path& path, const Context& ctx) {
    return parse_sketch(read_file(path, kLargestSketch, ctx), path.string(), path.parent_path());
}

}  // namespace coppice
