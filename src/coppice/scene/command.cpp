#include "coppice/scene/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "coppice/base/id.h"
#include "coppice/base/quote.h"
#include "coppice/options/renamed.h"
#include "coppice/options/spelling.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/scene/properties_internal.h"
#include "coppice/scene/script/script.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

constexpr double kMebibyte = 1 << 20;
constexpr std::uint64_t kLargestProperties = 1 << 20;  // [bytes]

std::vector<SceneCommand> whole_table() {
    std::vector<SceneCommand> table;
    for (const auto make :
         {primitive_commands, solid_commands, curve_commands, point_commands, material_commands,
          tree_commands, compose_commands, edit_commands, session_commands}) {
        std::ranges::move(make(), std::back_inserter(table));
    }
    return table;
}

const SceneCommand* command_called(std::string_view name) {
    for (const SceneCommand& c : scene_commands()) {
        if (c.name == name || std::ranges::find(c.aliases, name) != c.aliases.end()) return &c;
    }
    return nullptr;
}

std::vector<std::string> command_names() {
    std::vector<std::string> names;
    for (const SceneCommand& c : scene_commands()) {
        names.push_back(c.name);
        names.insert(names.end(), c.aliases.begin(), c.aliases.end());
    }
    for (const SceneStatement& s : scene_statements()) names.emplace_back(s.name);
    return names;
}

std::vector<std::string> names_of_kind(const SceneState& state, ObjectKind kind) {
    std::vector<std::string> names;
    for (const auto& [key, object] : state.objects) {
        if (key.first == kind) names.push_back(key.second);
    }
    return names;
}

/// Returns the kinds of objects that have this name.
std::vector<ObjectKind> find_kinds(const SceneState& state, const std::string& name) {
    std::vector<ObjectKind> kinds;
    for (int k = 0; k < static_cast<int>(EnumNames<ObjectKind>::names.size()); ++k) {
        if (state.objects.contains({static_cast<ObjectKind>(k), name}))
            kinds.push_back(static_cast<ObjectKind>(k));
    }
    return kinds;
}

void check_exists(const SceneState& state, ObjectKind kind, const std::string& name) {
    if (state.objects.contains({kind, name})) return;
    const auto others = find_kinds(state, name);
    const std::string wanted(name_of(kind));
    if (others.empty()) {
        throw InvalidInput(fmt::format("there is no {} {}{}", wanted, quote(name),
                                       did_you_mean(name, names_of_kind(state, kind))));
    }
    std::string hint;
    if (kind == ObjectKind::solid && others.back() == ObjectKind::mesh)
        hint = fmt::format("; create one from it with: solid {}", shortened(name));
    if (kind == ObjectKind::mesh && others.front() == ObjectKind::solid)
        hint = fmt::format("; create one from it with: polygonize {}", shortened(name));
    throw InvalidInput(fmt::format("{} is {}, not {}{}", quote(name), with_article(others.front()),
                                   with_article(kind), hint));
}

/// Returns the last line of the example, without its preparation.
std::string own_line(const SceneCommand& command) {
    const std::size_t end = command.example.rfind('\n');
    return end == std::string::npos ? command.example : command.example.substr(end + 1);
}

std::string option_word(const SceneWord& word) {
    return word.key.empty() ? word.text : word.key + "=" + word.text;
}

/// Assigns the words of a line to the arguments of its command.
class Binder {
  public:
    Binder(const SceneCommand& command, const SceneState& state, SceneCall& call)
        : command_(command), state_(state), call_(call) {}

    void bind(std::span<const SceneWord> words) {
        for (const SceneWord& word : words) {
            if (word.key.empty()) {
                positional_.push_back(word.text);
            } else {
                bind_value(option_called(word.key), word.text);
            }
        }
        bind_positionals();
        read_properties();
        fill_defaults();
        for (const auto& [argument, values] : typed_) call_.set(*argument, values);
    }

  private:
    const Argument& option_called(const std::string& name) const {
        const auto found = std::ranges::find(command_.arguments, name, &Argument::name);
        if (found != command_.arguments.end()) return *found;
        const auto renamed = std::ranges::find(command_.arguments, present_name(name), &Argument::name);
        if (renamed != command_.arguments.end()) return *renamed;
        std::vector<std::string> known;
        for (const Argument& a : command_.arguments) known.push_back(a.name);
        throw InvalidInput(
            fmt::format("{} has no option {}{}", command_.name, quote(name), did_you_mean(name, known)));
    }

