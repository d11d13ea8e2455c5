#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

constexpr std::size_t kRows = 8;
constexpr int kDirections = 16;
constexpr int kMaxReach = 256;      // [texels]
constexpr float kStepRatio = 1.7f;  // of the distances of successive samples along a direction

int wrapped(int i, int period) {
    const int r = i % period;
    return r < 0 ? r + period : r;
}

/// The heights with a margin on the left and the right, so that loops along rows need no modulo.
class PaddedRows {
  public:
    PaddedRows(std::span<const float> heights, int width, int height, int margin, const Context& ctx)
        : margin_(margin), height_(height), stride_(static_cast<std::size_t>(width + 2 * margin)) {
        values_.resize(stride_ * static_cast<std::size_t>(height));
        parallel_for(ctx, static_cast<std::size_t>(height), kRows, [&](std::size_t row) {
            const float* const from = heights.data() + row * static_cast<std::size_t>(width);
            float* const to = values_.data() + row * stride_;
            for (int i = 0; i < width + 2 * margin; ++i) to[i] = from[wrapped(i - margin, width)];
        });
    }

    /// Returns the texel of column 0 in a row, which may be outside the tile.
    const float* row(int j) const {
        return values_.data() + static_cast<std::size_t>(wrapped(j, height_)) * stride_ + margin_;
    }

  private:
    int margin_, height_;
    std::size_t stride_;
    std::vector<float> values_;
};

struct HorizonStep {
    int columns, rows;       // [texels] down and to the right
    float inverse_distance;  // [1/m]
};

using Horizons = std::array<std::vector<HorizonStep>, kDirections>;

/// Returns the samples of all directions up to `radius` [m].
Horizons make_horizons(float radius, float texel_width, float texel_height) {
    Horizons out;
    const float texel = std::min(texel_width, texel_height);
    for (int k = 0; k < kDirections; ++k) {
        const float angle = 2 * std::numbers::pi_v<float> * (static_cast<float>(k) + 0.5f) / kDirections;
        HorizonStep last{0, 0, 0};
        for (float r = 1.2f; r <= kMaxReach && r * texel <= std::max(radius, 1.2f * texel); r *= kStepRatio) {
            const int columns = static_cast<int>(std::lround(r * texel * std::cos(angle) / texel_width));
            const int rows = static_cast<int>(std::lround(r * texel * std::sin(angle) / texel_height));
            if ((columns == 0 && rows == 0) || (columns == last.columns && rows == last.rows)) continue;
            last = {columns, rows,
                    1 / std::hypot(static_cast<float>(columns) * texel_width,
                                   static_cast<float>(rows) * texel_height)};
            out[static_cast<std::size_t>(k)].push_back(last);
        }
    }
    return out;
}

/// The occlusion of a row: the mean of cos^2 of the elevations of the horizons, which is the visible share of
/// an evenly bright sky [Max1988].
class OcclusionRow {
  public:
    explicit OcclusionRow(std::size_t width) : tangent_(width), sum_(width) {}

    void compute(const PaddedRows& heights, int row, const Horizons& horizons, std::uint8_t* out) {
        const std::size_t width = sum_.size();
        std::ranges::fill(sum_, 0.0f);
        const float* const own = heights.row(row);
        for (const std::vector<HorizonStep>& direction : horizons) {
            std::ranges::fill(tangent_, 0.0f);
            for (const HorizonStep& step : direction)
                raise(own, heights.row(row + step.rows) + step.columns, step);
            for (std::size_t i = 0; i < width; ++i) sum_[i] += 1 / (1 + tangent_[i] * tangent_[i]);
        }
        for (std::size_t i = 0; i < width; ++i) out[i] = to_byte(sum_[i] / kDirections);
    }

  private:
    void raise(const float* own, const float* other, const HorizonStep& step) {
        float* const tangent = tangent_.data();
        const std::size_t width = tangent_.size();
        const float scale = step.inverse_distance;
        for (std::size_t i = 0; i < width; ++i)
            tangent[i] = std::max(tangent[i], (other[i] - own[i]) * scale);
    }

    std::vector<float> tangent_, sum_;
};

void compute_normals(const PaddedRows& heights, int row, float texel_width, float texel_height,
                     std::span<BarkMaps::Texel> out) {
    const float *own = heights.row(row), *above = heights.row(row - 1), *below = heights.row(row + 1);
    const float across = 0.5f / texel_width, along = 0.5f / texel_height;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float x = (own[i - 1] - own[i + 1]) * across, y = (below[i] - above[i]) * along;
        const float scale = 0.5f / std::sqrt(x * x + y * y + 1);
        out[i] = {to_byte(0.5f + x * scale), to_byte(0.5f + y * scale), to_byte(0.5f + scale)};
    }
}

void store_heights(BarkCanvas& canvas, const Context& ctx) {
    BarkMaps& maps = canvas.maps;
    const auto [low, high] = std::ranges::minmax_element(canvas.heights);
    maps.low = *low;
    maps.high = *high;
    const float scale = maps.high > maps.low ? 65535 / (maps.high - maps.low) : 0;
    parallel_for(ctx, canvas.heights.size(), std::size_t{1} << 16, [&](std::size_t i) {
        maps.heights[i] =
            static_cast<std::uint16_t>(std::min((canvas.heights[i] - maps.low) * scale + 0.5f, 65535.0f));
    });
}

}  // namespace

void derive_maps(BarkCanvas& canvas, float occlusion_radius, const Context& ctx) {
    BarkMaps& maps = canvas.maps;
    const float texel_width = maps.tile_width / static_cast<float>(maps.width);
    const float texel_height = maps.tile_height / static_cast<float>(maps.height);
    store_heights(canvas, ctx);
    const Horizons horizons = make_horizons(occlusion_radius, texel_width, texel_height);
    int margin = 1;
    for (const auto& direction : horizons)
        for (const HorizonStep& step : direction) margin = std::max(margin, std::abs(step.columns));
    const PaddedRows rows(canvas.heights, maps.width, maps.height, margin, ctx);
    const auto width = static_cast<std::size_t>(maps.width);
    parallel_for_ranges(ctx, static_cast<std::size_t>(maps.height), kRows, [&](IndexRange range) {
        OcclusionRow occlusion(width);
        for (std::size_t row = range.begin; row < range.end; ++row) {
            compute_normals(rows, static_cast<int>(row), texel_width, texel_height,
                            std::span(maps.normal).subspan(row * width, width));
            occlusion.compute(rows, static_cast<int>(row), horizons, maps.occlusion.data() + row * width);
        }
    });
}

}  // namespace coppice::texture_internal
