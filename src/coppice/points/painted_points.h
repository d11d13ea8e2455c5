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

/// Red, green and blue, as sRGB has them.
using Rgb = std::array<std::uint8_t, 3>;

/// Points with what is known of each. A column holds a value for every point, or is empty where nothing is
/// known.
struct PaintedPoints {
    PointSet points;               ///< the points themselves
    std::vector<float> distances;  ///< [m] from a surface, negative behind it
    std::vector<Rgb> colors;       ///< of the points
    /// As LAS numbers them: 2 ground, 3 to 5 vegetation, 6 buildings, 7 and 18 noise, and so on.
    std::vector<std::uint8_t> classes = {};
    std::vector<float> intensities = {};            ///< of the echoes, in the file's own unit
    std::vector<std::uint8_t> return_numbers = {};  ///< which echo of its pulse a point is, from 1
    std::vector<std::uint8_t> return_counts = {};   ///< echoes of its pulse
    /// The tree of each point by the number that a file gives it; 0 = of no tree.
    std::vector<std::uint32_t> tree_ids = {};
    std::vector<std::uint8_t> wood = {};           ///< 1: on the surface of the wood that was extracted
    std::vector<std::uint8_t> branch_orders = {};  ///< of the closest branch, 0 for stems; at most 255
    std::vector<float> evidence = {};              ///< share of measures in its radius there; in [0, 1]
};

/// Calls visit(column) for every column, the places not among them.
template <class Points, class Visitor>
requires std::same_as<std::remove_const_t<Points>, PaintedPoints>
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

/// Keeps those values of a column whose `kept` is not 0, in their order; a column of another size is left as
/// it is.
template <class Column>
void keep_values(Column& column, std::span<const std::uint8_t> kept) {
    if (column.size() != kept.size()) return;
    std::size_t count = 0;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i] != 0) column[count++] = column[i];
    column.resize(count);
}

/// Which columns of `PaintedPoints` are wanted; others take neither time nor memory.
struct PointColumns {
    bool distances = true;    ///< from a surface
    bool colors = true;       ///< of the points
    bool classes = true;      ///< by LAS
    bool intensities = true;  ///< of the echoes
    bool returns = true;      ///< numbers and counts
    bool tree_ids = true;     ///< of the points
    bool ranges = false;      ///< not a column: the least and the greatest of every other number of LAS
};

inline constexpr PointColumns kNoColumns{false, false, false, false, false, false};  ///< the places alone

}  // namespace coppice
