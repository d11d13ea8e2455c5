#include "coppice/measure/union_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "coppice/base/parallel.h"
#include "coppice/base/random.h"

namespace coppice {
namespace {

constexpr std::size_t kUnionVolumeGrain = 16;
constexpr std::size_t kEstimateGrain = 1024;
constexpr std::uint32_t kFirstRound = 8;  // points in every portion
constexpr int kMaxRounds = 12;

/// A cone consists of a frustum around its axis and the half balls at its ends. Portions of one kind are in
/// the order of their capsules; a point belongs to the first portion that contains it.
enum Kind : std::uint8_t { kFrustum, kStart, kEnd, kBall, kKinds };

struct Portion {
    std::uint32_t capsule = 0;
    Kind kind = kFrustum;
    double volume = 0;         ///< [m^3] without cuts
    std::uint64_t points = 0;  ///< number of sampled points
    std::uint64_t own = 0;     ///< of these, points in the union and in no previous portion
    std::uint64_t marked = 0;  ///< of these, points with a true mark
    std::uint64_t wanted = kFirstRound;

    double share() const {
        // Other points may exist even if the sample contains only one kind (Jeffreys' prior).
        return (static_cast<double>(own) + 0.5) / (static_cast<double>(points) + 1);
    }
    double deviation() const { return volume * std::sqrt(share() * (1 - share())); }
    double estimate(std::uint64_t count) const {
        return points == 0 ? 0 : volume * static_cast<double>(count) / static_cast<double>(points);
    }
};

/// Returns the portion of the cone that contains a point, given its closest point on the axis.
Kind kind_at(const RoundCone& cone, const RoundCone::ClosestPoint& closest) {
    if (length_squared(cone.axis) == 0) return kBall;
    return closest.t <= 0 ? kStart : closest.t >= 1 ? kEnd : kFrustum;
}

double cube(double x) { return x * x * x; }

std::vector<Portion> find_portions(const CapsuleTree& capsules) {
    constexpr double kPi = std::numbers::pi;
    std::vector<Portion> portions;
    portions.reserve(3 * std::size_t{capsules.size()});
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        const RoundCone& c = capsules.cone(i);
        const double a = c.radius_a, b = c.radius_b(), l = length(c.axis);
        if (l == 0) {
            portions.push_back({i, kBall, 4 * kPi / 3 * cube(std::max(a, b))});
            continue;
        }
        portions.push_back({i, kFrustum, kPi * l / 3 * (a * a + a * b + b * b)});
        portions.push_back({i, kStart, 2 * kPi / 3 * cube(a)});
        portions.push_back({i, kEnd, 2 * kPi / 3 * cube(b)});
    }
    return portions;
}

/// Returns two unit vectors perpendicular to u and to each other.
std::array<Vec3d, 2> across(Vec3d u) {
    const Vec3d other = std::fabs(u.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d v = normalized(cross(u, other));
    return {v, cross(u, v)};
}

/// Returns the parameter of a cone at which the volume from its start is the share u of the whole.
double parameter_of_share(const RoundCone& c, double u) {
    const double a = c.radius_a, b = c.radius_b();
    if (std::fabs(b - a) < 1e-5 * (a + b)) return u;
    return std::clamp((std::cbrt(cube(a) + u * (cube(b) - cube(a))) - a) / (b - a), 0.0, 1.0);
}

/// Maps points of the unit cube to points of a portion, evenly by volume.
class PortionMap {
  public:
    PortionMap(const RoundCone& cone, Kind kind) : cone_(cone), kind_(kind) {
        along_ = normalized(cone.axis, {0, 0, 1});
        if (kind == kStart) along_ = -along_;
        side_ = across(along_);
    }

    struct Point {
        Vec3d position;
        double radius;
    };
    Point operator()(double u, double v, double w) const {
        const double turn = 2 * std::numbers::pi * w;
        const Vec3d out = side_[0] * std::cos(turn) + side_[1] * std::sin(turn);
        if (kind_ == kFrustum) {
            const double t = parameter_of_share(cone_, u), r = cone_.radius(t);
            return {cone_.point(t) + out * (r * std::sqrt(v)), r};
        }
        const double r = kind_ == kBall    ? std::max(cone_.radius_a, cone_.radius_b())
                         : kind_ == kStart ? cone_.radius_a
                                           : cone_.radius_b();
        const double height = kind_ == kBall ? 2 * v - 1 : v;
        const Vec3d direction = along_ * height + out * std::sqrt(std::max(0.0, 1 - height * height));
        return {(kind_ == kEnd ? cone_.b() : cone_.a) + direction * (r * std::cbrt(u)), r};
    }

  private:
    const RoundCone& cone_;
    Kind kind_;
    Vec3d along_;
    std::array<Vec3d, 2> side_;
};

/// Returns whether p, in this portion, is in the union and in no previous portion.
bool is_own(const ConeUnion& solid, const Portion& portion, Vec3d p) {
    if (solid.is_cut_off(portion.capsule, p)) return false;
    bool own = true;
    solid.capsules().visit_containing(p, [&](std::uint32_t i, const RoundCone::ClosestPoint& closest) {
        if (i == portion.capsule) return true;
        const Kind kind = kind_at(solid.capsules().cone(i), closest);
        const bool before = kind < portion.kind || (kind == portion.kind && i < portion.capsule);
        own = !before || solid.is_cut_off(i, p);
        return own;
    });
    return own;
}

/// Samples additional points of a portion, up to the requested number.
class Sampler {
  public:
    Sampler(const ConeUnion& solid, const MarkPoint& mark) : solid_(solid), mark_(mark) {}

    void operator()(Portion& portion) const {
        // Powers of the inverse of the solution of x^4 = x + 1: their multiples, modulo 1, fill the cube
        // evenly.
        constexpr double kGolden = 1.2207440846057596;
        constexpr std::array kStep{1 / kGolden, 1 / (kGolden * kGolden), 1 / (kGolden * kGolden * kGolden)};
        const CounterRandom random(0, portion.kind);
        std::array<double, 3> shift;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            shift[axis] = random.uniform(3 * std::uint64_t{portion.capsule} + axis);
        }
        const PortionMap map(solid_.capsules().cone(portion.capsule), portion.kind);
        for (; portion.points < portion.wanted; ++portion.points) {
            std::array<double, 3> x;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                x[axis] = shift[axis] + static_cast<double>(portion.points) * kStep[axis];
                x[axis] -= std::floor(x[axis]);
            }
            const PortionMap::Point p = map(x[0], x[1], x[2]);
            if (!is_own(solid_, portion, p.position)) continue;
            ++portion.own;
            if (mark_ && mark_(portion.capsule, p.position, p.radius)) ++portion.marked;
        }
    }

