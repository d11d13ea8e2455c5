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

constexpr int kMaxPasses = 1000;

/// Returns the total length of the segments that end at the nodes, or begin there.
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

/// Returns a choice of the values of an enum, with the first one as default.
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
    SceneCommand c =
        new_command("edit " + std::move(name), "Editing trees", std::move(help), std::move(example));
    c.arguments.push_back(object("tree", ObjectKind::skeleton, "Tree to edit."));
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
        auto attributes = kept_attributes(call.attributes(call.text("tree")), skeleton, edited);
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
                       p.z, tree.radius(n), parent, compute_order(tree, n), anchor_text(tree, n));
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
    SceneCommand c = in_group("select", "List the nodes of a selection.", "edit select tree tips&height(40,)",
                              {selection("nodes", "Selection; see editing.md.")});
    c.records = false;
    c.show = [](const SceneCall& call, const EditableTree& tree) {
        return selection_text(tree, selected(tree, parse_selection(call.text("nodes")), find_solids(call)));
    };
    c.run = [show = c.show](const SceneCall& call) {
        SceneOutcome out;
        out.text = show(call, EditableTree(call.skeleton(call.text("tree"))));
        return out;
    };
    return c;
}

std::vector<SceneCommand> cutting_commands() {
    Argument at = number("at", "0", 0, 1, Unit::none,
                         "Position of a single split instead; 0 disables it, 1 is at the node.");
    std::vector<Argument> arguments{selection("nodes", "Nodes that may be removed.", "all")};
    add_options(arguments, PruneOptions{}, "prune");
    arguments.push_back(object_option("solid", ObjectKind::solid,
                                      "Trim the tree to this solid, or remove the portion inside it."));
    arguments.push_back(choice("keep", {"inside", "outside"}, "Side of the solid to keep."));
    const Edit prune_edit = [](const SceneCall& c, EditableTree& t) {
        const NodeSet nodes = find_nodes(c, t);
        if (!c.has("solid")) return prune(t, nodes, c.options<PruneOptions>("prune"));
        return prune_by_solid(t, nodes, c.solid(c.text("solid")), c.text("keep") == "inside");
    };
    return {
        edits(
            "split", "Split segments by new nodes without changing the surface.",
            "edit split tree order(0) parts=2",
            {branches("Nodes at the ends of the segments."),
             whole(number("parts", "2", 2, 1000, Unit::none, "Number of equal parts of each segment.")), at},
            [](const SceneCall& c, EditableTree& t) {
                const double where = c.number("at");
                const NodeSet nodes = find_nodes(c, t);
                if (where > 0) return split_at(t, nodes, where);
                c.reserve(kBytesOfEditedNode * static_cast<double>(nodes.size()) * c.number("parts"));
                return split(t, nodes, static_cast<int>(c.number("parts")));
            }),
        edits("detach", "Detach branches with their first segments as separate trees.",
              "edit detach tree near(0,0,60)", {branches("First nodes of the branches.")},
              [](const SceneCall& c, EditableTree& t) { return detach(t, find_nodes(c, t)); }),
        edits("delete", "Remove nodes with their descendants.", "edit delete tree tips",
              {branches("Nodes to remove."),
               flag("alone", false, "Keep the children of the nodes and attach them to their parents.")},
              [](const SceneCall& c, EditableTree& t) {
                  return c.flag("alone") ? dissolve(t, find_nodes(c, t))
                                         : remove_branches(t, find_nodes(c, t));
              }),
        edits("prune", "Remove branches that are thin, short, of high order, shaded, or outside a solid.",
              "edit prune tree length=3", std::move(arguments), prune_edit),
        edits("resample", "Space nodes evenly between forks, tips and nodes that are not selected.",
              "edit resample tree all 2",
              {branches("Nodes that may be moved, removed and added."),
               positional(number("spacing", "", 1e-9, 1e6, Unit::metre, "Length of a segment."))},
              [](const SceneCall& c, EditableTree& t) {
                  const NodeSet nodes = find_nodes(c, t);
                  c.reserve(kBytesOfEditedNode * length_to(t, nodes) / c.number("spacing"));
                  return resample(t, nodes, c.number("spacing"));
              }),
    };
}

