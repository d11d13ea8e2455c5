#include <bit>

#include "coppice/base/box.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/points/sampling/point_grid_internal.h"

namespace coppice::points_internal {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 14;

struct Item {
    std::uint64_t key;
    std::uint32_t number;
};

}  // namespace

PointGrid::PointGrid(std::span<const Vec3> points, double edge, const Context& ctx) : per_cell_(1 / edge) {
    const Box3 box = parallel_reduce(
        ctx, points.size(), kGrain, Box3{},
        [&](IndexRange range) {
            Box3 part;
            for (std::size_t i = range.begin; i < range.end; ++i) part.extend(points[i]);
            return part;
        },
        [](Box3 a, const Box3& b) {
            a.extend(b);
            return a;
        });
    if (!points.empty()) {
        low_ = {whole(box.low.x, 0), whole(box.low.y, 0), whole(box.low.z, 0)};
        last_ = cell(box.high, 0);
        x_bits_ = static_cast<unsigned>(std::bit_width(last_[0]));
        y_bits_ = static_cast<unsigned>(std::bit_width(last_[1]));
        z_bits_ = static_cast<unsigned>(std::bit_width(last_[2]));
    }
    sort(points, ctx);
    index_rows();
}

double PointGrid::bytes(double count) {
    // During sorting, the items and their copy; afterwards at most as many rows as points.
    constexpr double kSorting = 2 * sizeof(Item), kSorted = sizeof(Vec3) + 4 + 3 * sizeof(Row);
    return count * std::max(kSorting, kSorted);
}

void PointGrid::sort(std::span<const Vec3> points, const Context& ctx) {
    // Reversed: sorting preserves the order of equal keys, and the last point of a cell precedes.
    Buffer<Item> items(points.size());
    parallel_for(ctx, items.size(), kGrain, [&](std::size_t i) {
        const std::size_t number = points.size() - 1 - i;
        const Cell c = cell(points[number], 0);
        items[i] = {row(c[1], c[2]) << x_bits_ | c[0], static_cast<std::uint32_t>(number)};
    });
    radix_sort(ctx, items, x_bits_ + y_bits_ + z_bits_, [](const Item& item) { return item.key; });
    points_.resize(items.size());
    number_.resize(items.size());
    parallel_for(ctx, items.size(), kGrain, [&](std::size_t i) {
        number_[i] = items[i].number;
        points_[i] = points[items[i].number];
    });
}

void PointGrid::index_rows() {
    const auto find_row = [&](std::uint32_t i) {
        const Cell c = cell(points_[i], 0);
        return row(c[1], c[2]);
    };
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < size(); ++i) count += i == 0 || find_row(i) != find_row(i - 1);
    rows_.assign(std::bit_ceil(count + count / 2 + 1), Row{});
    for (std::uint32_t i = 0; i < size();) {
        Row next{find_row(i), i, i};
        while (next.end < size() && find_row(next.end) == next.key) ++next.end;
        std::size_t at = find_slot(next.key);
        while (rows_[at].key != kFree) at = (at + 1) & (rows_.size() - 1);
        rows_[at] = next;
        i = next.end;
    }
}

std::size_t PointGrid::find_slot(std::uint64_t row) const { return mix_bits(row) & (rows_.size() - 1); }

std::array<std::uint32_t, 2> PointGrid::in_row(std::uint64_t row, std::uint32_t x0, std::uint32_t x1) const {
    std::size_t at = find_slot(row);
    for (; rows_[at].key != row; at = (at + 1) & (rows_.size() - 1)) {
        if (rows_[at].key == kFree) return {0, 0};
    }
    const auto begin = points_.begin() + rows_[at].first, end = points_.begin() + rows_[at].end;
    const auto from = std::partition_point(begin, end, [&](Vec3 p) { return along(0, p.x, 0) < x0; });
    const auto to = std::partition_point(from, end, [&](Vec3 p) { return along(0, p.x, 0) <= x1; });
    return {static_cast<std::uint32_t>(from - points_.begin()),
            static_cast<std::uint32_t>(to - points_.begin())};
}

}  // namespace coppice::points_internal
