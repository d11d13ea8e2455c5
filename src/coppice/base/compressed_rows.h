#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/parallel.h"

namespace coppice {

/// Rows of various lengths in one array (compressed sparse rows): row i is items[first[i]] .. items[first[i +
/// 1]].
template <class T, class Offset = std::uint32_t>
struct CompressedRows {
    Buffer<Offset> first{0};  ///< size() + 1 offsets
    Buffer<T> items;          ///< row after row

    std::size_t size() const { return first.size() - 1; }  ///< number of rows
    /// The items of a row.
    std::span<const T> operator[](std::size_t row) const {
        return {items.data() + first[row], items.data() + first[row + 1]};
    }
    /// The items of a row, which may be changed or put in another order.
    std::span<T> operator[](std::size_t row) {
        return {items.data() + first[row], items.data() + first[row + 1]};
    }
    /// The same rows.
    friend bool operator==(const CompressedRows&, const CompressedRows&) = default;
};

/// Sorts items into rows by counting: `visit_all(put)` calls put(row, item) for every item and is called
/// twice, to the same effect. Within a row the items keep their order. O(rows + items).
template <class T, class VisitAll>
CompressedRows<T> compress_rows(std::size_t rows, const VisitAll& visit_all) {
    CompressedRows<T> out;
    out.first.assign(rows + 1, 0);
    visit_all([&](std::size_t row, const T&) { ++out.first[row]; });
    out.items.resize(exclusive_scan(std::span(out.first)));
    // Each offset runs through its row as that is filled, and then is that of the next row.
    visit_all([&](std::size_t row, const T& item) { out.items[out.first[row]++] = item; });
    for (std::size_t row = rows; row > 0; --row) out.first[row] = out.first[row - 1];
    out.first[0] = 0;
    return out;
}

/// A key that puts an item into no row.
inline constexpr std::uint32_t kNoRow = std::numeric_limits<std::uint32_t>::max();

/// Row r holds the i with keys[i] = r, ascending; those with kNoRow are in none.
inline CompressedRows<std::uint32_t> group_by(std::span<const std::uint32_t> keys, std::size_t rows) {
    return compress_rows<std::uint32_t>(rows, [&](const auto& put) {
        for (std::uint32_t i = 0; i < keys.size(); ++i) {
            if (keys[i] != kNoRow) put(keys[i], i);
        }
    });
}

}  // namespace coppice
