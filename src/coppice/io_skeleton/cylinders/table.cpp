#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include "coppice/io/text.h"
#include "coppice/io_skeleton/cylinders/columns_internal.h"
#include "coppice/io_skeleton/cylinders/models_internal.h"
#include "coppice/io_skeleton/cylinders/parents_internal.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

using Cells = std::vector<std::string_view>;

/// Parses a number with a decimal comma, which spreadsheets of many countries write with semicolons as
/// separators.
std::optional<double> parse_with_comma(std::string_view text) {
    std::string copy(text.substr(0, 64));
    std::replace(copy.begin(), copy.end(), ',', '.');
    return parse_number(copy);
}

bool is_name(std::string_view cell) { return !cell.empty() && cell != "NA" && !parse_number(cell); }
bool has_names(const Cells& cells) { return std::ranges::any_of(cells, is_name); }
/// Returns whether the cells are a heading: they contain no number.
bool is_heading(const Cells& cells) {
    const auto is_number = [](std::string_view cell) { return parse_number(cell) || parse_with_comma(cell); };
    return std::ranges::none_of(cells, is_number) && has_names(cells);
}
/// Returns whether the cells are a name and a value, as in a list of properties of a tree.
bool is_property(const Cells& cells) { return cells.size() == 2 && is_name(cells[0]); }

