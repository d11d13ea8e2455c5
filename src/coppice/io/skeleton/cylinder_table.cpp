#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>

#include <fmt/format.h>

#include "coppice/io/skeleton/parsers_internal.h"
#include "coppice/io/text_internal.h"

namespace coppice {

namespace {

constexpr char kBlanks = ' ';

/// What separates the cells of a line: the first of ; tab , that occurs, else blanks.
char separator_of(std::string_view line) {
    for (const char c : {';', '\t', ','}) {
        if (line.find(c) != std::string_view::npos) return c;
    }
    return kBlanks;
}

void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
    if (separator == kBlanks) {
        split_at_blanks(line, cells);
    } else {
        split_at(line, separator, cells);
    }
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

using Place = std::optional<std::size_t>;

/// Where the columns that matter stand in a row.
struct Columns {
    Place id, parent, radius, length;
    std::array<Place, 3> start, end, axis;

    static Columns treeqsm() {
        Columns c;
        c.radius = 0;
        c.length = 1;
        c.start = {2, 3, 4};
        c.axis = {5, 6, 7};
        c.parent = 8;
        return c;
    }

    /// Takes one name of the header; returns how many columns it stands for.
    std::size_t add(const std::string& name, std::size_t column) {
        // One name for three columns, as TreeQSM writes it.
        if (is_one_of(name, {"startpoint", "start"})) return add_point(start, column);
        if (is_one_of(name, {"axisdirection", "axis"})) return add_point(axis, column);
        if (is_one_of(name, {"id", "cylid", "cylinderid", "p1"})) set(id, column);
        if (is_one_of(name, {"parent", "parentid", "cylparent", "parentcylid", "p2"})) set(parent, column);
        if (is_one_of(name, {"radius", "radiuscyl", "cylradius", "rad"})) set(radius, column);
        if (is_one_of(name, {"length", "len", "cyllength"})) set(length, column);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::string x(1, static_cast<char>('x' + i));
            if (is_one_of(name, {"start" + x, "s" + x, "startpoint" + x})) set(start[i], column);
            if (is_one_of(name, {"end" + x, "e" + x, "endpoint" + x})) set(end[i], column);
            if (is_one_of(name, {"axis" + x, "a" + x, "axisdirection" + x})) set(axis[i], column);
        }
        return 1;
    }

    /// What is missing for a cylinder, or nothing.
    std::string_view missing() const {
        if (!radius) return "the radius ('radius')";
        if (!parent) return "the parent ('parent' or 'parentID')";
        if (!complete(start)) return "the start ('startX', 'startY', 'startZ')";
        if (!complete(end) && !(complete(axis) && length)) {
            return "the end ('endX', 'endY', 'endZ', or 'axis_x', 'axis_y', 'axis_z' and 'length')";
        }
        return {};
    }

    static bool complete(const std::array<Place, 3>& p) { return p[0] && p[1] && p[2]; }

  private:
    static void set(Place& place, std::size_t column) {
        if (!place) place = column;
    }
    static std::size_t add_point(std::array<Place, 3>& point, std::size_t column) {
        for (std::size_t i = 0; i < 3; ++i) set(point[i], column + i);
        return 3;
    }
};

struct Header {
    Columns columns;
    std::size_t width = 0;  ///< columns that the names stand for
};

Header read_header(const std::vector<std::string_view>& cells) {
    Header header;
    for (const std::string_view cell : cells)
        header.width += header.columns.add(plain_name(cell), header.width);
    return header;
}

bool is_name(std::string_view cell) { return !cell.empty() && cell != "NA" && !parse_number(cell); }

class TableParser {
  public:
    TableParser(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), source_(source) {}

    std::vector<RawCylinder> parse() {
        if (next()) {
            separator_ = separator_of(line_);
            split(line_, separator_, cells_);
            if (std::any_of(cells_.begin(), cells_.end(), is_name)) {
                take_header();
            } else {
                take_headerless();
            }
        }
        while (next()) {
            split(line_, separator_, cells_);
            add_row();
        }
        make_roots_of_zero();
        return std::move(cylinders_);
    }

  private:
    bool next() {
        while (lines_.next()) {
            line_ = lines_.line();
            const std::string_view text = trimmed(line_);
            if (!text.empty() && text[0] != '#') return true;
        }
        return false;
    }

    void take_header() {
        header_ = read_header(cells_);
        const std::string_view missing = header_.columns.missing();
        if (!missing.empty()) {
            fail(fmt::format("no column of the header gives {}; see docs/user/formats.md for the names",
                             missing));
        }
    }

