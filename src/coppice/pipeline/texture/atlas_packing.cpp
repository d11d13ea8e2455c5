#include "coppice/pipeline/texture/atlas_packing_internal.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace coppice::pipeline_internal {
namespace {

constexpr int kScaleSteps = 24;

std::vector<std::uint32_t> sort_by_height(std::span<const Upright> rectangles) {
    std::vector<std::uint32_t> out(rectangles.size());
    std::iota(out.begin(), out.end(), 0u);
    std::ranges::sort(out, [&](std::uint32_t a, std::uint32_t b) {
        const Upright &p = rectangles[a], &q = rectangles[b];
        return std::tie(q.height, q.width, a) < std::tie(p.height, p.width, b);
    });
    return out;
}

// Fills rows with rectangles at a scale, in the given order, and calls place(index, x, y). Returns whether
// all fit.
template <class Place>
bool fill_rows(std::span<const Upright> rectangles, std::span<const std::uint32_t> order, double scale,
               double margin, const Place& place) {
    double x = margin, y = margin, row = 0;
    for (const std::uint32_t i : order) {
        const double width = std::ceil(rectangles[i].width * scale) + margin;
        const double height = std::ceil(rectangles[i].height * scale) + margin;
        if (x + width > kAtlasUnits) {
            x = margin;
            y += row;
            row = 0;
        }
        if (x + width > kAtlasUnits || y + height > kAtlasUnits) return false;
        place(i, x, y);
        x += width;
        row = std::max(row, height);
    }
    return true;
}

}  // namespace

std::optional<std::vector<LatticePoint>> pack_rectangles(std::span<const Upright> rectangles,
                                                         std::int32_t margin) {
    std::vector<LatticePoint> out(rectangles.size());
    const auto place = [&](std::uint32_t i, double x, double y) {
        out[i] = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    };
    if (!fill_rows(rectangles, sort_by_height(rectangles), 1, margin, place)) return {};
    return out;
}

double find_scale(std::span<const Upright> rectangles, std::int32_t margin) {
    const std::vector<std::uint32_t> order = sort_by_height(rectangles);
    const auto fits = [&](double scale) {
        return fill_rows(rectangles, order, scale, margin, [](std::uint32_t, double, double) {});
    };
    double area = 0;
    for (const Upright& r : rectangles) area += r.width * r.height;
    double low = 0, high = kAtlasUnits / std::sqrt(std::max(area, 1e-30));
    for (int step = 0; step < kScaleSteps; ++step) {
        const double middle = 0.5 * (low + high);
        (fits(middle) ? low : high) = middle;
    }
    return low;
}

}  // namespace coppice::pipeline_internal
