#include "coppice/scene/keyframes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "coppice/base/quote.h"
#include "coppice/edit/animate/easing.h"
#include "coppice/edit/selection.h"
#include "coppice/options/spelling.h"
#include "coppice/scene/edit_lines_internal.h"
#include "coppice/scene/place_internal.h"
#include "coppice/scene/scene.h"

namespace coppice {

using scene_internal::placed;

namespace {

const std::string kTree = "tree";
constexpr double kLongest = 3600;  // [s]

/// An argument of an edit that scales with the completed fraction of the edit.
struct Graded {
    std::string_view edit, argument;
    bool is_factor = false;  ///< whether the neutral value is 1 instead of 0
};
constexpr std::array<Graded, 7> kGraded{{{"edit rotate", "angle"},
                                         {"edit bend", "angle"},
                                         {"edit twist", "angle"},
                                         {"edit translate", "by"},
                                         {"edit move", "by"},
                                         {"edit straighten", "amount"},
                                         {"edit scale", "factor", true}}};

const Graded* grading(const SceneCommand& command) {
    const auto found = std::ranges::find(kGraded, command.name, &Graded::edit);
    return found == kGraded.end() ? nullptr : &*found;
}

const Argument& argument_called(const SceneCommand& command, std::string_view name) {
    return *std::ranges::find(command.arguments, name, &Argument::name);
}

/// Returns the edit with a fraction of its angle, displacement or factor.
SceneCall graded(const SceneCall& call, const Graded& by, double part) {
    SceneCall out = call;
    const Argument& argument = argument_called(call.command(), by.argument);
    std::vector<ArgumentValue> values(call.values(by.argument).begin(), call.values(by.argument).end());
    for (ArgumentValue& value : values) {
        for (double& x : value.numbers) x = by.is_factor ? std::pow(x, part) : x * part;
    }
    out.set(argument, std::move(values));
    return out;
}

/// Interpolates two poses by the positions of the nodes.
Pose blend(const Pose& from, const Pose& to, double part) {
    Pose out = from;
    for (std::size_t i = 0; i < out.positions.size(); ++i) {
        out.positions[i] = Vec3(lerp(Vec3d(from.positions[i]), Vec3d(to.positions[i]), part));
        out.radii[i] = static_cast<float>(double{from.radii[i]} *
                                          std::pow(double{to.radii[i]} / double{from.radii[i]}, part));
    }
    return out;
}

/// The beginning of a line: time and easing.
struct Moment {
    double time = 0;
    Easing easing = Easing::smooth;
    std::string_view edits;
};

Easing easing_called(const std::string& name) {
    constexpr auto& names = EnumNames<Easing>::names;
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
        throw InvalidInput(
            fmt::format("there is no easing {}; use one of {}", quote(name), fmt::join(names, ", ")));
    }
    return static_cast<Easing>(found - names.begin());
}

double seconds_from(std::string text) {
    if (text.size() > 1 && text.back() == 's') text.pop_back();
    double time = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
    if (error != std::errc{} || end != text.data() + text.size() || !(time >= 0 && time <= kLongest))
        throw InvalidInput(
            fmt::format("{} is not a number of seconds from 0 to {:g}", quote(text), kLongest));
    return time;
}

Moment compute_moment(std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon == line.npos)
        throw InvalidInput("a key is seconds, a colon and edits, as in 2: rotate near(0,0,3) 30");
    std::vector<SceneWord> words = scene_words(line.substr(0, colon));
    if (words.size() > 1 && words[1].text == "s") words.erase(words.begin() + 1);
    if (words.empty() || words.size() > 2)
        throw InvalidInput(
            "before the colon of a key there must be seconds and optionally an easing, as in 2 out:");
    Moment out{.time = seconds_from(words[0].text), .easing = {}, .edits = line.substr(colon + 1)};
    if (words.size() > 1) out.easing = easing_called(words[1].text);
    return out;
}

}  // namespace

class Keyframes::Body {
  public:
    Body(const Skeleton& tree, std::string_view text, const std::string& source,
         const SceneSettings& settings, const Context& ctx)
        : tree_(tree), ctx_{.threads = ctx.threads, .stop = ctx.stop, .progress = {}}, scene_(settings) {
        scene_.hold_tree(kTree, tree);
        const EditableTree at_rest(tree);
        for (const SceneLine& line : scene_lines(text, source)) {
            const std::string place = fmt::format("{}:{}", source, line.number);
            placed(place, [&] { return add(line.text, place, at_rest); });
        }
        if (keys_.empty()) throw InvalidInput(fmt::format("{}: there is no key", source));
        if (keys_.front().time > 0) keys_.insert(keys_.begin(), Key{.time = 0, .easing = {}, .edits = {}});
    }

    double end() const { return keys_.back().time; }
    std::size_t size() const { return keys_.size(); }

    Pose at(double time) const {
        std::size_t next = 0;
        while (next < keys_.size() && keys_[next].time <= time) ++next;
        Pose pose = rest_pose(tree_);
        if (next == keys_.size()) return edited(std::move(pose), keys_.back(), 1);
        if (next == 0) return edited(std::move(pose), keys_.front(), 1);
        const Key &before = keys_[next - 1], &after = keys_[next];
        const double part = eased(after.easing, (time - before.time) / (after.time - before.time));
        return edited(edited(std::move(pose), before, 1 - part), after, part);
    }

