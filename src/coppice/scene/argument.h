#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/base/option_fields.h"
#include "coppice/scene/object.h"
#include "coppice/scene/words.h"

namespace coppice {

/// Type of the value of an argument.
enum class ArgumentType {
    new_name,     ///< name of a result of the command
    object,       ///< an object of `kind`, or of any kind if `any_kind`
    number,       ///< in the unit and range of the argument
    whole,        ///< an integer within the range
    flag,         ///< true or false
    choice,       ///< one of `choices`
    tuple,        ///< numbers separated by commas: a point, a pair
    section,      ///< a profile and a fraction, joined by an at sign
    word,         ///< any text
    input_file,   ///< a file to read
    selection,    ///< nodes of a tree, in the syntax of parse_selection
    output_file,  ///< a file to write
    properties,   ///< a file of options, which apply unless given in the command
};

/// An argument of a scene command, as used by parsing, checks, help, completion and the reference page.
/// Angles have the unit radian and are entered in degrees.
struct Argument {
    std::string name;                        ///< name before "="
    std::string help;                        ///< one sentence with a capital and a full stop
    ArgumentType type = ArgumentType::word;  ///< type of the value
    bool positional = false;                 ///< may be given without its name
    bool required = false;                   ///< must be given
    bool repeats = false;                    ///< may be given several times
    std::string initial;     ///< default as entered; "@x": the value of argument x; empty: no default
    Unit unit = Unit::none;  ///< of all numbers
    double low = 0;          ///< minimum of all numbers, if low < high
    double high = 0;         ///< maximum
    std::vector<std::string> choices;     ///< for ArgumentType::choice
    ObjectKind kind = ObjectKind::solid;  ///< for ArgumentType::object
    bool any_kind = false;                ///< accepts objects of any kind
    std::vector<std::size_t> sizes;       ///< valid numbers of components of a tuple
    std::string field;                    ///< "grow.step" if it represents a member of an option struct
    std::vector<ObjectKind> also = {};    ///< further kinds, used if no object of `kind` has the name
    std::string unless = {};              ///< the default does not apply if this argument is given
};

/// A value of an argument: a text, and its numbers, if any, in the units in which they were entered; see
/// `in_library_unit`.
struct ArgumentValue {
    std::string text;             ///< as entered, without quotes
    std::vector<double> numbers;  ///< for a number or tuple
};

/// Parses a value. Throws InvalidInput with a sentence without the location: "radius takes a number of metres
/// from 1e-05 to 100000, not 'x'". The caller resolves objects.
ArgumentValue parse_argument(const Argument& argument, std::string_view text);

/// Converts a number of the argument to the unit of the library: angles to radians.
double in_library_unit(const Argument& argument, double number);

/// Parses numbers separated by commas; empty if the word is anything else.
std::vector<double> parse_numbers(std::string_view word);

/// Returns the value as a user would enter it, so that parsing it is bit-identical.
std::string typed(const Argument& argument, const ArgumentValue& value);

/// Returns a description of the valid values: "number of metres from 0 to 10", "one of a, b".
std::string takes_text(const Argument& argument);

/// Returns whether an object may have this name: letters, digits, _, - and . after a letter or _, at most 64.
bool is_object_name(std::string_view name);

/// Returns an argument that represents a member of an option struct, with the value of the member as default.
Argument to_argument(const OptionField& member);

/// Calls visit(path, member) for the members of an option struct and of nested structs; the path has the form
/// "mesh.control.base".
void visit_members(std::span<const OptionField> members, const std::string& path,
                   const std::function<void(const std::string&, const OptionField&)>& visit);

/// Adds an argument for every member of an option struct, except those in `without`. It has the name of the
/// member, or the name in `names` for its path. Duplicate names, and paths without a member, are programming
/// errors.
void add_options(std::vector<Argument>& arguments, std::span<const OptionField> defaults,
                 const std::string& path, const std::set<std::string>& without = {},
                 const std::map<std::string, std::string>& names = {});

/// The same for an option struct.
template <OptionStruct Options>
void add_options(std::vector<Argument>& arguments, Options defaults, const std::string& path,
                 const std::set<std::string>& without = {},
                 const std::map<std::string, std::string>& names = {}) {
    add_options(arguments, option_fields(defaults), path, without, names);
}

}  // namespace coppice
