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

/// An array of a MATLAB file: numbers, or a struct or cell array of further arrays.
struct MatArray {
    enum class Kind { numbers, structure, cell, other };

    std::string name;  ///< name of the variable or the field
    Kind kind = Kind::other;
    std::vector<std::size_t> dims;
    std::vector<std::string> fields;  ///< names of the fields of a structure
    std::vector<MatArray>
        items;  ///< cells; or all fields of the first element of a structure, then those of the second, ...

    std::size_t count() const;  ///< product of dims

    /// Returns the numbers column by column, converted from any number type; nullopt if this is not an array
    /// of real numbers.
    std::optional<std::vector<double>> numbers() const;

    std::uint32_t type = 0;  ///< number type of the file format
    bool complex = false;
    bool swapped = false;   ///< whether the byte order differs from that of the machine
    std::string_view data;  ///< the numbers as stored in the file
};

/// The variables of a MATLAB file of level 5 ("-v6" and "-v7", compressed or not), in their order.
///
/// Safe for untrusted files: sizes are compared with the available bytes before memory is allocated,
/// compressed variables may decompress to a total of 64 MiB and 20 times the size of the file, structures may
/// be nested 8 levels deep and have a total of a million fields. Arrays that contain no numbers are stored as
/// `other`, without content.
class MatFile {
  public:
    /// Throws InvalidInput with `source` if the bytes are not such a file, or are truncated or damaged;
    /// Unsupported for "-v7.3"; Cancelled. Keeps a view of `bytes`.
    MatFile(std::string_view bytes, const std::string& source, const Context& ctx);

    const std::vector<MatArray>& variables() const { return variables_; }

  private:
    std::deque<std::string>
        unpacked_;  ///< storage of the decompressed variables, to which their arrays point
    std::vector<MatArray> variables_;
};

}  // namespace coppice
