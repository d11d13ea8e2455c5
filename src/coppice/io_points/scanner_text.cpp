// Text formats of scanner software: PTS and PTX.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_points/read_internal.h"

namespace coppice::io_internal {
namespace {

/// Returns the only number of a line, if it is an integer.
std::optional<std::uint64_t> lone_count(const std::vector<std::string_view>& cells) {
    if (cells.size() != 1) return {};
    const auto number = parse_integer(cells[0]);
    if (!number || *number < 0) return {};
    return static_cast<std::uint64_t>(*number);
}

/// Reads rows of numbers: x y z, then an intensity, then red, green and blue from 0 to 255.
class RowReader {
  public:
    RowReader(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), source_(source) {}

    /// Moves to the next line that is not empty; returns false at the end.
    bool next() {
        while (lines_.next()) {
            split_at_blanks(lines_.line(), cells_);
            if (!cells_.empty()) return true;
        }
        return false;
    }
    const std::vector<std::string_view>& cells() const { return cells_; }

    double number(std::size_t i) const {
        const auto number = parse_number(cells_[i]);
        if (!number) fail(fmt::format("{} is not a number", in_quotes(cells_[i])));
        return *number;
    }
    Vec3d place() const {
        if (cells_.size() < 3) fail("a point needs three coordinates");
        return {number(0), number(1), number(2)};
    }
    /// Adds the point of the current row at `p`.
    void keep(Vec3d p) {
        if (!fits_points(p)) fail("a coordinate is not finite or beyond 1e30");
        found_.expect(lines_.remaining(), lines_.line().size());
        found_.places.push_back(p);
        if (cells_.size() > 3) found_.note(found_.known.intensities, static_cast<float>(number(3)));
        if (cells_.size() > 6) {
            const auto color = to_color(number(4), number(5), number(6));
            if (color) found_.note(found_.known.colors, *color);
        }
    }
    /// Counts a pulse without return.
    void pass_over() { ++found_.without_return; }
    FoundPoints take(std::string_view format) {
        found_.format = format;
        return std::move(found_);
    }
    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, lines_.number(), text); }
    [[noreturn]] void cut_off(std::uint64_t named, std::uint64_t held) const {
        throw InvalidInput(fmt::format("{}: the file is cut off: it specifies {} points, but {} follow",
                                       source_, named, held));
    }

  private:
    LineReader lines_;
    const std::string& source_;
    std::vector<std::string_view> cells_;
    FoundPoints found_;
};

/// The numbers before the points of a scan in PTX.
struct ScanHead {
    std::uint64_t rows = 0;
    std::array<std::array<double, 4>, 4> transform{};  ///< for row vectors: the last row is the translation

    Vec3d world(Vec3d p) const {
        Vec3d out;
        for (int axis = 0; axis < 3; ++axis) {
            const auto column = static_cast<std::size_t>(axis);
            out[axis] = p.x * transform[0][column] + p.y * transform[1][column] + p.z * transform[2][column] +
                        transform[3][column];
        }
        return out;
    }
};

/// Reads the header after its first line, which has the number of columns.
ScanHead read_scan_head(RowReader& rows) {
    constexpr std::uint64_t kMax = std::uint64_t{1} << 31;
    const auto expect = [&](std::size_t count, const char* subject) {
        if (!rows.next() || rows.cells().size() < count)
            rows.fail(fmt::format("{} numbers are missing: {}", count, subject));
    };
    ScanHead head;
    const auto columns = lone_count(rows.cells());
    expect(1, "the number of rows of the scan");
    const auto in_column = lone_count(rows.cells());
    if (!columns || !in_column || *columns > kMax || *in_column > kMax)
        rows.fail("the numbers of columns and of rows of a scan are expected");
    head.rows = *columns * *in_column;
    // The transformation repeats the position and the axes of the scanner.
    for (int line = 0; line < 4; ++line) expect(3, "the position and the axes of the scanner");
    for (auto& row : head.transform) {
        expect(4, "the transformation of the scan");
        for (std::size_t i = 0; i < 4; ++i) {
            row[i] = rows.number(i);
            if (!std::isfinite(row[i])) rows.fail("the transformation is not finite");
        }
    }
    return head;
}

}  // namespace

ScannerText scanner_text(std::string_view text) {
    LineReader lines(text.substr(0, 4096));
    std::vector<std::string_view> cells;
    const auto next = [&] {
        cells.clear();
        while (cells.empty() && lines.next()) split_at_blanks(lines.line(), cells);
        return !cells.empty();
    };
    if (!next() || !lone_count(cells)) return ScannerText::none;
    if (!next()) return ScannerText::none;
    return lone_count(cells) ? ScannerText::ptx : ScannerText::pts;
}

FoundPoints parse_pts(std::string_view text, const std::string& source, const Context& ctx) {
    RowReader rows(text, source, ctx);
    std::uint64_t named = 0, held = 0;
    while (rows.next()) {
        if (const auto count = lone_count(rows.cells())) {
            if (held < named) rows.cut_off(named, held);
            named = *count;
            held = 0;
            continue;
        }
        rows.keep(rows.place());
        ++held;
    }
    if (held < named) rows.cut_off(named, held);
    return rows.take("PTS");
}

FoundPoints parse_ptx(std::string_view text, const std::string& source, const Context& ctx) {
    RowReader rows(text, source, ctx);
    while (rows.next()) {
        const ScanHead head = read_scan_head(rows);
        for (std::uint64_t i = 0; i < head.rows; ++i) {
            if (!rows.next()) rows.cut_off(head.rows, i);
            const Vec3d p = rows.place();
            if (p == Vec3d()) {
                rows.pass_over();
            } else {
                rows.keep(head.world(p));
            }
        }
    }
    return rows.take("PTX");
}

}  // namespace coppice::io_internal