  private:
    const ConeUnion& solid_;
    const MarkPoint& mark_;
};

struct Sums {
    double volume = 0, deviation = 0, variance = 0;
    std::uint64_t points = 0;
};

Sums compute_sums(std::span<const Portion> portions) {
    Sums s;
    for (const Portion& p : portions) {
        s.volume += p.estimate(p.own);
        s.deviation += p.deviation();
        s.variance += p.deviation() * p.deviation() / static_cast<double>(p.points);
        s.points += p.points;
    }
    return s;
}

/// Increases the numbers of points of the portions, in proportion to their deviations; returns false if there
/// are enough.
bool allocate(std::span<Portion> portions, const Sums& now, const UnionVolumeOptions& options) {
    const double target = options.tolerance * now.volume / 2;  // a standard error
    if (now.variance <= target * target || now.points >= options.max_samples) return false;
    // At most four times the points per round, because the first deviations are rough estimates.
    const double ideal = now.deviation * now.deviation / (target * target);
    const double budget =
        std::min({ideal, 4 * static_cast<double>(now.points), static_cast<double>(options.max_samples)});
    bool more = false;
    for (Portion& p : portions) {
        const double share = p.deviation() / now.deviation * budget;
        p.wanted = std::max(p.points, static_cast<std::uint64_t>(share));
        more = more || p.wanted > p.points;
    }
    return more;
}

}  // namespace