/// Returns the numbers; empty if a cell contains anything else.
std::vector<double> parse_numbers(const Cells& cells) {
    std::vector<double> numbers;
    for (const std::string_view cell : cells) {
        const std::optional<double> number = parse_number(cell);
        if (!number) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

/// A table of cylinders.
struct Table {
    CylinderColumns columns;
    bool has_header = false;
    char separator = ' ';
    std::vector<RawCylinder> cylinders;
    std::vector<double> order, branch;   ///< empty, or one for each cylinder
    std::vector<std::string_view> tree;  ///< empty, or the name of the tree of each cylinder
};

/// Reads the rows of a table.
class RowReader {
  public:
    RowReader(Table& table, const std::string& source) : table_(table), source_(source) {}

    void add(const Cells& cells, std::uint32_t line) {
        cells_ = &cells;
        line_ = line;
        const CylinderColumns& c = table_.columns;
        // R writes the row names as a first column without a name in the header.
        shift_ = table_.has_header && cells.size() == c.width + 1 ? 1 : 0;
        if (table_.separator == ',' && cells.size() > c.width + shift_) {
            fail(
                fmt::format("the row has {} values for {} columns; if these are decimal commas, write "
                            "decimal points, or separate the columns by semicolons",
                            cells.size(), c.width));
        }
        RawCylinder cylinder;
        cylinder.line = line;
        cylinder.id = c.id ? integer(*c.id, "id") : static_cast<std::int64_t>(table_.cylinders.size()) + 1;
        if (c.parent) cylinder.parent = parent(*c.parent);
        cylinder.radius =
            c.radius_unit * (c.radius ? number(*c.radius, "radius") : 0.5 * number(*c.diameter, "diameter"));
        cylinder.start = point(c.start, "start");
        cylinder.end = c.has_end() ? point(c.end, "end")
                                   : cylinder.start + c.length_unit * number(*c.length, "length") *
                                                          normalized(point(c.axis, "axis"), Vec3d{});
        table_.cylinders.push_back(cylinder);
        if (c.order) table_.order.push_back(number_or_none(*c.order));
        if (c.branch) table_.branch.push_back(number_or_none(*c.branch));
        if (c.tree) table_.tree.push_back(cell_or_none(*c.tree));
    }

  private:
    Vec3d point(const CylinderColumns::Point& place, std::string_view name) const {
        return {number(*place[0], name), number(*place[1], name), number(*place[2], name)};
    }

    std::string_view cell(std::size_t column, std::string_view name) const {
        if (column + shift_ >= cells_->size()) {
            fail(fmt::format("the row has {} values, but the {} is column {}", cells_->size(), name,
                             column + shift_ + 1));
        }
        return (*cells_)[column + shift_];
    }

    std::optional<double> parsed(std::string_view text) const {
        const std::optional<double> value = parse_number(text);
        return value || table_.separator == ',' ? value : parse_with_comma(text);
    }

    double number(std::size_t column, std::string_view name) const {
        const std::string_view text = cell(column, name);
        const std::optional<double> value = parsed(text);
        if (!value) fail_cell(text, "number", column, name);
        return *value;
    }

    /// Returns the cell, or an empty text beyond the end of a short row.
    std::string_view cell_or_none(std::size_t column) const {
        return column + shift_ < cells_->size() ? (*cells_)[column + shift_] : std::string_view{};
    }

    double number_or_none(std::size_t column) const {
        return parsed(cell_or_none(column)).value_or(std::numeric_limits<double>::quiet_NaN());
    }

    std::int64_t integer(std::size_t column, std::string_view name) const {
        const std::string_view text = cell(column, name);
        const std::optional<std::int64_t> value = parse_integer(text);
        if (!value) fail_cell(text, "whole number", column, name);
        return *value;
    }

    std::int64_t parent(std::size_t column) const {
        const std::string_view text = cell(column, "parent");
        if (text.empty() || text == "NA" || text == "NaN" || text == "nan") return -1;
        return integer(column, "parent");
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, line_, text); }
    [[noreturn]] void fail_cell(std::string_view text, std::string_view kind, std::size_t column,
                                std::string_view name) const {
        fail(fmt::format("{} is not a {}; column {} should be the {}", in_quotes(text), kind,
                         column + shift_ + 1, name));
    }

    Table& table_;
    const std::string& source_;
    const Cells* cells_ = nullptr;
    std::uint32_t line_ = 0;
    std::size_t shift_ = 0;
};

/// Finds the tables of cylinders in a text that may contain other tables, lists and titles too.
class TextReader {
  public:
    TextReader(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), source_(source) {}

    void read() {
        while (next()) {
            if (in_table_ && is_row()) {
                RowReader(tables_.back(), source_).add(cells_, lines_.number());
            } else if (!begins_table()) {
                pass_over();
            }
            after_gap_ = false;
        }
        if (stray_ > 0 && passed_with_stray_ == 1) refuse_stray();
        if (tables_.empty() && !failure_.empty()) fail_at(source_, failure_line_, failure_);
    }

    std::vector<Table>& tables() { return tables_; }
    std::uint32_t passed() const { return passed_; }  ///< number of lines outside tables of cylinders
    std::uint32_t first_passed() const { return first_passed_; }  ///< the first of these lines

  private:
    bool next() {
        while (lines_.next()) {
            line_ = lines_.line();
            const std::string_view text = trimmed(line_);
            if (!text.empty() && text[0] != '#') return true;
            after_gap_ = true;
        }
        return false;
    }

    /// Splits the line; returns whether it is a row of the current table.
    bool is_row() {
        const Table& table = tables_.back();
        split_cells(line_, table.separator, cells_);
        if (is_heading(cells_) || is_property(cells_)) return false;
        if (table.has_header || cells_.size() == table.columns.width) return true;
        // Without a header, a row of another width begins another table, unless more rows of this table
        // follow.
        if (!after_gap_) {
            stray_ = lines_.number();
            stray_width_ = cells_.size();
        }
        return false;
    }

    /// Begins a table if the line is a header of cylinders, or a row of cylinders without a header.
    bool begins_table() {
        const char separator = separator_of_cells(line_);
        split_cells(line_, separator, cells_);
        Table table{.separator = separator};
        if (has_names(cells_)) {
            table.columns = columns_of_names(cells_);
            table.has_header = true;
            under_title_ = cells_.size() < 3;
            if (const std::string_view missing = table.columns.missing(); !missing.empty()) {
                note_failure(fmt::format(
                    "no column of the header contains {}; see docs/user/formats.md for the names", missing));
                return false;
            }
            tables_.push_back(std::move(table));
        } else {
            const std::vector<double> row = parse_numbers(cells_);
            if (!may_be_headerless(row)) return false;
            table.columns = columns_of_treeqsm(row);
            tables_.push_back(std::move(table));
            RowReader(tables_.back(), source_).add(cells_, lines_.number());
        }
        if (stray_ > 0 && !after_gap_ && !under_title_) refuse_stray();
        in_table_ = true;
        return true;
    }

    /// Without names only the order of TreeQSM is supported; an axis of length one distinguishes it from
    /// other tables.
    bool may_be_headerless(const std::vector<double>& row) {
        const bool is_first = passed_ == 0 && tables_.empty();
        if (!is_first) return (under_title_ || after_gap_ || stray_ > 0) && is_treeqsm_row(row);
        if (row.size() >= kMinHeaderlessColumns && has_unit_axis(row)) return true;
        note_failure(cells_.size() < kMinHeaderlessColumns
                         ? "no header names the columns, and there are too few for TreeQSM's order: radius "
                           "length start(3) axis(3) parent extension"
                         : "no header names the columns, and columns 6 to 8 are not an axis of length 1 as "
                           "in TreeQSM's order");
        return false;
    }

    void pass_over() {
        in_table_ = false;
        if (!has_names(cells_)) under_title_ = false;
        if (passed_++ == 0) first_passed_ = lines_.number();
        if (stray_ > 0) ++passed_with_stray_;
    }

    void note_failure(std::string text) {
        if (!failure_.empty()) return;
        failure_ = std::move(text);
        failure_line_ = lines_.number();
    }

    [[noreturn]] void refuse_stray() const {
        fail_at(source_, stray_,
                fmt::format("the row has {} values, but the rows before it have {}", stray_width_,
                            tables_.front().columns.width));
    }

    LineReader lines_;
    const std::string& source_;
    std::string_view line_;
    Cells cells_;
    std::vector<Table> tables_;
    bool in_table_ = false;     // the previous line was part of the last table
    bool after_gap_ = false;    // empty lines or comments separate that line from this one
    bool under_title_ = false;  // the last skipped line may be the title of a table
    std::uint32_t stray_ = 0;   // line of a row with another width, which ended a table without a header
    std::size_t stray_width_ = 0;
    std::uint32_t passed_with_stray_ = 0;  // number of skipped lines from `stray_` on
    std::uint32_t passed_ = 0, first_passed_ = 0;
    std::string failure_;
    std::uint32_t failure_line_ = 0;
};

/// TreeQSM and aRchi count from 1 and write 0 for "no parent"; SimpleForest counts from 0.
void make_roots_of_zero(std::vector<RawCylinder>& cylinders) {
    if (std::ranges::any_of(cylinders, [](const RawCylinder& c) { return c.id == 0; })) return;
    for (RawCylinder& cylinder : cylinders) {
        if (cylinder.parent == 0) cylinder.parent = -1;
    }
}

/// Numbers trees in order of occurrence.
std::vector<std::uint32_t> numbers_of_trees(const std::vector<std::string_view>& names) {
    std::unordered_map<std::string_view, std::uint32_t> known;
    std::vector<std::uint32_t> out;
    out.reserve(names.size());
    for (const std::string_view name : names)
        out.push_back(known.emplace(name, static_cast<std::uint32_t>(known.size())).first->second);
    return out;
}

/// Returns the trees as an attribute: their names in the table if all are numbers, otherwise numbers from 1.
std::vector<double> values_of_trees(const Table& table, std::span<const std::uint32_t> tree) {
    std::vector<double> values = parse_numbers(table.tree);
    if (values.empty())
        for (const std::uint32_t t : tree) values.push_back(static_cast<double>(t) + 1);
    return values;
}

/// Completes the cylinders of a table: ids, parents and attributes.
RawCylinders completed(Table table, const std::string& source, const Context& ctx) {
    RawCylinders out;
    const std::vector<std::uint32_t> tree = numbers_of_trees(table.tree);
    std::vector<RawCylinder>& cylinders = table.cylinders;
    if (!table.columns.of_nodes) make_roots_of_zero(cylinders);
    if (!tree.empty()) {
        if (!table.columns.id) count_within_trees(cylinders, tree);
        number_across_trees(cylinders, tree, source);
        out.attributes.push_back({std::string(kTreeOfNode), values_of_trees(table, tree)});
    } else if (table.columns.of_nodes) {
        direct_from_base(cylinders);
    }
    if (!table.columns.parent && !cylinders.empty()) {
        join_by_place(cylinders, tree, ctx);
        const auto roots =
            std::ranges::count_if(cylinders, [](const RawCylinder& c) { return c.parent < 0; });
        out.notes.push_back(
            fmt::format("no column specifies the parents of cylinders: each was joined to the closest one at "
                        "its start; {} remain without a parent",
                        roots));
    }
    out.cylinders = std::move(cylinders);
    if (!table.order.empty()) out.attributes.push_back({std::string(kOrderOfNode), std::move(table.order)});
    if (!table.branch.empty()) out.attributes.push_back({std::string(kAxisOfNode), std::move(table.branch)});
    return out;
}

}  // namespace

RawCylinders parse_cylinders(std::string_view text, const std::string& source, int model,
                             const Context& ctx) {
    TextReader reader(text, source, ctx);
    reader.read();
    std::vector<Table>& tables = reader.tables();
    if (tables.empty()) return {};
    Table& chosen = tables[chosen_model(tables.size(), model, source)];
    RawCylinders out = completed(std::move(chosen), source, ctx);
    out.models = tables.size();
    if (reader.passed() > 0) {
        out.notes.push_back(fmt::format("{} lines, from line {} on, contain no cylinders and were skipped",
                                        reader.passed(), reader.first_passed()));
    }
    return out;
}

}  // namespace coppice
