#include "coppice/io_skeleton/cylinders/columns_internal.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "coppice/io/text.h"
#include "coppice/io_skeleton/length_unit.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

constexpr char kBlanks = ' ';

using Names = std::initializer_list<std::string_view>;

bool is_one_of(std::string_view name, Names names) { return std::ranges::find(names, name) != names.end(); }

/// Finds columns by their names. If several columns match, the first is used.
class NameReader {
  public:
    void add(std::string_view name) {
        const std::size_t at = columns_.width;
        columns_.width += add_at(plain_name(name), at);
        if (columns_.start[0] == at || numbered_[0][1] == at) start_unit_ = unit_in_brackets(name);
        if (columns_.length == at) length_unit_ = unit_in_brackets(name);
        if (columns_.radius == at || (columns_.diameter == at && !columns_.radius))
            radius_unit_ = unit_in_brackets(name);
    }

    CylinderColumns columns() {
        take_numbered(columns_.start, numbered_[0]);
        take_numbered(columns_.end, numbered_[1]);
        take_numbered(columns_.axis, numbered_[2]);
        columns_.of_nodes =
            first_node_ && second_node_ && columns_.id == first_node_ && columns_.parent == second_node_;
        take_units();
        return columns_;
    }

  private:
    using Place = CylinderColumns::Place;
    using Point = CylinderColumns::Point;
    using Numbered = std::array<Place, 4>;  // indexed by a digit from 0 to 3

    static std::optional<LengthUnit> unit_in_brackets(std::string_view name) {
        const std::size_t open = name.find_first_of("([");
        if (open == name.npos) return std::nullopt;
        return length_unit_of_word(trimmed(name.substr(open + 1, name.find_first_of(")]", open) - open - 1)));
    }

    /// Adds one name; returns the number of columns that it represents.
    std::size_t add_at(const std::string& name, std::size_t at) {
        // TreeQSM writes a single name for three columns.
        if (is_one_of(name, {"startpoint", "start"})) return add_point(columns_.start, at);
        if (is_one_of(name, {"axisdirection", "axis"})) return add_point(columns_.axis, at);
        if (name == "p1") set(first_node_, at);
        if (name == "p2") set(second_node_, at);
        if (is_one_of(name, {"id", "cylid", "cylinderid", "p1"})) set(columns_.id, at);
        if (is_one_of(name, {"parent", "parentid", "cylparent", "parentcyl", "parentcylid", "parentcylinder",
                             "parentcylinderid", "cpar", "p2"}))
            set(columns_.parent, at);
        if (is_one_of(name, {"radius", "radiuscyl", "cylradius", "cylinderradius", "radiusm", "rad"}))
            set(columns_.radius, at);
        if (is_one_of(name, {"diameter", "diametercyl", "cyldiameter", "diameterm", "diam"}))
            set(columns_.diameter, at);
        if (is_one_of(name, {"length", "len", "cyllength", "cylinderlength", "lengthm"}))
            set(columns_.length, at);
        if (is_one_of(name, {"branchorder", "branchingorder", "order"})) set(columns_.order, at);
        if (is_one_of(name, {"branch", "branchid", "axisid", "nbranch"})) set(columns_.branch, at);
        if (is_one_of(name, {"tree", "treeid"})) set(columns_.tree, at);
        add_coordinate(name, {"start", "startpoint", "startpos", "cylstart", "sta", "begin"}, "s",
                       columns_.start, numbered_[0], at);
        add_coordinate(name, {"end", "endpoint", "endpos", "cylend"}, "e", columns_.end, numbered_[1], at);
        add_coordinate(name, {"axis", "axisdirection", "direction", "cylaxis", "axe", "dir"}, "a",
                       columns_.axis, numbered_[2], at);
        return 1;
    }

    /// Accepts the name of a point with the suffix or prefix x, y or z, or with a digit as suffix; or its
    /// initial with the suffix x, y or z.
    static void add_coordinate(std::string_view name, Names points, std::string_view initial, Point& point,
                               Numbered& numbered, std::size_t at) {
        if (name.size() < 2) return;
        const char last = name.back(), first = name.front();
        const std::string_view before = name.substr(0, name.size() - 1), behind = name.substr(1);
        if (is_one_of(before, points) && last >= '0' && last <= '3')
            set(numbered[static_cast<std::size_t>(last - '0')], at);
        if ((is_one_of(before, points) || before == initial) && last >= 'x' && last <= 'z')
            set(point[static_cast<std::size_t>(last - 'x')], at);
        if (is_one_of(behind, points) && first >= 'x' && first <= 'z')
            set(point[static_cast<std::size_t>(first - 'x')], at);
    }

