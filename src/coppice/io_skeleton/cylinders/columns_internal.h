#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// Returns the separator of the cells of a row: the first of ; tab and , that occurs in it, otherwise blanks.
char separator_of_cells(std::string_view line);
/// Splits a row into its cells.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Column indices of the values of a cylinder.
struct CylinderColumns {
    using Place = std::optional<std::size_t>;
    using Point = std::array<Place, 3>;

    Place id, parent, radius, diameter, length;
    Place order, branch, tree;  ///< stored as attributes
    Point start, end, axis;
    /// unit of radius or diameter relative to that of the start, if their names state it
    double radius_unit = 1;
    double length_unit = 1;  ///< unit of the length, likewise
    bool of_nodes = false;   ///< id and parent are the end and the start node of a cylinder, as in treegraph
    std::size_t width = 0;   ///< number of columns that the names represent

    bool has_start() const { return is_complete(start); }
    bool has_end() const { return is_complete(end); }
    bool has_radius() const { return radius || diameter; }
    /// Returns a description of the value that is missing for a cylinder; empty if it is complete. Parents
    /// are optional.
    std::string_view missing() const;

  private:
    static bool is_complete(const Point& p) { return p[0] && p[1] && p[2]; }
};

/// Finds columns by their names, which docs/user/formats.md lists.
CylinderColumns columns_of_names(std::span<const std::string_view> names);

/// Returns the columns of a row without names in the order of TreeQSM: radius, length, start (3), axis (3),
/// parent, extension, and the following columns as far as the row identifies them.
CylinderColumns columns_of_treeqsm(std::span<const double> row);
/// Returns whether the numbers may be such a row: the axis has length 1, parent and extension are integers.
bool is_treeqsm_row(std::span<const double> row);
/// Returns whether columns 6 to 8 have length 1; the row must have them.
bool has_unit_axis(std::span<const double> row);

/// Minimum number of columns of a row without names: radius, length, start, axis, parent and extension of
/// TreeQSM.
inline constexpr std::size_t kMinHeaderlessColumns = 10;

}  // namespace coppice
