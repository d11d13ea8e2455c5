// Saved edits: JSON with commands and the positions of the nodes that they refer to.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "coppice/edit/selection.h"
#include "coppice/scene/edit_session.h"
#include "coppice/scene/place_internal.h"

namespace coppice {
namespace {

constexpr int kVersion = 1;
constexpr std::size_t kMaxEdits = 100'000;

Json make_json(Vec3d v) { return Json::array({v.x, v.y, v.z}); }

Json make_json(const EditSession::Named& node) {
    const Anchor& a = node.anchor;
    Json out{{"id", a.id.index()}, {"place", make_json(a.place)}, {"order", a.order},
             {"along", a.along},   {"length", a.length},          {"radius", a.radius}};
    if (node.maker > 0) {
        out["made_by"] = node.maker;
        out["as"] = node.added;
    }
    return out;
}

[[noreturn]] void fail(const std::string& where, std::string_view subject) {
    throw InvalidInput(fmt::format("{}{}", where, subject));
}

const Json& member(const Json& object, const char* name, const std::string& where) {
    if (!object.is_object() || !object.contains(name)) fail(where, fmt::format(" has no '{}'", name));
    return object.at(name);
}

double number(const Json& object, const char* name, const std::string& where, double low, double high) {
    const Json& value = member(object, name, where);
    const double x = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(x >= low && x <= high))
        fail(where, fmt::format(".{} is not a number from {} to {}", name, low, high));
    return x;
}

std::size_t whole(const Json& object, const char* name, const std::string& where) {
    const double x = number(object, name, where, 0, 4294967294.0);
    if (x != std::floor(x)) fail(where, fmt::format(".{} is not a whole number", name));
    return static_cast<std::size_t>(x);
}

EditSession::Named named_from(const Json& object, const std::string& where) {
    constexpr double kFar = 1e6;
    const Json& place = member(object, "place", where);
    if (!place.is_array() || place.size() != 3 ||
        !std::ranges::all_of(place, [](const Json& x) { return x.is_number(); }))
        fail(where, ".place is not a list of three numbers");
    EditSession::Named out{
        .anchor = {.id = StableId(static_cast<std::uint32_t>(whole(object, "id", where))),
                   .place = {place[0].get<double>(), place[1].get<double>(), place[2].get<double>()},
                   .order = static_cast<int>(number(object, "order", where, 0, 1e9)),
                   .along = number(object, "along", where, 0, 1),
                   .length = number(object, "length", where, 0, kFar),
                   .radius = number(object, "radius", where, 1e-15, kFar)}};
    if (object.contains("made_by")) {
        out.maker = whole(object, "made_by", where);
        out.added = whole(object, "as", where);
    }
    return out;
}

std::vector<EditSession::Named> all_named(const Json& edit, const std::string& where) {
    const Json& list = member(edit, "nodes", where);
    if (!list.is_array()) fail(where, ".nodes is not a list");
    std::vector<EditSession::Named> out;
    for (std::size_t i = 0; i < list.size(); ++i)
        out.push_back(named_from(list[i], fmt::format("{}.nodes[{}]", where, i)));
    return out;
}

Json parsed(std::string_view text, const std::string& source) {
    Json all = Json::parse(text, nullptr, false);
    if (all.is_discarded()) fail(source, ": this is not valid JSON");
    if (!all.is_object() || all.value("format", Json()) != "coppice-edits")
        fail(source, ": this JSON is not a file of edits: it needs \"format\": \"coppice-edits\"");
    if (number(all, "version", source, 0, 1e9) > kVersion)
        throw Unsupported(fmt::format("{}: this version of coppice-edits is newer than the program", source));
    const Json& edits = member(all, "edits", source);
    if (!edits.is_array() || edits.size() > kMaxEdits)
        fail(source, fmt::format(".edits is not a list of at most {} edits", kMaxEdits));
    return all;
}

}  // namespace

