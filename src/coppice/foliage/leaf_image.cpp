#include "coppice/foliage/leaf_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/srgb.h"
#include "coppice/foliage/flat_leaf_internal.h"

namespace coppice {
namespace {

using namespace foliage_internal;

constexpr int kSamples = 3;  // along each side of a pixel

/// Returns 1 at the middle of a line of a half-width, and 0 beyond it.
float draw_line(float distance, float half_width) {
    return std::clamp(1.5f - 1.5f * distance / std::max(half_width, 1e-9f), 0.0f, 1.0f);
}

/// The veins of a blade.
class Veins {
  public:
    explicit Veins(const LeafShape& shape) : shape_(shape), cell_(find_cell(shape)) {
        if (shape.lobes == LeafLobes::palmate) {
            rays_ = find_lobe_angles(shape);
        } else if (shape.lobes == LeafLobes::pinnate) {
            for (int i = 0; i < shape.lobe_count; ++i)
                secondaries_.push_back((static_cast<float>(i) + 0.5f) /
                                       (static_cast<float>(shape.lobe_count) + 0.5f));
        } else {
            for (int i = 0; i < shape.veins; ++i)
                secondaries_.push_back(0.03f + 0.9f * (static_cast<float>(i) + 0.6f) /
                                                   (static_cast<float>(shape.veins) + 0.3f));
        }
    }

    /// Returns how far a point of the blade is a vein, from 0 to 1.
    float compute(const FlatCorner& at) const {
        const float fine = 0.35f * compute_net(at.local);
        return std::max({fine, compute_rays(at), compute_midrib(at), 0.85f * compute_secondaries(at)});
    }

  private:
    static float find_cell(const LeafShape& shape) {
        return shape.length / (5.0f * static_cast<float>(std::clamp(shape.veins, 4, 12)));
    }

    float compute_midrib(const FlatCorner& at) const {
        if (!rays_.empty()) return 0;
        return draw_line(std::abs(at.local.x), shape_.length * (0.012f - 0.009f * at.t));
    }

    float compute_rays(const FlatCorner& at) const {
        const float reach = std::hypot(at.local.x, at.local.y);
        const float angle = std::atan2(std::abs(at.local.x), at.local.y);
        float out = 0;
        for (const float ray : rays_) {
            const float half_width = shape_.length * 0.011f * (1.1f - std::abs(at.s));
            out = std::max(out, draw_line(reach * std::abs(std::sin(angle - ray)), half_width));
        }
        return out;
    }

    float compute_secondaries(const FlatCorner& at) const {
        const float across = std::abs(at.s);
        const float bent = at.t - 0.04f * across * across;
        const float shift = at.s < 0 && shape_.lobes == LeafLobes::none && !secondaries_.empty()
                                ? 0.25f / static_cast<float>(secondaries_.size())
                                : 0;
        float distance = std::numeric_limits<float>::infinity();
        for (const float vein : secondaries_) distance = std::min(distance, std::abs(bent - vein - shift));
        return draw_line(distance * shape_.length * std::sin(shape_.vein_angle),
                         shape_.length * 0.006f * (1 - 0.7f * across));
    }

    /// The borders of cells around one random point per square.
    float compute_net(Point2 p) const {
        const float x = p.x / cell_, y = p.y / cell_;
        float first = 9, second = 9;
        for (int dx = -1; dx <= 1; ++dx) {
            for (int dy = -1; dy <= 1; ++dy) {
                const float cx = std::floor(x) + static_cast<float>(dx);
                const float cy = std::floor(y) + static_cast<float>(dy);
                const auto key = static_cast<std::uint64_t>(static_cast<std::int64_t>(cx) * 4099 +
                                                            static_cast<std::int64_t>(cy));
                const float d = std::hypot(cx + static_cast<float>(random_.uniform(2 * key)) - x,
                                           cy + static_cast<float>(random_.uniform(2 * key + 1)) - y);
                second = std::clamp(d, first, second);
                first = std::min(first, d);
            }
        }
        return draw_line(second - first, 0.16f);
    }

    const LeafShape& shape_;
    float cell_;
    std::vector<float> rays_, secondaries_;
    CounterRandom random_{0x7e15, 0};
};

struct Painter {
    const LeafShape& shape;
    Veins veins;
    Vec3 blade;

    Vec3 compute_color(const FlatCorner& at, LeafPart part) const {
        const Vec3 light = lerp(blade, Vec3{0.93f, 0.93f, 0.7f}, 0.38f);
        if (part == LeafPart::petiole) return lerp(blade, light, 0.7f);
        if (part == LeafPart::needle) return blade;
        return lerp(blade * (0.97f + 0.05f * std::abs(at.s)), light, veins.compute(at));
    }
};

/// The sums of the samples of one pixel.
struct Sum {
    Vec3 color;
    int count = 0;
};

/// Maps pixels to the flat leaf.
struct Raster {
    FlatBox box;
    int width = 0, height = 0;