    void bind_value(const Argument& a, const std::string& text) {
        auto& values = typed_[&a];
        if (!values.empty() && !a.repeats) throw InvalidInput(fmt::format("{} is given twice", a.name));
        values.push_back(parsed(a, text));
    }

    ArgumentValue parsed(const Argument& a, const std::string& text) const {
        ArgumentValue value = parse_argument(a, text);
        if (a.type == ArgumentType::object && !a.any_kind && !is_one_of(a.also, value.text))
            check_exists(state_, a.kind, value.text);
        if (a.type == ArgumentType::object && a.any_kind && find_kinds(state_, value.text).empty()) {
            std::vector<std::string> known;
            for (const auto& [key, object] : state_.objects) known.push_back(key.second);
            throw InvalidInput(
                fmt::format("there is no object {}{}", quote(value.text), did_you_mean(value.text, known)));
        }
        if (a.type == ArgumentType::section) check_exists(state_, ObjectKind::profile, value.text);
        return value;
    }

    /// Returns whether an object of one of the kinds has this name.
    bool is_one_of(const std::vector<ObjectKind>& kinds, const std::string& name) const {
        return std::ranges::any_of(kinds, [&](ObjectKind k) { return state_.objects.contains({k, name}); });
    }

    void bind_positionals() {
        std::vector<const Argument*> order;
        for (const Argument& a : command_.arguments) {
            if (a.positional && !typed_.contains(&a)) order.push_back(&a);
        }
        std::size_t at = 0;
        for (std::size_t i = 0; i < order.size(); ++i) {
            const std::size_t left = positional_.size() - at, after = order.size() - i - 1;
            if (left == 0) break;
            if (order[i]->repeats) {
                const std::size_t own_count = left > after ? left - after : 0;
                take(*order[i], at, own_count);
                at += own_count;
            } else if (order[i]->type == ArgumentType::tuple) {
                at += take_tuple(*order[i], at);
            } else {
                take(*order[i], at++, 1);
            }
        }
        if (at < positional_.size()) {
            throw InvalidInput(fmt::format("{} does not accept {}", command_.name, quote(positional_[at])));
        }
    }

    void take(const Argument& a, std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) typed_[&a].push_back(parsed(a, positional_[i]));
    }

    /// A point may be one word, or one word per number.
    std::size_t take_tuple(const Argument& a, std::size_t first) {
        std::string joined;
        std::size_t count = 0, numbers = 0;
        const std::size_t most = *std::ranges::max_element(a.sizes);
        while (first + count < positional_.size() && numbers < most) {
            const auto more = parse_numbers(positional_[first + count]);
            if (more.empty()) break;
            joined += (count > 0 ? "," : "") + positional_[first + count];
            numbers += more.size();
            ++count;
        }
        if (count == 0) joined = positional_[first];
        typed_[&a].push_back(parsed(a, joined));
        return std::max<std::size_t>(1, count);
    }

    /// Adds the options of a file that are not given in the command. The file itself is not recorded, so that
    /// a recipe does not depend on it.
    void read_properties() {
        const auto given = std::ranges::find_if(
            typed_, [](const auto& t) { return t.first->type == ArgumentType::properties; });
        if (given == typed_.end()) return;
        const Argument& file = *given->first;
        call_.set(file, given->second);
        const std::filesystem::path path = call_.input(file.name);
        call_.unset(file);
        typed_.erase(given);
        std::set<const Argument*> own;
        for (const Property& p : parse_properties(read_file(path, kLargestProperties), path.string())) {
            try {
                const Argument& a = option_called(p.name);
                if (a.type == ArgumentType::properties || a.required)
                    throw InvalidInput(
                        fmt::format("{} is not allowed in a file of options; add it to the command", p.name));
                if (typed_.contains(&a) && !own.contains(&a)) continue;
                bind_value(a, p.value);
                own.insert(&a);
            } catch (const InvalidInput& e) {
                throw InvalidInput(fmt::format("{}:{}: {}", path.string(), p.line, e.what()));
            }
        }
    }

    bool is_given(const std::string& name) const {
        return std::ranges::any_of(typed_, [&](const auto& given) { return given.first->name == name; });
    }

    void fill_defaults() {
        for (const Argument& a : command_.arguments) {
            if (typed_.contains(&a)) continue;
            if (a.required) {
                throw InvalidInput(fmt::format("{} needs {}: {}, as in: {}", command_.name, a.name,
                                               takes_text(a), own_line(command_)));
            }
            if (a.initial.empty() || is_given(a.unless)) continue;
            std::string text = a.initial;
            if (text.starts_with('@')) {
                const auto other = std::ranges::find(command_.arguments, text.substr(1), &Argument::name);
                text = typed_.at(&*other).front().text;
            } else if (a.name == "seed") {
                text = std::to_string(state_.seed);
            }
            typed_[&a].push_back(parsed(a, text));
        }
    }

    const SceneCommand& command_;
    const SceneState& state_;
    SceneCall& call_;
    std::vector<std::string> positional_;
    std::map<const Argument*, std::vector<ArgumentValue>> typed_;
};

}  // namespace

