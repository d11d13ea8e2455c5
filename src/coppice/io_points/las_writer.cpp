// Writes LAS 1.4 with point format 6, or 7 with colours, and extra dimensions for columns without a LAS
// field.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "coppice/io/item_writer.h"
#include "coppice/io_points/las_internal.h"
#include "coppice/io_points/write_internal.h"

namespace coppice::io_internal {
namespace {

constexpr std::uint8_t kPlainFormat = 6, kColoredFormat = 7;
constexpr std::uint16_t kPlainRecord = 30, kColoredRecord = 36;  // [bytes]

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

void put_text(std::string& bytes, std::size_t at, std::string_view text) {
    bytes.replace(at, text.size(), text);
}

/// Coordinates as integer multiples of a step from an offset.
struct Grid {
    double step = 1e-4;  ///< [m]
    Vec3d offset;

    /// Chooses the smallest step for which 32 bits suffice, at least 0.1 mm; the offset is a whole number of
    /// metres near the centre.
    explicit Grid(const PointSet& points) {
        constexpr double kMax = std::numeric_limits<std::int32_t>::max() - 1;
        const Box3 box = bounds(points);
        if (box.empty()) return;
        const Vec3d low = points.origin + Vec3d(box.low), high = points.origin + Vec3d(box.high);
        double reach = 0;
        for (int axis = 0; axis < 3; ++axis) {
            offset[axis] = std::floor(low[axis] + (high[axis] - low[axis]) / 2);
            reach = std::max({reach, high[axis] - offset[axis], offset[axis] - low[axis]});
        }
        while (reach / step > kMax) step *= 10;
    }
    std::int32_t steps(double coordinate, int axis) const {
        return static_cast<std::int32_t>(std::llround((coordinate - offset[axis]) / step));
    }
};

/// Intensities as 16 bits: integers in range unchanged, others scaled to the full range.
class Intensities {
  public:
    explicit Intensities(std::span<const float> values) : values_(values) {
        const auto fits = [](float v) { return v >= 0 && v <= kMax && v == std::floor(v); };
        if (std::ranges::all_of(values, fits)) return;
        float low = std::numeric_limits<float>::infinity(), high = -low;
        for (const float v : values) {
            if (!std::isfinite(v)) continue;
            low = std::min(low, v);
            high = std::max(high, v);
        }
        low_ = low;
        factor_ = high > low ? kMax / (double{high} - double{low}) : 0;
    }
    std::uint16_t operator[](std::size_t i) const {
        if (values_.empty() || !std::isfinite(values_[i])) return 0;
        return static_cast<std::uint16_t>(std::lround((double{values_[i]} - low_) * factor_));
    }

  private:
    static constexpr float kMax = 65535;
    std::span<const float> values_;
    double low_ = 0, factor_ = 1;
};

/// Calls visit(name, description, values) for every column without a LAS field.
template <class Visitor>
void visit_extra_dimensions(const PointCloud& known, const Visitor& visit) {
    const auto column = [&](std::string_view name, std::string_view description, const auto& values) {
        if (!values.empty()) visit(name, description, values);
    };
    column("tree_id", "0 = of no tree", known.tree_ids);
    column("distance", "from a surface [m]", known.distances);
    column("wood", "1 = on extracted wood", known.wood);
    column("branch_order", "of the closest branch", known.branch_orders);
    column("evidence", "measured share of its radius", known.evidence);
}

constexpr std::uint8_t get_type(std::uint8_t) { return 1; }
constexpr std::uint8_t get_type(std::uint32_t) { return 5; }
constexpr std::uint8_t get_type(float) { return 9; }

/// The extra dimensions: their descriptions in the record, and the extra bytes of a point.
struct Dimensions {
    std::string entries;
    std::size_t bytes = 0;

