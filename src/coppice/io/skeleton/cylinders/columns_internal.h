#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coppice {

/// What separates the cells of a row: ; tab or , whichever of these occurs first in that list, else blanks.
char separator_of_cells(std::string_view line);
/// Cuts a row into its cells.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Where the columns of cylinders stand in a row.
struct CylinderColumns {
    using Place = std::optional<std::size_t>;
    using Point = std::array<Place, 3>;

    Place id, parent, radius, diameter, length;
    Place order, branch, tree;  ///< kept as attributes
    Point start, end, axis;
    double radius_unit = 1;  ///< of radius or diameter, in that of the start, where their names tell
    double length_unit = 1;  ///< the same of the length
    bool of_nodes = false;   ///< id and parent are nodes that cylinders end in, as treegraph numbers them
    std::size_t width = 0;   ///< columns that the names stand for

    bool has_start() const { return is_complete(start); }
    bool has_end() const { return is_complete(end); }
    bool has_radius() const { return radius || diameter; }
    /// What is missing for a cylinder, or nothing. Parents may be.
    std::string_view missing() const;

  private:
    static bool is_complete(const Point& p) { return p[0] && p[1] && p[2]; }
};

/// Finds columns by their names, as docs/user/formats.md lists them.
CylinderColumns columns_of_names(std::span<const std::string_view> names);

/// Columns in the order in which TreeQSM writes a row without names: radius, length, start (3), axis (3),
/// parent, extension, and what comes behind these as far as the row tells.
CylinderColumns columns_of_treeqsm(std::span<const double> row);
/// Whether these can be the numbers of such a row: the axis has length 1, parent and extension are whole.
bool is_treeqsm_row(std::span<const double> row);
/// Whether columns 6 to 8 have length 1; the row has these.
bool has_unit_axis(std::span<const double> row);

/// A row without names has at least TreeQSM's radius, length, start, axis, parent and extension.
inline constexpr std::size_t kLeastHeaderlessColumns = 10;

}  // namespace coppice
