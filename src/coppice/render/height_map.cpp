#include "coppice/render/height_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

using Color = std::array<double, 3>;

// Increasingly light, so that the map is also readable in grey.
constexpr std::array<Color, 5> kSteps{
    {{26, 28, 94}, {36, 96, 168}, {58, 158, 140}, {178, 206, 84}, {252, 240, 176}}};
constexpr Color kNoNumber{128, 128, 128}, kDark{16, 16, 24}, kWhite{255, 255, 255};
constexpr double kFine = 0.6, kBroad = 1.6;  // [pixels] half the width of lines
constexpr double kFineShare = 0.55;          // opacity of a fine line

Color mixed(const Color& a, const Color& b, double t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Color compute_color(double t) {
    if (!std::isfinite(t)) return kNoNumber;
    const double at = std::clamp(t, 0.0, 1.0) * (kSteps.size() - 1);
    const auto step = std::min(static_cast<std::size_t>(at), kSteps.size() - 2);
    return mixed(kSteps[step], kSteps[step + 1], at - static_cast<double>(step));
}

void cover(Image::Pixel& pixel, const Color& color, double share) {
    for (std::size_t c = 0; c < 3; ++c) {
        const double v = pixel[c] + share * (color[c] - pixel[c]);
        pixel[c] = static_cast<std::uint8_t>(std::lround(v));
    }
}

/// Returns the fraction of a pixel within `half` of a point `distance` away, with a rim of one pixel.
double coverage(double distance, double half) { return std::clamp(half + 0.5 - distance, 0.0, 1.0); }

class Map {
  public:
    Map(std::span<const double> values, int width)
        : values_(values), width_(width), height_(static_cast<int>(values.size()) / width) {}

    int height() const { return height_; }
    double at(int x, int y) const {
        return values_[static_cast<std::size_t>(std::clamp(y, 0, height_ - 1)) *
                           static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(std::clamp(x, 0, width_ - 1))];
    }

    /// The minimum and maximum value of the pixels around one.
    struct Range {
        double low, high;
        bool passes(double level) const { return low < level && level <= high; }
    };
    Range around(int x, int y) const {
        constexpr int kReach = 2;
        Range range{at(x, y), at(x, y)};
        for (int dy = -kReach; dy <= kReach; ++dy) {
            for (int dx = -kReach; dx <= kReach; ++dx) {
                range.low = std::min(range.low, at(x + dx, y + dy));
                range.high = std::max(range.high, at(x + dx, y + dy));
            }
        }
        return range;
    }

    /// [pixels] Returns the distance to the isoline of `level`, to first order; some adjacent pixel is on its
    /// other side.
    double distance(int x, int y, double level) const {
        const double v = at(x, y) - level;
        const double gx = slope(at(x - 1, y), at(x, y), at(x + 1, y));
        const double gy = slope(at(x, y - 1), at(x, y), at(x, y + 1));
        return std::abs(v) / std::max(std::hypot(gx, gy), 1e-300);
    }

  private:
    /// The steeper side, so that steps are drawn as lines too.
    static double slope(double before, double here, double after) {
        return std::max(std::abs(here - before), std::abs(after - here));
    }

    std::span<const double> values_;
    int width_, height_;
};

}  // namespace

namespace {

void paint(const Map& map, int x, int y, const HeightMapOptions& options, Image::Pixel& pixel) {
    const Color c = compute_color((map.at(x, y) - options.low) / (options.high - options.low));
    for (std::size_t i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(std::lround(c[i]));
    pixel[3] = 255;
    const Map::Range around = map.around(x, y);
    for (const double level : options.isolines) {
        if (around.passes(level))
            cover(pixel, kDark, kFineShare * coverage(map.distance(x, y, level), kFine));
    }
    for (const double level : options.outlines) {
        if (around.passes(level)) cover(pixel, kWhite, coverage(map.distance(x, y, level), kBroad));
    }
}

}  // namespace

Image height_map(std::span<const double> values, int width, const HeightMapOptions& options,
                 const Context& ctx) {
    COPPICE_ASSERT(width > 0 && values.size() % static_cast<std::size_t>(width) == 0);
    constexpr std::size_t kRows = 8;
    const Map map(values, width);
    Image image(width, map.height());
    parallel_for(ctx, static_cast<std::size_t>(map.height()), kRows, [&](std::size_t row) {
        if (ctx.stop.stop_requested()) return;
        const int y = static_cast<int>(row);
        for (int x = 0; x < width; ++x) paint(map, x, y, options, image.at(x, y));
    });
    ctx.throw_if_cancelled();
    return image;
}

void draw_dot(Image& image, double x, double y, double radius) {
    const auto clamped = [](double v, int most) { return static_cast<int>(std::clamp<double>(v, 0, most)); };
    const int left = clamped(std::floor(x - radius - 2), image.width),
              right = clamped(std::ceil(x + radius + 2), image.width),
              top = clamped(std::floor(y - radius - 2), image.height),
              bottom = clamped(std::ceil(y + radius + 2), image.height);
    for (int py = top; py < bottom; ++py) {
        for (int px = left; px < right; ++px) {
            const double d = std::hypot(px + 0.5 - x, py + 0.5 - y);
            cover(image.at(px, py), kDark, coverage(d, radius + 1));
            cover(image.at(px, py), kWhite, coverage(d, radius));
        }
    }
}

}  // namespace coppice
