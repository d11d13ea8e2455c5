#include "coppice/implicit/shape/skin.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/implicit/shape/path_internal.h"

namespace coppice {
namespace {

constexpr double kOnePlace = 1e-6;  // [fraction] maximum distance of sections at one place
constexpr std::size_t kMaxSections = 10000;

void check_sections(std::span<const SkinSection> sections) {
    if (sections.empty() || sections.size() > kMaxSections)
        throw InvalidInput(
            fmt::format("skin: needs 1 to {} sections, but has {}", kMaxSections, sections.size()));
    for (std::size_t i = 0; i < sections.size(); ++i) {
        if (!(sections[i].fraction >= 0 && sections[i].fraction <= 1))
            throw InvalidInput(fmt::format(
                "skin: section {} must be at a fraction of the path between 0 and 1, but is at {}", i + 1,
                sections[i].fraction));
        if (!sections[i].profile.closed())
            throw InvalidInput(fmt::format("skin: section {} is open; close its profile", i + 1));
    }
}

/// Weight of the second of two sections at u in [0, 1], and its derivative.
struct Share {
    double value, slope;
};

Share quadratic_share(double u) {
    return u < 0.5 ? Share{2 * u * u, 4 * u} : Share{1 - 2 * (1 - u) * (1 - u), 4 * (1 - u)};
}

/// Three sections of the B-spline over a, a, a, b, b, b.
Share cubic_share(double u) {
    const double v = 3 * u;
    if (v < 1) return {v * v * v / 6, 1.5 * v * v};
    if (v > 2) return {1 - (3 - v) * (3 - v) * (3 - v) / 6, 1.5 * (3 - v) * (3 - v)};
    const double w = v - 1;
    return {1.0 / 6 + w / 2 + w * w / 2 - w * w * w / 3, 3 * (0.5 + w - w * w)};
}

}  // namespace

/// The stations that contribute at a place, with their weights and the derivatives of the weights by the
/// fraction.
struct Skin::Weights {
    struct One {
        std::size_t station;
        double weight, slope;
    };
    std::array<One, 4> of{};
    std::size_t count = 0;

    void add(std::size_t station, double weight, double slope) {
        for (std::size_t i = 0; i < count; ++i) {
            if (of[i].station != station) continue;
            of[i].weight += weight;
            of[i].slope += slope;
            return;
        }
        of[count++] = {station, weight, slope};
    }
};

Skin::Skin(Curve path, std::vector<SkinSection> sections, const SkinOptions& options)
    : path_(std::move(path)), sections_(std::move(sections)), options_(options) {
    check_fields(options, "skin");
    const PathTurn turn{options.roll, options.twist};
    check_path(path_, turn, "skin");
    check_sections(sections_);
    // The end of a closed path is its start.
    for (SkinSection& s : sections_)
        if (path_.closed() && s.fraction > 1 - kOnePlace) s.fraction = 0;
    std::stable_sort(sections_.begin(), sections_.end(),
                     [](const SkinSection& a, const SkinSection& b) { return a.fraction < b.fraction; });
    Vec2d low = sections_[0].profile.low(), high = sections_[0].profile.high();
    double most = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
        if (station_fraction_.empty() || sections_[i].fraction - station_fraction_.back() > kOnePlace) {
            station_fraction_.push_back(sections_[i].fraction);
            station_first_.push_back(i);
        }
        const Profile& p = sections_[i].profile;
        low = {std::min(low.x, p.low().x), std::min(low.y, p.low().y)};
        high = {std::max(high.x, p.high().x), std::max(high.y, p.high().y)};
        most = std::max(most, p.reach());
    }
    station_first_.push_back(sections_.size());

    // Some weights of `smooth` are negative; their absolute values add up to less than 1.6.
    const double swing = options.blend == SkinBlend::smooth ? 1.6 : 1.0;
    reach_ = swing * most;
    // A blend of fields may be inside where no section is, but only within `reach` of the path.
    const bool may_swell = options.blend == SkinBlend::smooth && station_count() > 2;
    if (may_swell) low = {-reach_, -reach_}, high = {reach_, reach_};
    bounds_ = swept_bounds(path_, turn, low, high, [](double) { return 1.0; });
}

