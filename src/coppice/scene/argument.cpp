#include "coppice/scene/argument.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/edit/selection.h"
#include "coppice/options/json.h"
#include "coppice/options/quantity.h"
#include "coppice/options/spelling.h"

namespace coppice {
namespace {

constexpr double kLargestNumber = 1e30;  // finite as a float
constexpr std::size_t kLongestName = 64;

std::string sizes_text(const Argument& a) { return fmt::format("{}", fmt::join(a.sizes, " or ")); }

[[noreturn]] void refuse(const Argument& a, std::string_view text) {
    const std::vector<std::string> words =
        a.type == ArgumentType::flag ? std::vector<std::string>{"true", "false"} : a.choices;
    throw InvalidInput(
        fmt::format("{} takes {}, not {}{}", a.name, takes_text(a), quote(text), did_you_mean(text, words)));
}

double checked(const Argument& a, std::string_view text, double number) {
    const double value = in_library_unit(a.unit, number);
    const bool ranged = a.low < a.high;
    // Users enter a bound with the digits that the help shows, so that it may exceed the exact value
    // slightly.
    const double slack = a.unit == Unit::radian ? 1e-3 : 0;
    const double low = ranged ? a.low - slack : -kLargestNumber,
                 high = ranged ? a.high + slack : kLargestNumber;
    const bool whole = a.type != ArgumentType::whole || number == std::floor(number);
    if (!whole || value < low || value > high) refuse(a, text);
    return number;
}

ArgumentValue parse_tuple(const Argument& a, std::string_view text) {
    ArgumentValue out;
    out.numbers = parse_numbers(text);
    if (std::ranges::find(a.sizes, out.numbers.size()) == a.sizes.end()) refuse(a, text);
    for (double& number : out.numbers) number = checked(a, text, number);
    return out;
}

ArgumentValue parse_section(const Argument& a, std::string_view text) {
    const std::size_t at = text.find('@');
    if (at == text.npos) refuse(a, text);
    const auto fraction = parse_finite(text.substr(at + 1));
    if (!fraction) refuse(a, text);
    return {std::string(text.substr(0, at)), {checked(a, text, *fraction)}};
}

/// Returns the choice with this name, or the only one with this prefix.
std::string chosen(const Argument& a, std::string_view text) {
    if (std::ranges::find(a.choices, text) != a.choices.end()) return std::string(text);
    const auto begins = [&](const std::string& choice) { return choice.starts_with(text); };
    if (text.empty() || std::ranges::count_if(a.choices, begins) != 1) refuse(a, text);
    return *std::ranges::find_if(a.choices, begins);
}

}  // namespace

double in_library_unit(const Argument& a, double number) {
    const double value = in_library_unit(a.unit, number);
    return a.low < a.high ? std::clamp(value, a.low, a.high) : value;
}

std::vector<double> parse_numbers(std::string_view word) {
    std::vector<double> out;
    for (;;) {
        const std::size_t end = std::min(word.find(','), word.size());
        const auto number = parse_finite(word.substr(0, end));
        if (!number) return {};
        out.push_back(*number);
        if (end == word.size()) return out;
        word.remove_prefix(end + 1);
    }
}

ArgumentValue parse_argument(const Argument& a, std::string_view text) {
    switch (a.type) {
        case ArgumentType::number:
        case ArgumentType::whole: {
            const auto number = parse_finite(text);
            if (!number) refuse(a, text);
            return {{}, {checked(a, text, *number)}};
        }
        case ArgumentType::tuple:
            return parse_tuple(a, text);
        case ArgumentType::section:
            return parse_section(a, text);
        case ArgumentType::flag: {
            const bool yes = text == "true" || text == "yes" || text == "on" || text == "1";
            const bool no = text == "false" || text == "no" || text == "off" || text == "0";
            if (!yes && !no) refuse(a, text);
            return {yes ? "true" : "false", {}};
        }
        case ArgumentType::choice:
            return {chosen(a, text), {}};
        case ArgumentType::new_name:
            if (!is_object_name(text)) refuse(a, text);
            return {std::string(text), {}};
        case ArgumentType::selection:
            return {to_text(parse_selection(text)), {}};
        case ArgumentType::object:
        case ArgumentType::word:
        case ArgumentType::input_file:
        case ArgumentType::output_file:
        case ArgumentType::properties:
            break;
    }
    if (text.empty()) refuse(a, text);
    return {std::string(text), {}};
}

std::string typed(const Argument& a, const ArgumentValue& value) {
    switch (a.type) {
        case ArgumentType::number:
        case ArgumentType::whole:
        case ArgumentType::tuple:
            return fmt::format("{}", fmt::join(value.numbers, ","));
        case ArgumentType::section:
            return fmt::format("{}@{}", value.text, value.numbers.at(0));
        default:
            return quoted_word(value.text);
    }
}

std::string takes_text(const Argument& a) {
    switch (a.type) {
        case ArgumentType::number:
            return "a " + quantity_text("number", a.unit, a.low, a.high);
        case ArgumentType::whole:
            return "a " + quantity_text("whole number", a.unit, a.low, a.high);
        case ArgumentType::tuple:
            return quantity_text(sizes_text(a) + " numbers", a.unit, a.low, a.high) + " joined by commas";
        case ArgumentType::section:
            return "a profile and a fraction from 0 to 1 as in top@0.5";
        case ArgumentType::flag:
            return "true or false";
        case ArgumentType::choice:
            return fmt::format("one of {}", fmt::join(a.choices, ", "));
        case ArgumentType::new_name:
            return "a name (letters, digits, _, - and . after a letter, at most 64)";
        case ArgumentType::object: {
            if (a.any_kind) return "the name of an object";
            std::string kinds(with_article(a.kind));
            for (const ObjectKind kind : a.also) kinds += fmt::format(" or {}", with_article(kind));
            return "the name of " + kinds;
        }
        case ArgumentType::input_file:
        case ArgumentType::output_file:
            return "the name of a file";
        case ArgumentType::properties:
            return "the name of a file of options, one per line";
        case ArgumentType::selection:
            return "nodes, such as 12, subtree(12) or tips&!order(0)";
        case ArgumentType::word:
            break;
    }
    return "a word";
}

bool is_object_name(std::string_view name) {
    const auto letter = [](char c) { return is_letter(c) || c == '_'; };
    const auto rest = [&](char c) { return letter(c) || is_digit(c) || c == '-' || c == '.'; };
    return !name.empty() && name.size() <= kLongestName && letter(name.front()) &&
           std::ranges::all_of(name, rest);
}

Argument to_argument(const OptionField& member) {
    const Field& field = member.field;
    Argument a;
    a.name = field.name;
    a.help = field.help;
    a.unit = field.unit;
    a.low = field.low;
    a.high = field.high;
    const auto set_number = [&](ArgumentType type, double value) {
        a.type = type;
        a.initial = typed(a, {{}, {in_typed_unit(field.unit, value)}});
    };
    if (const auto* flag = std::get_if<bool*>(&member.ref)) {
        a.type = ArgumentType::flag;
        a.initial = **flag ? "true" : "false";
    } else if (const auto* choice = std::get_if<ChoiceRef>(&member.ref)) {
        a.type = ArgumentType::choice;
        a.choices.assign(choice->names.begin(), choice->names.end());
        a.initial = choice->name();
    } else if (std::holds_alternative<std::vector<std::string>*>(member.ref)) {
        a.repeats = true;
    } else if (std::holds_alternative<std::optional<Vec3d>*>(member.ref)) {
        a.type = ArgumentType::tuple;
        a.sizes = {3};
    } else if (const auto* whole = std::get_if<int*>(&member.ref)) {
        set_number(ArgumentType::whole, **whole);
    } else {
        set_number(ArgumentType::number, shortest(*std::get<float*>(member.ref)));
    }
    return a;
}

void visit_members(std::span<const OptionField> members, const std::string& path,
                   const std::function<void(const std::string&, const OptionField&)>& visit) {
    for (const OptionField& member : members) {
        const std::string at = fmt::format("{}.{}", path, member.field.name);
        if (const auto* nested = std::get_if<std::vector<OptionField>>(&member.ref)) {
            visit_members(*nested, at, visit);
        } else {
            visit(at, member);
        }
    }
}

void add_options(std::vector<Argument>& arguments, std::span<const OptionField> defaults,
                 const std::string& path, const std::set<std::string>& without,
                 const std::map<std::string, std::string>& names) {
    std::size_t renamed = 0;
    visit_members(defaults, path, [&](const std::string& at, const OptionField& member) {
        if (without.contains(std::string(member.field.name))) return;
        Argument a = to_argument(member);
        a.field = at;
        if (const auto other = names.find(at); other != names.end()) {
            a.name = other->second;
            ++renamed;
        }
        for (const Argument& other : arguments) COPPICE_ASSERT(other.name != a.name);
        arguments.push_back(std::move(a));
    });
    COPPICE_ASSERT(renamed == names.size());
}

}  // namespace coppice
