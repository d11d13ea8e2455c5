#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "coppice/compose/compose.h"
#include "coppice/compose/placed_branch.h"
#include "coppice/edit/join.h"
#include "coppice/io_database/tree_library.h"
#include "coppice/scene/commands/edit_tables_internal.h"

namespace coppice {
namespace {

using namespace table;

constexpr double kBytesOfComposedNode = 300;  // including its segment and the result
constexpr double kBytesOfLibraryNode = 60;    // including its precomputed sizes

SceneCommand in_group(std::string name, std::string help, std::string example) {
    return new_command(std::move(name), "Composing trees", std::move(help), std::move(example));
}

/// Returns the memory of all branches of a tree: a node is contained in each branch that begins below it.
double memory_of_branches(const Skeleton& skeleton) {
    std::vector<double> branches(skeleton.size());
    double sum = 0;
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n)) continue;
        const NodeId p = skeleton.parent(n);
        branches[n.index()] = branches[p.index()] + (skeleton.children(p).size() > 1 ? 1 : 0);
        sum += branches[n.index()];
    }
    return sum * kBytesOfLibraryNode;
}

/// Returns the branches of each of the trees.
std::vector<std::vector<ChildTree>> find_branches(const SceneCall& call, std::span<const std::string> trees,
                                                  const ChildTreeOptions& options = {}) {
    double bytes = 0;
    for (const std::string& tree : trees) bytes += memory_of_branches(call.skeleton(tree));
    call.reserve(bytes);
    std::vector<std::vector<ChildTree>> out;
    for (const std::string& tree : trees)
        out.push_back(child_trees(call.skeleton(tree), options, call.context()));
    return out;
}

std::vector<std::string> texts(const SceneCall& call, std::string_view argument) {
    std::vector<std::string> out;
    for (const ArgumentValue& v : call.values(argument)) out.push_back(v.text);
    return out;
}

/// Returns all branches that may be inserted: from a library, from trees of the scene, otherwise from the
/// template.
std::vector<ChildTree> find_child_trees(const SceneCall& call) {
    const auto which = call.options<LibraryFilter>("library");
    std::vector<ChildTree> out;
    if (call.has("library")) {
        const std::filesystem::path path = call.input("library");
        constexpr double kBytesOfByte = 8;
        std::error_code error;
        const auto size = std::filesystem::file_size(path, error);
        if (!error) call.reserve(kBytesOfByte * static_cast<double>(size));
        out = read_child_trees(path, which, call.context());
    } else if (!which.empty()) {
        throw InvalidInput(
            "options that select trees, such as tag=, apply only to a library; add library=FILE");
    }
    std::vector<std::string> trees = texts(call, "branches");
    if (trees.empty() && !call.has("library")) trees.push_back(call.text("template"));
    for (auto& of_tree : find_branches(call, trees)) std::ranges::move(of_tree, std::back_inserter(out));
    return out;
}

std::string to_text(const ComposeReport& r) {
    return fmt::format("{} of {} branches replaced, {} blocked, {} without a match\n", r.replaced, r.chosen,
                       r.blocked, r.unmatched);
}

SceneCommand compose_command() {
    SceneCommand c =
        in_group("compose", "Create a new tree from a template by replacing branches with others.",
                 "compose other tree depth=2 probability=0.5");
    c.makes = ObjectKind::skeleton;
    Argument library{.name = "library",
                     .help = "Library of branches to insert, as written by library add.",
                     .type = ArgumentType::input_file};
    Argument trees =
        object_option("branches", ObjectKind::skeleton,
                      "Tree with branches to insert; without branches= and library=, the template.");
    Argument seed = number("seed", "0", 0, 2147483647, Unit::none, "Seed of the random choices.");
    seed.type = ArgumentType::whole;
    c.arguments = {new_name("name", "Name of the new skeleton."),
                   object("template", ObjectKind::skeleton, "Tree in which branches are replaced."),
                   library,
                   repeated(trees),
                   object_option("crown", ObjectKind::solid, "Solid that inserted branches may not leave."),
                   seed};
    add_options(c.arguments, ComposeOptions{}, "compose");
    add_options(c.arguments, LibraryFilter{}, "library", {},
                {{"library.ids", "id"}, {"library.tags", "tag"}});
    c.run = [](const SceneCall& call) {
        const Skeleton& template_tree = call.skeleton(call.text("template"));
        auto options = call.options<ComposeOptions>("compose");
        call.reserve(kBytesOfComposedNode * template_tree.size());
        options.max_nodes =
            static_cast<int>(std::min(double(options.max_nodes), call.memory_left() / kBytesOfComposedNode));
        const TreeComposer composer(find_child_trees(call), options);
        std::optional<SolidField> crown;
        if (call.has("crown")) crown.emplace(call.field(call.text("crown"), template_tree.origin()));
        const auto seed_given = static_cast<std::uint64_t>(call.number("seed"));
        ComposeResult made =
            composer.compose(template_tree, seed_given, crown ? &*crown : nullptr, call.context());
        SceneOutcome out = makes_tree(call.text("name"), std::move(made.skeleton));
        out.text = to_text(made.report);
        return out;
    };
    return c;
}

