#include "coppice/scene/words.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxWords = 200'000;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_key_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; }

bool holds_a_command(std::string_view line) {
    const auto first = std::ranges::find_if_not(line, is_blank);
    return first != line.end() && *first != '#';
}

bool goes_on(std::string_view line) { return line.ends_with('\\'); }

void check_text(std::string_view line, const std::string& source, std::uint32_t number) {
    const bool odd = std::ranges::any_of(line, [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < 32 && !is_blank(c)) || byte == 127;
    });
    if (odd) {
        throw InvalidInput(fmt::format("{}:{}: the line contains bytes that are not text", source, number));
    }
    if (line.size() > kLongestLine) {
        throw InvalidInput(
            fmt::format("{}:{}: the line is longer than {} bytes", source, number, kLongestLine));
    }
}

/// Returns the length of `key=` at the start of a word; 0 if there is no key.
std::size_t key_length(std::string_view rest) {
    const auto end = std::ranges::find_if_not(rest, is_key_letter);
    if (end == rest.begin() || end == rest.end() || *end != '=') return 0;
    return static_cast<std::size_t>(end - rest.begin()) + 1;
}

/// Returns the end of an unquoted word that begins at `at`, including blanks within ${...}; `closes` is the
/// position of the last } of the line, or 0.
std::size_t end_of_plain_word(std::string_view line, std::size_t at, std::size_t closes) {
    for (; at < line.size() && !is_blank(line[at]); ++at) {
        if (at < closes && line.substr(at).starts_with("${")) at = line.find('}', at);
    }
    return at;
}

/// Reads a quoted text from the quote at `at`; leaves `at` after the closing one.
std::string read_quoted(std::string_view line, std::size_t& at) {
    std::string text;
    for (++at; at < line.size(); ++at) {
        if (line[at] == '"') {
            ++at;
            return text;
        }
        if (line[at] == '\\' && at + 1 < line.size() && (line[at + 1] == '"' || line[at + 1] == '\\')) ++at;
        text += line[at];
    }
    throw InvalidInput("a quote is not closed");
}

}  // namespace

std::vector<SceneLine> scene_lines(std::string_view text, const std::string& source) {
    std::vector<SceneLine> lines;
    std::uint32_t number = 0;
    bool joined = false;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        ++number;
        if (line.ends_with('\r')) line.remove_suffix(1);
        check_text(line, source, number);
        const bool on = goes_on(line);
        if (on) line.remove_suffix(1);
        if (joined) {
            lines.back().text.append(" ").append(line);
            if (lines.back().text.size() > kLongestLine) check_text(lines.back().text, source, number);
        } else if (on || holds_a_command(line)) {
            lines.push_back({number, std::string(line)});
        }
        joined = on;
        if (lines.size() > kMaxLines) {
            throw InvalidInput(fmt::format("{}:{}: there are more than {} commands; split the file", source,
                                           number, kMaxLines));
        }
    }
    if (joined) {
        throw InvalidInput(
            fmt::format("{}:{}: nothing follows the backslash at the end of the line", source, number));
    }
    std::erase_if(lines, [](const SceneLine& line) { return !holds_a_command(line.text); });
    return lines;
}

std::vector<SceneWord> scene_words(std::string_view line) {
    std::vector<SceneWord> words;
    const std::size_t last = line.rfind('}'), closes = last == line.npos ? 0 : last;
    for (std::size_t at = 0; at < line.size();) {
        if (is_blank(line[at])) {
            ++at;
            continue;
        }
        if (line[at] == '#') break;
        SceneWord word;
        if (const std::size_t length = key_length(line.substr(at)); length > 0) {
            word.key = line.substr(at, length - 1);
            at += length;
        }
        if (at < line.size() && line[at] == '"') {
            word.quoted = true;
            word.text = read_quoted(line, at);
        } else {
            const std::size_t start = at;
            at = end_of_plain_word(line, at, closes);
            word.text = line.substr(start, at - start);
        }
        words.push_back(std::move(word));
        if (words.size() > kMaxWords) {
            throw InvalidInput(fmt::format("there are more than {} words in one command", kMaxWords));
        }
    }
    return words;
}

std::string quoted_word(std::string_view text) {
    const bool plain =
        !text.empty() && text.front() != '#' && key_length(text) == 0 &&
        std::ranges::none_of(text, [](char c) { return is_blank(c) || c == '"' || c == '\\'; });
    if (plain) return std::string(text);
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

}  // namespace coppice
