#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/points/point_set.h"

namespace coppice {

/// Red, green and blue in sRGB.
using Rgb = std::array<std::uint8_t, 3>;

/// Points with attributes. A column contains a value for every point, or is empty if the attribute is
/// unknown.
struct PointCloud {
    PointSet points;               ///< the points themselves
    std::vector<float> distances;  ///< [m] signed distances from a surface, negative inside
    std::vector<Rgb> colors;       ///< of the points
    /// Classes of LAS: 2 ground, 3 to 5 vegetation, 6 buildings, 7 and 18 noise, and so on.
    std::vector<std::uint8_t> classes = {};
    std::vector<float> intensities = {};            ///< intensities of the returns, in the unit of the file
    std::vector<std::uint8_t> return_numbers = {};  ///< number of the return within its pulse, from 1
    std::vector<std::uint8_t> return_counts = {};   ///< number of returns of the pulse
    /// Tree id of each point in the file; 0 = no tree.
    std::vector<std::uint32_t> tree_ids = {};
    std::vector<std::uint8_t> wood = {};           ///< 1: on the surface of the extracted wood
    std::vector<std::uint8_t> branch_orders = {};  ///< order of the closest branch, 0 for stems; at most 255
    std::vector<float> evidence = {};  ///< weight of the measurements in the radius there; in [0, 1]
};

/// Calls visit(column) for every column except the positions.
template <class Points, class Visitor>
requires std::same_as<std::remove_const_t<Points>, PointCloud>
void visit_columns(Points& points, Visitor&& visit) {
    visit(points.distances);
    visit(points.colors);
    visit(points.classes);
    visit(points.intensities);
    visit(points.return_numbers);
    visit(points.return_counts);
    visit(points.tree_ids);
    visit(points.wood);
    visit(points.branch_orders);
    visit(points.evidence);
}

/// Keeps the values of a column with a nonzero entry in `kept`, in their order; does not change a column of
/// another size.
template <class Column>
void keep_values(Column& column, std::span<const std::uint8_t> kept) {
    if (column.size() != kept.size()) return;
    std::size_t count = 0;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i] != 0) column[count++] = column[i];
    column.resize(count);
}

/// Selection of columns of `PointCloud`; other columns use neither time nor memory.
struct PointColumns {
    bool distances = true;    ///< from a surface
    bool colors = true;       ///< of the points
    bool classes = true;      ///< classes of LAS
    bool intensities = true;  ///< of the returns
    bool returns = true;      ///< return numbers and counts
    bool tree_ids = true;     ///< of the points
    bool ranges = false;  ///< not a column: the minimum and maximum of every other numeric attribute of LAS
};

inline constexpr PointColumns kNoColumns{false, false, false, false, false, false};  ///< positions only

}  // namespace coppice
