#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// What one unit of the coordinates and radii of a skeleton file is. Nothing is computed with it: it names
/// figures, and stands in written files.
enum class LengthUnit {
    automatic,  ///< what the file says; micrometres for a large neuron; else metres
    m,          ///< metre
    cm,         ///< centimetre
    mm,         ///< millimetre
    um,         ///< micrometre
    nm,         ///< nanometre
    inch,       ///< 25.4 mm
    ft          ///< foot of 12 inches
};

template <>
struct EnumNames<LengthUnit> {
    static constexpr std::array<std::string_view, 8> names{"automatic", "m",  "cm",   "mm",
                                                           "um",        "nm", "inch", "ft"};
};

/// The unit that a word means: a name of LengthUnit but automatic, or that in words, as "Micrometers". None
/// for others.
std::optional<LengthUnit> length_unit_of_word(std::string_view word);

/// [m] How long it is; 1 for automatic.
double metres_of(LengthUnit unit);

/// The unit that a file states: the word after "units" in the comments (# or, in PLY, comment) at its
/// beginning, or, in JSON, of that key: a name of LengthUnit or a word such as "micrometers". None for other
/// words and where several make a unit, as "8 nm" of voxels. Looks at the first 64 KiB.
std::optional<LengthUnit> stated_unit(std::string_view file);

}  // namespace coppice
