#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/median.h"
#include "coppice/sketch/line_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr std::size_t kMaxPoints = 256;  // maximum number of points of a line; longer ones are resampled
constexpr std::size_t kMinToJudge = 6;   // minimum number of points for the detection of wrong points
constexpr double kWorth = 8, kWorthOfPiece = 0.8;  // [pixels], [median segment] cost of leaving out a point
constexpr double kMinNoise = 0.3, kMaxNoise = 5;   // [pixels]
constexpr double kUnknownNoise = 1;                // [pixels] default if no line has enough points
constexpr std::size_t kMinPieces = 20;             // minimum number of segments of a sketch for statistics
constexpr double kMinSpread = 0.3;                 // minimum spread of hand-drawn segments

void measure(Line& line) {
    line.along.assign(1, 0);
    for (std::size_t i = 1; i < line.points.size(); ++i)
        line.along.push_back(line.along.back() + length(line.points[i] - line.points[i - 1]));
}

/// Returns the distance [pixels] of p from the segment from a to b.
double off_chord(PicturePoint p, PicturePoint a, PicturePoint b) {
    const PicturePoint ab = b - a, ap = p - a;
    const double t = std::clamp(dot(ap, ab) / std::max(dot(ab, ab), 1e-12), 0.0, 1.0);
    return length(ap - ab * t);
}

std::vector<double> offsets(const std::vector<PicturePoint>& points) {
    std::vector<double> out;
    for (std::size_t i = 1; i + 1 < points.size(); ++i)
        out.push_back(off_chord(points[i], points[i - 1], points[i + 1]));
    return out;
}

void erase_point(Line& line, std::size_t i) {
    const auto at = static_cast<std::ptrdiff_t>(i);
    line.points.erase(line.points.begin() + at);
    line.drawn.erase(line.drawn.begin() + at);
    if (!line.widths.empty()) line.widths.erase(line.widths.begin() + at);
}

class Cleaner {
  public:
    explicit Cleaner(Line& line) : line_(line) {}

    void run() {
        take_shortest_way();
        for (const bool front : {true, false})
            if (line_.points.size() >= kMinToJudge && wrong_end(front))
                erase(front ? 0 : line_.points.size() - 1), ++line_.left_out;
    }

  private:
    void erase(std::size_t i) { erase_point(line_, i); }

    /// Removes points, up to three in a row, if this shortens the line by more than their cost: a wrong point
    /// is a detour, a corner hardly is.
    void take_shortest_way() {
        const auto& p = line_.points;
        const double worth = kWorth + kWorthOfPiece * usual_piece();
        std::vector<double> way(p.size(), std::numeric_limits<double>::infinity());
        std::vector<std::size_t> from(p.size(), 0);
        way[0] = 0;
        for (std::size_t i = 1; i < p.size(); ++i) {
            for (std::size_t skipped = 0; skipped <= 3 && skipped < i; ++skipped) {
                const std::size_t before = i - 1 - skipped;
                const double there =
                    way[before] + length(p[i] - p[before]) + worth * static_cast<double>(skipped);
                if (there < way[i]) way[i] = there, from[i] = before;
            }
        }
        for (std::size_t i = p.size() - 1; i > 0;) {
            const std::size_t before = from[i];
            for (std::size_t wrong = i - 1; wrong > before; --wrong) erase(wrong), ++line_.left_out;
            i = before;
        }
    }

    double usual_piece() const {
        std::vector<double> pieces;
        for (std::size_t i = 1; i < line_.points.size(); ++i)
            pieces.push_back(length(line_.points[i] - line_.points[i - 1]));
        return median(pieces);
    }

    /// Returns whether an end is wrong: its segment is long and turns sharply.
    bool wrong_end(bool front) const {
        const auto& p = line_.points;
        const std::size_t n = p.size();
        const auto at = [&](std::size_t i) { return front ? p[i] : p[n - 1 - i]; };
        const PicturePoint last = at(0) - at(1), before = at(1) - at(3);
        const double size = length(last);
        return size > 1.8 * usual_piece() && dot(last, before) < 0.7 * size * length(before);
    }

    Line& line_;
};

std::vector<double> compute_widths(const Stroke& stroke) {
    if (stroke.widths.size() != 2 || stroke.points.size() == 2) return stroke.widths;
    std::vector<double> along(1, 0), out;
    for (std::size_t i = 1; i < stroke.points.size(); ++i)
        along.push_back(along.back() + length(stroke.points[i] - stroke.points[i - 1]));
    for (const double s : along)
        out.push_back(std::lerp(stroke.widths[0], stroke.widths[1], s / std::max(along.back(), 1e-12)));
    return out;
}

Line without_repeats(const SketchView& view, const Stroke& stroke) {
    Line line;
    const std::vector<double> widths = compute_widths(stroke);
    for (std::size_t i = 0; i < stroke.points.size(); ++i) {
        const PicturePoint p = undistorted(view, stroke.points[i]);
        if (!line.points.empty() && length(p - line.points.back()) < 1e-6) continue;
        line.points.push_back(p);
        line.drawn.push_back(static_cast<int>(i));
        if (!widths.empty()) line.widths.push_back(widths[i]);
    }
    return line;
}