/// Returns the branches that begin at the selected nodes.
std::vector<std::vector<ChildTree>> selected_branches(const SceneCall& call,
                                                      std::span<const std::string> trees,
                                                      const ChildTreeOptions& options) {
    const ChildTreeOptions all;
    if (trees.size() != 1) throw InvalidInput("nodes= selects nodes of one tree; name one tree");
    if (options.leaders != all.leaders || options.min_length != all.min_length)
        throw InvalidInput("nodes= selects the branches; leave leaders= and min_length= out");
    const Skeleton& skeleton = call.skeleton(trees.front());
    call.reserve(kBytesOfEditedNode * skeleton.size());
    const EditableTree tree(skeleton);
    const NodeSet chosen = find_nodes(call, tree);
    std::vector<NodeId> first;
    double branch_nodes = 0;
    for (const NodeId n : nodes(skeleton)) {
        const StableId id = skeleton.stable_id(n);
        if (!std::ranges::binary_search(chosen, id)) continue;
        if (!begins_child_tree(skeleton, n)) {
            throw InvalidInput(fmt::format(
                "node {} does not begin a branch; select the first node after a fork", id.index()));
        }
        tree.visit_subtree(id, [&](StableId) { ++branch_nodes; });
        first.push_back(n);
    }
    call.reserve(kBytesOfLibraryNode * branch_nodes);
    return {child_trees_at(skeleton, first)};
}

SceneCommand library_add_command() {
    SceneCommand c = in_group("library add", "Add the branches of trees to a library, for compose library=.",
                              "library add oaks.branches tree tag=oak");
    c.records = false;
    c.arguments = {
        file("library", ArgumentType::output_file,
             "File of the library, which is created if it does not exist."),
        object("trees", ObjectKind::skeleton, "Trees with the branches to add.", true),
        repeated(Argument{.name = "tag", .help = "Tag of the added branches."}),
        named(selection("nodes", "Add only the branches that begin at these nodes of a single tree."))};
    add_options(c.arguments, ChildTreeOptions{}, "take");
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("library");
        const auto options = call.options<ChildTreeOptions>("take");
        const std::vector<std::string> names = texts(call, "trees"), tags = texts(call, "tag");
        const auto trees =
            call.has("nodes") ? selected_branches(call, names, options) : find_branches(call, names, options);
        SceneOutcome out;
        if (!call.settings().outputs) return out;
        std::vector<TreeLibrary::Batch> batches;
        for (std::size_t i = 0; i < trees.size(); ++i) batches.push_back({trees[i], names[i]});
        const auto done = TreeLibrary(path, LibraryAccess::create, call.context()).add(batches, tags);
        out.text = fmt::format("{} branches added, {} already existed\n", done.ids.size(), done.known);
        return out;
    };
    return c;
}

SceneCommand library_list_command() {
    SceneCommand c =
        in_group("library list", "List the branches of a library.", "library list oaks.branches tag=oak");
    c.records = false;
    c.arguments = {file("library", ArgumentType::input_file, "File of the library.")};
    add_options(c.arguments, LibraryFilter{}, "library", {},
                {{"library.ids", "id"}, {"library.tags", "tag"}});
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        out.text = make_table(TreeLibrary(call.input("library"), LibraryAccess::read, call.context())
                                  .list(call.options<LibraryFilter>("library")));
        return out;
    };
    return c;
}

BranchPose compute_pose(const SceneCall& call) {
    BranchPose pose{.direction = {}, .roll = call.number("roll"), .scale = call.number("scale")};
    if (call.has("direction")) pose.direction = Vec3d(call.point("direction"));
    return pose;
}

NodeId node_with(const Skeleton& skeleton, StableId id) {
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.stable_id(n) == id) return n;
    }
    return NodeId::none();
}

SceneCommand library_graft_command() {
    SceneCommand c = in_group("library graft", "Attach a branch of a library to a node of a tree.",
                              "library add oaks.branches tree\nlibrary graft tree oaks.branches 1 roots");
    c.makes = ObjectKind::skeleton;
    Argument which_one =
        positional(number("number", "", 1, 1e15, Unit::none, "Number of the branch in library list."));
    which_one.type = ArgumentType::whole;
    c.arguments = {
        object("tree", ObjectKind::skeleton,
               "Tree to which the branch is attached; its nodes keep their ids."),
        file("library", ArgumentType::input_file, "File of the library."),
        std::move(which_one),
        selection("host", "Node to which the branch is attached."),
        number("along", "1", 0, 1, Unit::none, "Position on the segment of the host; 1 is at the host."),
        tuple("direction", "",
              "Initial direction x,y,z; by default the original inclination, towards the side with the most "
              "free space."),
        number("roll", "0", -6.2832e3, 6.2832e3, Unit::radian, "Rotation of the branch about itself."),
        number("scale", "1", 1e-6, 1e6, Unit::none, "Factor on lengths and radii."),
        flag("limit_radius", true, "Limit the radii to the radius of the host.")};
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("tree");
        const Skeleton& skeleton = call.skeleton(name);
        LibraryFilter which;
        which.ids = {fmt::format("{:.0f}", call.number("number"))};
        const ChildTree branch = read_child_trees(call.input("library"), which, call.context()).front();
        call.reserve(kBytesOfEditedNode * (skeleton.size() + branch.skeleton.size()));
        EditableTree tree(skeleton);
        const StableId parent_node = find_node(call, tree, "host");
        const NodeId at = node_with(skeleton, parent_node);
        const double along = call.number("along");
        graft(tree,
              placed_branch(branch, skeleton, find_parent_place(skeleton, at, along), compute_pose(call)),
              parent_node, {.along = along, .limit_radius = call.flag("limit_radius")});
        Skeleton grafted = tree.skeleton();
        auto attributes = kept_attributes(call.attributes(name), skeleton, grafted);
        return makes_tree(name, std::move(grafted), std::move(attributes));
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> compose_commands() {
    return {compose_command(), library_add_command(), library_list_command(), library_graft_command()};
}

}  // namespace coppice