  private:
    struct Edit {
        SceneCall call;
        std::string place;
    };
    struct Key {
        double time = 0;
        Easing easing = Easing::smooth;
        std::vector<Edit> edits;
    };

    bool add(std::string_view line, const std::string& place, const EditableTree& at_rest) {
        const Moment moment = compute_moment(line);
        if (!keys_.empty() && !(moment.time > keys_.back().time)) {
            throw InvalidInput(fmt::format("the key at {:g} s does not come after the one at {:g} s",
                                           moment.time, keys_.back().time));
        }
        Key key{.time = moment.time, .easing = moment.easing, .edits = {}};
        for (const std::string& command : scene_internal::parted(moment.edits)) {
            const std::vector<SceneWord> words = scene_words(command);
            if (words.empty() || (words.size() == 1 && words[0].text == "rest")) continue;
            key.edits.push_back({bind(words, at_rest), place});
        }
        keys_.push_back(std::move(key));
        edited(rest_pose(tree_), keys_.back(), 1);  // reports errors of the edits early
        return true;
    }

    SceneCall bind(std::vector<SceneWord> words, const EditableTree& at_rest) {
        if (words[0].text == "edit" && words.size() > 1) words.erase(words.begin());
        const SceneCommand* command = scene_internal::edit_called(words[0].text);
        if (command == nullptr || !command->edit) {
            throw InvalidInput(
                fmt::format("{} is not an edit; coppice edit --reference lists them", quote(words[0].text)));
        }
        words.insert(words.begin(), SceneWord{{}, "edit"});
        words.insert(words.begin() + 2, SceneWord{{}, kTree});
        SceneCall call = bind_command(words, scene_.state(), scene_.settings(), ctx_);
        for (const Argument& a : command->arguments) {
            if (a.type == ArgumentType::selection) fix_selection(call, a, at_rest);
        }
        if (command->name == "edit move" && call.has("to") && !call.has("by")) move_by(call, at_rest);
        return call;
    }

    /// Replaces a selection by the ids of its nodes at rest.
    void fix_selection(SceneCall& call, const Argument& argument, const EditableTree& at_rest) const {
        std::vector<ArgumentValue> values;
        for (const ArgumentValue& v : call.values(argument.name)) {
            const SolidLookup no_solids;
            Selection ids;
            ids.kind = SelectionKind::id;
            ids.ids = selected(at_rest, parse_selection(v.text), no_solids);
            if (ids.ids.empty())
                throw InvalidInput(fmt::format("{}: {} contains no node of the tree",
                                               call.command().name.substr(5), quote(v.text)));
            values.push_back({to_text(ids), {}});
        }
        call.set(argument, std::move(values));
    }

    /// Converts `move N to=...` to a displacement, which can be scaled.
    static void move_by(SceneCall& call, const EditableTree& at_rest) {
        const StableId n = selected_node(at_rest, parse_selection(call.text("node")));
        const Vec3d here = at_rest.origin() + Vec3d(at_rest.position(n));
        std::vector<ArgumentValue> values(call.values("to").begin(), call.values("to").end());
        for (ArgumentValue& v : values) {
            for (std::size_t k = 0; k < v.numbers.size(); ++k) v.numbers[k] -= here[static_cast<int>(k)];
        }
        call.set(argument_called(call.command(), "by"), std::move(values));
        call.set(argument_called(call.command(), "to"), {});
    }

    Pose edited(Pose pose, const Key& key, double part) const {
        if (!(part > 0)) return pose;
        for (const Edit& edit : key.edits)
            pose = placed(edit.place, [&] { return edited(pose, edit.call, part); });
        return pose;
    }

    Pose edited(const Pose& pose, const SceneCall& call, double part) const {
        EditableTree tree(posed(tree_, pose));
        tree.note_turns();
        const Graded* by = grading(call.command());
        const EditChange change = call.command().edit(by != nullptr ? graded(call, *by, part) : call, tree);
        if (!change.added.empty() || !change.removed.empty() || !change.reparented.empty()) {
            throw InvalidInput(
                fmt::format("{} adds or removes nodes or changes their parents, which an animation must "
                            "keep; use rotate, bend, twist, translate, move, scale, straighten or smooth",
                            call.command().name.substr(5)));
        }
        Pose out = pose;
        for (const NodeId n : nodes(tree_)) {
            const StableId id = tree_.stable_id(n);
            out.positions[n.index()] = tree.position(id);
            out.radii[n.index()] = tree.radius(id);
            out.turns[n.index()] = unit(tree.turn(id) * pose.turns[n.index()]);
        }
        return by != nullptr || part >= 1 ? out : blend(pose, out, part);
    }

    Skeleton tree_;
    Context ctx_;
    Scene scene_;
    std::vector<Key> keys_;
};

Keyframes::Keyframes(const Skeleton& tree, std::string_view text, const std::string& source,
                     const SceneSettings& settings, const Context& ctx)
    : body_(std::make_unique<Body>(tree, text, source, settings, ctx)) {}
Keyframes::~Keyframes() = default;
Keyframes::Keyframes(Keyframes&&) noexcept = default;
Keyframes& Keyframes::operator=(Keyframes&&) noexcept = default;

double Keyframes::end() const { return body_->end(); }
std::size_t Keyframes::size() const { return body_->size(); }
Pose Keyframes::at(double time) const { return body_->at(time); }

}  // namespace coppice