void sample_down(Line& line) {
    if (line.points.size() <= kMaxPoints) return;
    Line thin = line;
    thin.points.clear();
    thin.widths.clear();
    thin.drawn.clear();
    for (std::size_t i = 0; i < kMaxPoints; ++i) {
        const double s = line.length() * static_cast<double>(i) / (kMaxPoints - 1);
        thin.points.push_back(line.at(s));
        thin.drawn.push_back(line.drawn[i * (line.drawn.size() - 1) / (kMaxPoints - 1)]);
        if (!line.widths.empty()) thin.widths.push_back(line.width_at(s));
    }
    measure(thin);
    line = std::move(thin);
}

/// Returns the segment that contains s, and the parameter on it.
std::pair<std::size_t, double> find_piece(const Line& line, double s) {
    const auto after = std::upper_bound(line.along.begin() + 1, line.along.end() - 1, s);
    const auto i = static_cast<std::size_t>(after - line.along.begin()) - 1;
    const double size = line.along[i + 1] - line.along[i];
    return {i, std::clamp((s - line.along[i]) / std::max(size, 1e-12), 0.0, 1.0)};
}

/// If each of three points deviates by s, the median distance of the middle one from the chord of the others
/// is about 0.82 s.
double compute_noise(const std::vector<double>& off) {
    return std::clamp(median(off) / 0.82, kMinNoise, kMaxNoise);
}

}  // namespace

PicturePoint Line::at(double s) const {
    const auto [i, t] = find_piece(*this, s);
    return points[i] + (points[i + 1] - points[i]) * t;
}

double Line::width_at(double s) const {
    const auto [i, t] = find_piece(*this, s);
    return std::lerp(widths[i], widths[i + 1], t);
}

PicturePoint Line::direction(double s) const {
    const std::size_t i = find_piece(*this, s).first;
    const PicturePoint d = points[i + 1] - points[i];
    return d * (1 / coppice::length(d));
}

double Line::nearest(PicturePoint p, double low, double high) const {
    double best = low, least = std::numeric_limits<double>::infinity();
    for (std::size_t i = find_piece(*this, low).first; i + 1 < points.size() && along[i] <= high; ++i) {
        const PicturePoint ab = points[i + 1] - points[i];
        const double size = along[i + 1] - along[i];
        const double s = std::clamp(along[i] + dot(p - points[i], ab) / size, std::max(low, along[i]),
                                    std::min(high, along[i + 1]));
        const PicturePoint off = p - points[i] - ab * ((s - along[i]) / size);
        if (const double squared = dot(off, off); squared < least) least = squared, best = s;
    }
    return best;
}

Hand estimate_hand(const Sketch& sketch, double noise) {
    Hand hand;
    std::vector<double> off, pieces, above;
    for (const SketchBranch& branch : sketch.branches) {
        for (const Stroke& stroke : branch.strokes) {
            const Line line = without_repeats(sketch.views[stroke.view], stroke);
            for (std::size_t i = 1; i < line.points.size(); ++i)
                pieces.push_back(length(line.points[i] - line.points[i - 1]));
            if (line.points.size() < kMinToJudge) continue;
            const std::vector<double> own = offsets(line.points);
            off.insert(off.end(), own.begin(), own.end());
        }
    }
    hand.noise = noise > 0 ? noise : off.empty() ? kUnknownNoise : compute_noise(off);
    if (pieces.size() < kMinPieces) return hand;
    hand.piece = median(pieces);
    for (const double piece : pieces)
        if (piece > hand.piece) above.push_back(std::log(piece / hand.piece));
    // The median of the upper half of a normal distribution is 0.674 standard deviations above the mean.
    hand.spread = std::max(above.empty() ? 0 : median(above) / 0.674, kMinSpread);
    return hand;
}

Line make_line(const SketchView& view, const Stroke& stroke, const Hand& hand, double noise, bool clean) {
    Line line = without_repeats(view, stroke);
    if (line.points.size() < 2) return line;
    const bool judged = line.points.size() >= kMinToJudge;
    if (judged && clean) Cleaner(line).run();
    line.noise = noise > 0 ? noise : judged ? compute_noise(offsets(line.points)) : hand.noise;
    measure(line);
    sample_down(line);
    return line;
}

Line line_through(std::vector<PicturePoint> points) {
    Line line;
    const auto same = [](PicturePoint a, PicturePoint b) { return length(a - b) < 1e-6; };
    points.erase(std::unique(points.begin(), points.end(), same), points.end());
    if (points.size() == 1) points.push_back(points.front() + PicturePoint{1e-6, 0});
    line.points = std::move(points);
    line.drawn.assign(line.points.size(), -1);
    measure(line);
    return line;
}

Line with_start(const Line& line, PicturePoint start) {
    Line out = line;
    if (length(start - line.points.front()) < 1e-6)
        start.x += 1e-6;  // coincides with the only remaining point
    out.points.insert(out.points.begin(), start);
    out.drawn.insert(out.drawn.begin(), -1);
    if (!out.widths.empty()) out.widths.insert(out.widths.begin(), out.widths.front());
    measure(out);
    return out;
}

Line with_first(const Line& line, PicturePoint first) {
    if (line.points.size() < 2 || length(line.points[1] - first) < 1e-6) return line;
    Line out = line;
    out.points.front() = first;
    measure(out);
    return out;
}

Line without_point(const Line& line, std::size_t point) {
    Line out = line;
    erase_point(out, point);
    ++out.left_out;
    measure(out);
    return out;
}

Line reversed(const Line& line) {
    Line out = line;
    std::ranges::reverse(out.points);
    std::ranges::reverse(out.widths);
    std::ranges::reverse(out.drawn);
    measure(out);
    return out;
}

}  // namespace coppice::sketch_internal
