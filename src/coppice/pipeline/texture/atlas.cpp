#include "coppice/pipeline/texture/atlas_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/texture/atlas_charts_internal.h"
#include "coppice/pipeline/texture/atlas_overlap_internal.h"
#include "coppice/pipeline/texture/atlas_packing_internal.h"
#include "coppice/pipeline/texture/texture_quality_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kChartGrain = 16;
constexpr int kMargin = 2;  // [pixels]
// Share of the side of the square that a chart may be long.
constexpr float kMaxLength = 0.25f;
// Charts that are divided, and rounding, need some space.
constexpr double kFirstScale = 0.99;
constexpr double kScaleStep = 0.97;
// Below this share of the scale without margins, the size of the atlas is too small.
constexpr double kMinScale = 0.1;

// Places the charts of a surface in the unit square.
class AtlasMaker {
  public:
    AtlasMaker(const FaceView& mesh, const Texture& bark, int size, const Context& ctx)
        : mesh_(mesh),
          faces_(mesh),
          ctx_(ctx),
          size_(size),
          margin_(kMargin * ((kAtlasUnits + size - 1) / size)),
          lattice_(faces_.corner_count()) {
        for (std::uint32_t f = 0; f < faces_.size(); ++f) area_ += face_area(f);
        const auto side = static_cast<float>(std::sqrt(area_));
        charts_ = make_charts(faces_, bark.points, kMaxLength * side, ctx);
        out_.texture.report = bark.report;
        out_.texture.report.projected = charts_.projected;
    }

    Atlas run() {
        const std::vector<Upright> first = find_rectangles();
        const double without_margins = find_scale(first, 0);
        for (double scale = kFirstScale * find_scale(first, margin_);; scale *= kScaleStep) {
            if (!(scale > kMinScale * without_margins)) throw_too_small();
            set_lattice(scale);
            const std::vector<Rectangle> boxes = find_lattice_boxes();
            std::vector<Upright> rectangles(boxes.size());
            std::ranges::transform(boxes, rectangles.begin(), [](const Rectangle& b) { return b.upright(); });
            if (const auto places = pack_rectangles(rectangles, margin_)) {
                write(boxes, *places);
                measure();
                return std::move(out_);
            }
        }
    }

  private:
    // Bounds of a chart.
    struct Rectangle {
        double left = std::numeric_limits<double>::infinity(), bottom = left;
        double right = -left, top = -left;

        void extend(double x, double y) {
            left = std::min(left, x);
            bottom = std::min(bottom, y);
            right = std::max(right, x);
            top = std::max(top, y);
        }
        bool is_wide() const { return right - left > top - bottom; }
        Upright upright() const {
            return {std::min(right - left, top - bottom), std::max(right - left, top - bottom)};
        }
    };

    double face_area(std::uint32_t face) const {
        return 0.5 * double{length(doubled_area_normal(faces_, face))};
    }

    [[noreturn]] void throw_too_small() const {
        throw InvalidInput(
            fmt::format("mesh: atlas_size of {} is too small for the {} charts of this surface, which are {} "
                        "pixels apart",
                        size_, charts_.charts.size(), kMargin));
    }

    // Returns the bounds of a chart by the points of the corners of all faces.
    template <class Point>
    Rectangle find_bounds(const Chart& chart, std::span<const Point> points) const {
        Rectangle out;
        for (const std::uint32_t f : chart) {
            for (const Point p : faces_.values(points, f)) out.extend(p.x, p.y);
        }
        return out;
    }

    std::vector<Upright> find_rectangles() const {
        std::vector<Upright> out;
        for (const Chart& chart : charts_.charts)
            out.push_back(find_bounds(chart, std::span<const PlanePoint>(charts_.points)).upright());
        return out;
    }

    std::vector<Rectangle> find_lattice_boxes() const {
        std::vector<Rectangle> out;
        for (const Chart& chart : charts_.charts)
            out.push_back(find_bounds(chart, std::span<const LatticePoint>(lattice_)));
        return out;
    }

