#include "coppice/extract/prior/radii_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/extract/prior/isotonic_internal.h"

namespace coppice::extract_internal {
namespace {

// Exponent of the radius relative to the base as a function of the length beyond: 0.3 to 0.5 on models of
// scanned trees of many species.
constexpr double kUsualExponent = 0.42, kExponentError = 0.1;
constexpr double kMinExponent = 0.3, kMaxExponent = 1;
constexpr double kHeightPerRadius = 85, kFootError = 0.5;  // prior of the radius at the base; its error
constexpr double kOfFoot = 0.8;     // minimum share of the tree beyond a node that belongs to the base
constexpr double kKindError = 0.2;  // error of the exponent that a class of branches shows
constexpr double kError = 0.5;      // error of the logarithm of a radius
constexpr double kSeen = 4;         // minimum precision of a measured radius
// [error] deviation above the prior at which half of the measurements are not branches
constexpr double kTooThick = 1.5;
constexpr double kConvincing = 40;       // number of points about a node that form a tube hardly by chance
constexpr double kMinDeviation = 0.015;  // minimum error of the logarithm of any radius, caused by bark
constexpr double kNineOfTen = 1.645;     // [standard deviation] 90 % interval

/// Returns the length [m] of the branches beyond every node, including its own radius.
std::vector<double> length_beyond(const InitialTree& tree) {
    std::vector<double> beyond(tree.radius.begin(), tree.radius.end()), sum(tree.size(), 0);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        beyond[n] += sum[n];
        if (const std::uint32_t q = tree.parent[n]; q != kNoIndex)
            sum[q] += sum[n] + distance(tree.position[n], tree.position[q]);
    }
    return beyond;
}

/// Returns the distance [m] from every node to the farthest tip beyond it.
std::vector<double> farthest_beyond(const InitialTree& tree) {
    std::vector<double> far(tree.size(), 0);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        if (const std::uint32_t q = tree.parent[n]; q != kNoIndex)
            far[q] = std::max(far[q], far[n] + distance(tree.position[n], tree.position[q]));
    }
    return far;
}

/// Returns the precision of a measured radius, reduced if it is far above the prior and supported by few
/// points.
double doubted(const NodeEvidence& e, double errors_above) {
    const double seen = e.precision(), z = std::max(0.0, errors_above);
    if (e.fixed || !(seen > 0)) return seen;
    const double doubt = 0.5 * (z * z - kTooThick * kTooThick) - (1 - e.filled()) * e.points / kConvincing;
    return seen / (1 + std::exp(doubt));
}

/// Computes the shares and the radii at the bases.
Allometry measure_base_radii(const InitialTree& tree, std::span<const NodeEvidence> evidence) {
    const std::vector<double> beyond = length_beyond(tree), far = farthest_beyond(tree);
    std::vector<std::uint32_t> root(tree.size());
    std::vector<double> value(tree.size(), 0), weight(tree.size(), 0);
    Allometry out{std::vector<double>(tree.size()), std::vector<double>(tree.size())};
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t r = root[n] = tree.parent[n] == kNoIndex ? n : root[tree.parent[n]];
        if (r == n) {
            weight[n] = 1 / (kFootError * kFootError);
            value[n] = weight[n] * std::log(std::max(far[n] / kHeightPerRadius, 1e-3 * tree.radius[n]));
        }
        out.log_share[n] = std::log(beyond[n] / beyond[r]);
        if (beyond[n] < kOfFoot * beyond[r]) continue;
        if (!(evidence[n].precision() > 0)) continue;
        const double usual = std::log(far[r] / kHeightPerRadius);
        const double seen = doubted(evidence[n], (std::log(evidence[n].radius) - usual) / kFootError);
        weight[r] += seen;
        value[r] += seen * std::log(evidence[n].radius);
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n) out.log_base_radius[n] = value[root[n]] / weight[root[n]];
    return out;
}

/// Cross-sections of trees as a function of the distance from the root.
class CrossSections {
  public:
    CrossSections(const InitialTree& tree, std::span<const double> log_radius)
        : way_(tree.size(), 0), root_(tree.size()), far_(tree.size(), 0), area_(tree.size()) {
        for (std::uint32_t n = 0; n < tree.size(); ++n) {
            const std::uint32_t q = tree.parent[n];
            root_[n] = q == kNoIndex ? n : root_[q];
            if (q != kNoIndex) way_[n] = way_[q] + distance(tree.position[n], tree.position[q]);
            far_[root_[n]] = std::max(far_[root_[n]], way_[n]);
        }
        for (std::uint32_t n = 0; n < tree.size(); ++n) {
            if (tree.parent[n] == kNoIndex) continue;
            std::vector<double>& area = area_[root_[n]];
            area.resize(kSteps, 0);
            const double from = step(n, way_[tree.parent[n]]), to = step(n, way_[n]);
            for (auto k = static_cast<std::size_t>(from); k < kSteps && static_cast<double>(k) < to; ++k) {
                const auto low = static_cast<double>(k);
                area[k] += (std::min(to, low + 1) - std::max(from, low)) * std::exp(2 * log_radius[n]);
            }
        }
    }

    /// Returns the total cross-section of all branches as far from the root as node n, relative to the
    /// largest one in the lowest eighth of its tree.
    double over_base(std::uint32_t n) const {
        const std::vector<double>& area = area_[root_[n]];
        if (area.empty()) return 1;
        const double base = *std::max_element(area.begin(), area.begin() + kSteps / 8);
        return area[std::min(kSteps - 1, static_cast<std::size_t>(step(n, way_[n])))] / base;
    }