std::string EditSession::saved() const {
    Json edits = Json::array();
    for (const Made& made : made_) {
        Json nodes = Json::array();
        for (const Named& node : made.named) nodes.push_back(make_json(node));
        edits.push_back({{"command", made.command}, {"nodes", std::move(nodes)}});
    }
    const Json all{{"format", "coppice-edits"},
                   {"version", kVersion},
                   {"base", make_json(frame_.base)},
                   {"size", frame_.size},
                   {"edits", std::move(edits)}};
    return all.dump(1) + "\n";
}

/// Checks a saved command against the table.
SceneCall EditSession::bind_edit(const std::string& command, const std::string& where, const Context& ctx) {
    return scene_internal::placed(where, [&] {
        const auto lines = scene_lines(command, "command");
        if (lines.size() != 1)
            throw InvalidInput(fmt::format("there are {} commands instead of one", lines.size()));
        SceneCall call = bind(scene_words(lines[0].text), ctx);
        if (!call.command().edit) throw InvalidInput(fmt::format("{} is not an edit", call.command().name));
        return call;
    });
}

/// Returns the node of this tree that corresponds to a node of a saved edit. Throws InvalidInput if there is
/// no such node.
StableId EditSession::find_again(const Named& node, const std::vector<std::size_t>& made_as) const {
    const std::uint32_t id = node.anchor.id.index();
    if (node.maker > 0) {
        const std::size_t made = node.maker <= made_as.size() ? made_as[node.maker - 1] : 0;
        if (made == 0 || node.added >= made_[made - 1].change.added.size()) {
            throw InvalidInput(
                fmt::format("node {} was made by edit {}, which has not made it this time", id, node.maker));
        }
        const StableId again = made_[made - 1].change.added[node.added];
        check_node(tree_, again);
        return again;
    }
    const Binding found = bind_anchor(tree_, frame_, node.anchor);
    if (!found.node) {
        throw InvalidInput(fmt::format("node {} is not found: {}; the nearest is node {}, {:.3g} m away", id,
                                       found.reason, found.nearest.index(), found.distance));
    }
    return found.node;
}

/// Executes an edit with the ids of this tree in place of the saved ones.
void EditSession::make_again(SceneCall call, const std::vector<Named>& named,
                             const std::vector<std::size_t>& made_as) {
    for (const Argument& a : call.command().arguments) {
        if (a.type != ArgumentType::selection) continue;
        std::vector<ArgumentValue> values;
        for (const ArgumentValue& v : call.values(a.name)) {
            Selection selection = parse_selection(v.text);
            for_each_id(selection, [&](StableId& n) {
                const auto saved =
                    std::ranges::find_if(named, [&](const Named& node) { return node.anchor.id == n; });
                if (saved == named.end())
                    throw InvalidInput(fmt::format("the position of node {} is missing", n.index()));
                n = find_again(*saved, made_as);
            });
            values.push_back({to_text(selection), {}});
        }
        call.set(a, std::move(values));
    }
    edit(call);
}

EditSession::Replayed EditSession::replay(std::string_view json, const std::string& source,
                                          const Context& ctx) {
    const Json all = parsed(json, source);
    const Json& edits = all.at("edits");
    std::vector<std::pair<std::string, std::vector<Named>>> saved;
    for (std::size_t i = 0; i < edits.size(); ++i) {
        const std::string where = fmt::format("{}: edits[{}]", source, i);
        const Json& command = member(edits[i], "command", where);
        if (!command.is_string()) fail(where, ".command is not a text");
        saved.emplace_back(command.get<std::string>(), all_named(edits[i], where));
        bind_edit(saved.back().first, where, ctx);
    }
    Replayed out{.edits = saved.size(), .made = 0, .unbound = {}};
    std::vector<std::size_t> made_as;  // number of the corresponding edit in this session, from 1; 0: skipped
    for (std::size_t i = 0; i < saved.size(); ++i) {
        ctx.throw_if_cancelled();
        const std::size_t before = made_.size();
        try {
            make_again(bind_edit(saved[i].first, source, ctx), saved[i].second, made_as);
            ++out.made;
        } catch (const InvalidInput& error) {
            out.unbound.push_back({i, saved[i].first, error.what()});
        }
        made_as.push_back(made_.size() > before ? made_.size() : 0);
    }
    follow(ctx);
    return out;
}

}  // namespace coppice
