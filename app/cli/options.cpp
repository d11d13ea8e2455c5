#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "coppice/base/quote.h"
#include "coppice/options/json.h"
#include "coppice/options/quantity.h"
#include "coppice/options/spelling.h"

namespace coppice::cli {
namespace {

double parse_number(const Option& option, const std::string& word, bool whole) {
    const std::optional<double> number = parse_finite(word);
    const double limit = whole ? std::numeric_limits<int>::max() : std::numeric_limits<float>::max();
    const bool ranged = option.low < option.high;
    const double low = ranged ? in_typed_unit(option.unit, option.low) : -limit,
                 high = ranged ? in_typed_unit(option.unit, option.high) : limit;
    if (number && (!whole || *number == std::floor(*number)) && *number >= low && *number <= high) {
        const double value = in_library_unit(option.unit, *number);
        return ranged ? std::clamp(value, option.low, option.high) : value;
    }
    throw UsageError(fmt::format(
        "{} takes a {}, not {}", option.name,
        quantity_text(whole ? "whole number" : "number", option.unit, option.low, option.high), quote(word)));
}

/// "1,2.5,-3"
Vec3d parse_place(const Option& option, const std::string& word) {
    Vec3d p;
    const char* at = word.data();
    const char* const end = word.data() + word.size();
    for (int axis = 0; axis < 3; ++axis) {
        const auto [next, error] = std::from_chars(at, end, p[axis]);
        const bool separated = axis == 2 ? next == end : next != end && *next == ',';
        if (error != std::errc() || !separated || !std::isfinite(p[axis])) {
            throw UsageError(
                fmt::format("{} takes three numbers such as 1,2.5,0, not {}", option.name, quote(word)));
        }
        at = next + 1;
    }
    return p;
}

std::size_t parse_choice(const Option& option, std::span<const std::string_view> names,
                         const std::string& word) {
    const auto found = std::ranges::find(names, word);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::vector<std::string> known(names.begin(), names.end());
    throw UsageError(fmt::format("{} takes one of {}, not {}{}", option.name, fmt::join(names, ", "),
                                 quote(word), did_you_mean(word, known)));
}

/// Stores a word in the target of an option.
struct Store {
    const Option& option;
    const std::string& word;

    void operator()(std::filesystem::path* out) const { *out = word; }
    void operator()(std::vector<std::filesystem::path>* out) const { out->emplace_back(word); }
    void operator()(bool*) const { COPPICE_ASSERT(false); }
    void operator()(int* out) const { *out = static_cast<int>(parse_number(option, word, true)); }
    void operator()(float* out) const { *out = static_cast<float>(parse_number(option, word, false)); }
    void operator()(const ChoiceRef& choice) const { choice.set(parse_choice(option, choice.names, word)); }
    void operator()(std::optional<Vec3d>* out) const { *out = parse_place(option, word); }
    void operator()(std::vector<std::string>* out) const { out->push_back(word); }
};

std::string number_help(const Option& option, double default_value) {
    std::string text = " [";
    if (option.unit != Unit::none) text += fmt::format("{}; ", unit_text(option.unit));
    if (option.low < option.high) text += range_text(option.unit, option.low, option.high) + "; ";
    return text + fmt::format("default {}]", number_text(option.unit, default_value));
}

/// Returns the text that follows the sentence of a help: unit, range and default.
struct HelpEnd {
    const Option& option;

    std::string operator()(int* value) const { return number_help(option, *value); }
    std::string operator()(float* value) const { return number_help(option, shortest(*value)); }
    std::string operator()(const ChoiceRef& choice) const {
        return fmt::format(" [{}; default {}]", fmt::join(choice.names, ", "), choice.name());
    }
    // Files and switches show no default: it is always empty or off.
    template <class Other>
    std::string operator()(const Other&) const {
        return {};
    }
};

std::string type_text(const OptionTarget& target) {
    if (std::holds_alternative<bool*>(target)) return {};
    if (std::holds_alternative<int*>(target) || std::holds_alternative<float*>(target)) return "NUMBER";
    return std::holds_alternative<std::optional<Vec3d>*>(target) ? "X,Y,Z" : "NAME";
}

/// Converts a reference to a member that is not a struct to a target.
OptionTarget make_target(const OptionRef& ref) {
    return std::visit(
        [](const auto& value) -> OptionTarget {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::vector<OptionField>>) {
                COPPICE_ASSERT(false);
                return {};
            } else {
                return value;
            }
        },
        ref);
}

std::string name_of_field(const FlagNames& names, const std::string& path, const Field& field) {
    for (const auto& [known, name] : names.names)
        if (known == path) return std::string(name);
    return flag_name(names.prefix.empty() ? std::string(field.name)
                                          : fmt::format("{}_{}", names.prefix, field.name));
}

Option make_option(const OptionField& field, const std::string& group) {
    Option option;
    option.help = field.field.help;
    option.target = make_target(field.ref);
    option.type = type_text(option.target);
    option.group = group;
    option.unit = field.field.unit;
    option.low = field.field.low;
    option.high = field.field.high;
    option.common = field.field.common;
    return option;
}

Option make_option(const OptionTarget& target, const std::string& type, const std::string& help,
                   const HelpPlace& place) {
    Option option;
    option.help = help;
    option.type = type;
    option.group = place.group;
    option.common = place.common;
    option.target = target;
    return option;
}

}  // namespace