std::vector<SceneCommand> moving_commands() {
    const std::string subject = "Branches, each given by one of its nodes: the node with its descendants.";
    return {
        edits("translate", "Translate branches.", "edit translate tree roots 0 0 1",
              {branches(subject), positional(tuple("by", "", "Displacement along x, y and z."))},
              [](const SceneCall& c, EditableTree& t) {
                  return translate(t, find_nodes(c, t), vector(c, "by"));
              }),
        edits("rotate", "Rotate branches about their joints.", "edit rotate tree order(1) 20 about=side",
              {branches(subject), angle("Angle, counter-clockwise seen against the axis."),
               choice<TurnAxis>(
                   "about",
                   "Axis of the rotation: given is axis=; own rolls the branch; host turns it about its "
                   "parent branch; side raises it towards the direction of its parent branch."),
               tuple("axis", "0,0,1", "Direction of the axis with about=given.", {3}, Unit::none)},
              [](const SceneCall& c, EditableTree& t) {
                  return rotate(t, find_nodes(c, t),
                                {.angle = c.number("angle"),
                                 .about = chosen<TurnAxis>(c, "about"),
                                 .axis = vector(c, "axis")});
              }),
        edits("scale", "Scale branches about their joints.", "edit scale tree order(1) 0.9",
              {branches(subject),
               positional(number("factor", "", 1e-6, 1e6, Unit::none, "Scale factor; 1 changes nothing.")),
               flag("radii", true, "Scale the radii too.")},
              [](const SceneCall& c, EditableTree& t) {
                  return scale(t, find_nodes(c, t), c.number("factor"), c.flag("radii"));
              }),
        edits("mirror", "Mirror branches in planes through their joints.",
              "edit mirror tree order(1) normal=1,0,0",
              {branches(subject), tuple("normal", "1,0,0", "Normal of the plane.", {3}, Unit::none),
               flag("copy", false, "Keep the branches and add mirrored copies.")},
              [](const SceneCall& c, EditableTree& t) {
                  return mirror(t, find_nodes(c, t), vector(c, "normal"), c.flag("copy"));
              }),
        edits(
            "bend", "Bend axes; their first segments keep their direction.", "edit bend tree roots 30",
            {branches("Axes, each given by its first node."), angle("Angle by which the last segment turns."),
             tuple("towards", "0,0,-1", "Direction towards which the axes bend.", {3}, Unit::none)},
            [](const SceneCall& c, EditableTree& t) {
                return bend(t, find_nodes(c, t), c.number("angle"), vector(c, "towards"));
            }),
        edits("twist", "Rotate the branches on axes about them, increasingly towards the tip.",
              "edit twist tree roots 90",
              {branches("Axes, each given by its first node."), angle("Angle at the tip.")},
              [](const SceneCall& c, EditableTree& t) {
                  return twist(t, find_nodes(c, t), c.number("angle"));
              }),
        edits("move", "Move a node; its axis follows as rigidly as possible.",
              "edit move tree near(0,0,50) by=2,0,0",
              {selection("node", "Node to move."), tuple("to", "", "Target position."),
               tuple("by", "", "Displacement, instead of to=."),
               metres("reach", "0",
                      "Maximum distance along the axis of nodes that follow; 0 moves the whole axis.")},
              [](const SceneCall& c, EditableTree& t) {
                  const StableId n = find_node(c, t, "node");
                  if (c.has("to") == c.has("by"))
                      throw InvalidInput("give the target by to=x,y,z or by=x,y,z, but not both");
                  const Vec3d here = t.origin() + Vec3d(t.position(n));
                  return move_node(t, n, c.has("to") ? vector(c, "to") : here + vector(c, "by"),
                                   c.number("reach"));
              }),
        edits("straighten", "Straighten axes between joint and tip.",
              "edit straighten tree order(1) amount=0.5",
              {branches("Axes, each given by its first node."),
               number("amount", "1", 0, 1, Unit::none, "Fraction of the straightening; 1 is complete.")},
              [](const SceneCall& c, EditableTree& t) {
                  return straighten(t, find_nodes(c, t), c.number("amount"));
              }),
        edits("smooth", "Smooth the course of axes, or their radii.", "edit smooth tree all passes=2",
              {branches("Nodes that may change."),
               whole(number("passes", "1", 1, kMaxPasses, Unit::none, "Number of smoothing passes.")),
               choice("subject", {"places", "radii"}, "Quantity to smooth.")},
              [](const SceneCall& c, EditableTree& t) {
                  const int passes = static_cast<int>(c.number("passes"));
                  return c.text("subject") == "radii" ? smooth_radii(t, find_nodes(c, t), passes)
                                                      : smooth(t, find_nodes(c, t), passes);
              }),
    };
}