Skin::Weights Skin::weights(double fraction) const {
    const auto& at = station_fraction_;
    const std::size_t n = at.size();
    Weights w;
    auto next = static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), fraction) - at.begin());
    const bool wraps = path_.closed() && n > 1, outside = next == 0 || next == n;
    if (n == 1 || (outside && !wraps)) {
        w.add(next == 0 ? 0 : n - 1, 1, 0);
        return w;
    }
    // Stations by index, cyclic on a closed path: place(-1) is the last one, a turn earlier.
    const auto station = [&](std::ptrdiff_t i) {
        const auto m = static_cast<std::ptrdiff_t>(n);
        return wraps ? static_cast<std::size_t>((i + m) % m)
                     : static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, m - 1));
    };
    const auto place = [&](std::ptrdiff_t i) {
        const auto m = static_cast<std::ptrdiff_t>(n);
        return at[station(i)] + (!wraps ? 0.0 : i < 0 ? -1.0 : i >= m ? 1.0 : 0.0);
    };
    const auto j = static_cast<std::ptrdiff_t>(next), i = j - 1;
    const double width = place(j) - place(i), u = (fraction - place(i)) / width;
    if (options_.blend != SkinBlend::smooth) {
        const Share s = options_.blend == SkinBlend::linear      ? Share{u, 1}
                        : options_.blend == SkinBlend::quadratic ? quadratic_share(u)
                                                                 : cubic_share(u);
        w.add(station(i), 1 - s.value, -s.slope / width);
        w.add(station(j), s.value, s.slope / width);
        return w;
    }
    // Cubic Hermite interpolation; the tangent at a station is the slope between its neighbours.
    const double v = 1 - u, rise = u * u * (3 - 2 * u), rise_slope = 6 * u * v / width;
    w.add(station(i), 1 - rise, -rise_slope);
    w.add(station(j), rise, rise_slope);
    const auto tangent = [&](std::ptrdiff_t k, double factor, double slope) {
        const double scale = width / std::max(place(k + 1) - place(k - 1), kOnePlace);
        w.add(station(k + 1), factor * scale, slope * scale / width);
        w.add(station(k - 1), -factor * scale, -slope * scale / width);
    };
    tangent(i, u * v * v, v * (v - 2 * u));
    tangent(j, -u * u * v, u * (u - 2 * v));
    return w;
}

PlaneSample Skin::station(std::size_t i, Vec2d p) const {
    PlaneSample least = sections_[station_first_[i]].profile.distance(p);
    for (std::size_t k = station_first_[i] + 1; k < station_first_[i + 1]; ++k)
        if (const PlaneSample s = sections_[k].profile.distance(p); s.value < least.value) least = s;
    return least;
}

void Skin::distance(std::span<const Vec3> points, std::span<FieldSample> out) const {
    const auto value = [&](double fraction, Vec2d q) {
        PathSample sum;
        const Weights w = weights(fraction);
        for (std::size_t i = 0; i < w.count; ++i) {
            const auto& [k, weight, slope] = w.of[i];
            if (weight == 0 && slope == 0) continue;
            const PlaneSample s = station(k, q);
            sum.value += weight * s.value;
            sum.gradient = sum.gradient + s.gradient * weight;
            sum.by_fraction += slope * s.value;
        }
        return sum;
    };
    const PathTurn turn{options_.roll, options_.twist};
    for (std::size_t i = 0; i < points.size(); ++i)
        out[i] = sample_along(path_, turn, points[i], reach_, value);
}

void list_fields(SkinOptions& o, FieldList& list) {
    list.add(Field{"blend", "Interpolation between consecutive sections."}, o.blend);
    list.add(
        Field{"roll", "Angle by which the sections are rotated about the path.", Unit::radian, -1e3, 1e3},
        o.roll);
    list.add(Field{"twist", "Additional angle by which they rotate from the path's start to its end.",
                   Unit::radian, -1e3, 1e3},
             o.twist);
}

}  // namespace coppice
