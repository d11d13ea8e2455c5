#include <algorithm>

#include "coppice/implicit/solid/solid.h"
#include "coppice/scene/commands/tables_internal.h"

namespace coppice {
namespace {

using namespace table;

constexpr double kFar = 1e6;  // [m] maximum coordinate

/// Returns a command that creates a primitive, with its name, the arguments of its skeleton, radius and
/// influence.
SceneCommand primitive(std::string name, std::string help, std::string example,
                       std::vector<Argument> skeleton, float radius,
                       std::function<Solid(const SceneCall&, const PrimitiveOptions&)> make) {
    SceneCommand c = new_command(std::move(name), "Primitives", std::move(help), std::move(example));
    c.makes = ObjectKind::solid;
    c.arguments.push_back(new_name("name", "Name of the new solid."));
    std::ranges::move(skeleton, std::back_inserter(c.arguments));
    add_options(c.arguments, PrimitiveOptions{.radius = radius}, "primitive");
    c.run = [make = std::move(make)](const SceneCall& call) {
        const auto options = call.options<PrimitiveOptions>("primitive");
        constexpr std::uint64_t kBytesOfPoint = 600;
        return makes_solid(call.text("name"), make(call, options),
                           kBytesOfSolid + kBytesOfPoint * call.values("points").size());
    };
    return c;
}

Argument place(std::string name, std::string initial, std::string help) {
    Argument a = tuple(std::move(name), std::move(initial), std::move(help));
    a.low = -kFar;
    a.high = kFar;
    return a;
}

Argument axis() { return tuple("axis", "0,0,1", "Direction of the axis of symmetry.", {3}, Unit::none); }

Argument skeleton_radius(std::string name, std::string initial, std::string help) {
    return number(std::move(name), std::move(initial), 0, 1e5, Unit::metre, std::move(help));
}

Argument point_list(std::string help) {
    Argument a = positional(repeated(place("points", "", std::move(help))));
    a.initial.clear();
    return a;
}

Argument closed() {
    Argument a{.name = "closed", .help = "Connect the last point to the first."};
    a.type = ArgumentType::flag;
    a.initial = "false";
    return a;
}

float as_float(double v) { return static_cast<float>(v); }

SceneCommand sphere_command() {
    return primitive("sphere", "Create a ball, which becomes an ellipsoid if scaled unevenly.", "sphere s",
                     {place("center", "0,0,0", "Centre of the ball.")}, 1,
                     [](const SceneCall& c, const auto& o) { return sphere(c.point("center"), o); });
}

SceneCommand line_command() {
    return primitive(
        "line", "Create a capsule: all points near a segment.", "line l from=0,0,0 to=0,0,4 radius=0.5",
        {place("from", "0,0,0", "One end of the segment."),
         place("to", "0,0,1", "Other end of the segment.")},
        0.25f, [](const SceneCall& c, const auto& o) { return line(c.point("from"), c.point("to"), o); });
}

SceneCommand circle_command() {
    SceneCommand command = primitive(
        "circle", "Create a torus: all points near a circle.", "circle ring skeleton_radius=2 radius=0.4",
        {place("center", "0,0,0", "Centre of the circle."), axis(),
         skeleton_radius("skeleton_radius", "1", "Radius of the circle.")},
        0.25f, [](const SceneCall& c, const auto& o) {
            return circle(c.point("center"), c.point("axis"), as_float(c.number("skeleton_radius")), o);
        });
    command.aliases = {"torus"};
    return command;
}

SceneCommand disc_command() {
    return primitive("disc", "Create all points near a disc.", "disc plate skeleton_radius=2 radius=0.2",
                     {place("center", "0,0,0", "Centre of the disc."), axis(),
                      skeleton_radius("skeleton_radius", "1", "Radius of the disc.")},
                     0.1f, [](const SceneCall& c, const auto& o) {
                         return disc(c.point("center"), c.point("axis"),
                                     as_float(c.number("skeleton_radius")), o);
                     });
}

SceneCommand box_command() {
    return primitive("box", "Create a box with round edges: all points near a box.",
                     "box b low=-1,-1,0 high=1,1,1 radius=0.1",
                     {place("low", "-1,-1,-1", "Minimum corner of the box."),
                      place("high", "1,1,1", "Maximum corner of the box.")},
                     0.1f, [](const SceneCall& c, const auto& o) {
                         return box(Box3{c.point("low"), c.point("high")}, o);
                     });
}

SceneCommand cylinder_command() {
    return primitive(
        "cylinder", "Create a cylinder with round edges: all points near a cylinder.",
        "cylinder drum from=0,0,0 to=0,0,2 skeleton_radius=1",
        {place("from", "0,0,0", "Centre of one end."), place("to", "0,0,1", "Centre of the other end."),
         skeleton_radius("skeleton_radius", "1", "Radius of the cylinder.")},
        0.1f, [](const SceneCall& c, const auto& o) {
            return cylinder(c.point("from"), c.point("to"), as_float(c.number("skeleton_radius")), o);
        });
}

SceneCommand cone_command() {
    return primitive(
        "cone", "Create a cone or truncated cone with round edges: all points near it.",
        "cone hat from=0,0,0 to=0,0,3 from_radius=2",
        {place("from", "0,0,0", "Centre of one end."), place("to", "0,0,1", "Centre of the other end."),
         skeleton_radius("from_radius", "1", "Radius of the cone at the first end."),
         skeleton_radius("to_radius", "0", "Radius of the cone at the other end.")},
        0.1f, [](const SceneCall& c, const auto& o) {
            return cone(c.point("from"), c.point("to"), as_float(c.number("from_radius")),
                        as_float(c.number("to_radius")), o);
        });
}

SceneCommand polyline_command() {
    return primitive(
        "polyline", "Create all points near a polyline.",
        "polyline zigzag 0,0,0 1,0,1 0,0,2 1,0,3 radius=0.2",
        {point_list("At least two points, as x,y,z."), closed()}, 0.25f,
        [](const SceneCall& c, const auto& o) { return polyline(c.points("points"), c.flag("closed"), o); });
}

SceneCommand spline_command() {
    std::vector<Argument> arguments{
        point_list("At least two points, as x,y,z; the curve passes through all of them.")};
    add_options(arguments, CurveOptions{}, "curve");
    SceneCommand c = primitive("spline", "Create all points near a smooth curve through points.",
                               "spline snake 0,0,0 2,0,1 0,2,2 -2,0,3 radius=0.4", std::move(arguments),
                               0.25f, [](const SceneCall& call, const auto& o) {
                                   Curve curve(call.points("points"), call.options<CurveOptions>("curve"));
                                   return make_solid(std::make_shared<CurveShape>(std::move(curve)), o);
                               });
    return c;
}

SceneCommand polygon_command() {
    return primitive("polygon", "Create all points near a planar polygon with at least three corners.",
                     "polygon leaf 0,0,0 2,0,0 2,2,0 0,2,0 radius=0.1",
                     {point_list("Corners in a plane, as x,y,z.")}, 0.1f,
                     [](const SceneCall& c, const auto& o) { return polygon(c.points("points"), o); });
}

}  // namespace

std::vector<SceneCommand> primitive_commands() {
    return {sphere_command(),   line_command(), circle_command(),   disc_command(),   box_command(),
            cylinder_command(), cone_command(), polyline_command(), spline_command(), polygon_command()};
}

}  // namespace coppice
