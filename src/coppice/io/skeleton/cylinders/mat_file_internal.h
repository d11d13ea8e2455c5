#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"

namespace coppice {

/// One array of a MATLAB file: numbers, or a struct or cell array of further arrays.
struct MatArray {
    enum class Kind { numbers, structure, cell, other };

    std::string name;  ///< of the variable or the field
    Kind kind = Kind::other;
    std::vector<std::size_t> dims;
    std::vector<std::string> fields;  ///< of a structure
    std::vector<MatArray>
        items;  ///< cells; or all fields of the first element of a structure, then of the second...

    std::size_t count() const;  ///< product of dims

    /// The numbers column by column, of whatever type they are; none when this is no array of real numbers.
    std::optional<std::vector<double>> numbers() const;

    std::uint32_t type = 0;  ///< number type of the file format
    bool complex = false;
    bool swapped = false;   ///< bytes are in the other order
    std::string_view data;  ///< the numbers as they stand in the file
};

/// The variables of a MATLAB file of level 5 ("-v6" and "-v7", packed or not), in their order.
///
/// For untrusted files: sizes are held against the bytes that are there before memory is taken, packed
/// variables may unfold to 64 MiB and 20 times the file in all, structures may be nested 8 deep and have a
/// million fields in all. Kinds of arrays that hold no numbers are kept as `other`, without content.
class MatFile {
  public:
    /// Throws InvalidInput naming `source` when the bytes are no such file, or are cut or damaged;
    /// Unsupported for "-v7.3"; Cancelled. Keeps a view of `bytes`.
    MatFile(std::string_view bytes, const std::string& source, const Context& ctx);

    const std::vector<MatArray>& variables() const { return variables_; }

  private:
    std::deque<std::string> unpacked_;  ///< what the arrays of packed variables point into
    std::vector<MatArray> variables_;
};

}  // namespace coppice
