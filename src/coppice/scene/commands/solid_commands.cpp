#include <fmt/format.h>

#include <cmath>

#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/options/quantity.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/skeleton/assemble.h"

namespace coppice {
namespace {

using namespace table;

constexpr auto kSolid = ObjectKind::solid;

float as_float(double v) { return static_cast<float>(v); }

/// Returns a command that replaces a solid by a changed one; solids made from the old one are unchanged.
SceneCommand change(std::string name, std::string help, std::string example, std::vector<Argument> arguments,
                    std::function<Solid(const SceneCall&, const Solid&)> make) {
    SceneCommand c = new_command(std::move(name), "Moving and bending", std::move(help), std::move(example));
    c.makes = kSolid;
    c.arguments.push_back(object("solid", kSolid, "Object to change."));
    std::ranges::move(arguments, std::back_inserter(c.arguments));
    c.run = [make = std::move(make)](const SceneCall& call) {
        const std::string& name_of_solid = call.text("solid");
        return makes_solid(name_of_solid, make(call, call.solid(name_of_solid)));
    };
    return c;
}

/// Extends the command to skeletons: used if no solid has the name, or if `kind` selects it.
SceneCommand motion(SceneCommand c, std::function<Skeleton(const SceneCall&, const Skeleton&)> move) {
    c.help.insert(c.help.size() - 1, "; applies to a solid or a skeleton");
    c.arguments.front().also = {ObjectKind::skeleton};
    Argument which = choice_of_kind();
    which.choices = {std::string(name_of(kSolid)), std::string(name_of(ObjectKind::skeleton))};
    c.arguments.push_back(std::move(which));
    c.run = [of_solid = std::move(c.run), move = std::move(move)](const SceneCall& call) {
        const std::string& name = call.text("solid");
        const bool solid = call.state().objects.contains({kSolid, name});
        const std::string& wanted = call.text("kind");
        const std::string_view kind =
            wanted.empty() ? name_of(solid ? kSolid : ObjectKind::skeleton) : wanted;
        if (call.any(name, std::string(kind))->kind() == kSolid) return of_solid(call);
        constexpr double kBytesOfNode = 100;
        const Skeleton& skeleton = call.skeleton(name);
        call.reserve(kBytesOfNode * skeleton.size());
        const auto attributes = call.attributes(name);
        return makes_tree(name, move(call, skeleton), {attributes.begin(), attributes.end()});
    };
    return c;
}

Vec3d vector(const SceneCall& call, std::string_view argument) {
    const auto& n = call.values(argument).front().numbers;
    return {n.at(0), n.at(1), n.at(2)};
}

SceneCommand combination(std::string name, std::vector<std::string> aliases, std::string help,
                         std::string example, std::vector<Argument> options,
                         std::function<Solid(const SceneCall&, std::span<const Solid>)> make) {
    SceneCommand c = new_command(std::move(name), "Combining", std::move(help), std::move(example));
    c.aliases = std::move(aliases);
    c.makes = kSolid;
    c.arguments = {object("parts", kSolid, "At least two solids.", true),
                   new_name("result", "Name of the new solid, the last word.")};
    std::ranges::move(options, std::back_inserter(c.arguments));
    c.run = [make = std::move(make)](const SceneCall& call) {
        std::vector<Solid> parts;
        for (const ArgumentValue& part : call.values("parts")) parts.push_back(call.solid(part.text));
        if (parts.size() < 2) {
            throw InvalidInput(fmt::format("name at least two solids and then the result, as in: {}",
                                           call.command().example));
        }
        return makes_solid(call.text("result"), make(call, parts), kBytesOfSolid + 16 * parts.size());
    };
    return c;
}

SceneCommand copy_command() {
    SceneCommand c{.name = "copy", .group = "Moving and bending"};
    c.help = "Give another name to the current state of an object.";
    c.example = "copy s s2";
    c.arguments = {any_object("name", "Object to copy."), new_name("copy", "Name of the copy."),
                   choice_of_kind()};
    c.run = [](const SceneCall& call) {
        const ObjectPtr object = call.any(call.text("name"), call.text("kind"));
        SceneOutcome out;
        out.changes.push_back({object->kind(), call.text("copy"), object});
        return out;
    };
    return c;
}

SceneCommand scale_command() {
    Argument factors =
        positional(tuple("factors", "", "Scale factor of all axes, or one per axis.", {1, 3}, Unit::none));
    factors.low = -1e6;
    factors.high = 1e6;
    SceneCommand of_solid =
        change("scale", "Scale along the axes; a negative factor mirrors solids.", "scale s 50 80 50",
               {factors, tuple("center", "0,0,0", "Fixed point of the scaling.")},
               [](const SceneCall& c, const Solid& s) {
                   const auto& n = c.values("factors").front().numbers;
                   const Vec3d by = n.size() == 1 ? Vec3d(n[0], n[0], n[0]) : Vec3d(n[0], n[1], n[2]);
                   return scaled(s, Vec3(by), c.point("center"));
               });
    return motion(std::move(of_solid), [](const SceneCall& call, const Skeleton& s) {
        const auto& n = call.values("factors").front().numbers;
        if (n.size() > 1)
            throw InvalidInput("a skeleton is scaled by a single factor, so that its branches stay round");
        return scaled(s, n[0], vector(call, "center"));
    });
}

SceneCommand translate_command() {
    SceneCommand of_solid =
        change("translate", "Translate an object.", "translate s 0 0 60",
               {positional(tuple("by", "", "Displacement along x, y and z."))},
               [](const SceneCall& c, const Solid& s) { return translated(s, c.point("by")); });
    return motion(std::move(of_solid),
                  [](const SceneCall& call, const Skeleton& s) { return translated(s, vector(call, "by")); });
}

SceneCommand rotate_command() {
    SceneCommand of_solid = change(
        "rotate", "Rotate about a line, counter-clockwise seen against the axis.", "rotate s 30 axis=1,0,0",
        {positional(number("angle", "", -6.2832e3, 6.2832e3, Unit::radian, "Angle of the rotation.")),
         tuple("axis", "0,0,1", "Direction of the line.", {3}, Unit::none),
         tuple("center", "0,0,0", "Point of the line.")},
        [](const SceneCall& c, const Solid& s) {
            return rotated(s, c.point("axis"), as_float(c.number("angle")), c.point("center"));
        });
    return motion(std::move(of_solid), [](const SceneCall& call, const Skeleton& s) {
        return rotated(s, vector(call, "axis"), call.number("angle"), vector(call, "center"));
    });
}

SceneCommand twist_command() {
    return change("twist", "Twist a solid about a line, increasingly with the height.", "twist b 45",
                  {positional(number("rate", "", -1e5, 1e5, Unit::none, "Degrees per metre of height.")),
                   tuple("origin", "0,0,0", "Point of the line at height 0."),
                   tuple("axis", "0,0,1", "Direction of the line.", {3}, Unit::none)},
                  [](const SceneCall& c, const Solid& s) {
                      return twisted(s, c.point("origin"), c.point("axis"),
                                     as_float(in_library_unit(Unit::radian, c.number("rate"))));
                  });
}

/// Returns the line along which a solid is tapered or bent.
std::vector<Argument> along() {
    return {tuple("from", "", "Start of the line; by default the centre of the bottom of the bounding box."),
            tuple("to", "", "End of the line; by default the centre of the top of the bounding box.")};
}

std::pair<Vec3, Vec3> ends(const SceneCall& c, const Solid& s) {
    const Box3 box = s.surface_bounds();
    if (box.empty() && !(c.has("from") && c.has("to")))
        throw InvalidInput("the solid is empty; give the line by from= and to=");
    const Vec3 middle = box.empty() ? Vec3{} : box.center();
    return {c.has("from") ? c.point("from") : Vec3{middle.x, middle.y, box.low.z},
            c.has("to") ? c.point("to") : Vec3{middle.x, middle.y, box.high.z}};
}

SceneCommand taper_command() {
    std::vector<Argument> arguments = along();
    arguments.insert(arguments.begin(),
                     positional(number("factor", "", 0.01, 100, Unit::none,
                                       "Ratio of the width at the end to the width at the start.")));
    return change("taper", "Make a solid narrower or wider along a line.", "taper b 0.4",
                  std::move(arguments), [](const SceneCall& c, const Solid& s) {
                      const auto [a, b] = ends(c, s);
                      return tapered(s, a, b, as_float(c.number("factor")));
                  });
}

SceneCommand bend_command() {
    std::vector<Argument> arguments = along();
    arguments.insert(arguments.begin(), positional(number("angle", "", -3.14159265, 3.14159265, Unit::radian,
                                                          "Angle by which the end turns.")));
    arguments.push_back(tuple("side", "1,0,0", "Direction towards which the line bends.", {3}, Unit::none));
    return change("bend", "Bend a line through a solid to an arc.", "bend zigzag 60", std::move(arguments),
                  [](const SceneCall& c, const Solid& s) {
                      const auto [a, b] = ends(c, s);
                      const double angle = c.number("angle");
                      const Vec3 side = angle < 0 ? -c.point("side") : c.point("side");
                      return bent(s, a, b, side, as_float(std::abs(angle)));
                  });
}

SceneCommand union_command() {
    return combination("union", {}, "Unite solids: all points in any of them.", "union s l both", {},
                       [](const SceneCall&, std::span<const Solid> p) { return unite(p); });
}

SceneCommand intersection_command() {
    return combination("intersection", {"intersect"}, "Intersect solids: all points in each of them.",
                       "intersection s b common", {},
                       [](const SceneCall&, std::span<const Solid> p) { return intersect(p); });
}

SceneCommand diff_command() {
    return combination(
        "diff", {"difference", "subtract"}, "Subtract all other solids from the first.", "diff s l rest", {},
        [](const SceneCall&, std::span<const Solid> p) { return subtract(p.front(), p.subspan(1)); });
}

SceneCommand blend_command() {
    return combination("blend", {}, "Blend solids by the sum of their fields.", "blend s l soft", {},
                       [](const SceneCall&, std::span<const Solid> p) { return blend(p); });
}

SceneCommand ricci_command() {
    return combination("ricci", {}, "Blend solids, between blend (exponent 1) and union (large exponents).",
                       "ricci s l tight exponent=4",
                       {number("exponent", "2", 1, 100, Unit::none, "Exponent; larger values blend less.")},
                       [](const SceneCall& c, std::span<const Solid> p) {
                           return ricci_blend(p, as_float(c.number("exponent")));
                       });
}

SceneCommand polygonize_command() {
    SceneCommand c{.name = "polygonize", .group = "Combining"};
    c.help = "Convert the surface of a solid to a closed triangle mesh.";
    c.example = "polygonize rest rest_mesh cell=4";
    c.makes = ObjectKind::mesh;
    c.arguments = {object("solid", kSolid, "Solid to convert."),
                   positional(new_name("name", "Name of the new mesh.", "@solid"), false)};
    add_options(c.arguments, PolygonizeOptions{}, "polygonize");
    c.run = [](const SceneCall& call) {
        // per cell at the surface, at most twice the six sides of the box
        constexpr double kBytesOfCell = 250;
        const SolidField field = call.field(call.text("solid"));
        const auto options = call.options<PolygonizeOptions>("polygonize");
        const Vec3d size(field.surface_bounds().size());
        const double longest = std::max({size.x, size.y, size.z});
        const double cell = options.cell > 0 ? static_cast<double>(options.cell) : longest / 64;
        if (cell > 0) {
            const Vec3d n = size / cell;
            call.reserve(4 * kBytesOfCell * (n.x * n.y + n.y * n.z + n.z * n.x));
        }
        Surface surface{polygonize(field, options, call.context())};
        const std::uint64_t bytes = compute_memory(surface);
        return makes(call.text("name"), std::move(surface), bytes);
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> solid_commands() {
    return {scale_command(),        translate_command(), rotate_command(), twist_command(),
            taper_command(),        bend_command(),      copy_command(),   union_command(),
            intersection_command(), diff_command(),      blend_command(),  ricci_command(),
            polygonize_command()};
}

}  // namespace coppice