    /// Digits count from 0 if there is a 0, otherwise from 1.
    static void take_numbered(Point& point, const Numbered& numbered) {
        const std::size_t first = numbered[0] ? 0 : 1;
        for (std::size_t i = 0; i < 3; ++i)
            if (numbered[first + i]) set(point[i], *numbered[first + i]);
    }

    /// Assumes metres if the start column states no unit, unless radius and length state the same unit.
    void take_units() {
        if (!start_unit_ && radius_unit_ == length_unit_) return;
        const double unit = to_metres(start_unit_.value_or(LengthUnit::m));
        if (radius_unit_) columns_.radius_unit = to_metres(*radius_unit_) / unit;
        if (length_unit_) columns_.length_unit = to_metres(*length_unit_) / unit;
    }

    static void set(Place& place, std::size_t column) {
        if (!place) place = column;
    }
    static std::size_t add_point(Point& point, std::size_t column) {
        for (std::size_t i = 0; i < 3; ++i) set(point[i], column + i);
        return 3;
    }

    CylinderColumns columns_;
    std::array<Numbered, 3> numbered_;
    Place first_node_, second_node_;
    std::optional<LengthUnit> start_unit_, radius_unit_, length_unit_;
};

bool is_whole(double number) { return std::trunc(number) == number; }

}  // namespace

char separator_of_cells(std::string_view line) {
    for (const char c : {';', '\t', ','}) {
        if (line.find(c) != std::string_view::npos) return c;
    }
    return kBlanks;
}

void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells) {
    if (separator == kBlanks) {
        split_at_blanks(line, cells);
    } else {
        split_at(line, separator, cells);
    }
}

std::string_view CylinderColumns::missing() const {
    if (!has_radius()) return "the radius ('radius')";
    if (!has_start()) return "the start ('startX', 'startY', 'startZ')";
    if (!has_end() && !(is_complete(axis) && length))
        return "the end ('endX', 'endY', 'endZ', or 'axis_x', 'axis_y', 'axis_z' and 'length')";
    return {};
}

CylinderColumns columns_of_names(std::span<const std::string_view> names) {
    NameReader reader;
    for (const std::string_view name : names) reader.add(name);
    return reader.columns();
}

CylinderColumns columns_of_treeqsm(std::span<const double> row) {
    CylinderColumns c;
    c.radius = 0;
    c.length = 1;
    c.start = {2, 3, 4};
    c.axis = {5, 6, 7};
    c.parent = 8;
    c.width = row.size();
    // The next columns are branch, branch order and position in the branch, in one version after two
    // additional columns.
    const auto are_ranks = [&](std::size_t at) {
        return at + 2 < row.size() && row[at] >= 1 && is_whole(row[at]) && row[at + 1] >= 0 &&
               is_whole(row[at + 1]) && is_whole(row[at + 2]);
    };
    for (const std::size_t at : {kMinHeaderlessColumns, kMinHeaderlessColumns + 2}) {
        if (c.branch || !are_ranks(at)) continue;
        c.branch = at;
        c.order = at + 1;
    }
    return c;
}

bool has_unit_axis(std::span<const double> row) {
    return std::abs(std::hypot(row[5], row[6], row[7]) - 1) < 0.05;
}

bool is_treeqsm_row(std::span<const double> row) {
    if (row.size() < kMinHeaderlessColumns || !(row[0] > 0) || !(row[1] >= 0)) return false;
    return has_unit_axis(row) && is_whole(row[8]) && is_whole(row[9]);
}

bool is_cylinder_header(std::string_view line) {
    std::vector<std::string_view> cells;
    split_cells(line, separator_of_cells(line), cells);
    const CylinderColumns columns = columns_of_names(cells);
    return columns.has_radius() && columns.has_start();
}

bool begins_cylinders(std::string_view line) {
    std::vector<std::string_view> cells;
    split_cells(line, separator_of_cells(line), cells);
    std::vector<double> row;
    for (const std::string_view cell : cells)
        if (const auto number = parse_number(cell)) row.push_back(*number);
    if (row.size() == cells.size()) return is_treeqsm_row(row);
    return row.empty() && columns_of_names(cells).missing().empty();
}

}  // namespace coppice
