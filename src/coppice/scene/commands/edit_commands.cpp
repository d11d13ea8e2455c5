#include <fmt/format.h>

#include <algorithm>

#include "coppice/edit/anchor.h"
#include "coppice/edit/bend_apart.h"
#include "coppice/edit/cut.h"
#include "coppice/edit/deform.h"
#include "coppice/edit/join.h"
#include "coppice/edit/rigid.h"
#include "coppice/edit/selection.h"
#include "coppice/edit/thickness.h"
#include "coppice/scene/commands/edit_tables_internal.h"

namespace coppice {
namespace {

using namespace table;

using Edit = std::function<EditChange(const SceneCall&, EditableTree&)>;

constexpr int kMostPasses = 1000;

/// Of the segments that end at the nodes, or begin there.
double length_to(const EditableTree& tree, const NodeSet& nodes) {
    double sum = 0;
    for (const StableId n : nodes) {
        if (!tree.is_root(n)) sum += double{distance(tree.position(n), tree.position(tree.parent(n)))};
        for (StableId c = tree.first_child(n); c; c = tree.next_sibling(c))
            sum += double{distance(tree.position(n), tree.position(c))};
    }
    return sum;
}

std::vector<Vec3d> vectors(const SceneCall& call, std::string_view argument) {
    std::vector<Vec3d> out;
    for (const ArgumentValue& v : call.values(argument)) {
        const auto& n = v.numbers;
        out.emplace_back(n.at(0), n.at(1), n.at(2));
    }
    return out;
}

Vec3d vector(const SceneCall& call, std::string_view argument) { return vectors(call, argument).at(0); }

Argument branches(std::string help) { return selection("nodes", std::move(help)); }

Argument angle(std::string help) {
    return positional(number("angle", "", -6.2832e3, 6.2832e3, Unit::radian, std::move(help)));
}

Argument choice(std::string name, std::vector<std::string> choices, std::string help) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::choice};
    a.initial = choices.front();
    a.choices = std::move(choices);
    return a;
}

/// A choice of an enum's values, the first of which is the default.
template <NamedEnum E>
Argument choice(std::string name, std::string help) {
    const auto& names = EnumNames<E>::names;
    return choice(std::move(name), {names.begin(), names.end()}, std::move(help));
}

template <NamedEnum E>
E chosen(const SceneCall& call, std::string_view argument) {
    const auto found = std::ranges::find(EnumNames<E>::names, call.text(argument));
    return static_cast<E>(found - EnumNames<E>::names.begin());
}

Argument whole(Argument a) {
    a.type = ArgumentType::whole;
    return a;
}

Argument metres(std::string name, std::string initial, std::string help) {
    return number(std::move(name), std::move(initial), 0, 1e6, Unit::metre, std::move(help));
}

SceneCommand in_group(std::string name, std::string help, std::string example,
                      std::vector<Argument> arguments) {
    SceneCommand c{.name = "edit " + std::move(name), .group = "Editing trees", .help = std::move(help)};
    c.example = std::move(example);
    c.arguments.push_back(object("tree", ObjectKind::skeleton, "what is edited"));
    std::ranges::move(arguments, std::back_inserter(c.arguments));
    return c;
}

SceneCommand edits(std::string name, std::string help, std::string example, std::vector<Argument> arguments,
                   Edit edit) {
    SceneCommand c = in_group(std::move(name), std::move(help), std::move(example), std::move(arguments));
    c.makes = ObjectKind::skeleton;
    c.edit = edit;
    c.run = [edit = std::move(edit)](const SceneCall& call) {
        const Skeleton& skeleton = call.skeleton(call.text("tree"));
        call.reserve(kBytesOfEditedNode * skeleton.size());
        EditableTree tree(skeleton);
        const EditChange change = edit(call, tree);
        Skeleton edited = tree.skeleton();
        auto attributes = carried_attributes(call.attributes(call.text("tree")), skeleton, edited);
        SceneOutcome out = makes_tree(call.text("tree"), std::move(edited), std::move(attributes));
        if (change.empty()) out.text = "nothing changed\n";
        return out;
    };
    return c;
}

std::string node_line(const EditableTree& tree, StableId n) {
    const Vec3d p = tree.origin() + Vec3d(tree.position(n));
    const std::string parent = tree.is_root(n) ? "a root" : fmt::format("on {}", tree.parent(n).index());
    return fmt::format("node {} at {:.6g},{:.6g},{:.6g} radius {:.4g} {} order {}: {}\n", n.index(), p.x, p.y,
                       p.z, tree.radius(n), parent, order_of(tree, n), anchor_text(tree, n));
}

