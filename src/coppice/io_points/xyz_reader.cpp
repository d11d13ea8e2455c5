// Points as text: rows of numbers, with or without column names.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_points/read_internal.h"

namespace coppice::io_internal {
namespace {

using Cells = std::vector<std::string_view>;

constexpr std::size_t kNameKinds = 4;

/// Names of x, y and z, most specific first.
bool is_called(const std::string& name, std::size_t axis, std::size_t kind) {
    const std::string letter(1, static_cast<char>('x' + axis)), digit(1, static_cast<char>('0' + axis));
    const auto is_one_of = [&](std::initializer_list<std::string> names) {
        return std::ranges::find(names, name) != names.end();
    };
    switch (kind) {
        case 0:
            return name == letter;
        case 1:
            return is_one_of({letter + "coord", letter + "coordinate", "coord" + letter,
                              "coordinate" + letter, letter + "pos", "pos" + letter, letter + "position",
                              "position" + letter, "point" + letter, letter + "m", "points" + digit});
        case 2:
            return name == (axis == 0 ? "easting" : axis == 1 ? "northing" : "elevation");
        default:
            return axis == 0   ? name == "east"
                   : axis == 1 ? name == "north"
                               : is_one_of({"altitude", "height"});
    }
}

std::optional<std::size_t> column_named(const Cells& names, std::initializer_list<std::string_view> wanted) {
    for (const std::string_view name : wanted) {
        for (std::size_t i = 0; i < names.size(); ++i)
            if (plain_name(names[i]) == name) return i;
    }
    return {};
}

/// Indices of the coordinates and of the other attributes in a row.
struct XyzColumns {
    std::array<std::size_t, 3> axis{0, 1, 2};
    std::optional<std::size_t> classification, intensity, return_number, return_count, tree_id;
    std::optional<std::array<std::size_t, 3>> color;
    std::size_t count = 0;   ///< number of named columns; 0 without names
    bool row_names = false;  ///< R writes row names as a first column without a name

    std::size_t needed() const { return *std::ranges::max_element(axis) + 1; }
    std::size_t shift(std::size_t cells) const { return row_names && cells == count + 1 ? 1 : 0; }
};

/// Returns nullopt if x, y and z are not among the names.
std::optional<XyzColumns> find_columns(const Cells& names) {
    XyzColumns columns{.count = names.size()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::optional<std::size_t> found;
        for (std::size_t kind = 0; kind < kNameKinds && !found; ++kind) {
            for (std::size_t i = 0; i < names.size() && !found; ++i)
                if (is_called(plain_name(names[i]), axis, kind)) found = i;
        }
        if (!found) return {};
        columns.axis[axis] = *found;
    }
    columns.classification =
        column_named(names, {"classification", "scalarclassification", "class", "scalarclass"});
    columns.intensity =
        column_named(names, {"intensity", "scalarintensity", "reflectance", "scalarreflectance"});
    columns.return_number = column_named(names, {"returnnumber"});
    columns.return_count = column_named(names, {"numberofreturns"});
    columns.tree_id = find_tree_ids(std::vector<std::string>(names.begin(), names.end()));
    const auto red = column_named(names, {"r", "red"}), green = column_named(names, {"g", "green"}),
               blue = column_named(names, {"b", "blue"});
    if (red && green && blue) columns.color = {*red, *green, *blue};
    return columns;
}

/// Returns whether the cells are words, none of them a number; a damaged number is not a word.
bool are_names(const Cells& cells) {
    const auto is_number = [](std::string_view cell) { return parse_number(cell).has_value(); };
    const auto is_word = [](std::string_view cell) {
        const std::string name = plain_name(cell);
        return !name.empty() && name[0] >= 'a' && name[0] <= 'z';
    };
    return cells.size() >= 3 && std::ranges::none_of(cells, is_number) && std::ranges::any_of(cells, is_word);
}

std::string names_in_quotes(const Cells& names) {
    constexpr std::size_t kMax = 12;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMax); ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ", ", in_quotes(names[i]));
    return text + (names.size() > kMax ? ", ..." : "");
}

class XyzParser {
  public:
    XyzParser(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), source_(source) {}

