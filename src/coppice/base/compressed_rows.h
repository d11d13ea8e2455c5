#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice {

/// Rows of different lengths in one array (compressed sparse rows): row i is items[first[i]] .. items[first[i
/// + 1]].
template <class T, class Offset = std::uint32_t>
struct CompressedRows {
    Buffer<Offset> first{0};  ///< size() + 1 offsets
    Buffer<T> items;          ///< the rows in order

    std::size_t size() const { return first.size() - 1; }  ///< number of rows
    /// Returns the items of a row.
    std::span<const T> operator[](std::size_t row) const {
        return {items.data() + first[row], items.data() + first[row + 1]};
    }
    /// Returns the items of a row, which may be modified or reordered.
    std::span<T> operator[](std::size_t row) {
        return {items.data() + first[row], items.data() + first[row + 1]};
    }
    /// Compares the rows.
    friend bool operator==(const CompressedRows&, const CompressedRows&) = default;
};

/// Sorts items into rows by counting: `visit_all(put)` calls put(row, item) for every item; it is called
/// twice and must do the same each time. Within a row the items keep their order. O(rows + items).
template <class T, class VisitAll>
CompressedRows<T> compress_rows(std::size_t rows, const VisitAll& visit_all) {
    CompressedRows<T> out;
    out.first.assign(rows + 1, 0);
    visit_all([&](std::size_t row, const T&) { ++out.first[row]; });
    out.items.resize(exclusive_scan(std::span(out.first)));
    // Each offset advances while its row is filled, and is finally that of the next row.
    visit_all([&](std::size_t row, const T& item) { out.items[out.first[row]++] = item; });
    for (std::size_t row = rows; row > 0; --row) out.first[row] = out.first[row - 1];
    out.first[0] = 0;
    return out;
}

/// Returns rows such that row r contains the i with keys[i] = r, ascending; items with kNoIndex are in no
/// row.
inline CompressedRows<std::uint32_t> group_by(std::span<const std::uint32_t> keys, std::size_t rows) {
    return compress_rows<std::uint32_t>(rows, [&](const auto& put) {
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            if (keys[i] != kNoIndex) put(keys[i], i);
        }
    });
}

}  // namespace coppice