  private:
    static constexpr std::size_t kSteps = 64;  // number of steps along the longest path of a tree

    double step(std::uint32_t n, double way) const {
        const double far = far_[root_[n]];
        return far > 0 ? static_cast<double>(kSteps) * way / far : 0;
    }

    std::vector<double> way_;  // [m] distance from the root
    std::vector<std::uint32_t> root_;
    std::vector<double> far_;                // [m] per root
    std::vector<std::vector<double>> area_;  // [m2 / pi] per root and step
};

/// Reduces logarithms of radii to the maximum that measured stems can support, except fixed ones.
std::vector<char> limit_to_stems(const InitialTree& tree, double area_limit,
                                 std::vector<double>& log_radius) {
    std::vector<char> limited(tree.size(), 0);
    if (!(area_limit > 0)) return limited;
    const CrossSections sections(tree, log_radius);
    std::vector<char> on_stem(tree.size(), 0);  // per node: whether its root was measured
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t q = tree.parent[n];
        on_stem[n] = q == kNoIndex ? tree.fixed[n] : on_stem[q];
        if (!on_stem[n] || tree.fixed[n] || q == kNoIndex) continue;
        const double over = sections.over_base(n) / area_limit;
        limited[n] = over > 1;
        if (limited[n]) log_radius[n] -= 0.5 * std::log(over);
        log_radius[n] = std::min(log_radius[n], log_radius[q]);
    }
    return limited;
}

/// Class of branches with a similar share of their tree beyond.
struct Kind {
    struct Section {
        double log_radius;  ///< relative to the base; -infinity if it was not measured
        double length;      ///< [m]
    };
    std::vector<Section> sections;
    double log_share = 0, length = 0;  ///< sums

    /// Returns the median radius, weighted by length; -infinity if half of the length was not measured.
    double median_log_radius() {
        std::ranges::sort(sections, {}, &Section::log_radius);
        double sum = 0;
        for (const Section& p : sections) {
            sum += p.length;
            if (2 * sum >= length) return p.log_radius;
        }
        return -std::numeric_limits<double>::infinity();
    }

    /// Returns the weight of the median in [0, 1]: 0 if half of the length was not measured, 1 if all was.
    double median_weight() const {
        double seen = 0;
        for (const Section& p : sections)
            if (std::isfinite(p.log_radius)) seen += p.length;
        return std::max(0.0, 2 * seen / length - 1);
    }
};

std::vector<Kind> collect_kinds(const InitialTree& tree, std::span<const NodeEvidence> evidence,
                                const Allometry& allometry) {
    std::vector<Kind> kinds;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNoIndex) continue;
        const auto k = static_cast<std::size_t>(std::max(0.0, -allometry.log_share[n]));
        if (k >= kinds.size()) kinds.resize(k + 1);
        const double length = distance(tree.position[n], tree.position[tree.parent[n]]);
        const double off = evidence[n].precision() >= kSeen
                               ? std::log(evidence[n].radius) - allometry.log_base_radius[n]
                               : -std::numeric_limits<double>::infinity();
        kinds[k].sections.push_back({off, length});
        kinds[k].log_share += length * allometry.log_share[n];
        kinds[k].length += length;
    }
    return kinds;
}

}  // namespace

Allometry fit_allometry(const InitialTree& tree, std::span<const NodeEvidence> evidence) {
    Allometry out = measure_base_radii(tree, evidence);
    double xx = 1 / (kExponentError * kExponentError), xy = xx * kUsualExponent;
    for (Kind& kind : collect_kinds(tree, evidence, out)) {
        const double y = kind.median_log_radius();
        if (!std::isfinite(y) || !(kind.length > 0)) continue;
        const double x = kind.log_share / kind.length, error = kKindError * std::max(1.0, -x);
        const double weight = kind.median_weight() / (error * error);
        xx += weight * x * x;
        xy += weight * x * y;
    }
    out.exponent = std::clamp(xy / xx, kMinExponent, kMaxExponent);
    return out;
}

RadiusEstimate believe_radii(InitialTree& tree, std::span<const NodeEvidence> evidence, double area_limit) {
    const Allometry allometry = fit_allometry(tree, evidence);
    const double prior = 1 / (kError * kError);
    std::vector<double> value(tree.size()), weight(tree.size());
    RadiusEstimate out{std::vector<double>(tree.size()),
                       std::vector<double>(tree.size()),
                       std::vector<double>(tree.size()),
                       {}};
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const double usual = allometry.log_radius(n);
        const double off = evidence[n].precision() > 0 ? std::log(evidence[n].radius) - usual : 0;
        const double seen = doubted(evidence[n], off / kError);
        weight[n] = seen + prior;
        value[n] = usual + seen / weight[n] * off;
        out.measured[n] = seen / weight[n];
    }
    value = isotonic_on_tree(tree.parent, value, weight);
    out.limited = limit_to_stems(tree, area_limit, value);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (out.limited[n]) {
            weight[n] = prior;
            out.measured[n] = 0;
        }
        const double factor = std::exp(kNineOfTen * std::max(1 / std::sqrt(weight[n]), kMinDeviation));
        tree.radius[n] = std::exp(value[n]);
        out.low[n] = tree.radius[n] / factor;
        out.high[n] = tree.radius[n] * factor;
    }
    return out;
}

}  // namespace coppice::extract_internal