std::string selection_text(const EditableTree& tree, const NodeSet& nodes) {
    constexpr std::size_t kShownNodes = 20, kShownLetters = 400;
    std::string text = fmt::format("{} of {} nodes\n", nodes.size(), tree.size());
    if (nodes.empty()) return text;
    if (nodes.size() <= kShownNodes) {
        for (const StableId n : nodes) text += node_line(tree, n);
        return text;
    }
    Selection ids;
    ids.kind = SelectionKind::id;
    ids.ids = nodes;
    std::string list = to_text(ids);
    if (list.size() > kShownLetters) list = list.substr(0, list.rfind(',', kShownLetters)) + ",...)";
    return text + list + "\n";
}

SceneCommand select_command() {
    SceneCommand c = in_group("select", "shows what a selection holds", "edit select tree tips&height(40,)",
                              {selection("nodes", "the selection; see editing.md")});
    c.records = false;
    c.show = [](const SceneCall& call, const EditableTree& tree) {
        return selection_text(tree, selected(tree, parse_selection(call.text("nodes")), solids_of(call)));
    };
    c.run = [show = c.show](const SceneCall& call) {
        SceneOutcome out;
        out.text = show(call, EditableTree(call.skeleton(call.text("tree"))));
        return out;
    };
    return c;
}

std::vector<SceneCommand> cutting_commands() {
    Argument at = number("at", "0", 0, 1, Unit::none, "where instead, once: 0 = off, 1 = at the node");
    std::vector<Argument> arguments{selection("nodes", "where it may be cut", "all")};
    add_options(arguments, PruneOptions{}, "prune");
    arguments.push_back(object_option("solid", ObjectKind::solid, "trims to this solid, or out of it"));
    arguments.push_back(choice("keep", {"inside", "outside"}, "which side of the solid stays"));
    const Edit prune_edit = [](const SceneCall& c, EditableTree& t) {
        const NodeSet nodes = nodes_of(c, t);
        if (!c.has("solid")) return prune(t, nodes, c.options<PruneOptions>("prune"));
        return prune_by_solid(t, nodes, c.solid(c.text("solid")), c.text("keep") == "inside");
    };
    return {
        edits("split", "splits segments by new nodes; the surface stays as it is",
              "edit split tree order(0) parts=2",
              {branches("nodes at which the segments end"),
               whole(number("parts", "2", 2, 1000, Unit::none, "how many equal parts of each")), at},
              [](const SceneCall& c, EditableTree& t) {
                  const double where = c.number("at");
                  const NodeSet nodes = nodes_of(c, t);
                  if (where > 0) return split_at(t, nodes, where);
                  c.reserve(kBytesOfEditedNode * static_cast<double>(nodes.size()) * c.number("parts"));
                  return split(t, nodes, static_cast<int>(c.number("parts")));
              }),
        edits("detach", "makes trees of their own of branches, with their first segments",
              "edit detach tree near(0,0,60)", {branches("branches by their first nodes")},
              [](const SceneCall& c, EditableTree& t) { return detach(t, nodes_of(c, t)); }),
        edits("delete", "removes nodes with all that hangs on them", "edit delete tree tips",
              {branches("what goes"), flag("alone", false, "what hangs on them stays, on their parents")},
              [](const SceneCall& c, EditableTree& t) {
                  return c.flag("alone") ? dissolve(t, nodes_of(c, t)) : remove_branches(t, nodes_of(c, t));
              }),
        edits("prune", "cuts off what is thin, short, of high order, in the shade, or beyond a solid",
              "edit prune tree length=3", std::move(arguments), prune_edit),
        edits("resample", "spaces nodes evenly between forks, tips and what is not selected",
              "edit resample tree all 2",
              {branches("nodes that may move, go and come"),
               positional(number("spacing", "", 1e-9, 1e6, Unit::metre, "length of a segment"))},
              [](const SceneCall& c, EditableTree& t) {
                  const NodeSet nodes = nodes_of(c, t);
                  c.reserve(kBytesOfEditedNode * length_to(t, nodes) / c.number("spacing"));
                  return resample(t, nodes, c.number("spacing"));
              }),
    };
}