SceneCall::SceneCall(const SceneCommand& command, const SceneState& state, const SceneSettings& settings,
                     const Context& ctx)
    : command_(command), state_(state), settings_(settings), ctx_(ctx) {}

void SceneCall::set(const Argument& argument, std::vector<ArgumentValue> values) {
    values_[argument.name] = std::move(values);
}

std::string SceneCall::typed() const {
    std::string line = command_.name;
    for (const Argument& a : command_.arguments) {
        for (ArgumentValue value : values(a.name)) {
            // A recipe may be in another folder than the scene.
            if (a.type == ArgumentType::input_file && !settings_.sandbox)
                value.text = std::filesystem::absolute(input(a.name)).lexically_normal().string();
            line += a.positional ? " " : " " + a.name + "=";
            line += coppice::typed(a, value);
        }
    }
    return line;
}

std::span<const ArgumentValue> SceneCall::values(std::string_view name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) return {};
    return found->second;
}

const std::string& SceneCall::text(std::string_view name) const {
    static const std::string kNoText;
    const auto all = values(name);
    return all.empty() ? kNoText : all.front().text;
}

double SceneCall::number(std::string_view name) const {
    const auto argument = std::ranges::find(command_.arguments, name, &Argument::name);
    COPPICE_ASSERT(argument != command_.arguments.end() && has(name));
    return in_library_unit(*argument, values(name).front().numbers.at(0));
}

std::vector<Vec3> SceneCall::points(std::string_view name) const {
    std::vector<Vec3> out;
    for (const ArgumentValue& value : values(name)) {
        const auto& n = value.numbers;
        out.push_back(Vec3(Vec3d(n.at(0), n.at(1), n.at(2))));
    }
    return out;
}

Vec3 SceneCall::point(std::string_view name) const { return points(name).at(0); }

ObjectPtr SceneCall::any(const std::string& name, const std::string& kind) const {
    auto kinds = find_kinds(state_, name);
    if (!kind.empty()) std::erase_if(kinds, [&](ObjectKind k) { return name_of(k) != kind; });
    if (kinds.empty()) throw InvalidInput(fmt::format("there is no {} {}", kind, quote(name)));
    if (kinds.size() > 1) {
        std::vector<std::string_view> names;
        for (const ObjectKind k : kinds) names.push_back(name_of(k));
        throw InvalidInput(fmt::format("{} is the name of several objects; add kind= and one of {}",
                                       quote(name), fmt::join(names, ", ")));
    }
    return state_.objects.at({kinds.front(), name});
}

SolidField SceneCall::field(const std::string& name, Vec3d origin) const {
    constexpr double kBytesOfPart = 300;
    reserve(kBytesOfPart * solid(name).part_count());
    return SolidField(relative_to(solid(name), origin));
}

double SceneCall::memory_left() const {
    return std::max(0.0, settings_.max_memory * kMebibyte - static_cast<double>(state_.bytes));
}

void SceneCall::reserve(double bytes) const {
    const double held = static_cast<double>(state_.bytes), limit = settings_.max_memory * kMebibyte;
    if (held + bytes <= limit) return;
    throw InvalidInput(
        fmt::format("this may take {:.1f} MiB in addition to the {:.1f} in use, and {} are allowed; request "
                    "less, delete objects, or raise max_memory",
                    bytes / kMebibyte, held / kMebibyte, settings_.max_memory));
}

std::filesystem::path SceneCall::input(std::string_view name) const {
    std::filesystem::path path = text(name);
    if (!settings_.files)
        throw IoError(fmt::format("'{}' is not read: files are not allowed here", path.string()));
    if (settings_.sandbox) return settings_.sandbox->to_read(text(name));
    if (path.is_absolute() || settings_.folder.empty()) return path;
    const std::filesystem::path in_folder = settings_.folder / path;
    std::error_code error;
    const bool is_only_here =
        !std::filesystem::exists(in_folder, error) && std::filesystem::exists(path, error);
    return is_only_here ? path : in_folder;
}

