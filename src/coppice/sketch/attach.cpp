#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/sketch/branch_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr int kParts = 8;        // of a piece of the parent, that are looked at
constexpr double kCutShort = 6;  // [noise] the more a stroke lacks beyond this, the less that tells

/// Unit, against the way a line begins.
PicturePoint backwards(const Line& line) {
    const std::size_t few = std::min<std::size_t>(line.points.size() - 1, 4);
    const PicturePoint d = line.points.front() - line.points[few];
    const double size = length(d);
    return size > 1e-9 ? d * (1 / size) : line.direction(0) * -1;
}

}  // namespace

Vec3d Axis::at(Place place) const {
    return lerp(positions[place.node], positions[place.node + 1], place.along);
}

double Axis::radius_at(Place place) const {
    return std::lerp(radii[place.node], radii[place.node + 1], place.along);
}

Place place_on(const Axis& parent, std::span<const SketchView> views, std::span<const Stroke> strokes,
               std::span<const Line> lines) {
    const auto cost = [&](Place place) {
        const Vec3d p = parent.at(place);
        double sum = 0;
        for (std::size_t i = 0; i < strokes.size(); ++i) {
            const double noise = std::hypot(lines[i].noise, 3.0);
            const PicturePoint off =
                (project(views[strokes[i].view], p) - lines[i].points.front()) * (1 / noise);
            const PicturePoint back = backwards(lines[i]);
            const double ahead = dot(off, back), beside = cross(off, back);
            const double lack = std::max(ahead / kCutShort, 0.0);
            sum += beside * beside + ahead * ahead / (1 + lack * lack);
        }
        return sum;
    };
    Place best;
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](std::size_t node, double low, double high) {
        for (int part = 0; part <= kParts; ++part) {
            const Place place{node, std::lerp(low, high, 1.0 * part / kParts)};
            if (const double c = cost(place); c < least) least = c, best = place;
        }
    };
    for (std::size_t node = 0; node + 1 < parent.positions.size(); ++node) look(node, 0, 1);
    for (double wide = 1.0 / kParts; wide > 1e-3; wide *= 2.0 / kParts)
        look(best.node, std::max(0.0, best.along - wide), std::min(1.0, best.along + wide));
    return best;
}

}  // namespace coppice::sketch_internal
