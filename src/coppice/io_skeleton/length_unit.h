#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "coppice/base/fields.h"

namespace coppice {

/// Unit of the coordinates and radii of a skeleton file. It is not used for conversion: it labels figures and
/// is stated in written files.
enum class LengthUnit {
    automatic,  ///< as stated by the file; otherwise micrometres for a large neuron, metres for others
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

/// Returns the unit for a word: a name of LengthUnit except automatic, or a written-out name such as
/// "Micrometers"; nullopt for others.
std::optional<LengthUnit> length_unit_of_word(std::string_view word);

/// Returns the length of the unit in metres; 1 for automatic.
double to_metres(LengthUnit unit);

/// Returns the unit that a file states: the word after "units" in the comments (# or, in PLY, comment) at its
/// beginning or, in JSON, the value of that key: a name of LengthUnit or a word such as "micrometers".
/// Returns nullopt for other words and for multiples of a unit, such as "8 nm" for voxels. Searches the first
/// 64 KiB.
std::optional<LengthUnit> stated_unit(std::string_view file);

}  // namespace coppice
