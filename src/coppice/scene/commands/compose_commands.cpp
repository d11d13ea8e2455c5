#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "coppice/compose/compose.h"
#include "coppice/compose/placed_branch.h"
#include "coppice/edit/join.h"
#include "coppice/io/library/tree_library.h"
#include "coppice/scene/commands/edit_tables_internal.h"

namespace coppice {
namespace {

using namespace table;

constexpr double kBytesOfComposedNode = 300;  // with its segment, and what comes out
constexpr double kBytesOfLibraryNode = 60;    // with what is looked up of it

SceneCommand in_group(std::string name, std::string help, std::string example) {
    SceneCommand c{.name = std::move(name), .group = "Composing trees", .help = std::move(help)};
    c.example = std::move(example);
    return c;
}

/// Of all branches of a tree: a node is in each that begins below it.
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

/// The branches of each of the trees.
std::vector<std::vector<ChildTree>> branches_of(const SceneCall& call, std::span<const std::string> trees,
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

/// All that may be put in: of a library, of trees of the scene, else of the template.
std::vector<ChildTree> child_trees_of(const SceneCall& call) {
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
        throw InvalidInput("what says which trees, such as tag=, is for those of library=FILE");
    }
    std::vector<std::string> trees = texts(call, "branches");
    if (trees.empty() && !call.has("library")) trees.push_back(call.text("template"));
    for (auto& of_tree : branches_of(call, trees)) std::ranges::move(of_tree, std::back_inserter(out));
    return out;
}

std::string text_of(const ComposeReport& r) {
    return fmt::format("{} of {} branches replaced, {} blocked, {} without a match\n", r.replaced, r.chosen,
                       r.blocked, r.unmatched);
}

SceneCommand compose_command() {
    SceneCommand c = in_group("compose", "makes a new tree of a template by replacing branches by others",
                              "compose other tree depth=2 probability=0.5");
    c.makes = ObjectKind::skeleton;
    Argument library{.name = "library",
                     .help = "branches to put in, as library add keeps them",
                     .type = ArgumentType::input_file};
    Argument trees =
        object_option("branches", ObjectKind::skeleton,
                      "a tree whose branches are put in too; without any and library=, the template");
    Argument seed = number("seed", "0", 0, 2147483647, Unit::none, "another seed, another tree");
    seed.type = ArgumentType::whole;
    c.arguments = {new_name("name", "name of the new skeleton"),
                   object("template", ObjectKind::skeleton, "whose branches are replaced"),
                   library,
                   repeated(trees),
                   object_option("crown", ObjectKind::solid, "no branch that is put in may leave this solid"),
                   seed};
    add_options(c.arguments, ComposeOptions{}, "compose");
    add_options(c.arguments, LibraryFilter{}, "library", {},
                {{"library.ids", "id"}, {"library.tags", "tag"}});
    c.run = [](const SceneCall& call) {
        const Skeleton& host = call.skeleton(call.text("template"));
        auto options = call.options<ComposeOptions>("compose");
        call.reserve(kBytesOfComposedNode * host.size());
        options.max_nodes =
            static_cast<int>(std::min(double(options.max_nodes), call.memory_left() / kBytesOfComposedNode));
        const TreeComposer composer(child_trees_of(call), options);
        std::optional<SolidField> crown;
        if (call.has("crown")) crown.emplace(call.field(call.text("crown"), host.origin()));
        const auto seed_given = static_cast<std::uint64_t>(call.number("seed"));
        ComposeResult made = composer.compose(host, seed_given, crown ? &*crown : nullptr, call.context());
        SceneOutcome out = makes_tree(call.text("name"), std::move(made.skeleton));
        out.text = text_of(made.report);
        return out;
    };
    return c;
}

/// The branches that begin at the nodes that are selected.
std::vector<std::vector<ChildTree>> selected_branches(const SceneCall& call,
                                                      std::span<const std::string> trees,
                                                      const ChildTreeOptions& options) {
    const ChildTreeOptions all;
    if (trees.size() != 1) throw InvalidInput("nodes= are those of one tree; name one");
    if (options.leaders != all.leaders || options.least_length != all.least_length)
        throw InvalidInput("nodes= says which branches; leave leaders= and least_length= out");
    const Skeleton& skeleton = call.skeleton(trees.front());
    call.reserve(kBytesOfEditedNode * skeleton.size());
    const EditableTree tree(skeleton);
    const NodeSet chosen = nodes_of(call, tree);
    std::vector<NodeId> first;
    double branch_nodes = 0;
    for (const NodeId n : nodes(skeleton)) {
        const StableId id = skeleton.stable_id(n);
        if (!std::ranges::binary_search(chosen, id)) continue;
        if (!begins_child_tree(skeleton, n)) {
            throw InvalidInput(fmt::format(
                "node {} does not begin a branch; select the first node behind a fork", id.index()));
        }
        tree.visit_subtree(id, [&](StableId) { ++branch_nodes; });
        first.push_back(n);
    }
    call.reserve(kBytesOfLibraryNode * branch_nodes);
    return {child_trees_at(skeleton, first)};
}

SceneCommand library_add_command() {
    SceneCommand c = in_group("library add", "keeps the branches of trees in a library, for compose library=",
                              "library add oaks.branches tree tag=oak");
    c.records = false;
    c.arguments = {file("library", ArgumentType::output_file,
                        "the library, one file, which is made where it is missing"),
                   object("trees", ObjectKind::skeleton, "whose branches are kept", true),
                   repeated(Argument{.name = "tag", .help = "they get this tag"}),
                   named(selection("nodes", "of one tree, the branches that begin at these nodes alone"))};
    add_options(c.arguments, ChildTreeOptions{}, "take");
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("library");
        const auto options = call.options<ChildTreeOptions>("take");
        const std::vector<std::string> names = texts(call, "trees"), tags = texts(call, "tag");
        const auto trees =
            call.has("nodes") ? selected_branches(call, names, options) : branches_of(call, names, options);
        SceneOutcome out;
        if (!call.settings().outputs) return out;
        std::vector<TreeLibrary::Batch> batches;
        for (std::size_t i = 0; i < trees.size(); ++i) batches.push_back({trees[i], names[i]});
        const auto done = TreeLibrary(path, LibraryAccess::create, call.context()).add(batches, tags);
        out.text = fmt::format("{} branches added, {} were there already\n", done.ids.size(), done.known);
        return out;
    };
    return c;
}

SceneCommand library_list_command() {
    SceneCommand c =
        in_group("library list", "shows what a library holds", "library list oaks.branches tag=oak");
    c.records = false;
    c.arguments = {file("library", ArgumentType::input_file, "the library")};
    add_options(c.arguments, LibraryFilter{}, "library", {},
                {{"library.ids", "id"}, {"library.tags", "tag"}});
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        out.text = table_of(TreeLibrary(call.input("library"), LibraryAccess::read, call.context())
                                .list(call.options<LibraryFilter>("library")));
        return out;
    };
    return c;
}