std::vector<SceneCommand> moving_commands() {
    const std::string what = "branches, each by one of its nodes: from there on to all its tips";
    return {
        edits("translate", "moves branches", "edit translate tree roots 0 0 1",
              {branches(what), positional(tuple("by", "", "how far along x, y and z"))},
              [](const SceneCall& c, EditableTree& t) {
                  return translate(t, nodes_of(c, t), vector(c, "by"));
              }),
        edits("rotate", "turns branches about their joints", "edit rotate tree order(1) 20 about=side",
              {branches(what), angle("counter-clockwise seen against the axis"),
               choice<TurnAxis>(
                   "about",
                   "given = axis; own = the branch rolls; host = it goes round its host; side = it rises "
                   "towards "
                   "the direction of its host"),
               tuple("axis", "0,0,1", "direction, for about=given", {3}, Unit::none)},
              [](const SceneCall& c, EditableTree& t) {
                  return rotate(t, nodes_of(c, t),
                                {.angle = c.number("angle"),
                                 .about = chosen<TurnAxis>(c, "about"),
                                 .axis = vector(c, "axis")});
              }),
        edits("scale", "scales branches from their joints", "edit scale tree order(1) 0.9",
              {branches(what), positional(number("factor", "", 1e-6, 1e6, Unit::none, "1 = as it is")),
               flag("radii", true, "whether radii are scaled too")},
              [](const SceneCall& c, EditableTree& t) {
                  return scale(t, nodes_of(c, t), c.number("factor"), c.flag("radii"));
              }),
        edits("mirror", "mirrors branches in planes through their joints",
              "edit mirror tree order(1) normal=1,0,0",
              {branches(what), tuple("normal", "1,0,0", "across the plane", {3}, Unit::none),
               flag("copy", false, "they stay, and mirrored copies come")},
              [](const SceneCall& c, EditableTree& t) {
                  return mirror(t, nodes_of(c, t), vector(c, "normal"), c.flag("copy"));
              }),
        edits("bend", "bends axes; their first segments keep their direction", "edit bend tree roots 30",
              {branches("axes, each by its first node"), angle("by which the last segment turns"),
               tuple("towards", "0,0,-1", "the direction that they bend to", {3}, Unit::none)},
              [](const SceneCall& c, EditableTree& t) {
                  return bend(t, nodes_of(c, t), c.number("angle"), vector(c, "towards"));
              }),
        edits(
            "twist", "turns what hangs on axes about them, the more the nearer to the tip",
            "edit twist tree roots 90", {branches("axes, each by its first node"), angle("at the tip")},
            [](const SceneCall& c, EditableTree& t) { return twist(t, nodes_of(c, t), c.number("angle")); }),
        edits("move", "moves a node; its axis follows as rigidly as it can",
              "edit move tree near(0,0,50) by=2,0,0",
              {selection("node", "one node"), tuple("to", "", "where it goes"), tuple("by", "", "or how far"),
               metres("reach", "0", "how far along the axis others follow; 0 = all of it")},
              [](const SceneCall& c, EditableTree& t) {
                  const StableId n = node_of(c, t, "node");
                  if (c.has("to") == c.has("by"))
                      throw InvalidInput("say where the node goes, by to=x,y,z or by=x,y,z, and not both");
                  const Vec3d here = t.origin() + Vec3d(t.position(n));
                  return move_node(t, n, c.has("to") ? vector(c, "to") : here + vector(c, "by"),
                                   c.number("reach"));
              }),
        edits(
            "straighten", "draws axes straight between joint and tip",
            "edit straighten tree order(1) amount=0.5",
            {branches("axes, each by its first node"), number("amount", "1", 0, 1, Unit::none, "1 = wholly")},
            [](const SceneCall& c, EditableTree& t) {
                return straighten(t, nodes_of(c, t), c.number("amount"));
            }),
        edits("smooth", "smooths the course of axes, or their radii", "edit smooth tree all passes=2",
              {branches("nodes that may change"),
               whole(number("passes", "1", 1, kMostPasses, Unit::none, "how often")),
               choice("what", {"places", "radii"}, "what is smoothed")},
              [](const SceneCall& c, EditableTree& t) {
                  const int passes = static_cast<int>(c.number("passes"));
                  return c.text("what") == "radii" ? smooth_radii(t, nodes_of(c, t), passes)
                                                   : smooth(t, nodes_of(c, t), passes);
              }),
    };
}

