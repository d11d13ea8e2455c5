#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/system/file_progress.h"

namespace coppice {

/// Encoding of the data of a PLY file.
enum class PlyEncoding { ascii, little_endian, big_endian };
/// Scalar types of PLY, by size.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_size(PlyType type);  ///< size of one number in a binary file

/// A column of an element.
struct PlyProperty {
    std::string name;                                        ///< as in the header
    PlyType type = PlyType::float32;                         ///< type of the value, or of each item of a list
    std::optional<PlyType> count_type = std::nullopt;        ///< type of the length; set for a list property
    bool is_list() const { return count_type.has_value(); }  ///< whether a row contains several values
};

/// A table of a PLY file, such as vertices, faces or edges.
struct PlyElement {
    std::string name;  ///< as in the header
    /// number of rows specified by the header; untrusted until `PlyRows` has checked it
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;  ///< in the order of the data

    /// Returns the index of the first property with one of `names`; nullopt if there is no such property.
    std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
    bool has_list() const;  ///< whether the rows differ in length
    /// Returns the minimum number of bytes of a row: in binary its values with empty lists, in ASCII one
    /// digit and one blank for each value.
    std::size_t min_row_bytes(PlyEncoding encoding) const;
};

/// Header of a PLY file: names, number of rows and properties of its elements.
struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;  ///< encoding of all elements
    std::vector<PlyElement> elements;           ///< in the order of the data
    std::vector<std::string> comments;          ///< one for each line, without the keyword
    std::size_t data_offset = 0;                ///< offset of the first byte after the line "end_header"
};

bool is_ply(std::string_view file);  ///< returns whether the file starts with "ply" and a line end

/// Reads the header of `file`. Throws InvalidInput with `source` and the line if it is not PLY, has an
/// unknown type or encoding, a property without an element, an element that has rows but no properties, or no
/// end_header. Linear in the size of the header.
PlyHeader parse_ply_header(std::string_view file, const std::string& source);

/// A row of an element. The values of property p are values[first[p]] to values[first[p + 1]], a single one
/// for a scalar. A double represents all PLY types without loss.
struct PlyRow {
    std::vector<double> values;      ///< values of all properties in order
    std::vector<std::size_t> first;  ///< number of properties + 1 offsets

    /// Returns the value of a property that is not a list.
    double scalar(std::size_t property) const { return values[first[property]]; }
    /// Returns the values of a list, or the value of a scalar as a span.
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
    /// `file` must outlive this object.
    PlyRows(std::string_view file, const PlyHeader& header, std::string source, const Context& ctx = {});

    /// Starts reading `element`. Throws if the file is too short for its count: after this, reserving memory
    /// by `element.count` is safe.
    void begin_element(const PlyElement& element);
    void read(PlyRow& row);  ///< reads the next row
    void skip_element();     ///< skips the remaining rows of the current element

    std::size_t offset() const { return offset_; }  ///< offset of the next byte
    /// Returns the rows of the current element as raw bytes, count * min_row_bytes long, and skips them: a
    /// fast path for binary elements without lists.
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