BranchPose pose_of(const SceneCall& call) {
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
    SceneCommand c = in_group("library graft", "puts a branch of a library on a node of a tree",
                              "library add oaks.branches tree\nlibrary graft tree oaks.branches 1 roots");
    c.makes = ObjectKind::skeleton;
    Argument which_one =
        positional(number("number", "", 1, 1e15, Unit::none, "of the branch, as library list has it"));
    which_one.type = ArgumentType::whole;
    c.arguments = {object("tree", ObjectKind::skeleton, "what it is put on; its nodes keep their ids"),
                   file("library", ArgumentType::input_file, "the library"),
                   std::move(which_one),
                   selection("host", "the node that it comes to hang on"),
                   number("along", "1", 0, 1, Unit::none, "where on the host's segment; 1 = at the host"),
                   tuple("direction", "",
                         "x,y,z where it sets off to; else as inclined as on its own host, to the side "
                         "with most room"),
                   number("roll", "0", -6.2832e3, 6.2832e3, Unit::radian, "about itself"),
                   number("scale", "1", 1e-6, 1e6, Unit::none, "of its lengths and radii"),
                   flag("limit_radius", true, "no radius exceeds the host's")};
    c.run = [](const SceneCall& call) {
        const std::string& name = call.text("tree");
        const Skeleton& skeleton = call.skeleton(name);
        LibraryFilter which;
        which.ids = {fmt::format("{:.0f}", call.number("number"))};
        const ChildTree branch = read_child_trees(call.input("library"), which, call.context()).front();
        call.reserve(kBytesOfEditedNode * (skeleton.size() + branch.skeleton.size()));
        EditableTree tree(skeleton);
        const StableId host = node_of(call, tree, "host");
        const NodeId at = node_with(skeleton, host);
        const double along = call.number("along");
        graft(tree, placed_branch(branch, skeleton, host_place(skeleton, at, along), pose_of(call)), host,
              {.along = along, .limit_radius = call.flag("limit_radius")});
        Skeleton grafted = tree.skeleton();
        auto attributes = carried_attributes(call.attributes(name), skeleton, grafted);
        return makes_tree(name, std::move(grafted), std::move(attributes));
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> compose_commands() {
    return {compose_command(), library_add_command(), library_list_command(), library_graft_command()};
}

}  // namespace coppice