    Point2 find_point(float x, float y) const {
        return {box.low.x + (box.high.x - box.low.x) * x / static_cast<float>(width),
                box.high.y - (box.high.y - box.low.y) * y / static_cast<float>(height)};
    }
};

Raster make_raster(const FlatBox& box, int size) {
    const float across = box.high.x - box.low.x, along = box.high.y - box.low.y;
    const float scale = static_cast<float>(size) / std::max(across, along);
    const auto count = [&](float extent) {
        return std::clamp(static_cast<int>(std::lround(extent * scale)), 4, size);
    };
    return {box, count(across), count(along)};
}

float cross2(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }

FlatCorner interpolate(const FlatTriangle& t, std::array<float, 3> w) {
    FlatCorner out;
    for (std::size_t k = 0; k < 3; ++k) {
        out.t += w[k] * t[k].t;
        out.s += w[k] * t[k].s;
        out.local = out.local + t[k].local * w[k];
    }
    return out;
}

/// Calls use(sample, corner) for the samples of one row of samples inside of the triangle.
template <class Use>
void visit_samples(const Raster& raster, const FlatTriangle& triangle, int row, const Use& use) {
    const Point2 a = triangle[0].flat, b = triangle[1].flat, c = triangle[2].flat;
    const float y = raster.find_point(0, (static_cast<float>(row) + 0.5f) / kSamples).y;
    if (y < std::min({a.y, b.y, c.y}) || y > std::max({a.y, b.y, c.y})) return;
    const float area = cross2(b - a, c - a);
    if (std::abs(area) < 1e-20f) return;
    const float scale = static_cast<float>(raster.width * kSamples) / (raster.box.high.x - raster.box.low.x);
    const int first = static_cast<int>((std::min({a.x, b.x, c.x}) - raster.box.low.x) * scale) - 1;
    const int last = static_cast<int>((std::max({a.x, b.x, c.x}) - raster.box.low.x) * scale) + 1;
    for (int i = std::max(first, 0); i <= std::min(last, raster.width * kSamples - 1); ++i) {
        const Point2 p{raster.find_point((static_cast<float>(i) + 0.5f) / kSamples, 0).x, y};
        const float wa = cross2(b - p, c - p) / area, wb = cross2(c - p, a - p) / area, wc = 1 - wa - wb;
        if (wa >= 0 && wb >= 0 && wc >= 0) use(i, interpolate(triangle, {wa, wb, wc}));
    }
}

/// Draws a row of pixels.
void draw_row(const Raster& raster, const FlatLeaf& leaf, const Painter& painter, int row, LeafImage& out) {
    std::vector<Sum> sums(static_cast<std::size_t>(raster.width));
    std::vector<Vec3> colors(static_cast<std::size_t>(raster.width * kSamples));
    std::vector<char> is_inside(colors.size());
    for (int sample = 0; sample < kSamples; ++sample) {
        std::ranges::fill(is_inside, 0);
        for (const FlatTriangle& triangle : leaf.triangles) {
            visit_samples(raster, triangle, row * kSamples + sample, [&](int i, const FlatCorner& at) {
                colors[static_cast<std::size_t>(i)] = painter.compute_color(at, triangle.part);
                is_inside[static_cast<std::size_t>(i)] = 1;
            });
        }
        for (std::size_t i = 0; i < colors.size(); ++i) {
            if (is_inside[i] == 0) continue;
            sums[i / kSamples].color += colors[i];
            ++sums[i / kSamples].count;
        }
    }
    const std::size_t first = static_cast<std::size_t>(row) * sums.size();
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Sum& sum = sums[i];
        const Vec3 color = sum.count > 0 ? sum.color / static_cast<float>(sum.count) : painter.blade;
        out.color[first + i] = to_bytes(color);
        out.alpha[first + i] = static_cast<std::uint8_t>(255 * sum.count / (kSamples * kSamples));
    }
}

void check_image(int size, Vec3d color) {
    constexpr int kMinSize = 8, kMaxSize = 4096;
    if (size < kMinSize || size > kMaxSize)
        throw InvalidInput(fmt::format("leaf: the size of the image must be between {} and {}, but is {}",
                                       kMinSize, kMaxSize, size));
    for (int k = 0; k < 3; ++k) {
        if (!(color[k] >= 0 && color[k] <= 1))
            throw InvalidInput(
                fmt::format("leaf: the colour must have three values from 0 to 1, but has {}", color[k]));
    }
}

}  // namespace

LeafImage make_leaf_image(const LeafShape& shape, int size, Vec3d color, const Context& ctx) {
    check_fields(shape, "leaf");
    check_image(size, color);
    const FlatLeaf leaf = make_fine_leaf(shape);
    const Raster raster = make_raster(find_image_box(leaf), size);
    LeafImage out{.width = raster.width, .height = raster.height, .color = {}, .alpha = {}};
    out.color.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    out.alpha.resize(out.color.size());
    const Painter painter{shape, Veins(shape), Vec3(color)};
    parallel_for(ctx, static_cast<std::size_t>(out.height), 8,
                 [&](std::size_t row) { draw_row(raster, leaf, painter, static_cast<int>(row), out); });
    return out;
}

}  // namespace coppice
