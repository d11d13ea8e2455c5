#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

// Numbers with units as people type and read them: angles are degrees there, and radians everywhere else.

/// What a typed number is inside the library: degrees become radians.
double in_library_unit(Unit unit, double typed);
double in_typed_unit(Unit unit, double value);  ///< the other way round

/// "metres", "degrees", "radii", "seconds"; nothing for a plain number.
std::string_view unit_text(Unit unit);

/// A value in the typed unit with six digits, all of a whole number without unit; four for an angle, since
/// bounds of angles are rounded radians, so that their degrees have stray digits.
std::string number_text(Unit unit, double value);

/// "0 to 90": bounds in the library's unit, shown in the typed one.
std::string range_text(Unit unit, double low, double high);

/// What a flag or argument takes: "number of metres from 0 to 10". The parts about the unit and the range are
/// left out where there is none; low < high is a range.
std::string quantity_text(std::string_view noun, Unit unit, double low, double high);

/// 37376 -> "37,376"
std::string grouped(std::uint64_t number);

/// The finite number that a whole word spells, with or without a sign; none for anything else.
std::optional<double> parse_finite(std::string_view word);

}  // namespace coppice
