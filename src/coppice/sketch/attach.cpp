#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/sketch/branch_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr double kMaxParts = 1024;  // maximum number of samples per segment of the parent axis
constexpr int kParts = 8;           // number of samples in the segments around the best one
constexpr double kMinNoise = 3;     // [pixels] minimum noise of the start of a stroke
constexpr double kCutShort = 6;     // [noise] gap beyond which a missing beginning of a stroke counts less

/// Returns the unit vector opposite to the initial direction of a line.
PicturePoint backwards(const Line& line) {
    const std::size_t few = std::min<std::size_t>(line.points.size() - 1, 4);
    const PicturePoint d = line.points.front() - line.points[few];
    const double size = length(d);
    return size > 1e-9 ? d * (1 / size) : line.direction(0) * -1;
}

/// Returns whether a line contains the first point of its stroke, drawn from either end.
bool begins(const Stroke& stroke, const Line& line) {
    const int first = line.drawn.front();
    return first == 0 || first + 1 == static_cast<int>(stroke.points.size()) || first < 0;
}

/// Evidence of a stroke for the start of its branch.
struct Start {
    const SketchView* view;
    PicturePoint first, back;  ///< its first point, and the unit vector opposite to its initial direction
    double noise;              ///< [pixels]
    double most;               ///< maximum cost, so that one wrong start does not outweigh a correct one

    double cost(Vec3d p) const {
        const PicturePoint off = (project(*view, p) - first) * (1 / noise);
        const double ahead = dot(off, back), sideways = cross(off, back);
        const double lack = std::max(ahead / kCutShort, 0.0);
        const double off_squared = sideways * sideways + ahead * ahead / (1 + lack * lack);
        return off_squared / (1 + off_squared / most);
    }
};

Start find_start(const SketchView& view, const Stroke& stroke, const Line& line) {
    return {&view, line.points.front(), backwards(line), std::hypot(line.noise, kMinNoise),
            begins(stroke, line) ? kWrong : kShort};
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
    std::vector<Start> starts;
    for (std::size_t i = 0; i < strokes.size(); ++i)
        if (lines[i].points.size() >= 2)
            starts.push_back(find_start(views[strokes[i].view], strokes[i], lines[i]));
    Place best;
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](std::size_t node, double low, double high, int parts) {
        for (int part = 0; part <= parts; ++part) {
            const Place place{node, std::lerp(low, high, 1.0 * part / parts)};
            double sum = 0;
            for (const Start& start : starts) sum += start.cost(parent.at(place));
            if (sum < least) least = sum, best = place;
        }
    };
    for (std::size_t node = 0; node + 1 < parent.positions.size(); ++node) {
        const Vec3d a = parent.positions[node], b = parent.positions[node + 1];
        double parts = 1;
        for (const Start& start : starts)
            parts = std::max(parts,
                             length(project(*start.view, b) - project(*start.view, a)) / (2 * start.noise));
        look(node, 0, 1, static_cast<int>(std::min(parts, kMaxParts)));
    }
    const std::size_t near = best.node, last = parent.positions.size() - 2;
    for (std::size_t node = near - std::min<std::size_t>(near, 1); node <= std::min(near + 1, last); ++node)
        look(node, 0, 1, kParts);
    for (double wide = 1.0 / kParts; wide > 1e-3; wide *= 0.5)
        look(best.node, std::max(0.0, best.along - wide), std::min(1.0, best.along + wide), 4);
    return best;
}

}  // namespace coppice::sketch_internal
