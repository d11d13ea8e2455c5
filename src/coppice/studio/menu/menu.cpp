#include "coppice/studio/menu/menu_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/options/spelling.h"
#include "coppice/scene/command.h"
#include "coppice/scene/words.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxItems = 2000;
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Splits a text into its first word and the rest.
std::pair<std::string_view, std::string_view> split_word(std::string_view text) {
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    return {text.substr(0, end), trimmed(text.substr(end))};
}

MenuAction action_called(std::string_view word) {
    const auto& names = EnumNames<MenuAction>::names;
    const auto found = std::ranges::find(names, word);
    if (found != names.end() && word != name_of(MenuAction::separator))
        return static_cast<MenuAction>(found - names.begin());
    throw InvalidInput(fmt::format(
        "'{}' is not an action; after the = an item needs tool, line, page, set, program or nothing",
        word.substr(0, 40)));
}

/// Checks the form of an identifier; only the page knows the existing tools and commands.
void check_id(std::string_view text) {
    const bool good = !text.empty() && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    });
    if (!good)
        throw InvalidInput(fmt::format("'{}' is not the name of a tool or command", text.substr(0, 40)));
}

void check_line(std::string_view text) {
    std::size_t used = 0;
    find_command(scene_words(text), used);
}

/// Checks a text of the form COMMAND.ARGUMENT VALUE.
void check_setting(std::string_view text) {
    const std::size_t dot = text.find('.');
    if (dot == text.npos) throw InvalidInput("set takes COMMAND.ARGUMENT VALUE, as in set mesh.levels 3");
    const auto [name, value] = split_word(text.substr(dot + 1));
    const std::vector<SceneWord> words = scene_words(text.substr(0, dot));
    std::size_t used = 0;
    const SceneCommand& command = find_command(words, used);
    if (used != words.size())
        throw InvalidInput(fmt::format("there is no command '{}'", text.substr(0, dot)));
    std::vector<std::string> known;
    for (const Argument& a : command.arguments) {
        if (a.name != name) {
            known.push_back(a.name);
            continue;
        }
        if (value.empty()) throw InvalidInput(fmt::format("set {} needs a value", text));
        parse_argument(a, value);
        return;
    }
    throw InvalidInput(
        fmt::format("{} has no option '{}'{}", command.name, name, did_you_mean(std::string(name), known)));
}

/// Splits a text into words at blanks; quotes of both kinds enclose words with blanks.
std::vector<std::string> split_words(std::string_view text) {
    std::vector<std::string> out;
    std::optional<std::string> word;
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quote == 0 && kBlanks.find(c) != kBlanks.npos) {
            if (word) out.push_back(*std::exchange(word, std::nullopt));
            continue;
        }
        if (!word) word.emplace();
        if (quote == 0 && (c == '"' || c == '\'')) {
            quote = c;
        } else if (quote != 0 && c == quote) {
            quote = 0;
        } else if (quote == '"' && c == '\\' && i + 1 < text.size()) {
            *word += text[++i];
        } else {
            *word += c;
        }
    }
    if (quote != 0) throw InvalidInput(fmt::format("a {} is not closed", quote));
    if (word) out.push_back(*word);
    return out;
}

bool is_ending(std::string_view text) {
    return !text.empty() &&
           std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); });
}

/// Checks the placeholders ${...} in the words of a program.
void check_holes(std::string_view word) {
    for (std::size_t at = word.find("${"); at != word.npos; at = word.find("${", at + 1)) {
        const std::string_view hole = word.substr(at, word.find('}', at) - at + 1);
        if (hole == "${file}" || hole == "${folder}" || hole == "${object}") continue;
        if (hole.starts_with("${file.") && hole.ends_with('}') && is_ending(hole.substr(7, hole.size() - 8)))
            continue;
        throw InvalidInput(
            fmt::format("'{}' is not a placeholder; programs accept ${{file}}, ${{file.ENDING}}, ${{folder}} "
                        "and ${{object}}",
                        hole.substr(0, 40)));
    }
}

std::vector<std::string> program_words(std::string_view text) {
    std::vector<std::string> words = split_words(text);
    if (words.empty()) throw InvalidInput("program requires the name of a program");
    const std::string& name = words.front();
    if (name.find("${") != name.npos || (name.find('/') != name.npos && !name.starts_with('/')))
        throw InvalidInput(
            fmt::format("'{}' is not a program; specify only its name, or its absolute path", name));
    for (const std::string& word : words) check_holes(word);
    return words;
}

/// Reads a menu file into a copy of the items.
class Reader {
  public:
    explicit Reader(std::vector<MenuItem> items) : items_(std::move(items)) {}

    void read(std::string_view line) {
        if (line == "clear" && menu_.empty()) return items_.clear();
        if (line.starts_with('[')) return begin(line);
        if (menu_.empty())
            throw InvalidInput("an item must belong to a menu; name that before it, as in [Crown]");
        if (items_.size() >= kMaxItems)
            throw InvalidInput(fmt::format("a menu can have at most {} items", kMaxItems));
        if (line == "---") return items_.push_back({.menu = menu_, .label = {}});
        const std::size_t equals = line.find(" =");
        if (equals == line.npos || equals == 0)
            throw InvalidInput("an item has the form LABEL = ACTION, as in Ball = line sphere ${new crown}");
        take(std::string(trimmed(line.substr(0, equals))), trimmed(line.substr(equals + 2)));
    }

    std::vector<MenuItem> items() && { return std::move(items_); }

  private:
    void begin(std::string_view line) {
        menu_ = std::string(trimmed(line.substr(1, line.find(']') - 1)));
        if (!line.ends_with(']') || menu_.empty())
            throw InvalidInput("a menu starts with its name in brackets, as in [Crown]");
    }

    void take(std::string label, std::string_view definition) {
        const auto old = std::ranges::find_if(
            items_, [&](const MenuItem& item) { return item.menu == menu_ && item.label == label; });
        if (definition == "nothing") {
            if (old == items_.end())
                throw InvalidInput(fmt::format("there is no item '{}' in {} to remove", label, menu_));
            items_.erase(old);
            return;
        }
        const auto [does, text] = split_word(definition);
        MenuItem item{.menu = menu_, .label = std::move(label), .does = action_called(does)};
        item.text = std::string(text);
        check(item);
        if (item.does == MenuAction::program) item.words = program_words(text);
        if (old == items_.end()) {
            items_.push_back(std::move(item));
        } else {
            *old = std::move(item);
        }
    }

    static void check(const MenuItem& item) {
        if (item.does == MenuAction::line) check_line(item.text);
        if (item.does == MenuAction::set) check_setting(item.text);
        if (item.does == MenuAction::tool || item.does == MenuAction::page) check_id(item.text);
    }

    std::vector<MenuItem> items_;
    std::string menu_;
};

}  // namespace

Menu::Menu() { add(built_in_menu(), "built-in menu"); }

std::vector<std::string> Menu::add(std::string_view text, const std::string& source) {
    constexpr std::size_t kMaxFaults = 20;
    std::vector<std::string> faults;
    Reader reader(items_);
    std::size_t number = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view line = trimmed(text.substr(at, end - at));
        at = end + 1;
        ++number;
        if (line.empty() || line.starts_with('#')) continue;
        try {
            reader.read(line);
        } catch (const InvalidInput& error) {
            faults.push_back(fmt::format("{}:{}: {}", source, number, error.what()));
            if (faults.size() == kMaxFaults) break;
        }
    }
    items_ = std::move(reader).items();
    return faults;
}

}  // namespace coppice