    explicit Dimensions(const PointCloud& known) {
        visit_extra_dimensions(known,
                               [&](std::string_view name, std::string_view description, const auto& values) {
                                   std::string entry(kDimension, '\0');
                                   put(entry, 2, get_type(values.front()));
                                   put_text(entry, 4, name);
                                   put_text(entry, 160, description);
                                   entries += entry;
                                   bytes += sizeof(values.front());
                               });
    }
};

void append_record(std::string& bytes, std::string_view user, std::uint16_t id, std::string_view data) {
    const std::size_t at = bytes.size();
    bytes.resize(at + kVlrHeader);
    put_text(bytes, at + 2, user);
    put(bytes, at + 18, id);
    put(bytes, at + 20, static_cast<std::uint16_t>(data.size()));
    bytes += data;
}

/// Returns the return number and the number of returns in one byte; 1 of 1 if unknown.
std::uint8_t get_return_byte(const PointCloud& known, std::size_t i) {
    constexpr std::uint8_t kOne = 1, kMax = 15;
    const auto of = [&](const std::vector<std::uint8_t>& column) {
        return column.empty() ? kOne : std::clamp(column[i], kOne, kMax);
    };
    return static_cast<std::uint8_t>(of(known.return_numbers) | of(known.return_counts) << 4);
}

/// Returns everything that precedes the points.
std::string make_header(const PointSet& points, const PointCloud& known, const Dimensions& dimensions,
                        const CoordinateSystem& system, const Grid& grid) {
    const bool colored = !known.colors.empty();
    std::string bytes(kNewLasHeader, '\0');
    put_text(bytes, 0, "LASF");
    put<std::uint16_t>(bytes, 6, system.has_wkt() ? 0x10 : 0);
    put<std::uint8_t>(bytes, 24, 1);
    put<std::uint8_t>(bytes, 25, 4);
    put_text(bytes, 26, "Coppice");
    put_text(bytes, 58, "Coppice");
    put(bytes, 94, static_cast<std::uint16_t>(kNewLasHeader));
    for (const CoordinateSystem::Record& r : system.records)
        append_record(bytes, kLasProjection, r.id, r.data);
    if (dimensions.bytes > 0) append_record(bytes, kLasSpecification, kExtraBytes, dimensions.entries);
    put(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
    put(bytes, 100, static_cast<std::uint32_t>(system.records.size() + (dimensions.bytes > 0 ? 1 : 0)));
    put(bytes, 104, colored ? kColoredFormat : kPlainFormat);
    put(bytes, 105, static_cast<std::uint16_t>((colored ? kColoredRecord : kPlainRecord) + dimensions.bytes));
    const Box3 box = bounds(points);
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t k = 8 * static_cast<std::size_t>(axis);
        const auto on_grid = [&](float place) {
            return grid.steps(points.origin[axis] + double{place}, axis) * grid.step + grid.offset[axis];
        };
        put(bytes, 131 + k, grid.step);
        put(bytes, 155 + k, grid.offset[axis]);
        put(bytes, 179 + 2 * k, on_grid(box.high[axis]));
        put(bytes, 187 + 2 * k, on_grid(box.low[axis]));
    }
    put(bytes, 247, static_cast<std::uint64_t>(points.size()));
    std::array<std::uint64_t, 16> of_return{};
    for (std::size_t i = 0; i < points.size(); ++i) ++of_return[get_return_byte(known, i) & 15u];
    for (std::size_t r = 1; r < of_return.size(); ++r) put(bytes, 247 + 8 * r, of_return[r]);
    return bytes;
}

}  // namespace

void write_las(AtomicFile& file, const PointSet& points, const PointCloud& known,
               const CoordinateSystem& system, const Context& ctx) {
    const Grid grid(points);
    const Intensities intensities(known.intensities);
    const Dimensions dimensions(known);
    file.write(make_header(points, known, dimensions, system, grid));
    write_items(file, points.size(), {}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(kColoredRecord + dimensions.bytes);
        const Vec3d p = points.world(i);
        for (int axis = 0; axis < 3; ++axis) chunk.put_raw(grid.steps(p[axis], axis));
        chunk.put_raw(intensities[i]);
        chunk.put_raw(get_return_byte(known, i));
        chunk.put('\0');  // flags
        chunk.put_raw(known.classes.empty() ? std::uint8_t{0} : known.classes[i]);
        chunk.put_raw(std::array<std::uint8_t, 13>{});  // user data, angle, source, time
        if (!known.colors.empty()) {
            constexpr unsigned kTo16Bits = 257;
            for (const std::uint8_t c : known.colors[i])
                chunk.put_raw(static_cast<std::uint16_t>(kTo16Bits * c));
        }
        visit_extra_dimensions(
            known, [&](std::string_view, std::string_view, const auto& values) { chunk.put_raw(values[i]); });
    });
}

}  // namespace coppice::io_internal
