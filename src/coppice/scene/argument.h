#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/fields.h"
#include "coppice/pipeline/json.h"
#include "coppice/pipeline/option_fields.h"
#include "coppice/pipeline/quantity.h"
#include "coppice/pipeline/spelling.h"
#include "coppice/scene/object.h"
#include "coppice/scene/words.h"

namespace coppice {

/// What an argument of a command takes.
enum class ArgumentType {
    new_name,     ///< of what the command makes
    object,       ///< an object of `kind`; any kind where `any_kind`
    number,       ///< in the unit of the argument, within its range
    whole,        ///< a whole number within its range
    flag,         ///< true or false
    choice,       ///< one of the argument's choices
    tuple,        ///< numbers joined by commas: a point, a pair
    section,      ///< "PROFILE at FRACTION", joined by an at sign
    word,         ///< anything
    input_file,   ///< read
    selection,    ///< nodes of a tree, as parse_selection reads them
    output_file,  ///< written
    properties,   ///< a file of options, which stand for those that are not given
};

/// One argument of a command of scenes: all that parsing, checks, help, completion and the reference page
/// know of it. Angles have the unit radian and are written in degrees.
struct Argument {
    std::string name;                        ///< as it is typed before "="
    std::string help;                        ///< one sentence without a full stop
    ArgumentType type = ArgumentType::word;  ///< what it takes
    bool positional = false;                 ///< may stand without its name
    bool required = false;                   ///< must be given
    bool repeats = false;                    ///< may be given several times
    std::string initial;                     ///< as typed; "@x": what argument x is; empty: none
    Unit unit = Unit::none;                  ///< of every number
    double low = 0;                          ///< least of every number, where low < high
    double high = 0;                         ///< greatest
    std::vector<std::string> choices;        ///< for ArgumentType::choice
    ObjectKind kind = ObjectKind::solid;     ///< for ArgumentType::object
    bool any_kind = false;                   ///< an object of whatever kind
    std::vector<std::size_t> sizes;          ///< how many numbers a tuple may have
    std::string field;                       ///< "grow.step" where it stands for a member of an option struct
    std::vector<ObjectKind> also =
        {};                   ///< further kinds an object may be of, where none of `kind` is called so
    std::string unless = {};  ///< no default where this argument is given
};

/// One value of an argument: a text, and its numbers where it has some, as they were typed: see
/// `in_library_unit`.
struct ArgumentValue {
    std::string text;             ///< as typed, without quotes
    std::vector<double> numbers;  ///< of a number or tuple
};

/// Reads what was typed. Throws InvalidInput, one sentence without the place: "radius takes a number of
/// metres from 1e-05 to 100000, not 'x'". Objects are looked up by the caller.
ArgumentValue parse_argument(const Argument& argument, std::string_view text);

/// A number of the argument as the library takes it: angles in radians.
double in_library_unit(const Argument& argument, double number);

/// The numbers of a word, none when it is not made of numbers joined by commas.
std::vector<double> numbers_of(std::string_view word);

/// The value as it would be typed, so that reading it gives the same bits.
std::string typed(const Argument& argument, const ArgumentValue& value);

/// What it takes, for people: "number of metres from 0 to 10", "one of a, b".
std::string takes_text(const Argument& argument);

/// Letters, digits, _, - and . after a letter or _, at most 64: what objects may be called.
bool is_object_name(std::string_view name);

/// An argument that stands for a member of an option struct, its default being the member's value.
template <class T>
Argument argument_of(const Field& field, const T& value) {
    Argument a;
    a.name = field.name;
    a.help = field.help;
    a.unit = field.unit;
    a.low = field.low;
    a.high = field.high;
    if constexpr (std::is_same_v<T, bool>) {
        a.type = ArgumentType::flag;
        a.initial = value ? "true" : "false";
    } else if constexpr (NamedEnum<T>) {
        a.type = ArgumentType::choice;
        a.choices.assign(EnumNames<T>::names.begin(), EnumNames<T>::names.end());
        a.initial = name_of(value);
    } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
        a.repeats = true;
    } else if constexpr (std::is_same_v<T, std::optional<Vec3d>>) {
        a.type = ArgumentType::tuple;
        a.sizes = {3};
    } else {
        a.type = std::is_same_v<T, int> ? ArgumentType::whole : ArgumentType::number;
        double shown = static_cast<double>(value);
        if constexpr (std::is_same_v<T, float>) shown = shortest(value);
        a.initial = typed(a, {{}, {in_typed_unit(field.unit, shown)}});
    }
    return a;
}

/// Calls visit(path, field, member) for the members of an option struct and of those within it; the path is
/// "mesh.control.base".
template <class Options, class Visitor>
void visit_members(Options& options, const std::string& path, Visitor&& visit) {
    visit_fields(options, [&](const Field& field, auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        const std::string name(field.name);
        if constexpr (OptionStruct<T>) {
            visit_members(value, path + "." + name, visit);
        } else {
            visit(path + "." + name, field, value);
        }
    });
}

/// Adds an argument for every member of an option struct, but for those in `without`. It has the name of the
/// member, or that in `names` for its path; each name is declared once, so a name that is taken is an error
/// of the program.
template <class Options>
void add_options(std::vector<Argument>& arguments, const Options& defaults, const std::string& path,
                 const std::set<std::string>& without = {},
                 const std::map<std::string, std::string>& names = {}) {
    visit_members(defaults, path, [&](const std::string& at, const Field& field, const auto& value) {
        if (without.contains(std::string(field.name))) return;
        Argument a = argument_of(field, value);
        a.field = at;
        if (const auto other = names.find(at); other != names.end()) a.name = other->second;
        for (const Argument& other : arguments) COPPICE_ASSERT(other.name != a.name);
        arguments.push_back(std::move(a));
    });
}

}  // namespace coppice
