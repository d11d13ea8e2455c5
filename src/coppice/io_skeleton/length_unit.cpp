#include "coppice/io_skeleton/length_unit.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "coppice/base/ascii.h"
#include "coppice/io/text.h"

namespace coppice {

namespace {

bool is_part_of_number(char c) { return is_digit(c) || c == '.' || c == 'e' || c == '-'; }

/// Normalizes a word: "Micrometers" to "micrometre".
std::string singular(std::string_view word) {
    std::string name = to_lower(word);
    if (name.size() > 2 && name.ends_with('s')) name.pop_back();
    if (name.ends_with("meter")) name.replace(name.size() - 2, 2, "re");
    return name;
}

/// Parses the text after "units" in a line: `: micrometre`, `": "1 nanometer"`.
std::optional<LengthUnit> unit_in_line(std::string_view line) {
    constexpr std::string_view kKey = "units";
    const std::size_t found = line.find(kKey);
    if (found == std::string_view::npos || (found > 0 && is_letter(line[found - 1]))) return std::nullopt;
    line.remove_prefix(found + kKey.size());
    const std::size_t begin = line.find_first_not_of(" \t:=\"'");
    if (begin == std::string_view::npos || begin == 0) return std::nullopt;
    line.remove_prefix(begin);
    const std::size_t number =
        static_cast<std::size_t>(std::ranges::find_if_not(line, is_part_of_number) - line.begin());
    if (number > 0) {
        if (parse_number(line.substr(0, number)) != 1.0) return std::nullopt;
        line = trimmed(line.substr(number));
    }
    return length_unit_of_word(line.substr(0, line.find_first_of(" \t\r\"',;}")));
}

}  // namespace

std::optional<LengthUnit> length_unit_of_word(std::string_view word) {
    constexpr std::array<std::pair<std::string_view, LengthUnit>, 12> kWords{{{"metre", LengthUnit::m},
                                                                              {"centimetre", LengthUnit::cm},
                                                                              {"millimetre", LengthUnit::mm},
                                                                              {"micrometre", LengthUnit::um},
                                                                              {"micron", LengthUnit::um},
                                                                              {"\u00b5m", LengthUnit::um},
                                                                              {"\u03bcm", LengthUnit::um},
                                                                              {"nanometre", LengthUnit::nm},
                                                                              {"in", LengthUnit::inch},
                                                                              {"inche", LengthUnit::inch},
                                                                              {"foot", LengthUnit::ft},
                                                                              {"feet", LengthUnit::ft}}};
    const std::string name = singular(word);
    for (const LengthUnit unit : {LengthUnit::m, LengthUnit::cm, LengthUnit::mm, LengthUnit::um,
                                  LengthUnit::nm, LengthUnit::inch, LengthUnit::ft}) {
        if (name == name_of(unit)) return unit;
    }
    for (const auto& [known, unit] : kWords) {
        if (name == known) return unit;
    }
    return std::nullopt;
}

double to_metres(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::automatic:
        case LengthUnit::m:
            return 1;
        case LengthUnit::cm:
            return 1e-2;
        case LengthUnit::mm:
            return 1e-3;
        case LengthUnit::um:
            return 1e-6;
        case LengthUnit::nm:
            return 1e-9;
        case LengthUnit::inch:
            return 0.0254;
        case LengthUnit::ft:
            return 0.3048;
    }
    return 1;
}

std::optional<LengthUnit> stated_unit(std::string_view file) {
    constexpr std::size_t kHead = 1 << 16;
    LineReader lines(file.substr(0, kHead));
    bool json = false;
    while (lines.next()) {
        const std::string_view line = trimmed(lines.line());
        json = json || line.starts_with('{');
        if (line == "end_header") break;
        if (!json && !line.starts_with('#') && !line.starts_with("comment")) continue;
        if (const auto unit = unit_in_line(line)) return unit;
    }
    return std::nullopt;
}

}  // namespace coppice