    /// Without names only TreeQSM's order is known, and an axis of length one is what tells it from any other
    /// table.
    void take_headerless() {
        headerless_ = true;
        if (cells_.size() < kLeastHeaderlessColumns) {
            fail(
                "no header names the columns, and there are too few for TreeQSM's order: radius length "
                "start(3) "
                "axis(3) parent extension");
        }
        header_ = {Columns::treeqsm(), cells_.size()};
        add_row();
        const Vec3d axis{number(5, "axis"), number(6, "axis"), number(7, "axis")};
        if (!(std::abs(length(axis) - 1) < 0.05)) {
            fail(
                "no header names the columns, and columns 6 to 8 are no axis of length 1 as in TreeQSM's "
                "order");
        }
    }

    void add_row() {
        // R writes the names of rows as a first column that the header does not count.
        shift_ = !headerless_ && cells_.size() == header_.width + 1 ? 1 : 0;
        if (separator_ == ',' && cells_.size() > header_.width + shift_) {
            fail(
                fmt::format("the row has {} values for {} columns; if commas stand for decimal points, write "
                            "them as points, or separate the columns by semicolons",
                            cells_.size(), header_.width));
        }
        const Columns& c = header_.columns;
        RawCylinder cylinder;
        cylinder.line = lines_.number();
        cylinder.id = c.id ? integer(*c.id, "id") : static_cast<std::int64_t>(cylinders_.size()) + 1;
        cylinder.parent = parent(*c.parent);
        cylinder.radius = number(*c.radius, "radius");
        cylinder.start = point(c.start, "start");
        cylinder.end =
            Columns::complete(c.end)
                ? point(c.end, "end")
                : cylinder.start + number(*c.length, "length") * normalized(point(c.axis, "axis"), Vec3d{});
        cylinders_.push_back(cylinder);
    }

    Vec3d point(const std::array<Place, 3>& place, std::string_view name) const {
        return {number(*place[0], name), number(*place[1], name), number(*place[2], name)};
    }

    std::string_view cell(std::size_t column, std::string_view name) const {
        if (column + shift_ >= cells_.size()) {
            fail(fmt::format("the row has {} values, but the {} is column {}", cells_.size(), name,
                             column + shift_ + 1));
        }
        return cells_[column + shift_];
    }

    double number(std::size_t column, std::string_view name) const {
        const std::string_view text = cell(column, name);
        std::optional<double> value = parse_number(text);
        if (!value && separator_ != ',') value = parse_number(with_point(text));
        if (!value) fail_cell(text, "number", column, name);
        return *value;
    }

    std::int64_t integer(std::size_t column, std::string_view name) const {
        const std::string_view text = cell(column, name);
        const std::optional<std::int64_t> value = parse_integer(text);
        if (!value) fail_cell(text, "whole number", column, name);
        return *value;
    }

    std::int64_t parent(std::size_t column) const {
        const std::string_view text = cell(column, "parent");
        if (text.empty() || text == "NA" || text == "NaN") return -1;
        return integer(column, "parent");
    }

    /// Decimal commas, as spreadsheets of many countries write them beside semicolons.
    static std::string with_point(std::string_view text) {
        std::string copy(text.substr(0, 64));
        std::replace(copy.begin(), copy.end(), ',', '.');
        return copy;
    }

    /// TreeQSM and aRchi count from 1 and write 0 for "no parent"; SimpleForest counts from 0.
    void make_roots_of_zero() {
        for (const RawCylinder& cylinder : cylinders_) {
            if (cylinder.id == 0) return;
        }
        for (RawCylinder& cylinder : cylinders_) {
            if (cylinder.parent == 0) cylinder.parent = -1;
        }
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, lines_.number(), text); }
    [[noreturn]] void fail_cell(std::string_view text, std::string_view kind, std::size_t column,
                                std::string_view name) const {
        fail(fmt::format("{} is not a {}; column {} should be the {}", in_quotes(text), kind,
                         column + shift_ + 1, name));
    }

    LineReader lines_;
    const std::string& source_;
    std::string_view line_;
    std::vector<std::string_view> cells_;
    char separator_ = kBlanks;
    Header header_;
    bool headerless_ = false;
    std::size_t shift_ = 0;
    std::vector<RawCylinder> cylinders_;
};

}  // namespace

std::vector<RawCylinder> parse_cylinders(std::string_view text, const std::string& source,
                                         const Context& ctx) {
    return TableParser(text, source, ctx).parse();
}

bool is_cylinder_header(std::string_view line) {
    std::vector<std::string_view> cells;
    split(line, separator_of(line), cells);
    const Columns columns = read_header(cells).columns;
    return columns.radius && Columns::complete(columns.start);
}

}  // namespace coppice
