#pragma once

#include <array>
#include <span>
#include <string_view>
#include <type_traits>

namespace coppice {

/// The unit of a number of an option struct.
enum class Unit { none, metre, radian, radius, second };

/// The description of one member of an option struct for front ends; the default is that of the member.
struct Field {
    std::string_view name;   ///< snake_case; the command line writes it with dashes
    std::string_view help;   ///< one sentence with a capital and a full stop; for a nested struct its title
    Unit unit = Unit::none;  ///< `radius` = multiples of the local radius
    double low = 0;          ///< minimum and maximum, both included; unused for bool and enums
    double high = 0;         ///< see `low`
    bool common = false;     ///< one of the most common options, which the short help shows
};

/// Creates a field that the short help shows.
constexpr Field common_field(std::string_view name, std::string_view help, Unit unit = Unit::none,
                             double low = 0, double high = 0) {
    return {name, help, unit, low, high, true};
}

/// The names of the values of an enum, in the order of the values from 0: specialise `EnumNames` next to the
/// enum.
template <class E>
struct EnumNames;

template <class E>
concept NamedEnum = std::is_enum_v<E> && requires {
    EnumNames<E>::names;
};

/// Returns the name of a value in options, JSON and schema.
template <NamedEnum E>
constexpr std::string_view name_of(E value) {
    return EnumNames<E>::names[static_cast<std::size_t>(value)];
}

/// The members of an option struct, see option_fields.h. An option struct O is listed by a free function
///     void list_fields(O& options, FieldList& list);
/// in its namespace, which calls list.add(Field, member) for every member. Command line, JSON and schema are
/// all derived from it.
class FieldList;

}  // namespace coppice
