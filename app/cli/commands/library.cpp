#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>

#include "command.h"
#include "coppice/base/quote.h"
#include "coppice/io_database/tree_library.h"
#include "coppice/render/png.h"
#include "files.h"
#include "options.h"
#include "pictures.h"

namespace coppice::cli {
namespace {

enum class Action { add, list, tag, remove, draw };
constexpr std::array<std::string_view, 5> kActions{"add", "list", "tag", "remove", "draw"};
constexpr const char* kAddGroup = "Adding";
constexpr const char* kTagGroup = "Tags to set and remove";
constexpr const char* kDrawGroup = "Drawing";
constexpr const char* kWhichGroup = "Trees of the library to use";

struct LibraryFlags {
    std::filesystem::path action, library, output;
    std::vector<std::filesystem::path> trees;
    std::vector<std::string> nodes, set_tags, clear_tags;
    int picture_size = 256;
    ChildTreeOptions take;
    LibraryFilter which;
    ReadSkeletonOptions read;
};

Action select_action(const LibraryFlags& flags) {
    const auto found = std::ranges::find(kActions, flags.action.string());
    if (flags.library.empty() || found == kActions.end()) {
        throw UsageError(fmt::format("choose an action, and name the library: coppice library {} LIBRARY",
                                     fmt::join(kActions, "|")));
    }
    return static_cast<Action>(found - kActions.begin());
}

/// Throws UsageError for an option that belongs to another action.
void check_groups(const GivenOptions& given, Action action) {
    for (const Option* option : given) {
        const std::string& group = option->group;
        const bool fits = group == kAddGroup   ? action == Action::add
                          : group == kTagGroup ? action == Action::tag ||
                                                     (action == Action::add && option->name == "--set-tag")
                          : group == kDrawGroup  ? action == Action::draw
                          : group == kWhichGroup ? action != Action::add
                                                 : true;
        if (!fits)
            throw UsageError(fmt::format("{} does nothing with coppice library {}", option->name,
                                         kActions[static_cast<std::size_t>(action)]));
    }
}

std::vector<NodeId> find_nodes(const LibraryFlags& flags) {
    std::vector<NodeId> out;
    for (const std::string& word : flags.nodes) {
        std::uint32_t n = 0;
        const char* const end = word.data() + word.size();
        const auto [at, error] = std::from_chars(word.data(), end, n);
        if (error != std::errc{} || at != end)
            throw UsageError(
                fmt::format("--node takes the number of a node, as in --node 12, and not {}", quote(word)));
        out.emplace_back(n);
    }
    return out;
}

ExitCode add(Run& run, const LibraryFlags& flags) {
    if (flags.trees.empty())
        throw UsageError("name the trees that provide the branches: coppice library add LIBRARY TREE");
    const std::vector<NodeId> chosen = find_nodes(flags);
    if (!chosen.empty() && flags.trees.size() > 1) throw UsageError("--node requires exactly one tree");
    check_output_folder(flags.library);
    // All files are read before the library is written.
    std::vector<std::vector<ChildTree>> trees;
    for (const auto& path : flags.trees) {
        const SkeletonFile file = load_skeleton(run, path, flags.read);
        trees.push_back(run.stage("cut", [&](const Context& ctx) {
            return chosen.empty() ? child_trees(file.skeleton, flags.take, ctx)
                                  : child_trees_at(file.skeleton, chosen);
        }));
        if (trees.back().empty())
            run.warn(fmt::format("{}: it contains no such branch, so nothing was added", path.string()));
    }
    std::vector<TreeLibrary::Batch> batches;
    for (std::size_t i = 0; i < trees.size(); ++i)
        batches.push_back({trees[i], flags.trees[i].filename().string()});
    const TreeLibrary::Added done = run.stage("write", [&](const Context& ctx) {
        return TreeLibrary(flags.library, LibraryAccess::create, ctx).add(batches, flags.set_tags);
    });
    run.counts().update({{"added", done.ids.size()}, {"known", done.known}});
    run.finish(fmt::format("{}: {} branches added{}", flags.library.string(), grouped(done.ids.size()),
                           done.known > 0 ? fmt::format(", {} already existed", grouped(done.known)) : ""));
    return kDone;
}

Json compute_figures(const LibraryEntry& e) {
    return {{"id", e.id},
            {"source", e.source},
            {"node", e.tree.source_node},
            {"tags", e.tags},
            {"leads", e.tree.leads},
            {"length_m", e.measures.length},
            {"volume_m3", e.measures.volume},
            {"extent_m", e.measures.extent},
            {"nodes", e.measures.nodes},
            {"tips", e.measures.tips},
            {"orders", e.measures.orders},
            {"radius_m", e.measures.radius},
            {"host_radius_m", e.tree.parent_radius},
            {"inclination_degrees", double{e.tree.inclination} * 180 / std::numbers::pi}};
}

ExitCode list(Run& run, const LibraryFlags& flags) {
    const std::vector<LibraryEntry> entries = run.stage("read", [&](const Context& ctx) {
        return TreeLibrary(flags.library, LibraryAccess::read, ctx).list(flags.which);
    });
    run.print(make_table(entries));
    Json figures = Json::array();
    for (const LibraryEntry& e : entries) figures.push_back(compute_figures(e));
    run.counts().update({{"trees", entries.size()}, {"entries", figures}});
    run.finish(fmt::format("{}: {} branches", flags.library.string(), grouped(entries.size())));
    return kDone;
}

void check_chosen(const LibraryFlags& flags, std::string_view subject) {
    if (flags.which.empty())
        throw UsageError(
            fmt::format("choose the trees to {}, as with --id 7, --tag oak or --from oak.swc", subject));
}

ExitCode tag(Run& run, const LibraryFlags& flags) {
    if (flags.set_tags.empty() && flags.clear_tags.empty())
        throw UsageError("choose the tags, as with --set-tag oak or --clear-tag elm");
    check_chosen(flags, "tag");
    const std::uint32_t changed = run.stage("write", [&](const Context& ctx) {
        return TreeLibrary(flags.library, LibraryAccess::write, ctx)
            .tag(flags.which, flags.set_tags, flags.clear_tags);
    });
    run.counts()["tagged"] = changed;
    run.finish(fmt::format("{}: {} branches tagged", flags.library.string(), grouped(changed)));
    return kDone;
}

ExitCode remove(Run& run, const LibraryFlags& flags) {
    check_chosen(flags, "remove");
    const std::uint32_t removed = run.stage("write", [&](const Context& ctx) {
        return TreeLibrary(flags.library, LibraryAccess::write, ctx).remove(flags.which);
    });
    run.counts()["removed"] = removed;
    run.finish(fmt::format("{}: {} branches removed", flags.library.string(), grouped(removed)));
    return kDone;
}

ExitCode draw(Run& run, const LibraryFlags& flags) {
    if (flags.output.empty())
        throw UsageError("name a sheet or a folder: coppice library draw LIBRARY -o SHEET.png");
    const bool sheet = is_png_name(flags.output);
    check_output_folder(flags.output);
    if (!sheet && std::filesystem::is_regular_file(flags.output))
        throw UsageError(fmt::format("'{}' is a file; name a sheet that ends in .png, or a folder",
                                     flags.output.string()));
    const std::vector<LibraryEntry> entries = run.stage("read", [&](const Context& ctx) {
        return TreeLibrary(flags.library, LibraryAccess::read, ctx).read(flags.which);
    });
    if (entries.empty())
        throw InvalidInput(fmt::format("{}: it contains no such trees", flags.library.string()));
    std::vector<const Skeleton*> trees;
    for (const LibraryEntry& e : entries) trees.push_back(&e.tree.skeleton);
    const std::vector<Image> pictures = draw_each(run, trees, flags.picture_size);
    run.stage("write", [&](const Context&) {
        if (sheet) {
            write_sheet(flags.output, pictures);
            return;
        }
        std::filesystem::create_directories(flags.output);
        for (std::size_t i = 0; i < entries.size(); ++i)
            write_picture(flags.output / fmt::format("{}.png", entries[i].id), pictures[i]);
    });
    run.counts()["drawn"] = entries.size();
    run.finish(fmt::format("{}: {} branches", flags.output.string(), grouped(entries.size())));
    return kDone;
}

ExitCode use_library(Run& run, const GivenOptions& given, const LibraryFlags& flags) {
    const Action action = select_action(flags);
    check_groups(given, action);
    if (action != Action::add && !flags.trees.empty())
        throw UsageError(
            fmt::format("'{}': only coppice library add accepts trees", flags.trees[0].string()));
    if (action != Action::draw && !flags.output.empty())
        throw UsageError("-o is for the images of coppice library draw");
    switch (action) {
        case Action::add:
            return add(run, flags);
        case Action::list:
            return list(run, flags);
        case Action::tag:
            return tag(run, flags);
        case Action::remove:
            return remove(run, flags);
        case Action::draw:
            break;
    }
    return draw(run, flags);
}

}  // namespace

FlagNames library_flag_names() { return {.names = {{"ids", "--id"}, {"tags", "--tag"}}}; }

Command library_command() {
    const auto flags = std::make_shared<LibraryFlags>();
    OptionList options;
    options.file("action", "ACTION", flags->action, "Action: add, list, tag, remove or draw.");
    options.file("library", "LIBRARY", flags->library, "Library file; add creates it if it is missing.");
    options.files("trees", "TREE", flags->trees, "Skeletons with the branches to add (add).");
    options.output("-o,--output", "PNG", flags->output,
                   "Sheet of images (.png), or a folder for one image per tree (draw).");
    options.value(
        {common_field(
             "node",
             "Add the branch that begins at this node, numbered from 0 as in reports; may be repeated."),
         &flags->nodes},
        kAddGroup);
    options.fields(flags->take, kAddGroup, {.names = {{"min_length", "--take-min-length"}}});
    options.value({common_field("set_tag", "Tag to set on the trees; may be repeated."), &flags->set_tags},
                  kTagGroup);
    options.value(
        {common_field("clear_tag", "Tag to remove from the trees; may be repeated."), &flags->clear_tags},
        kTagGroup);
    options.value({{"picture_size", "Width and height of each image in pixels.", Unit::none, 16, 4096},
                   &flags->picture_size},
                  kDrawGroup);
    options.fields(flags->which, kWhichGroup, library_flag_names());
    options.fields(flags->read, "Reading a skeleton");
    return {"library", "Manage a library of branches, from which new trees are composed.", options,
            [flags](Run& run, const GivenOptions& given) { return use_library(run, given, *flags); }};
}

}  // namespace coppice::cli
