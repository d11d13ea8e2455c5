#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_points/read_internal.h"
#include "coppice/system/file_progress.h"

namespace coppice::io_internal {
namespace {

enum class PcdData { ascii, binary, compressed };

struct PcdField {
    std::string name;
    std::size_t size = 4, count = 1;
    char type = 'F';
    std::size_t offset = 0;  ///< [bytes] offset in a row
    std::size_t column = 0;  ///< index of its first value in a line of text
};

struct PcdHeader {
    std::vector<PcdField> fields;
    std::uint64_t points = 0;
    std::size_t row = 0;    ///< [bytes] size of a point
    std::size_t cells = 0;  ///< number of values in a line of text
    PcdData data = PcdData::ascii;
    std::size_t begin = 0;  ///< offset of the data
    std::uint32_t lines = 0;
    std::array<std::size_t, 3> axis{};  ///< the fields x, y and z
};

constexpr std::size_t kMaxFields = 1000, kMaxCount = 100'000;

class HeaderReader {
  public:
    HeaderReader(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {}

    PcdHeader read() {
        LineReader lines(bytes_);
        while (lines.next()) {
            line_ = lines.number();
            split_at_blanks(lines.line(), cells_);
            if (cells_.empty() || cells_[0].starts_with('#')) continue;
            const std::string key = plain_name(cells_[0]);
            cells_.erase(cells_.begin());
            if (key == "data") {
                take_data();
                header_.begin = bytes_.size() - lines.remaining();
                header_.lines = line_;
                finish();
                return std::move(header_);
            }
            take(key);
        }
        throw InvalidInput(
            fmt::format("{}: the file ends within its PCD header: there is no line DATA", source_));
    }

  private:
    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, line_, text); }

    std::uint64_t whole(std::string_view cell, std::uint64_t most) const {
        const auto value = parse_integer(cell);
        if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > most) {
            fail(fmt::format("{} is not a whole number up to {}", in_quotes(cell), most));
        }
        return static_cast<std::uint64_t>(*value);
    }

    void take(const std::string& key) {
        constexpr std::uint64_t kMax = std::uint64_t{1} << 40;
        if (key == "fields" || key == "columns") {
            if (cells_.size() > kMaxFields) fail(fmt::format("there are more than {} fields", kMaxFields));
            header_.fields.resize(cells_.size());
            for (std::size_t i = 0; i < cells_.size(); ++i) header_.fields[i].name = plain_name(cells_[i]);
        } else if (key == "size" || key == "count" || key == "type") {
            if (cells_.size() != header_.fields.size())
                fail(fmt::format("it has {} values for {} fields", cells_.size(), header_.fields.size()));
            for (std::size_t i = 0; i < cells_.size(); ++i) take_of_field(key, cells_[i], header_.fields[i]);
        } else if (key == "width" || key == "height" || key == "points") {
            if (cells_.empty()) fail("a number is missing");
            const std::uint64_t value = whole(cells_[0], kMax);
            (key == "width" ? width_ : key == "height" ? height_ : points_) = value;
        }
    }

    void take_of_field(const std::string& key, std::string_view cell, PcdField& field) const {
        if (key == "type") {
            if (cell != "F" && cell != "I" && cell != "U")
                fail(fmt::format("{} is not a field type", in_quotes(cell)));
            field.type = cell[0];
        } else if (key == "size") {
            field.size = whole(cell, 8);
            if (!std::has_single_bit(field.size))
                fail(fmt::format("{} is not a field size", in_quotes(cell)));
        } else {
            field.count = whole(cell, kMaxCount);
        }
    }

    void take_data() {
        const std::string kind = cells_.empty() ? "" : plain_name(cells_[0]);
        if (kind == "ascii") {
            header_.data = PcdData::ascii;
        } else if (kind == "binary") {
            header_.data = PcdData::binary;
        } else if (kind == "binarycompressed") {
            header_.data = PcdData::compressed;
        } else {
            fail("DATA must be ascii, binary or binary_compressed");
        }
    }

    void finish() {
        if (points_) {
            header_.points = *points_;
        } else if (width_) {
            const std::uint64_t height = height_.value_or(1);
            if (height > 0 && *width_ > (std::uint64_t{1} << 40) / height)
                fail("WIDTH times HEIGHT is too large");
            header_.points = *width_ * height;
        }
        std::array<bool, 3> found{};
        for (std::size_t i = 0; i < header_.fields.size(); ++i) {
            PcdField& field = header_.fields[i];
            field.offset = header_.row;
            field.column = header_.cells;
            header_.row += field.size * field.count;
            header_.cells += field.count;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (field.name != std::string(1, static_cast<char>('x' + axis)) || field.count == 0) continue;
                found[axis] = true;
                header_.axis[axis] = i;
                if (field.type == 'F' && field.size < 4)
                    fail("the size of the coordinates is not that of a number");
            }
        }
        if (!found[0] || !found[1] || !found[2])
            throw InvalidInput(fmt::format("{}: the points lack a field x, y or z", source_));
    }

    std::string_view bytes_;
    const std::string& source_;
    std::uint32_t line_ = 0;
    std::vector<std::string_view> cells_;
    std::optional<std::uint64_t> width_, height_, points_;
    PcdHeader header_;
};

/// Returns a little-endian number of a field.
double read_value(const PcdField& field, const char* at) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < field.size; ++i) {
        bits |= std::uint64_t{static_cast<std::uint8_t>(at[i])} << (8 * i);
    }
    if (field.type == 'F') {
        return field.size == 8 ? std::bit_cast<double>(bits)
                               : double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
    }
    if (field.type == 'U') return static_cast<double>(bits);
    const std::size_t unused = 64 - 8 * field.size;
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
}

