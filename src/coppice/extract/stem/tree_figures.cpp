#include "coppice/extract/stem/tree_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

constexpr double kInCommon = 0.5;      // of the errors of radii, to all branches
constexpr double kOfCones = 0.03;      // [volume] standard deviation of what cones leave out
constexpr double kMeasured = 0.5;      // evidence of a radius that was measured
constexpr double kDiameterOff = 0.05;  // between skeleton and points
constexpr double kMinForm = 0.5, kMaxForm = 1.8;
constexpr double kMaxInferred = 0.5;
constexpr double kMinHeight = 2 * kBreastHeight;  // [m] of a tree that has a form

/// Sums over the segments of one tree.
struct Sums {
    double length = 0, volume = 0, inferred = 0, error = 0, squares = 0;
};

void add_segment(Sums& sums, const Segment& s, const NodeConfidence& c) {
    const double a = s.radius_a, b = s.radius_b, l = distance(Vec3d(s.a), Vec3d(s.b));
    const double volume = std::numbers::pi / 3 * l * (a * a + a * b + b * b);
    sums.length += l;
    sums.volume += volume;
    if (double{c.evidence} < kMeasured) sums.inferred += volume;
    if (!(c.radius_low > 0) || !(c.radius_high > 0)) return;
    // Twice the standard deviation of the logarithm of the radius.
    const double error = volume * std::log(double{c.radius_high} / double{c.radius_low}) / kNineOfTen;
    sums.error += error;
    sums.squares += error * error;
}

void add_doubts(TreeFigures& t) {
    if (!(t.height > kMinHeight)) return;
    if (!(t.dbh_of_points > 0)) {
        t.doubts.emplace_back(kNoCircle);
    } else if (std::abs(t.dbh - t.dbh_of_points) > kDiameterOff * t.dbh_of_points) {
        t.doubts.push_back(
            fmt::format("the diameter at breast height is {:.1f} cm, but {:.1f} cm in the points",
                        100 * t.dbh, 100 * t.dbh_of_points));
    }
    if (t.form > 0 && (t.form < kMinForm || t.form > kMaxForm)) {
        t.doubts.push_back(
            fmt::format("its volume is {:.2g} times what its diameter and height suggest", t.form));
    }
    if (t.inferred > kMaxInferred)
        t.doubts.push_back(fmt::format("{:.0f} % of its volume is inferred", 100 * t.inferred));
}

}  // namespace

std::vector<TreeFigures> tree_figures(const Skeleton& s, std::span<const NodeConfidence> confidence,
                                      std::span<const SeenStem> stems) {
    const std::vector<StemForm> forms = stem_forms(s);
    std::vector<Sums> sums(forms.size());
    std::vector<std::uint32_t> tree_of(s.size(), 0);
    std::uint32_t next = 0;
    for (const NodeId n : nodes(s)) {
        tree_of[n.index()] = s.is_root(n) ? next++ : tree_of[s.parent(n).index()];
        if (!s.is_root(n)) add_segment(sums[tree_of[n.index()]], s.segment(n), confidence[n.index()]);
    }
    std::vector<TreeFigures> out;
    for (std::size_t k = 0; k < forms.size(); ++k) {
        const Sums& of = sums[k];
        TreeFigures t{.height = forms[k].height,
                      .dbh = forms[k].breast.diameter,
                      .length = of.length,
                      .volume = of.volume};
        for (const SeenStem& stem : stems) {
            if (distance(stem.foot, forms[k].foot) > 1e-3 * (1 + t.height)) continue;
            t.dbh_of_points = stem.breast.diameter;
            t.dbh_low = stem.breast.low();
            t.dbh_high = stem.breast.high();
        }
        const double error = kNineOfTen * std::sqrt(kInCommon * kInCommon * of.error * of.error + of.squares +
                                                    kOfCones * kOfCones * of.volume * of.volume);
        // As a factor up and down: a volume is not negative.
        const double factor = of.volume > 0 ? std::exp(error / of.volume) : 1;
        t.volume_low = of.volume / factor;
        t.volume_high = of.volume * factor;
        t.inferred = of.volume > 0 ? of.inferred / of.volume : 0;
        const double d = t.dbh_of_points > 0 ? t.dbh_of_points : t.dbh;
        if (d > 0 && t.height > kMinHeight) {
            const double above = 1 - kBreastHeight / t.height;
            t.form = of.volume * above * above / (0.5 * std::numbers::pi / 4 * d * d * t.height);
        }
        add_doubts(t);
        out.push_back(std::move(t));
    }
    return out;
}

}  // namespace coppice