UnionVolume union_volume(const ConeUnion& solid, const UnionVolumeOptions& options, const MarkPoint& mark,
                         const Context& ctx) {
    std::vector<Portion> portions = find_portions(solid.capsules());
    const Sampler sample(solid, mark);
    Sums sums;
    for (int round = 0; round < kMaxRounds; ++round) {
        parallel_for(ctx, portions.size(), kUnionVolumeGrain, [&](std::size_t i) { sample(portions[i]); });
        sums = compute_sums(portions);
        ctx.report(static_cast<float>(round + 1) / kMaxRounds);
        if (!allocate(portions, sums, options)) break;
    }
    UnionVolume out;
    out.of_capsule.assign(solid.capsules().size(), 0.0);
    out.marked.assign(solid.capsules().size(), 0.0);
    for (const Portion& p : portions) {
        out.of_capsule[p.capsule] += p.estimate(p.own);
        out.marked[p.capsule] += p.estimate(p.marked);
    }
    out.total = sums.volume;
    out.error = 2 * std::sqrt(sums.variance);
    out.samples = sums.points;
    return out;
}

VolumeEstimate estimate_union_volume(const ConeUnion& solid, std::uint64_t samples, const Context& ctx) {
    struct Count {
        std::uint64_t points = 0, own = 0;
    };
    using Counts = std::array<Count, kKinds>;
    const std::vector<Portion> portions = find_portions(solid.capsules());
    std::array<double, kKinds> volume{};
    for (const Portion& p : portions) volume[p.kind] += p.volume;
    const double all = std::accumulate(volume.begin(), volume.end(), 0.0);
    if (!(all > 0)) return {};
    // Points first[i] up to first[i + 1] belong to portion i.
    std::vector<std::uint64_t> first(portions.size() + 1, 0);
    double before = 0;
    for (std::size_t i = 0; i < portions.size(); ++i) {
        before += portions[i].volume;
        const std::int64_t end = std::llround(before / all * static_cast<double>(samples));
        first[i + 1] = std::max(first[i], static_cast<std::uint64_t>(end));
    }
    const CounterRandom random(0, kKinds);
    const auto look = [&](IndexRange range) {
        Counts counts;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (first[i] == first[i + 1]) continue;
            const Portion& portion = portions[i];
            const PortionMap map(solid.capsules().cone(portion.capsule), portion.kind);
            for (std::uint64_t k = first[i]; k < first[i + 1]; ++k) {
                const auto p =
                    map(random.uniform(3 * k), random.uniform(3 * k + 1), random.uniform(3 * k + 2));
                ++counts[portion.kind].points;
                counts[portion.kind].own += is_own(solid, portion, p.position) ? 1 : 0;
            }
        }
        return counts;
    };
    const Counts counts =
        parallel_reduce(ctx, portions.size(), kEstimateGrain, Counts{}, look, [](Counts a, const Counts& b) {
            for (std::size_t k = 0; k < kKinds; ++k) {
                a[k].points += b[k].points;
                a[k].own += b[k].own;
            }
            return a;
        });
    VolumeEstimate out;
    double variance = 0;
    for (std::size_t k = 0; k < kKinds; ++k) {
        // Jeffreys' prior; the share of a kind without points is unknown.
        const double n = static_cast<double>(counts[k].points), own = static_cast<double>(counts[k].own);
        const double share = (own + 0.5) / (n + 1);
        out.volume += volume[k] * (n > 0 ? own / n : share);
        variance += volume[k] * volume[k] * share * (1 - share) / (n + 1);
    }
    out.error = 2 * std::sqrt(variance);
    return out;
}

}  // namespace coppice
