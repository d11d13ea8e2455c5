#include "coppice/scene/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "coppice/scene/script/script.h"

namespace coppice {
namespace {

constexpr std::string_view kLanguage = "Variables and loops";

/// Returns the default, rounded if it is an angle in degrees with rounding errors.
std::string default_text(const Argument& a) {
    if (a.initial.starts_with('@')) return fmt::format("value of {}", a.initial.substr(1));
    if (!a.unless.empty()) return fmt::format("{}; with {}= no default", a.initial, a.unless);
    if (a.name == "seed") return fmt::format("{}, or the value of set seed", a.initial);
    if (a.unit != Unit::radian || a.initial.empty()) return a.initial;
    return fmt::format("{:.4g}", parse_numbers(a.initial).at(0));
}

std::string argument_line(const Argument& a) {
    std::string text = fmt::format("{} [{}", a.help, takes_text(a));
    if (const std::string initial = default_text(a); !initial.empty()) text += "; default " + initial;
    if (a.repeats && !a.positional) text += "; may be repeated";
    return text + "]";
}

std::string upper(std::string_view name) {
    std::string out(name);
    std::ranges::transform(out, out.begin(),
                           [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return out;
}

/// Indents lines by two blanks.
std::string indented(std::string_view lines) {
    std::string text;
    while (!lines.empty()) {
        const std::size_t end = std::min(lines.find('\n'), lines.size());
        text += fmt::format("  {}\n", lines.substr(0, end));
        lines.remove_prefix(std::min(end + 1, lines.size()));
    }
    return text;
}

std::string help_of_statement(const SceneStatement& s) {
    return fmt::format("{}\n    {}\nexample:\n{}", s.usage, s.help, indented(s.example));
}

std::string help_of_command(const SceneCommand& c) {
    std::string text = fmt::format("{}\n    {}\n", format_usage(c), c.help);
    if (!c.aliases.empty()) text += fmt::format("    also: {}\n", fmt::join(c.aliases, ", "));
    for (const Argument& a : c.arguments)
        text += fmt::format("  {:<18} {}\n", a.positional ? upper(a.name) : a.name + "=", argument_line(a));
    return text + "example:\n" + indented(c.example);
}

std::string table_cell(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '|') out += '\\';
        out += c;
    }
    return out;
}

std::string to_markdown(const SceneCommand& c) {
    std::string text = fmt::format("### {}\n`{}`: {}\n", c.name, format_usage(c), c.help);
    if (!c.aliases.empty()) text += fmt::format("Also called `{}`.\n", fmt::join(c.aliases, "`, `"));
    text += fmt::format("```\n{}\n```\n", c.example);
    if (c.arguments.empty()) return text + "\n";
    text += "| argument | description | value | default |\n| --- | --- | --- | --- |\n";
    for (const Argument& a : c.arguments) {
        text += fmt::format("| `{}` | {} | {}{} | {} |\n", a.positional ? upper(a.name) : a.name + "=",
                            table_cell(a.help), table_cell(takes_text(a)), a.repeats ? ", repeated" : "",
                            a.required ? "required" : default_text(a));
    }
    return text + "\n";
}

std::string to_markdown(const SceneStatement& s) {
    return fmt::format("### {}\n`{}`: {}\n```\n{}\n```\n\n", s.name, s.usage, s.help, s.example);
}

std::vector<std::string> groups() {
    std::vector<std::string> names;
    for (const SceneCommand& c : scene_commands()) {
        if (std::ranges::find(names, c.group) == names.end()) names.push_back(c.group);
    }
    return names;
}

/// Returns the possible values of an argument, if they can be listed.
std::vector<std::string> list_values(const Argument& a, const SceneState& state) {
    if (a.type == ArgumentType::choice) return a.choices;
    if (a.type == ArgumentType::flag) return {"false", "true"};
    std::vector<std::string> names;
    for (const auto& [key, object] : state.objects) {
        const bool fits =
            a.any_kind || key.first == a.kind || std::ranges::find(a.also, key.first) != a.also.end();
        if (a.type == ArgumentType::object && fits) names.push_back(key.second);
        if (a.type == ArgumentType::section && key.first == ObjectKind::profile)
            names.push_back(key.second + "@");
    }
    return names;
}

/// Returns whether the text is a positional word rather than key=value.
bool is_plain(const SceneWord& word) { return word.key.empty(); }

void add_matches(std::set<std::string>& out, const std::vector<std::string>& words, std::string_view begin,
                 const std::string& before = {}) {
    for (const std::string& word : words) {
        if (word.starts_with(begin)) out.insert(before + word);
    }
}

/// Adds the words after `done` that begin with `begin`, of commands with one or two words.
void add_commands(std::set<std::string>& out, const std::string& done, std::string_view begin) {
    for (const SceneCommand& c : scene_commands()) {
        if (!c.name.starts_with(done)) continue;
        const std::string rest = c.name.substr(done.size());
        const std::string word = rest.substr(0, rest.find(' '));
        if (word.starts_with(begin)) out.insert(word);
    }
    if (!done.empty()) return;
    for (const SceneStatement& s : scene_statements()) {
        if (s.name.starts_with(begin)) out.insert(std::string(s.name));
    }
}

Json make_json(const Argument& a) {
    static constexpr std::array<std::string_view, 13> kTypes{
        "new_name", "object", "number",     "whole",     "flag",        "choice",    "tuple",
        "section",  "word",   "input_file", "selection", "output_file", "properties"};
    Json out{{"name", a.name},
             {"help", a.help},
             {"type", kTypes[static_cast<std::size_t>(a.type)]},
             {"positional", a.positional},
             {"required", a.required},
             {"repeats", a.repeats}};
    if (!a.initial.empty()) out["default"] = a.initial;
    if (a.unit != Unit::none) out["unit"] = a.unit == Unit::radian ? "degree" : name_of_unit(a.unit);
    if (a.low < a.high) {
        out["low"] = in_typed_unit(a.unit, a.low);
        out["high"] = in_typed_unit(a.unit, a.high);
    }
    if (!a.choices.empty()) out["choices"] = a.choices;
    if (!a.sizes.empty()) out["sizes"] = a.sizes;
    if (a.type == ArgumentType::object) out["kind"] = a.any_kind ? "any" : name_of(a.kind);
    for (const ObjectKind kind : a.also) out["also"].push_back(name_of(kind));
    return out;
}

}  // namespace

std::string format_usage(const SceneCommand& command) {
    std::string text = command.name;
    bool options = false;
    for (const Argument& a : command.arguments) {
        options = options || !a.positional;
        if (!a.positional) continue;
        const std::string name = upper(a.name) + (a.repeats ? "..." : "");
        text += a.required ? fmt::format(" {}", name) : fmt::format(" [{}]", name);
    }
    return options ? text + " [OPTION=VALUE...]" : text;
}

std::string help_overview() {
    std::string text;
    for (const std::string& group : groups()) {
        text += group + "\n";
        for (const SceneCommand& c : scene_commands()) {
            if (c.group == group) text += fmt::format("  {:<18} {}\n", c.name, c.help);
        }
    }
    text += fmt::format("{}\n", kLanguage);
    for (const SceneStatement& s : scene_statements()) text += fmt::format("  {:<18} {}\n", s.name, s.help);
    return text + "help COMMAND explains a command; lines that begin with # are comments.\n";
}

std::string format_help(std::span<const SceneWord> words) {
    if (words.size() == 1) {
        if (const SceneStatement* statement = find_statement(words[0].text))
            return help_of_statement(*statement);
        std::string family;
        for (const SceneCommand& c : scene_commands()) {
            if (c.name.starts_with(words[0].text + " "))
                family += fmt::format("  {:<18} {}\n", c.name, c.help);
        }
        if (!family.empty() && words[0].text != "save") return family;
    }
    std::size_t used = 0;
    return help_of_command(find_command(words, used));
}

std::string scene_reference(std::string_view only) {
    std::string text =
        "# Commands of scenes\n\nGenerated by `coppice run --reference`; [scenes.md](scenes.md) explains the "
        "language. Angles are in degrees.\nWords in capitals are given in order, without their names; all "
        "others as `name=value`.\n\n";
    for (const std::string& group : groups()) {
        if (!only.empty() && group != only) continue;
        text += fmt::format("## {}\n\n", group);
        for (const SceneCommand& c : scene_commands()) {
            if (c.group == group) text += to_markdown(c);
        }
    }
    if (only.empty()) {
        text += fmt::format("## {}\n\n", kLanguage);
        for (const SceneStatement& s : scene_statements()) text += to_markdown(s);
    }
    text.pop_back();
    return text;
}

Json scene_schema() {
    Json all = Json::array();
    for (const SceneCommand& c : scene_commands()) {
        Json arguments = Json::array();
        for (const Argument& a : c.arguments) arguments.push_back(make_json(a));
        all.push_back({{"name", c.name},
                       {"aliases", c.aliases},
                       {"group", c.group},
                       {"help", c.help},
                       {"example", c.example},
                       {"arguments", arguments}});
    }
    return all;
}

std::vector<std::string> completions(std::string_view line, const SceneState& state) {
    std::vector<SceneWord> words;
    try {
        words = scene_words(line);
    } catch (const InvalidInput&) {
        return {};  // a file name within quotes
    }
    const bool fresh = line.empty() || line.back() == ' ' || line.back() == '\t';
    const SceneWord last = fresh || words.empty() ? SceneWord{} : words.back();
    if (!fresh && !words.empty()) words.pop_back();
    std::set<std::string> out;
    if (words.empty()) {
        add_commands(out, "", last.text);
        return {out.begin(), out.end()};
    }
    if (words.size() == 1) add_commands(out, words[0].text + " ", last.text);
    std::size_t used = 0;
    const SceneCommand* command = nullptr;
    try {
        command = &find_command(words, used);
    } catch (const InvalidInput&) {
        return {out.begin(), out.end()};
    }
    if (command->name == "help") add_commands(out, words.size() > 1 ? words[1].text + " " : "", last.text);
    std::size_t before = 0;
    for (const SceneWord& word : std::span(words).subspan(used)) before += is_plain(word) ? 1 : 0;
    std::size_t place = 0;
    for (const Argument& a : command->arguments) {
        if (!last.key.empty()) {
            if (a.name == last.key) add_matches(out, list_values(a, state), last.text, a.name + "=");
            continue;
        }
        if (!a.positional) {
            add_matches(out, {fmt::format("{}=", a.name)}, last.text);
        } else if (place++ == before || (a.repeats && place <= before + 1)) {
            add_matches(out, list_values(a, state), last.text);
        }
    }
    return {out.begin(), out.end()};
}

}  // namespace coppice
