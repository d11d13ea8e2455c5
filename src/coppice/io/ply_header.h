#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io/file_progress.h"

namespace coppice {

/// How the data of a PLY file is written.
enum class PlyEncoding { ascii, little_endian, big_endian };
/// The numbers that PLY knows, by size.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_size(PlyType type);  ///< of one number in a binary file

/// One column of an element.
struct PlyProperty {
    std::string name;                                        ///< as in the header
    PlyType type = PlyType::float32;                         ///< of the value, or of each item of a list
    std::optional<PlyType> count_type = std::nullopt;        ///< set for a list property
    bool is_list() const { return count_type.has_value(); }  ///< whether a row holds several
};

/// One table of a PLY file: vertices, faces, edges.
struct PlyElement {
    std::string name;         ///< as in the header
    std::uint64_t count = 0;  ///< rows, as the header claims: untrusted until `PlyRows` has checked it
    std::vector<PlyProperty> properties;  ///< in the order of their data

    /// The place of the first property called one of `names`; none when there is no such property.
    std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
    bool has_list() const;  ///< whether rows differ in length
    /// The fewest bytes one row can take: in binary its values with empty lists, in ASCII one digit and a
    /// blank each.
    std::size_t least_row_bytes(PlyEncoding encoding) const;
};

/// The head of a PLY file: what its elements are called, how many rows each has and what is in a row.
struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;  ///< of all elements
    std::vector<PlyElement> elements;           ///< in the order of their data
    std::vector<std::string> comments;          ///< one per line, without the word
    std::size_t data_offset = 0;                ///< first byte after "end_header" and its line end
};

bool is_ply(std::string_view file);  ///< starts with the word "ply" and a line end

/// Reads the head of `file`. Throws InvalidInput naming `source` and the line: no PLY, an unknown type or
/// encoding, a property without an element, an element that has rows but no properties, no end_header. Linear
/// in the head.
PlyHeader parse_ply_header(std::string_view file, const std::string& source);

/// One row: the values of property p are values[first[p]] to values[first[p + 1]], one for a scalar. All
/// types of PLY fit a double without loss.
struct PlyRow {
    std::vector<double> values;      ///< of all properties, one after the other
    std::vector<std::size_t> first;  ///< one more than there are properties

    /// of a property that is no list
    double scalar(std::size_t property) const { return values[first[property]]; }
    /// The values of a list, or the one of a scalar.
    std::span<const double> list(std::size_t property) const {
        return {values.data() + first[property], first[property + 1] - first[property]};
    }
};

/// Reads the rows of a PLY file one after another; keeps a view of the file.
///
///     PlyRows rows(file, header, source);
///     for (const PlyElement& element : header.elements) {
///         rows.begin_element(element);
///         for (std::uint64_t i = 0; i < element.count; ++i) rows.read(row);
///     }
///
/// Throws InvalidInput where the file ends too early or a value is no number, and Cancelled.
class PlyRows {
  public:
    /// `file` must outlive this.
    PlyRows(std::string_view file, const PlyHeader& header, std::string source, const Context& ctx = {});

    /// Makes `element` the one that is read next, and refuses a count for which the file is too short: after
    /// this, reserving memory by `element.count` is safe.
    void begin_element(const PlyElement& element);
    void read(PlyRow& row);  ///< the next row
    void skip_element();     ///< passes over all rows of the element just begun

    std::size_t offset() const { return offset_; }  ///< of the next byte to be read
    /// The rows of the element just begun as raw bytes, which are then passed over: for fast paths over
    /// binary elements without lists, count * least_row_bytes long.
    std::string_view take_fixed_rows();

  private:
    double read_value(PlyType type);
    double read_ascii();
    std::size_t read_count(const PlyProperty& property);
    [[noreturn]] void fail(const std::string& text) const;

    std::string_view file_;
    PlyEncoding encoding_;
    std::string source_;
    FileProgress progress_;
    std::size_t offset_;
    const PlyElement* element_ = nullptr;
    std::uint64_t row_ = 0;
};

}  // namespace coppice