std::vector<SceneCommand> joining_commands() {
    std::vector<Argument> apart{selection("nodes", "Branches that may move.", "all")};
    add_options(apart, BendApartOptions{}, "apart");
    return {
        edits(
            "draw", "Draw a branch through points, beginning at the closest axis.",
            "edit draw tree 0,0,50 10,0,55 20,0,65 snap=1000",
            {positional(repeated(tuple("points", "", "At least two points x,y,z."))),
             metres("radius", "0", "Radius at the first node; 0 uses half the radius of the parent branch."),
             metres("tip_radius", "0", "Radius at the last node; 0 uses a quarter of the first radius."),
             number("snap", "3", 0, 1e6, Unit::radius,
                    "Maximum distance of the first point from an axis, in radii of the branch there."),
             flag("alone", false, "Create a separate tree without snapping its first point.")},
            [](const SceneCall& c, EditableTree& t) {
                return draw(t, vectors(c, "points"),
                            {.radius = c.number("radius"),
                             .tip_radius = c.number("tip_radius"),
                             .snap = c.number("snap"),
                             .alone = c.flag("alone")});
            }),
        edits("append", "Add a child to a node.", "edit append tree near(0,0,60) 0 0 2",
              {selection("node", "Parent of the new node."),
               positional(tuple("by", "", "Offset from the parent.")),
               metres("radius", "0", "Radius of the new node; 0 uses the radius of its parent.")},
              [](const SceneCall& c, EditableTree& t) {
                  return append(t, find_node(c, t, "node"), vector(c, "by"), c.number("radius"));
              }),
        edits(
            "graft", "Move a branch, or the branches of a root, to another host.",
            "edit graft tree near(20,0,65) near(0,0,30) align=true",
            {selection("branch", "First node of the branch, or a root."),
             selection("host", "Node to which the branch is attached."),
             number("along", "1", 0, 1, Unit::none, "Position on the segment of the host; 1 is at the host."),
             flag("align", false, "Rotate the branch with the host."),
             flag("limit_radius", true, "Limit the radii to the radius of the host.")},
            [](const SceneCall& c, EditableTree& t) {
                return graft(t, find_node(c, t, "branch"), find_node(c, t, "host"),
                             {.along = c.number("along"),
                              .align = c.flag("align"),
                              .limit_radius = c.flag("limit_radius")});
            }),
        edits("attach", "Join trees with roots inside branches of other trees.", "edit attach tree",
              {selection("nodes", "Roots to join, and branches that cross others.", "roots"),
               choice<Crossings>("crossings",
                                 "Treatment of branches that cross others: join attaches the outgoing "
                                 "portion to the branch that it leaves.")},
              [](const SceneCall& c, EditableTree& t) {
                  return attach(t, find_nodes(c, t), chosen<Crossings>(c, "crossings"), c.context());
              }),
        edits("apart", "Bend overlapping branches of different trees apart without removing any.",
              "edit apart tree", std::move(apart),
              [](const SceneCall& c, EditableTree& t) {
                  return bend_apart(t, find_nodes(c, t), c.options<BendApartOptions>("apart"), c.context());
              }),
    };
}

std::vector<SceneCommand> thickness_commands() {
    return {
        edits("radius", "Set the radius of nodes.", "edit radius tree tips 0.2",
              {branches("Nodes to change."),
               positional(number("radius", "", 1e-9, 1e6, Unit::metre, "New radius of each node."))},
              [](const SceneCall& c, EditableTree& t) {
                  return set_radii(t, find_nodes(c, t), c.number("radius"));
              }),
        edits("thicken", "Multiply radii by a factor.", "edit thicken tree all 1.1",
              {branches("Nodes to change."), positional(number("factor", "", 1e-6, 1e6, Unit::none,
                                                               "Factor on the radii; 1 changes nothing."))},
              [](const SceneCall& c, EditableTree& t) {
                  return scale_radii(t, find_nodes(c, t), c.number("factor"));
              }),
        edits("taper", "Taper axes linearly towards their tips.", "edit taper tree order(1) to=0.2",
              {branches("Axes, each given by its first node."),
               metres("from", "0", "Radius at the first node; 0 keeps the existing one."),
               metres("to", "0", "Radius at the tip; 0 keeps the existing one.")},
              [](const SceneCall& c, EditableTree& t) {
                  return taper(t, find_nodes(c, t), c.number("from"), c.number("to"));
              }),
        edits("pipe", "Set radii by the pipe model, from nodes down to their roots.",
              "edit pipe tree tips exponent=2.3",
              {branches("Nodes at which the paths to the roots begin."),
               number("exponent", "2", 0.1, 10, Unit::none,
                      "Exponent of the pipe model: r^exponent of a node is the sum over its children.")},
              [](const SceneCall& c, EditableTree& t) {
                  return pipe_radii(t, find_nodes(c, t), c.number("exponent"));
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
