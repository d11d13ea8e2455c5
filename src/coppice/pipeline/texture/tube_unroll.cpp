#include "coppice/pipeline/texture/tube_unroll_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace coppice::pipeline_internal {
namespace {

// Places per width of a piece of bark coordinates, along it.
constexpr double kPlacesPerWidth = 4;
constexpr double kMaxPlaces = 1 << 16;
// Maximum ratio of lengths on the surface and in the chart, both ways.
constexpr double kMaxStretch = 2.5;
// Ratio of widths within a chart at which it is cut.
constexpr double kMaxTaper = 2;

// Interval of real numbers.
struct Range {
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    void extend(double x) {
        min = std::min(min, x);
        max = std::max(max, x);
    }
    double size() const { return max - min; }
};

// Returns the edges of the parallelogram that represents a face of `count` corners; `at` returns one.
template <class At>
auto find_frame(std::size_t count, const At& at) {
    if (count == 4) return std::array{at(1) - at(0) + (at(2) - at(3)), at(3) - at(0) + (at(2) - at(1))};
    return std::array{at(count / 3) - at(0), at(2 * count / 3) - at(0)};
}

}  // namespace

double TubeUnroll::mean_v(std::uint32_t face) const {
    double sum = 0;
    const IndexRange corners = faces_.corners(face);
    for (std::size_t c = corners.begin; c < corners.end; ++c) sum += double{bark(c).v};
    return sum / static_cast<double>(corners.size());
}

TubeUnroll::Sums TubeUnroll::sums(std::uint32_t face) const {
    const IndexRange corners = faces_.corners(face);
    const double area = 0.5 * double{length(doubled_area_normal(faces_, face))};
    const TexturePoint a = bark(corners.begin);
    double texture_area = 0;
    for (std::size_t c = corners.begin + 1; c + 1 < corners.end; ++c) {
        const TexturePoint b = bark(c), d = bark(c + 1);
        texture_area +=
            0.5 * ((double{b.u} - a.u) * (double{d.v} - a.v) - (double{d.u} - a.u) * (double{b.v} - a.v));
    }
    if (!(texture_area > 0 && area > 0)) return {};
    return {mean_v(face) * area, area, texture_area};
}

// Returns the mean width at places along a piece, at least one.
std::vector<TubeUnroll::Place> TubeUnroll::find_places(const Chart& piece) const {
    Range u, v;
    for (const std::uint32_t f : piece) {
        for (std::size_t c = faces_.corners(f).begin; c < faces_.corners(f).end; ++c) {
            u.extend(bark(c).u);
            v.extend(bark(c).v);
        }
    }
    const double count = std::floor(std::min(kPlacesPerWidth * v.size() / u.size(), kMaxPlaces)) + 1;
    std::vector<Sums> at(static_cast<std::size_t>(count > 0 ? count : 1));
    for (const std::uint32_t f : piece) {
        const double share = v.size() > 0 ? (mean_v(f) - v.min) / v.size() : 0;
        const auto i = static_cast<std::size_t>(share * static_cast<double>(at.size()));
        const Sums own = sums(f);
        Sums& all = at[std::min(i, at.size() - 1)];
        all = {all.v + own.v, all.area + own.area, all.texture_area + own.texture_area};
    }
    std::vector<Place> out;
    for (const Sums& s : at) {
        if (!(s.area > 0)) continue;
        Place place{s.v / s.area, std::sqrt(s.area / s.texture_area), 0};
        if (!out.empty()) {
            const Place& last = out.back();
            place.length = last.length + 0.5 * (place.width + last.width) * (place.v - last.v);
        }
        out.push_back(place);
    }
    if (out.empty()) out.push_back({v.min, 1, 0});
    return out;
}

// Returns the v at which a piece of some width is cut.
std::vector<double> TubeUnroll::find_cuts(const std::vector<Place>& places, double range) const {
    const double length = places.back().length;
    const double part = length / std::ceil(std::max(length / double{max_length_}, 1.0)) * (1 + 1e-9);
    std::vector<double> out;
    double begin = 0;
    Range width;
    for (const Place& p : places) {
        width.extend(p.width);
        const bool tapers = width.max > kMaxTaper * width.min && p.length - begin > 2 * width.max * range;
        if (p.length - begin <= part && !tapers) continue;
        out.push_back(p.v);
        begin = p.length;
        width = {};
        width.extend(p.width);
    }
    return out;
}

// Returns whether lengths are kept within the maximum ratio, and the face is not turned over.
bool TubeUnroll::is_good(std::uint32_t face, std::span<const PlanePoint> points) const {
    const auto [a, b] = find_frame(points.size(), [&](std::size_t k) { return faces_.position(face, k); });
    const auto [p, q] = find_frame(points.size(), [&](std::size_t k) {
        return Vec3{points[k].x, points[k].y, 0};
    });
    // The map in an orthonormal frame of the face, in which a = (ax, 0) and b = (bx, by).
    const double ax{length(a)}, bx = double{dot(a, b)} / ax, by = double{length(cross(a, b))} / ax;
    const double xx = double{p.x} / ax, yx = double{p.y} / ax;
    const double xy = (double{q.x} - bx * xx) / by, yy = (double{q.y} - bx * yx) / by;
    const double det = xx * yy - xy * yx, sum = xx * xx + xy * xy + yx * yx + yy * yy;
    if (!(det > 0 && std::isfinite(sum))) return false;
    const double max = std::sqrt(0.5 * (sum + std::sqrt(std::max(sum * sum - 4 * det * det, 0.0))));
    return max <= kMaxStretch && det / max >= 1 / kMaxStretch;
}

UnrolledTube TubeUnroll::run(const Chart& piece, std::span<PlanePoint> points) const {
    const std::vector<Place> places = find_places(piece);
    Range u;
    for (const std::uint32_t f : piece) {
        for (std::size_t c = faces_.corners(f).begin; c < faces_.corners(f).end; ++c) u.extend(bark(c).u);
    }
    const double middle = 0.5 * (u.min + u.max);
    const auto flatten = [&](TexturePoint t) {
        const double v{t.v};
        const auto next = std::ranges::upper_bound(places, v, {}, &Place::v);
        const Place& low = next == places.begin() ? *next : *(next - 1);
        const Place& high = next == places.end() ? low : *next;
        const double share = high.v > low.v ? (v - low.v) / (high.v - low.v) : 0;
        const double width = low.width + (high.width - low.width) * share;
        const double y = low.length + 0.5 * (low.width + width) * (v - low.v);
        return PlanePoint{static_cast<float>((double{t.u} - middle) * width), static_cast<float>(y)};
    };
    const std::vector<double> cuts = find_cuts(places, u.size());
    UnrolledTube out;
    out.charts.resize(cuts.size() + 1);
    for (const std::uint32_t f : piece) {
        const IndexRange corners = faces_.corners(f);
        for (std::size_t c = corners.begin; c < corners.end; ++c) points[c] = flatten(bark(c));
        if (!is_good(f, faces_.values(points, f))) {
            out.left.push_back(f);
            continue;
        }
        const auto part = std::ranges::upper_bound(cuts, mean_v(f)) - cuts.begin();
        out.charts[static_cast<std::size_t>(part)].push_back(f);
    }
    if (out.left.empty() && cuts.empty()) return out;
    std::vector<Chart> connected;
    for (const Chart& chart : out.charts)
        std::ranges::move(find_connected_parts(faces_, chart, std::span<const PlanePoint>(points)),
                          std::back_inserter(connected));
    out.charts = std::move(connected);
    return out;
}

}  // namespace coppice::pipeline_internal