    FoundPoints parse() {
        bool first = true;
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            const std::size_t comment = std::min(line.find('#'), line.find("//"));
            const std::string_view row = line.substr(0, comment);
            if (has_decimal_commas(row, 3)) fail(kDecimalCommas);
            split_row(row, cells_);
            if (cells_.empty()) {
                if (first && comment < line.size()) take_comment(line.substr(comment));
                continue;
            }
            if (first && are_names(cells_)) {
                take_names(line);
            } else {
                add_point();
            }
            first = false;
        }
        found_.format = "text";
        return std::move(found_);
    }

  private:
    /// Reads column names from a comment: CloudCompare writes them after //, others after #; comments may
    /// contain any other text too.
    void take_comment(std::string_view comment) {
        comment.remove_prefix(std::min(comment.find_first_not_of("#/"), comment.size()));
        split_row(comment, cells_);
        if (const auto columns = find_columns(cells_); columns && are_names(cells_)) columns_ = *columns;
    }

    void take_names(std::string_view line) {
        const auto columns = find_columns(cells_);
        if (!columns) {
            fail(fmt::format("the columns are named {}, but x, y and z are not among them",
                             names_in_quotes(cells_)));
        }
        columns_ = *columns;
        const std::string_view text = trimmed(line);
        columns_.row_names = text.starts_with('"') || text.starts_with('\'') || rows_count_up();
    }

    /// Returns whether the next three rows have one cell more than there are names and begin with 1, 2 and 3.
    bool rows_count_up() const {
        LineReader ahead = lines_;
        Cells cells;
        for (const std::string_view number : {"1", "2", "3"}) {
            if (!ahead.next()) return number != "1";
            split_row(ahead.line(), cells);
            if (cells.size() != columns_.count + 1 || cells[0] != number) return false;
        }
        return true;
    }

    void add_point() {
        const std::size_t shift = columns_.shift(cells_.size());
        if (cells_.size() < columns_.needed() + shift) {
            if (!parse_number(cells_[0])) fail(fmt::format("{} is not a number", in_quotes(cells_[0])));
            fail(columns_.count == 0
                     ? "a point needs three coordinates"
                     : fmt::format("it has {} values for {} named columns", cells_.size(), columns_.count));
        }
        if (columns_.count > 0 && cells_.size() == 2 * columns_.count && has_only_commas(lines_.line()))
            fail(kDecimalCommas);
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view cell = cells_[columns_.axis[static_cast<std::size_t>(axis)] + shift];
            const auto number = parse_number(cell);
            if (!number) fail(fmt::format("{} is not a number", in_quotes(cell)));
            p[axis] = *number;
        }
        if (!fits_points(p)) fail("a coordinate is not finite or beyond 1e30");
        found_.expect(lines_.remaining(), lines_.line().size());
        found_.places.push_back(p);
        note_columns(shift);
    }

    /// Stores the other attributes of a point; values that are not numbers are unknown.
    void note_columns(std::size_t shift) {
        const auto number = [&](std::size_t column) -> std::optional<double> {
            if (column + shift >= cells_.size()) return {};
            return parse_number(cells_[column + shift]);
        };
        const auto note_byte = [&](std::optional<std::size_t> column, std::vector<std::uint8_t>& to) {
            if (!column) return;
            if (const auto c = number(*column)) found_.note(to, to_byte(*c));
        };
        note_byte(columns_.classification, found_.known.classes);
        note_byte(columns_.return_number, found_.known.return_numbers);
        note_byte(columns_.return_count, found_.known.return_counts);
        if (columns_.intensity) {
            const auto i = number(*columns_.intensity);
            if (i) found_.note(found_.known.intensities, static_cast<float>(*i));
        }
        if (columns_.tree_id) {
            const auto id = number(*columns_.tree_id);  // NA of R means no tree
            found_.note(found_.known.tree_ids, to_tree_id(id.value_or(0)));
        }
        if (!columns_.color) return;
        const auto [r, g, b] = *columns_.color;
        const auto red = number(r), green = number(g), blue = number(b);
        if (!red || !green || !blue) return;
        if (const auto color = to_color(*red, *green, *blue)) found_.note(found_.known.colors, *color);
    }

    [[noreturn]] void fail(std::string_view text) const { fail_at(source_, lines_.number(), text); }

    LineReader lines_;
    const std::string& source_;
    Cells cells_;
    XyzColumns columns_;
    FoundPoints found_;
};

}  // namespace

FoundPoints parse_xyz(std::string_view text, const std::string& source, const Context& ctx) {
    return XyzParser(text, source, ctx).parse();
}

}  // namespace coppice::io_internal