Option& OptionList::add(Option option, const std::string& names) {
    const std::size_t comma = names.find(',');
    option.name = comma == names.npos ? names : names.substr(comma + 1);
    if (comma != names.npos) option.letter = names.substr(0, comma);
    for (const Option& other : options_) {
        COPPICE_ASSERT(other.name != option.name);
        COPPICE_ASSERT(option.letter.empty() || other.letter != option.letter);
    }
    return options_.emplace_back(std::move(option));
}

void OptionList::file(const std::string& names, const std::string& type, std::filesystem::path& target,
                      const std::string& help, const HelpPlace& place) {
    add(make_option(&target, type, help, place), names);
}

void OptionList::files(const std::string& names, const std::string& type,
                       std::vector<std::filesystem::path>& target, const std::string& help,
                       const HelpPlace& place) {
    add(make_option(&target, type, help, place), names);
}

void OptionList::output(const std::string& names, const std::string& type, std::filesystem::path& target,
                        const std::string& help, const HelpPlace& place) {
    add(make_option(&target, type, help, place), names).is_output = true;
}

void OptionList::outputs(const std::string& names, const std::string& type,
                         std::vector<std::filesystem::path>& target, const std::string& help,
                         const HelpPlace& place) {
    add(make_option(&target, type, help, place), names).is_output = true;
}

void OptionList::may_replace(const std::string& output, const std::string& input) {
    const auto named = std::ranges::find(options_, output, &Option::name);
    COPPICE_ASSERT(named != options_.end());
    named->replaces.push_back(input);
}

void OptionList::flag(const std::string& names, bool& target, const std::string& help,
                      const HelpPlace& place) {
    add(make_option(&target, {}, help, place), names);
}

void OptionList::value(const OptionField& field, const std::string& group) {
    add(make_option(field, group), flag_name(field.field.name));
}

void OptionList::add_struct(std::span<const OptionField> fields, const std::string& group,
                            const FlagNames& names) {
    const std::size_t before = options_.size();
    add_fields(fields, group, {}, names);
    const auto exists = [&](std::string_view path) {
        return std::any_of(options_.begin() + static_cast<std::ptrdiff_t>(before), options_.end(),
                           [&](const Option& option) { return option.field == path; });
    };
    for (const auto& [path, name] : names.names) COPPICE_ASSERT(exists(path));
    for (const std::string_view path : names.common.value_or(MemberNames{})) COPPICE_ASSERT(exists(path));
}

void OptionList::add_fields(std::span<const OptionField> fields, const std::string& group,
                            const std::string& path, const FlagNames& names) {
    for (const OptionField& field : fields) {
        const std::string at = path + std::string(field.field.name);
        if (std::ranges::find(names.without, at) != names.without.end()) continue;
        if (const auto* nested = std::get_if<std::vector<OptionField>>(&field.ref)) {
            add_fields(*nested, std::string(field.field.help), at + ".", names);
            continue;
        }
        Option option = make_option(field, group);
        option.field = at;
        if (names.common) option.common = std::ranges::find(*names.common, at) != names.common->end();
        add(std::move(option), name_of_field(names, at, field.field));
    }
}

bool is_given(const GivenOptions& given, std::string_view name) {
    return std::ranges::any_of(given, [&](const Option* option) { return option->name == name; });
}

const Option* first_of_groups(const GivenOptions& given, std::initializer_list<std::string_view> groups) {
    const auto found = std::ranges::find_if(given, [&](const Option* option) {
        return std::ranges::find(groups, option->group) != groups.end();
    });
    return found == given.end() ? nullptr : *found;
}

void copy_given(std::span<const OptionField> from, std::span<const OptionField> to,
                const GivenOptions& given) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        const auto is_same = [&](const Option* option) { return option->field == to[i].field.name; };
        if (std::ranges::none_of(given, is_same)) continue;
        std::visit(
            [&]<class Ref>(const Ref& target) {
                if constexpr (std::is_same_v<Ref, ChoiceRef>) {
                    target.set(std::get<ChoiceRef>(from[i].ref).index());
                } else if constexpr (std::is_pointer_v<Ref>) {
                    *target = *std::get<Ref>(from[i].ref);
                }
            },
            to[i].ref);
    }
}

std::string flag_name(std::string_view field_name) {
    std::string flag = "--" + std::string(field_name);
    std::ranges::replace(flag, '_', '-');
    return flag;
}

void store(const Option& option, const std::string& word) { std::visit(Store{option, word}, option.target); }

std::string help_text(const Option& option) {
    return option.help + std::visit(HelpEnd{option}, option.target);
}

}  // namespace coppice::cli
