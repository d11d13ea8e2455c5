#include "coppice/extract/stem/tree_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

constexpr double kInCommon = 0.5;  // share of the errors of radii common to all branches
constexpr double kOfCones = 0.03;  // [volume] standard deviation of the approximation by cones
constexpr double kMeasured = 0.5;  // minimum evidence of a measured radius
// Errors of the logarithm of the length in 90 % of simulated scans: of every length, and additional ones for
// inferred branches.
constexpr double kOfLength = 0.03, kMissing = 0.3, kInvented = 0.35;
constexpr double kDiameterOff = 0.05;  // maximum difference between skeleton and points
constexpr double kMinForm = 0.5, kMaxForm = 1.8;
constexpr double kMaxInferred = 0.5;
constexpr double kMinHeight = 2 * kBreastHeight;  // [m] minimum height of a tree with a form

/// Sums over the segments of one tree.
struct Sums {
    double length = 0, volume = 0, inferred = 0, error = 0, squares = 0;
    double inferred_length = 0;  ///< [m] length, weighted by the inferred share of the radius
    double unsupported = 0;      ///< [m] length without points
    double area = 0, samples = 0;

    /// Returns the spacing [m] of the points on the surface; 0 without points.
    double spacing() const { return samples > 0 ? std::sqrt(area / samples) : 0; }
};

void add_segment(Sums& sums, const Segment& s, const NodeConfidence& c) {
    const double a = s.radius_a, b = s.radius_b, l = distance(Vec3d(s.a), Vec3d(s.b));
    const double volume = std::numbers::pi / 3 * l * (a * a + a * b + b * b);
    sums.length += l;
    sums.volume += volume;
    if (double{c.evidence} < kMeasured) sums.inferred += volume;
    sums.inferred_length += l * (1 - double{c.evidence});
    if (c.samples == 0) sums.unsupported += l;
    sums.area += std::numbers::pi * l * (a + b);
    sums.samples += c.samples;
    if (!(c.radius_low > 0) || !(c.radius_high > 0)) return;
    // Twice the standard deviation of the logarithm of the radius.
    const double error = volume * std::log(double{c.radius_high} / double{c.radius_low}) / kNineOfTen;
    sums.error += error;
    sums.squares += error * error;
}

/// Computes bounds as factors, because a volume or length is not negative.
void add_bounds(TreeFigures& t, const Sums& of, double seen_height) {
    if (of.volume > 0) {
        const double error = kNineOfTen * std::sqrt(kInCommon * kInCommon * of.error * of.error + of.squares +
                                                    kOfCones * kOfCones * of.volume * of.volume);
        t.volume_low = of.volume / std::exp(error / of.volume);
        t.volume_high = of.volume * std::exp(error / of.volume);
    }
    if (of.length > 0) {
        const double inferred_length = of.inferred_length / of.length;
        t.length_low = (of.length - of.unsupported) / std::exp(kOfLength + kInvented * inferred_length);
        t.length_high = of.length * std::exp(kOfLength + kMissing * inferred_length);
    }
    if (of.samples > 0) {
        const double margin = height_margin(of.spacing());
        t.height_low = std::max(t.height - margin, 0.0);
        t.height_high = std::max(t.height, seen_height) + margin;
    }
}

/// Returns the form factor of a tall tree from the diameter of the points, or else of the skeleton.
double compute_form(const TreeFigures& t) {
    const double d = t.dbh_of_points > 0 ? t.dbh_of_points : t.dbh;
    if (!(d > 0) || !(t.height > kMinHeight)) return 0;
    const double above = 1 - kBreastHeight / t.height;
    return t.volume * above * above / (0.5 * std::numbers::pi / 4 * d * d * t.height);
}

void add_doubts(TreeFigures& t, bool points_known) {
    if (!(t.height > kMinHeight)) return;
    if (!(t.dbh_of_points > 0)) {
        if (points_known) t.doubts.emplace_back(kNoCircle);
    } else if (std::abs(t.dbh - t.dbh_of_points) > kDiameterOff * t.dbh_of_points) {
        t.doubts.push_back(
            fmt::format("the diameter at breast height is {:.1f} cm, but {:.1f} cm in the points",
                        100 * t.dbh, 100 * t.dbh_of_points));
    }
    if (t.form > 0 && (t.form < kMinForm || t.form > kMaxForm)) {
        t.doubts.push_back(fmt::format(
            "its volume is {:.2g} times the volume that its diameter and height suggest", t.form));
    }
    if (t.inferred > kMaxInferred)
        t.doubts.push_back(fmt::format("{:.0f} % of its volume is inferred", 100 * t.inferred));
}

std::vector<Sums> sums_of_trees(const Skeleton& s, std::span<const NodeConfidence> confidence) {
    std::vector<Sums> sums(s.tree_count());
    std::vector<std::uint32_t> tree_of(s.size(), 0);
    std::uint32_t next = 0;
    for (const NodeId n : nodes(s)) {
        tree_of[n.index()] = s.is_root(n) ? next++ : tree_of[s.parent(n).index()];
        if (s.is_root(n)) continue;
        const NodeConfidence known = confidence.empty() ? NodeConfidence{} : confidence[n.index()];
        add_segment(sums[tree_of[n.index()]], s.segment(n), known);
    }
    return sums;
}

std::vector<TreeFigures> compute_figures(const Skeleton& s, std::span<const NodeConfidence> confidence,
                                         std::optional<std::span<const SeenStem>> stems) {
    const std::vector<StemForm> forms = stem_forms(s);
    const std::vector<Sums> sums = sums_of_trees(s, confidence);
    std::vector<TreeFigures> out;
    for (std::size_t k = 0; k < forms.size(); ++k) {
        const Sums& of = sums[k];
        TreeFigures t;
        t.height = forms[k].height;
        t.dbh = forms[k].breast.diameter;
        t.length = of.length;
        t.volume = of.volume;
        t.inferred = of.volume > 0 ? of.inferred / of.volume : 0;
        double seen_height = 0;
        for (const SeenStem& stem : stems.value_or(std::span<const SeenStem>())) {
            if (distance(stem.foot, forms[k].foot) > 1e-3 * (1 + t.height)) continue;
            t.dbh_of_points = stem.breast.diameter;
            t.dbh_low = stem.breast.low();
            t.dbh_high = stem.breast.high();
            seen_height = stem.height;
        }
        if (!confidence.empty()) add_bounds(t, of, seen_height);
        t.form = compute_form(t);
        add_doubts(t, stems.has_value());
        out.push_back(std::move(t));
    }
    return out;
}

}  // namespace

std::vector<TreeFigures> tree_figures(const Skeleton& s, std::span<const NodeConfidence> confidence,
                                      std::span<const SeenStem> stems) {
    return compute_figures(s, confidence, stems);
}

std::vector<TreeFigures> tree_figures(const Skeleton& s, std::span<const NodeConfidence> confidence) {
    return compute_figures(s, confidence, std::nullopt);
}

}  // namespace coppice
