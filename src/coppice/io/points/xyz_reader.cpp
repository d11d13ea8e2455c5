// Points as text: numbers in rows, with or without names of the columns.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io/points/read_internal.h"
#include "coppice/io/text_internal.h"

namespace coppice::io_internal {
namespace {

using Cells = std::vector<std::string_view>;

constexpr std::size_t kNameKinds = 4;

/// What x, y and z are called, the surest names first.
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

/// The columns of x, y and z.
struct XyzColumns {
    std::array<std::size_t, 3> axis{0, 1, 2};
    std::size_t count = 0;  ///< of those with a name; 0 without names
    bool quoted = false;    ///< the names stand in quotes

    std::size_t needed() const { return *std::ranges::max_element(axis) + 1; }

    /// R writes the names of rows as a first column that has no name.
    std::size_t shift(std::size_t cells) const { return quoted && cells == count + 1 ? 1 : 0; }
};

/// None where x, y and z are not among the names.
std::optional<XyzColumns> columns_of(const Cells& names) {
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
    return columns;
}

/// Words, none of which is a number; a damaged number is no word.
bool are_names(const Cells& cells) {
    const auto is_number = [](std::string_view cell) { return parse_number(cell).has_value(); };
    const auto is_word = [](std::string_view cell) {
        const std::string name = plain_name(cell);
        return !name.empty() && name[0] >= 'a' && name[0] <= 'z';
    };
    return cells.size() >= 3 && std::ranges::none_of(cells, is_number) && std::ranges::any_of(cells, is_word);
}

std::string names_in_quotes(const Cells& names) {
    constexpr std::size_t kMost = 12;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ", ", in_quotes(names[i]));
    return text + (names.size() > kMost ? ", ..." : "");
}

class XyzParser {
  public:
    XyzParser(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), source_(source) {}

    std::vector<Vec3d> parse() {
        bool first = true;
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            const std::size_t comment = std::min(line.find('#'), line.find("//"));
            split_row(line.substr(0, comment), cells_);
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
        return std::move(points_);
    }

  private:
    /// CloudCompare writes the names behind //, others behind #; a comment may say anything else.
    void take_comment(std::string_view comment) {
        comment.remove_prefix(std::min(comment.find_first_not_of("#/"), comment.size()));
        split_row(comment, cells_);
        if (const auto columns = columns_of(cells_); columns && are_names(cells_)) columns_ = *columns;
    }

    void take_names(std::string_view line) {
        const auto columns = columns_of(cells_);
        if (!columns) {
            fail(fmt::format("the columns are named {}, but x, y and z are not among them",
                             names_in_quotes(cells_)));
        }
        columns_ = *columns;
        columns_.quoted = trimmed(line).starts_with('"') || trimmed(line).starts_with('\'');
    }

    void add_point() {
        const std::size_t shift = columns_.shift(cells_.size());
        if (cells_.size() < columns_.needed() + shift) {
            if (!parse_number(cells_[0])) fail(fmt::format("{} is not a number", in_quotes(cells_[0])));
            fail(columns_.count == 0
                     ? "a point needs three coordinates"
                     : fmt::format("it has {} values for {} named columns", cells_.size(), columns_.count));
        }
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view cell = cells_[columns_.axis[static_cast<std::size_t>(axis)] + shift];
            const auto number = parse_number(cell);
            if (!number) fail(fmt::format("{} is not a number", in_quotes(cell)));
            p[axis] = *number;
        }
        if (!fits_points(p)) fail("a coordinate is not finite or beyond 1e30");
        points_.push_back(p);
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, lines_.number(), text); }

    LineReader lines_;
    const std::string& source_;
    Cells cells_;
    XyzColumns columns_;
    std::vector<Vec3d> points_;
};

}  // namespace

std::vector<Vec3d> parse_xyz(std::string_view text, const std::string& source, const Context& ctx) {
    return XyzParser(text, source, ctx).parse();
}

}  // namespace coppice::io_internal