    // Rounds a chart to the lattice.
    void round_chart(const Chart& chart, double scale) {
        const Rectangle box = find_bounds(chart, std::span<const PlanePoint>(charts_.points));
        for (const std::uint32_t f : chart) {
            const IndexRange corners = faces_.corners(f);
            for (std::size_t c = corners.begin; c < corners.end; ++c) {
                const PlanePoint p = charts_.points[c];
                lattice_[c] = {static_cast<std::int32_t>(std::lround((double{p.x} - box.left) * scale)),
                               static_cast<std::int32_t>(std::lround((double{p.y} - box.bottom) * scale))};
            }
        }
    }

    // Makes a chart of one face, on its own plane. A face without an area there becomes a regular polygon.
    void round_alone(std::uint32_t face, double scale) {
        flatten_face(faces_, face, charts_.points);
        round_chart({face}, scale);
        const auto points = faces_.values(std::span<LatticePoint>(lattice_), face);
        if (is_convex(points)) return;
        const double n = static_cast<double>(points.size());
        const double radius = std::max(0.25 * kAtlasUnits / size_, n * n);
        for (std::size_t k = 0; k < points.size(); ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / n;
            points[k] = {static_cast<std::int32_t>(std::lround(radius * std::cos(angle))),
                         static_cast<std::int32_t>(std::lround(radius * std::sin(angle)))};
        }
    }

    // Rounds all charts, and divides them where faces overlap or are turned over.
    void set_lattice(double scale) {
        std::vector<SplitChart> split(charts_.charts.size());
        parallel_for(ctx_, split.size(), kChartGrain, [&](std::size_t i) {
            round_chart(charts_.charts[i], scale);
            split[i] = split_chart(faces_, charts_.charts[i], lattice_);
            for (const std::uint32_t f : split[i].rejected) {
                round_alone(f, scale);
                split[i].charts.push_back({f});
            }
        });
        charts_.charts.clear();
        for (SplitChart& s : split)
            charts_.charts.insert(charts_.charts.end(), std::move_iterator(s.charts.begin()),
                                  std::move_iterator(s.charts.end()));
    }

    // Moves the charts to their places, and turns those upright that are wider than high.
    void write(const std::vector<Rectangle>& boxes, const std::vector<LatticePoint>& places) {
        out_.texture.points.resize(lattice_.size());
        const auto to_texture = [](double x) { return static_cast<float>(x / kAtlasUnits); };
        parallel_for(ctx_, boxes.size(), kChartGrain, [&](std::size_t i) {
            const Rectangle& box = boxes[i];
            for (const std::uint32_t f : charts_.charts[i]) {
                const IndexRange corners = faces_.corners(f);
                for (std::size_t c = corners.begin; c < corners.end; ++c) {
                    const LatticePoint p = lattice_[c];
                    const double x = box.is_wide() ? box.top - p.y : p.x - box.left;
                    const double y = box.is_wide() ? p.x - box.left : p.y - box.bottom;
                    out_.texture.points[c] = {to_texture(places[i].x + x), to_texture(places[i].y + y)};
                }
            }
        });
    }

    // The charts have one scale, except for faces without an area.
    void measure() {
        Texture& texture = out_.texture;
        AtlasReport& report = out_.report;
        report.charts = static_cast<std::uint32_t>(charts_.charts.size());
        for (std::uint32_t f = 0; f < faces_.size(); ++f)
            report.used += texture_area(faces_.values(std::span<const TexturePoint>(texture.points), f));
        const double side = std::sqrt(area_ / report.used);  // [m]
        report.pixels_per_metre = size_ / side;
        measure_texture(mesh_, texture.points, {static_cast<float>(side)}, texture.report, ctx_);
    }

    FaceView mesh_;
    AtlasFaces faces_;
    const Context& ctx_;
    int size_;
    std::int32_t margin_;  // [units]
    double area_ = 0;      // [m^2]
    AtlasCharts charts_;
    Buffer<LatticePoint> lattice_;  // per corner
    Atlas out_;
};

}  // namespace

Atlas make_atlas(const FaceView& mesh, const Texture& bark, int size, const Context& ctx) {
    return AtlasMaker(mesh, bark, size, ctx).run();
}

}  // namespace coppice::pipeline_internal
