#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

// Numbers with units for input and output: angles are in degrees there, and in radians everywhere else.

/// Converts a typed number to the unit of the library: degrees to radians.
double in_library_unit(Unit unit, double typed);
double in_typed_unit(Unit unit, double value);  ///< inverse of from_typed

/// Returns "metres", "degrees", "radii" or "seconds"; empty for a plain number.
std::string_view unit_text(Unit unit);

/// Returns a value in the typed unit with six digits, or all digits of a whole number without unit; four for
/// an angle, because bounds of angles are rounded radians and have stray digits in degrees.
std::string number_text(Unit unit, double value);

/// Returns a range such as "0 to 90": bounds in the library's unit, shown in the typed one.
std::string range_text(Unit unit, double low, double high);

/// Describes the value of a flag or argument: "number of metres from 0 to 10". Unit and range are left out if
/// there is none; low < high is a range.
std::string quantity_text(std::string_view noun, Unit unit, double low, double high);

/// Groups digits: 37376 -> "37,376".
std::string grouped(std::uint64_t number);

/// Returns the finite number that a whole word spells, with or without a sign; nullopt for other words.
std::optional<double> parse_finite(std::string_view word);

}  // namespace coppice
