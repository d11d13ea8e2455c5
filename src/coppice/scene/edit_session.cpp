#include "coppice/scene/edit_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "coppice/base/quote.h"
#include "coppice/edit/selection.h"
#include "coppice/scene/edit_lines_internal.h"
#include "coppice/scene/place_internal.h"

namespace coppice {

namespace scene_internal {

const SceneCommand* edit_called(const std::string& name) {
    for (const SceneCommand& c : scene_commands()) {
        if ((c.edit || c.show) && c.name == "edit " + name) return &c;
    }
    return nullptr;
}

std::vector<std::string> parted(std::string_view line) {
    std::vector<std::string> out(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        const bool begins = i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t' || line[i - 1] == ';';
        if (!quoted && c == '#' && begins) break;
        if (!quoted && c == ';') {
            out.emplace_back();
            continue;
        }
        if (quoted && c == '\\' && i + 1 < line.size()) out.back() += line[i++];
        if (line[i] == '"' && (i == 0 || !quoted || line[i - 1] != '\\')) quoted = !quoted;
        out.back() += line[i];
    }
    return out;
}

}  // namespace scene_internal

using scene_internal::edit_called;
using scene_internal::parted;
using scene_internal::placed;

namespace {

constexpr double kBytesOfNode = 400;  // for an edit that doubles the tree, and its history
const std::string kTree = "tree";     // name of the tree in the scene

std::vector<StableId> ids_named(const SceneCall& call) {
    std::set<StableId> ids;
    for (const Argument& a : call.command().arguments) {
        if (a.type != ArgumentType::selection) continue;
        for (const ArgumentValue& v : call.values(a.name)) {
            Selection selection = parse_selection(v.text);
            for_each_id(selection, [&](StableId& n) { ids.insert(n); });
        }
    }
    return {ids.begin(), ids.end()};
}

/// Converts "edit bend tree 12 30 ..." to the form of this session: "bend 12 30 ...".
std::string typed_here(const SceneCall& call) {
    const std::string name = call.command().name, line = call.typed();
    const std::string before = name + " " + kTree;
    return name.substr(std::string_view("edit ").size()) + line.substr(before.size());
}

std::string counted(std::size_t n, std::string_view subject) {
    return n == 0 ? "" : fmt::format(" {} {},", n, subject);
}

}  // namespace

EditSession::EditSession(const Skeleton& tree, SceneSettings settings)
    : scene_(std::move(settings)), tree_(tree), frame_(anchor_frame(tree_)), first_slots_(tree_.slots()) {
    scene_.hold_tree(kTree, tree);
}

void EditSession::keep_surface(const MeshOptions& options, const Context& ctx) {
    surface_.emplace(tree_.skeleton(), options, ctx);
    unfollowed_.clear();
}

void EditSession::note(const EditChange& change) {
    last_change_ = change;
    if (!surface_) return;
    const NodeSet nodes = change.nodes();
    unfollowed_.insert(unfollowed_.end(), nodes.begin(), nodes.end());
}

void EditSession::follow(const Context& ctx) {
    if (!surface_) return;
    surface_->update(tree_.skeleton(), unfollowed_, ctx);
    unfollowed_.clear();
}

std::string EditSession::run(std::string_view line, const std::string& place, const Context& ctx) {
    std::string output = run_one(line, place, ctx);
    follow(ctx);
    return output;
}

std::string EditSession::run_one(std::string_view line, const std::string& place, const Context& ctx) {
    last_change_ = {};
    auto words = placed(place, [&] { return scene_words(line); });
    if (words.size() > 1 && words[0].text == "edit") words.erase(words.begin());
    if (words.empty()) return {};
    const std::string first = words[0].text;
    if (first == "undo" || first == "redo" || first == "history")
        return placed(place.empty() ? first : place + ": " + first, [&] { return history_command(words); });
    const SceneCommand* command = edit_called(first);
    if (command == nullptr) {
        std::size_t used = 0;
        const SceneCommand& other =
            placed(place, [&]() -> const SceneCommand& { return find_command(words, used); });
        if (other.makes == ObjectKind::skeleton) {
            throw InvalidInput(
                fmt::format("{}{}{} creates a tree, but edits apply to the existing one; run a scene first",
                            place, place.empty() ? "" : ": ", other.name));
        }
        if (!held_) scene_.hold_tree(kTree, tree_.skeleton());
        held_ = true;
        return scene_.run(line, place, ctx);
    }
    const SceneCall call = placed(place, [&] { return bind(words, ctx); });
    return placed(place.empty() ? first : place + ": " + first,
                  [&] { return command->show ? command->show(call, tree_) : edit(call); });
}

SceneCall EditSession::bind(std::vector<SceneWord> words, const Context& ctx) {
    words.insert(words.begin(), SceneWord{{}, "edit"});
    words.insert(words.begin() + 2, SceneWord{{}, kTree});
    return bind_command(words, scene_.state(), scene_.settings(), ctx);
}

std::string EditSession::run_text(std::string_view text, const std::string& source, const Context& ctx) {
    std::string out;
    for (const SceneLine& line : scene_lines(text, source)) {
        for (const std::string& command : parted(line.text)) {
            ctx.throw_if_cancelled();
            out += run(command, fmt::format("{}:{}", source, line.number), ctx);
        }
    }
    return out;
}

std::string EditSession::edit(const SceneCall& call) {
    Made made{.command = typed_here(call), .named = {}, .change = {}};
    for (const StableId n : ids_named(call)) {
        if (tree_.contains(n)) made.named.push_back(named(n));
    }
    call.reserve(kBytesOfNode * tree_.size());
    made.change = call.command().edit(call, tree_);
    note(made.change);
    if (made.change.empty()) return "nothing changed\n";
    held_ = false;
    made_.push_back(std::move(made));
    undone_.clear();
    return {};
}

std::string EditSession::history_command(const std::vector<SceneWord>& words) {
    const std::string& subject = words[0].text;
    if (words.size() > (subject == "history" ? 1 : 2))
        throw InvalidInput(fmt::format("{} does not accept {}", subject, quote(words.back().text)));
    if (subject == "history") return history_text();
    const Argument count{.name = "count", .help = {}, .type = ArgumentType::whole, .low = 1, .high = 1e9};
    const double most = words.size() > 1 ? parse_argument(count, words[1].text).numbers.at(0) : 1;
    std::vector<Made>& from = subject == "undo" ? made_ : undone_;
    std::vector<Made>& to = subject == "undo" ? undone_ : made_;
    if (most > static_cast<double>(from.size())) {
        throw InvalidInput(fmt::format("only {} edits can be {}; history lists them", from.size(),
                                       subject == "undo" ? "undone" : "redone"));
    }
    for (double i = 0; i < most; ++i) {
        note(subject == "undo" ? tree_.undo() : tree_.redo());
        to.push_back(std::move(from.back()));
        from.pop_back();
    }
    held_ = false;
    return {};
}

std::string EditSession::history_text() const {
    std::string text;
    std::size_t number = 0;
    for (const Made& made : made_) {
        const EditChange& c = made.change;
        std::string did = counted(c.added.size(), "added") + counted(c.removed.size(), "removed") +
                          counted(c.moved.size(), "moved") + counted(c.resized.size(), "with other radii") +
                          counted(c.reparented.size(), "on other parents");
        did.pop_back();
        text += fmt::format("{:>4}  {}  #{}\n", ++number, made.command, did);
    }
    return text + fmt::format("{} edits, {} undone\n", made_.size(), undone_.size());
}

EditSession::Named EditSession::named(StableId n) const {
    Named out{.anchor = compute_anchor(tree_, frame_, n)};
    for (std::size_t i = made_.size(); n.index() >= first_slots_ && i-- > 0 && out.maker == 0;) {
        const NodeSet& added = made_[i].change.added;
        const auto at = std::ranges::lower_bound(added, n);
        if (at == added.end() || *at != n) continue;
        out.maker = i + 1;
        out.added = static_cast<std::size_t>(at - added.begin());
    }
    return out;
}

}  // namespace coppice
