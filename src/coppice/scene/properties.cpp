#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/scene/properties_internal.h"
#include "coppice/scene/words.h"

namespace coppice {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == text.npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Returns the text before a word that begins with "#".
std::string_view without_comment(std::string_view text) {
    for (std::size_t i = text.find('#'); i != text.npos; i = text.find('#', i + 1)) {
        if (i == 0 || kBlanks.find(text[i - 1]) != kBlanks.npos) return text.substr(0, i);
    }
    return text;
}

std::string_view unquoted(std::string_view text) {
    const bool quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
    return quoted ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

std::vector<Property> parse_properties(std::string_view text, const std::string& source) {
    std::vector<Property> out;
    for (const SceneLine& line : scene_lines(text, source)) {
        const std::string_view all = trimmed(without_comment(line.text));
        const std::size_t end = std::min(all.find_first_of("=: \t"), all.size());
        std::string_view value = trimmed(all.substr(end));
        if (!value.empty() && (value.front() == '=' || value.front() == ':'))
            value = trimmed(value.substr(1));
        if (end == 0 || value.empty())
            throw InvalidInput(fmt::format(
                "{}:{}: an option and its value are required here, as in count = 500", source, line.number));
        out.push_back({line.number, std::string(all.substr(0, end)), std::string(unquoted(value))});
    }
    return out;
}

}  // namespace coppice