std::vector<SceneCommand> joining_commands() {
    std::vector<Argument> apart{selection("nodes", "branches that may give way", "all")};
    add_options(apart, BendApartOptions{}, "apart");
    return {
        edits(
            "draw", "draws a branch through points, from the nearest axis on",
            "edit draw tree 0,0,50 10,0,55 20,0,65 snap=1000",
            {positional(repeated(tuple("points", "", "x,y,z of two points or more"))),
             metres("radius", "0", "at its first node; 0 = half its host's"),
             metres("tip_radius", "0", "at its last node; 0 = a quarter of the first one's"),
             number("snap", "3", 0, 1e6, Unit::radius, "how near to an axis it has to begin, in radii there"),
             flag("alone", false, "a tree of its own, which snaps to nothing")},
            [](const SceneCall& c, EditableTree& t) {
                return draw(t, vectors(c, "points"),
                            {.radius = c.number("radius"),
                             .tip_radius = c.number("tip_radius"),
                             .snap = c.number("snap"),
                             .alone = c.flag("alone")});
            }),
        edits("append", "adds a node to one", "edit append tree near(0,0,60) 0 0 2",
              {selection("node", "its parent"), positional(tuple("by", "", "from there")),
               metres("radius", "0", "of the new node; 0 = its parent's")},
              [](const SceneCall& c, EditableTree& t) {
                  return append(t, node_of(c, t, "node"), vector(c, "by"), c.number("radius"));
              }),
        edits("graft", "moves a branch, or what hangs on a root, to another host",
              "edit graft tree near(20,0,65) near(0,0,30) align=true",
              {selection("branch", "the branch by its first node, or a root"),
               selection("host", "the node that it comes to hang on"),
               number("along", "1", 0, 1, Unit::none, "where on the host's segment; 1 = at the host"),
               flag("align", false, "it turns with the host"),
               flag("limit_radius", true, "no radius exceeds the host's")},
              [](const SceneCall& c, EditableTree& t) {
                  return graft(t, node_of(c, t, "branch"), node_of(c, t, "host"),
                               {.along = c.number("along"),
                                .align = c.flag("align"),
                                .limit_radius = c.flag("limit_radius")});
              }),
        edits("attach", "joins trees whose roots lie inside the wood of others", "edit attach tree",
              {selection("nodes", "their roots, and what crosses others", "roots"),
               choice<Crossings>("crossings",
                                 "what becomes of branches that run through others: join = what comes out "
                                 "springs from there")},
              [](const SceneCall& c, EditableTree& t) {
                  return attach(t, nodes_of(c, t), chosen<Crossings>(c, "crossings"), c.context());
              }),
        edits("apart", "bends trees apart where their wood overlaps; each keeps all of it", "edit apart tree",
              std::move(apart),
              [](const SceneCall& c, EditableTree& t) {
                  return bend_apart(t, nodes_of(c, t), c.options<BendApartOptions>("apart"), c.context());
              }),
    };
}

std::vector<SceneCommand> thickness_commands() {
    return {
        edits("radius", "gives nodes one radius", "edit radius tree tips 0.2",
              {branches("which nodes"), positional(number("radius", "", 1e-9, 1e6, Unit::metre, "of each"))},
              [](const SceneCall& c, EditableTree& t) {
                  return set_radii(t, nodes_of(c, t), c.number("radius"));
              }),
        edits("thicken", "multiplies radii", "edit thicken tree all 1.1",
              {branches("which nodes"),
               positional(number("factor", "", 1e-6, 1e6, Unit::none, "1 = as they are"))},
              [](const SceneCall& c, EditableTree& t) {
                  return scale_radii(t, nodes_of(c, t), c.number("factor"));
              }),
        edits(
            "taper", "lets axes taper evenly to their tips", "edit taper tree order(1) to=0.2",
            {branches("axes, each by its first node"), metres("from", "0", "at that node; 0 = what is there"),
             metres("to", "0", "at the tip; 0 = what is there")},
            [](const SceneCall& c, EditableTree& t) {
                return taper(t, nodes_of(c, t), c.number("from"), c.number("to"));
            }),
        edits("pipe", "radii by the pipe model, from nodes down to their roots",
              "edit pipe tree tips exponent=2.3",
              {branches("where the ways begin"), number("exponent", "2", 0.1, 10, Unit::none,
                                                        "r^exponent of a node is the sum over its children")},
              [](const SceneCall& c, EditableTree& t) {
                  return pipe_radii(t, nodes_of(c, t), c.number("exponent"));
              }),
    };
}

}  // namespace

std::vector<SceneCommand> edit_commands() {
    std::vector<SceneCommand> all{select_command()};
    for (const auto make : {cutting_commands, moving_commands, joining_commands, thickness_commands})
        std::ranges::move(make(), std::back_inserter(all));
    return all;
}

}  // namespace coppice