std::filesystem::path SceneCall::output(std::string_view name) const {
    std::filesystem::path path = text(name);
    if (!settings_.files)
        throw IoError(fmt::format("'{}' is not written: files are not allowed here", path.string()));
    if (settings_.sandbox) return settings_.sandbox->to_write(text(name));
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::error_code error;
    if (settings_.outputs && !std::filesystem::is_directory(folder, error)) {
        throw IoError(
            fmt::format("cannot write '{}': the folder '{}' does not exist", path.string(), folder.string()));
    }
    return path;
}

void SceneCall::read_members(std::span<const OptionField> members, const std::string& path) const {
    visit_members(members, path, [&](const std::string& at, const OptionField& member) {
        if (const Argument* a = by_field(at); a != nullptr && has(a->name)) read(*a, member.ref);
    });
}

void SceneCall::read(const Argument& a, const OptionRef& member) const {
    if (auto* const* flag_value = std::get_if<bool*>(&member)) {
        **flag_value = flag(a.name);
    } else if (auto* const* words = std::get_if<std::vector<std::string>*>(&member)) {
        for (const ArgumentValue& v : values(a.name)) (*words)->push_back(v.text);
    } else if (auto* const* point = std::get_if<std::optional<Vec3d>*>(&member)) {
        const std::vector<double>& n = values(a.name).front().numbers;
        **point = Vec3d(n.at(0), n.at(1), n.at(2));
    } else if (const auto* choice = std::get_if<ChoiceRef>(&member)) {
        const auto found = std::ranges::find(choice->names, text(a.name));
        choice->set(static_cast<std::size_t>(found - choice->names.begin()));
    } else if (auto* const* whole = std::get_if<int*>(&member)) {
        **whole = static_cast<int>(number(a.name));
    } else {
        *std::get<float*>(member) = static_cast<float>(number(a.name));
    }
}

const Argument* SceneCall::by_field(const std::string& field) const {
    const auto found = std::ranges::find(command_.arguments, field, &Argument::field);
    return found == command_.arguments.end() ? nullptr : &*found;
}

std::span<const SceneCommand> scene_commands() {
    static const std::vector<SceneCommand> kTable = whole_table();
    return kTable;
}

const SceneCommand& find_command(std::span<const SceneWord> words, std::size_t& used) {
    COPPICE_ASSERT(!words.empty());
    const std::string first = option_word(words[0]);
    const std::string both = words.size() > 1 ? first + " " + option_word(words[1]) : first;
    used = 2;
    if (const SceneCommand* command = command_called(both); command && words.size() > 1) return *command;
    used = 1;
    if (const SceneCommand* command = command_called(first)) return *command;
    const auto names = command_names();
    const std::string start = first + " ";
    const bool family =
        std::ranges::any_of(names, [&](const std::string& n) { return n.starts_with(start); });
    const std::string word = family ? both : first;
    std::string hint = did_you_mean(word, names);
    if (hint.empty()) hint = "; help lists them";
    throw InvalidInput(fmt::format("there is no command {}{}", quote(word), hint));
}

std::optional<std::vector<const SceneCommand*>> find_commands(std::span<const SceneLine> lines) {
    std::vector<const SceneCommand*> commands;
    try {
        for (const SceneLine& line : lines) {
            if (find_statement(line.text) != nullptr) continue;
            std::size_t used = 0;
            const auto words = scene_words(line.text);
            if (!words.empty()) commands.push_back(&find_command(words, used));
        }
    } catch (const InvalidInput&) {
        return std::nullopt;
    }
    return commands;
}

SceneCall bind_command(std::span<const SceneWord> words, const SceneState& state,
                       const SceneSettings& settings, const Context& ctx) {
    std::size_t used = 0;
    const SceneCommand& command = find_command(words, used);
    return bind_command(command, words.subspan(used), state, settings, ctx);
}

SceneCall bind_command(const SceneCommand& command, std::span<const SceneWord> words, const SceneState& state,
                       const SceneSettings& settings, const Context& ctx) {
    SceneCall call(command, state, settings, ctx);
    Binder(command, state, call).bind(words);
    return call;
}

}  // namespace coppice
