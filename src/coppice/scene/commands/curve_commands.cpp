#include <fmt/format.h>

#include <algorithm>

#include "coppice/implicit/shape/revolution.h"
#include "coppice/implicit/shape/skin.h"
#include "coppice/implicit/shape/sweep.h"
#include "coppice/implicit/shape/variational.h"
#include "coppice/implicit/shape/variational_curve.h"
#include "coppice/implicit/solid/mesh_solid.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/mesh/topology.h"
#include "coppice/scene/commands/tables_internal.h"

namespace coppice {
namespace {

using namespace table;

constexpr std::string_view kGroup = "Profiles, paths and other surfaces";
constexpr std::size_t kMaxContours = 1000;
constexpr std::size_t kMaxSections = 1000;
constexpr double kBytesOfCurvePoint = 600;

float as_float(double v) { return static_cast<float>(v); }

SceneCommand in_group(ObjectKind makes, std::string name, std::string help, std::string example) {
    SceneCommand c = new_command(std::move(name), std::string(kGroup), std::move(help), std::move(example));
    c.makes = makes;
    return c;
}

Argument& find_argument(SceneCommand& c, std::string_view name) {
    return *std::ranges::find(c.arguments, name, &Argument::name);
}

/// Adds the options of influence and falloff of a closed shape.
void add_field_options(SceneCommand& c) {
    add_options(c.arguments, PrimitiveOptions{}, "primitive", {"radius"});
    find_argument(c, "influence").help =
        "Distance above and below the surface to which the field extends; 0 uses half the shortest side.";
}

SceneOutcome makes_closed(const SceneCall& call, std::shared_ptr<const Shape> shape, double bytes) {
    return makes_solid(call.text("name"),
                       make_solid(std::move(shape), call.options<PrimitiveOptions>("primitive")),
                       kBytesOfSolid + static_cast<std::uint64_t>(bytes));
}

std::vector<Vec2d> plane_points(const SceneCall& call) {
    std::vector<Vec2d> out;
    for (const ArgumentValue& v : call.values("points")) out.push_back({v.numbers.at(0), v.numbers.at(1)});
    return out;
}

Profile made_profile(const SceneCall& call, CurveKind kind) {
    std::vector<Vec2d> points = plane_points(call);
    const double radius = call.number("circle");
    if (points.empty() == (radius <= 0))
        throw InvalidInput("a profile is made of points or of circle=RADIUS, but not of both");
    const bool closed = call.flag("closed");
    if (radius > 0) {
        if (!closed) throw InvalidInput("a circle is closed; leave out closed=false");
        const auto& c = call.values("center").front().numbers;
        points = circle_contour({c.at(0), c.at(1)}, radius, static_cast<int>(call.number("corners")));
        kind = CurveKind::polyline;
    }
    Profile one(points, kind, closed);
    if (!call.has("add")) return one;
    const Profile& other = call.profile(call.text("add"));
    if (!closed || !other.closed()) throw InvalidInput("only closed profiles can be added to each other");
    std::vector<std::vector<Vec2d>> all(other.contours().begin(), other.contours().end());
    all.insert(all.end(), one.contours().begin(), one.contours().end());
    if (all.size() > kMaxContours)
        throw InvalidInput(fmt::format("a profile has at most {} contours", kMaxContours));
    return Profile(all);
}

std::size_t corner_count(const Profile& profile) {
    std::size_t n = 0;
    for (const auto& contour : profile.contours()) n += contour.size();
    return n;
}

SceneCommand profile_command() {
    SceneCommand c = in_group(ObjectKind::profile, "profile",
                              "Create a line or an area in a plane, for revolve, sweep and skin.",
                              "profile vase 0,0 1,0 0.6,1.5 0.9,2.5 closed=false");
    c.arguments = {new_name("name", "Name of the new profile."),
                   positional(repeated(tuple("points", "", "Points x,y.", {2})), false),
                   number("circle", "0", 0, 1e6, Unit::metre, "Radius of a circle that replaces the points."),
                   tuple("center", "0,0", "Centre of the circle.", {2}),
                   number("corners", "64", 3, 10'000, Unit::none, "Number of corners of the circle."),
                   object_option("add", ObjectKind::profile,
                                 "Profile with contours to add; a contour inside another is a hole.")};
    c.arguments[4].type = ArgumentType::whole;
    CurveOptions straight;
    straight.kind = CurveKind::polyline;
    straight.closed = true;
    add_options(c.arguments, straight, "curve");
    c.run = [](const SceneCall& call) {
        Profile made = made_profile(call, call.options<CurveOptions>("curve").kind);
        const auto bytes = static_cast<std::uint64_t>(kBytesOfCurvePoint) * corner_count(made);
        return makes(call.text("name"), std::move(made), bytes);
    };
    return c;
}

/// Returns points with normals: the given normals, or if there are none, those of a closed line through the
/// points in order.
std::vector<OrientedPoint> contour_points(const SceneCall& call) {
    std::vector<OrientedPoint> out;
    std::size_t with_normal = 0;
    for (const ArgumentValue& v : call.values("points")) {
        const auto& n = v.numbers;
        out.push_back({{n.at(0), n.at(1)}, {0, 0}});
        if (n.size() < 4) continue;
        out.back().normal = {n.at(2), n.at(3)};
        ++with_normal;
    }
    if (with_normal == out.size()) return out;
    if (with_normal > 0)
        throw InvalidInput("either all points have normals, as x,y,nx,ny, or none has one, as x,y");
    return with_normals(plane_points(call));
}

SceneCommand contour_command() {
    SceneCommand c =
        in_group(ObjectKind::profile, "contour",
                 "Create the smoothest closed line through points (a variational curve) as a profile.",
                 "contour bean 1,0 0,0.8 -1,0 0,0.2");
    c.arguments = {
        new_name("name", "Name of the new profile."),
        positional(repeated(tuple(
            "points", "",
            "Points in order around the area as x,y, or in any order with outward normals as x,y,nx,ny.",
            {2, 4})))};
    add_options(c.arguments, VariationalOptions{}, "contour");
    find_argument(c, "margin").help =
        "Distance from the bounding box of the points at which the area ends, as a multiple of the size of "
        "the box.";
    c.run = [](const SceneCall& call) {
        const auto points = contour_points(call);
        const double n = static_cast<double>(points.size());
        call.reserve(64 * n * n);
        Profile made =
            variational_profile(points, call.options<VariationalOptions>("contour"), call.context());
        const auto bytes = static_cast<std::uint64_t>(kBytesOfCurvePoint) * corner_count(made);
        return makes(call.text("name"), std::move(made), bytes);
    };
    return c;
}

SceneCommand path_command() {
    SceneCommand c =
        in_group(ObjectKind::path, "path", "Create a curve through points in space, for sweep and skin.",
                 "path spine 0,0,0 0,0,2 1,0,4");
    c.arguments = {new_name("name", "Name of the new path."),
                   positional(repeated(tuple("points", "", "At least two points, as x,y,z.")))};
    add_options(c.arguments, CurveOptions{}, "curve");
    c.run = [](const SceneCall& call) {
        const auto points = call.points("points");
        Curve curve(points, call.options<CurveOptions>("curve"));
        const auto bytes = static_cast<std::uint64_t>(kBytesOfCurvePoint) * points.size();
        return makes(call.text("name"), std::move(curve), bytes);
    };
    return c;
}

SceneCommand revolve_command() {
    SceneCommand c =
        in_group(ObjectKind::solid, "revolve",
                 "Revolve a profile about an axis; x is the distance from the axis, y the height.",
                 "revolve pot vase");
    c.arguments = {new_name("name", "Name of the new solid."),
                   object("profile", ObjectKind::profile, "Profile to revolve."),
                   tuple("origin", "0,0,0", "Point of the axis at which y is 0."),
                   tuple("axis", "0,0,1", "Direction of the axis.", {3}, Unit::none)};
    add_field_options(c);
    c.run = [](const SceneCall& call) {
        const Profile& profile = call.profile(call.text("profile"));
        const Axis axis{call.point("origin"), call.point("axis")};
        return makes_closed(call, std::make_shared<Revolution>(profile, axis),
                            kBytesOfCurvePoint * static_cast<double>(corner_count(profile)));
    };
    return c;
}

SceneCommand sweep_command() {
    SceneCommand c = in_group(ObjectKind::solid, "sweep", "Sweep a closed profile along a path.",
                              "profile round circle=0.4\nsweep worm round spine scale=0,1 scale=1,0.3");
    c.arguments = {
        new_name("name", "Name of the new solid."),
        object("profile", ObjectKind::profile, "Profile to sweep."),
        object("path", ObjectKind::path, "Path of the sweep."),
        repeated(tuple("scale", "", "FRACTION,FACTOR: scale of the profile at a fraction of the length.", {2},
                       Unit::none))};
    add_options(c.arguments, SweepOptions{}, "sweep");
    add_field_options(c);
    c.run = [](const SceneCall& call) {
        std::vector<ScaleAt> scales;
        for (const ArgumentValue& v : call.values("scale"))
            scales.push_back({as_float(v.numbers.at(0)), as_float(v.numbers.at(1))});
        const Profile& profile = call.profile(call.text("profile"));
        const double bytes = kBytesOfCurvePoint * (call.path(call.text("path")).span_count() +
                                                   static_cast<double>(corner_count(profile)));
        call.reserve(bytes);
        return makes_closed(call,
                            std::make_shared<Sweep>(call.path(call.text("path")), profile, scales,
                                                    call.options<SweepOptions>("sweep")),
                            bytes);
    };
    return c;
}

SceneCommand skin_command() {
    SceneCommand c =
        in_group(ObjectKind::solid, "skin", "Create a surface through profiles at positions of a path.",
                 "profile square -1,-1 1,-1 1,1 -1,1\n"
                 "skin column spine square@0 round@0.6 square@1 blend=quadratic");
    c.arguments = {new_name("name", "Name of the new solid."),
                   object("path", ObjectKind::path, "Path perpendicular to the profiles.")};
    Argument sections{.name = "sections"};
    sections.help =
        "PROFILE@FRACTION: a profile and the fraction of the length of the path; several profiles at one "
        "position are united.";
    sections.type = ArgumentType::section;
    sections.positional = sections.required = sections.repeats = true;
    sections.low = 0;
    sections.high = 1;
    c.arguments.push_back(std::move(sections));
    add_options(c.arguments, SkinOptions{}, "skin");
    add_field_options(c);
    c.run = [](const SceneCall& call) {
        std::vector<SkinSection> sections_of_skin;
        double corners = call.path(call.text("path")).span_count();
        if (call.values("sections").size() > kMaxSections)
            throw InvalidInput(fmt::format("a skin has at most {} sections", kMaxSections));
        for (const ArgumentValue& v : call.values("sections")) {
            const Profile& profile = call.profile(v.text);
            corners += static_cast<double>(corner_count(profile));
            call.reserve(kBytesOfCurvePoint * corners);
            sections_of_skin.push_back({as_float(v.numbers.at(0)), profile});
        }
        return makes_closed(call,
                            std::make_shared<Skin>(call.path(call.text("path")), std::move(sections_of_skin),
                                                   call.options<SkinOptions>("skin")),
                            kBytesOfCurvePoint * corners);
    };
    return c;
}

/// Returns points and normals from x,y,z,nx,ny,nz.
std::pair<std::vector<Vec3>, std::vector<Vec3>> oriented_points(const SceneCall& call) {
    std::vector<Vec3> points, normals;
    for (const ArgumentValue& v : call.values("points")) {
        const auto& n = v.numbers;
        points.push_back(Vec3(Vec3d(n.at(0), n.at(1), n.at(2))));
        normals.push_back(Vec3(Vec3d(n.at(3), n.at(4), n.at(5))));
    }
    return {points, normals};
}

SceneCommand variational_command() {
    SceneCommand c = in_group(ObjectKind::solid, "variational",
                              "Create the smoothest closed surface through points with outward normals.",
                              "variational pebble 1,0,0,1,0,0 -1,0,0,-1,0,0 0,1,0,0,1,0 0,-1,0,0,-1,0 "
                              "0,0,0.5,0,0,1 0,0,-0.5,0,0,-1");
    c.aliases = {"points"};
    c.arguments = {
        new_name("name", "Name of the new solid."),
        positional(repeated(tuple("points", "", "Points and their normals, as x,y,z,nx,ny,nz.", {6})))};
    add_options(c.arguments, VariationalOptions{}, "variational");
    add_field_options(c);
    c.run = [](const SceneCall& call) {
        const auto [points, normals] = oriented_points(call);
        const double n = static_cast<double>(std::min(points.size(), Variational::kMaxPoints));
        call.reserve(12 * n * n);  // 290 MB for 5,000 points
        return makes_closed(
            call,
            std::make_shared<Variational>(points, normals, call.options<VariationalOptions>("variational"),
                                          call.context()),
            200 * n);
    };
    return c;
}

SceneCommand loadmesh_command() {
    SceneCommand c =
        in_group(ObjectKind::mesh, "loadmesh", "Read a mesh from a file.", "loadmesh cube cube.obj");
    c.arguments = {new_name("name", "Name of the new mesh."),
                   file("file", ArgumentType::input_file, "Mesh file: .obj, .ply, .off, .stl or .glb.")};
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.input("file");
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        if (!error) call.reserve(4.0 * static_cast<double>(size));
        PolygonMesh mesh = read_mesh(path, call.context());
        validate(mesh);
        Surface surface{std::move(mesh)};
        const std::uint64_t bytes = compute_memory(surface);
        return makes(call.text("name"), std::move(surface), bytes);
    };
    return c;
}

SceneCommand solid_command() {
    SceneCommand c = in_group(ObjectKind::solid, "solid", "Convert a closed mesh to a solid.",
                              "solid rest_mesh influence=5");
    c.arguments = {object("mesh", ObjectKind::mesh, "Closed mesh to convert."),
                   positional(new_name("name", "Name of the new solid.", "@mesh"), false)};
    add_field_options(c);
    c.run = [](const SceneCall& call) {
        constexpr double kBytesOfTriangle = 100;
        const Surface& surface = call.surface(call.text("mesh"));
        const double bytes = kBytesOfTriangle * 2 * static_cast<double>(face_count(surface));
        call.reserve(bytes);
        const TriMesh mesh = to_triangles(surface);
        std::vector<Vec3> world;
        world.reserve(mesh.positions.size());
        for (const Vec3 p : mesh.positions) world.push_back(Vec3(mesh.origin + Vec3d(p)));
        return makes_closed(call, std::make_shared<MeshSolid>(world, mesh.triangles, call.context()), bytes);
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> curve_commands() {
    return {profile_command(), contour_command(),     path_command(),     revolve_command(), sweep_command(),
            skin_command(),    variational_command(), loadmesh_command(), solid_command()};
}

}  // namespace coppice
