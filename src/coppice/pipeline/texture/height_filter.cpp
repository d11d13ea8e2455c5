#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/pipeline/texture/height_filter_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr double kFullHeight = 65535;

// Returns x minus a multiple of the period, in [0, period).
double wrap(double x, double period) {
    const double inside = x - std::floor(x / period) * period;
    return inside < period ? inside : 0.0;
}

}  // namespace

HeightFilter::HeightFilter(const HeightTexture& texture)
    : width_(static_cast<std::size_t>(std::max(texture.width, 0))),
      height_(static_cast<std::size_t>(std::max(texture.height, 0))) {
    if (width_ == 0 || height_ == 0 || texture.heights.size() != width_ * height_)
        throw InvalidInput("a height texture needs pixels, with one height for each");
    sums_.assign((width_ + 1) * (height_ + 1), 0);
    for (std::size_t y = 0; y < height_; ++y) {
        const std::uint16_t* const row = &texture.heights[(height_ - 1 - y) * width_];
        std::uint64_t sum = 0;
        for (std::size_t x = 0; x < width_; ++x) {
            sum += row[x];
            sums_[(y + 1) * (width_ + 1) + x + 1] = sums_[y * (width_ + 1) + x + 1] + sum;
        }
    }
    const auto pixels = static_cast<double>(width_ * height_);
    mean_ = static_cast<double>(sums_.back()) / (pixels * kFullHeight);
    const auto [low, high] = std::ranges::minmax(texture.heights);
    amplitude_ = std::max(mean_ - low / kFullHeight, high / kFullHeight - mean_);
}

// Returns the sum over the pixels from 0 to x and y, both within the tile, in part at the edges.
double HeightFilter::integral_in_tile(double x, double y) const {
    const auto i = std::min(static_cast<std::size_t>(x), width_ - 1);
    const auto j = std::min(static_cast<std::size_t>(y), height_ - 1);
    const double s = x - static_cast<double>(i), t = y - static_cast<double>(j);
    const std::uint64_t* const below = &sums_[j * (width_ + 1) + i];
    const std::uint64_t* const above = below + width_ + 1;
    return std::lerp(std::lerp(static_cast<double>(below[0]), static_cast<double>(below[1]), s),
                     std::lerp(static_cast<double>(above[0]), static_cast<double>(above[1]), s), t);
}

// The same for any x, y >= 0: the texture repeats.
double HeightFilter::integral(double x, double y) const {
    const auto width = static_cast<double>(width_), height = static_cast<double>(height_);
    const double columns = std::floor(x / width), rows = std::floor(y / height);
    const double in_x = wrap(x, width), in_y = wrap(y, height);
    return columns * rows * static_cast<double>(sums_.back()) + columns * integral_in_tile(width, in_y) +
           rows * integral_in_tile(in_x, height) + integral_in_tile(in_x, in_y);
}

double HeightFilter::mean(TexturePoint center, TexturePoint size) const {
    const auto width = static_cast<double>(width_), height = static_cast<double>(height_);
    const double w = std::max(1.0, double{size.u} * width), h = std::max(1.0, double{size.v} * height);
    const double x = wrap(double{center.u} * width - w / 2, width);
    const double y = wrap(double{center.v} * height - h / 2, height);
    const double sum = integral(x + w, y + h) - integral(x, y + h) - integral(x + w, y) + integral(x, y);
    return sum / (w * h * kFullHeight);
}

}  // namespace coppice::pipeline_internal