/// Adds a point unless its coordinates are not numbers, which marks pixels without echo.
void add_point(std::vector<Vec3d>& points, Vec3d p, const std::string& source, std::uint64_t i) {
    if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) return;
    if (!fits_points(p))
        throw InvalidInput(fmt::format("{}: point {} is not finite or beyond 1e30", source, i));
    points.push_back(p);
}

std::vector<Vec3d> read_ascii(std::string_view bytes, const PcdHeader& h, const std::string& source,
                              const Context& ctx) {
    std::vector<Vec3d> points;
    LineReader lines(bytes.substr(h.begin), ctx);
    std::vector<std::string_view> cells;
    for (std::uint64_t i = 0; i < h.points;) {
        if (!lines.next()) {
            throw InvalidInput(
                fmt::format("{}: the file is cut off: its header specifies {} points, but it contains {}",
                            source, h.points, i));
        }
        split_at_blanks(lines.line(), cells);
        if (cells.empty()) continue;
        const std::uint32_t line = h.lines + lines.number();
        if (cells.size() < h.cells)
            fail_at(source, line,
                    fmt::format("it has {} values, but the fields need {}", cells.size(), h.cells));
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view cell = cells[h.fields[h.axis[static_cast<std::size_t>(axis)]].column];
            const auto number = parse_number(cell);
            if (!number) fail_at(source, line, fmt::format("{} is not a number", in_quotes(cell)));
            p[axis] = *number;
        }
        add_point(points, p, source, i++);
    }
    return points;
}

/// `stride` is the number of bytes between values of a field; the values of each field begin at its `start`.
std::vector<Vec3d> read_rows(std::string_view data, const PcdHeader& h, bool by_field,
                             const std::string& source, const Context& ctx) {
    std::vector<Vec3d> points;
    points.reserve(h.points);
    FileProgress progress(ctx, h.points);
    for (std::uint64_t i = 0; i < h.points; ++i) {
        progress.at(i);
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            const PcdField& field = h.fields[h.axis[static_cast<std::size_t>(axis)]];
            const std::uint64_t at =
                by_field ? field.offset * h.points + i * field.size * field.count : i * h.row + field.offset;
            p[axis] = read_value(field, data.data() + at);
        }
        add_point(points, p, source, i);
    }
    return points;
}

/// Decompresses binary_compressed: literal runs, and copies of previous output. Returns an empty text if the
/// data are damaged.
std::string expand(std::string_view packed, std::size_t size) {
    std::string out;
    out.reserve(size);
    for (std::size_t i = 0; i < packed.size();) {
        const auto control = static_cast<std::uint8_t>(packed[i++]);
        if (control < 32) {
            const std::size_t run = control + std::size_t{1};
            if (run > packed.size() - i || run > size - out.size()) return {};
            out.append(packed.substr(i, run));
            i += run;
            continue;
        }
        std::size_t length = control >> 5;
        if (length == 7) {
            if (i == packed.size()) return {};
            length += static_cast<std::uint8_t>(packed[i++]);
        }
        length += 2;
        if (i == packed.size()) return {};
        const std::size_t back =
            (std::size_t{control} & 31) * 256 + static_cast<std::uint8_t>(packed[i++]) + 1;
        if (back > out.size() || length > size - out.size()) return {};
        for (std::size_t k = 0; k < length; ++k) out.push_back(out[out.size() - back]);
    }
    return out.size() == size ? out : std::string();
}

std::vector<Vec3d> read_compressed(std::string_view data, const PcdHeader& h, const std::string& source,
                                   const Context& ctx) {
    const auto size_at = [&](std::size_t at) {
        std::uint32_t size = 0;
        for (std::size_t i = 0; i < 4; ++i)
            size |= std::uint32_t{static_cast<std::uint8_t>(data[at + i])} << (8 * i);
        return size;
    };
    const std::string damaged = fmt::format("{}: its compressed points are cut off or damaged", source);
    if (data.size() < 8) throw InvalidInput(damaged);
    const std::uint64_t packed = size_at(0), whole = size_at(4);
    // Three bytes encode at most 264.
    if (packed > data.size() - 8 || whole / 88 > packed || h.row == 0 || h.points > whole / h.row)
        throw InvalidInput(damaged);
    const std::string rows = expand(data.substr(8, packed), whole);
    if (rows.size() < h.points * h.row) throw InvalidInput(damaged);
    return read_rows(rows, h, true, source, ctx);
}

std::vector<Vec3d> read_binary(std::string_view data, const PcdHeader& h, const std::string& source,
                               const Context& ctx) {
    if (h.row == 0 || h.points > data.size() / h.row) {
        throw InvalidInput(
            fmt::format("{}: the file is cut off: its header specifies {} points, but it contains {}", source,
                        h.points, h.row == 0 ? 0 : data.size() / h.row));
    }
    return read_rows(data, h, false, source, ctx);
}

}  // namespace

bool is_pcd(std::string_view bytes) {
    return bytes.starts_with("# .PCD") || bytes.starts_with("VERSION .") || bytes.starts_with("VERSION 0.");
}

std::vector<Vec3d> parse_pcd(std::string_view bytes, const std::string& source, const Context& ctx) {
    const PcdHeader header = HeaderReader(bytes, source).read();
    const std::string_view data = bytes.substr(header.begin);
    return header.data == PcdData::ascii    ? read_ascii(bytes, header, source, ctx)
           : header.data == PcdData::binary ? read_binary(data, header, source, ctx)
                                            : read_compressed(data, header, source, ctx);
}

}  // namespace coppice::io_internal
