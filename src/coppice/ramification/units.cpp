#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/golden_section.h"
#include "coppice/ramification/objective_internal.h"
#include "coppice/ramification/units_internal.h"

namespace coppice::ramification_internal {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kQuarter = kPi / 2;
// An angle from the middle of a face that is closer to an edge of the cube than 10 degrees.
constexpr double kOffFace = 35 * kPi / 180;
constexpr double kPrintedPeriod = kPi / 4, kPrintedReach = 10 * kPi / 180;
// Corners of the face of a thick lateral: minimum angle from the crease, and maximum angle from its middle.
constexpr double kCreaseMargin = 15 * kPi / 180, kWidest = 60 * kPi / 180;
// Half the footprint of a lateral along its parent, in radii divided by the sine of its angle; constant for
// smaller angles.
constexpr double kFootprint = 1.2, kMinSine = 0.35;
// Laterals in a row of faces; each row has space for 16 crowded ones.
constexpr std::uint32_t kLateralsOfRow = 8;
// Maximum number of laterals of a unit, to limit operations on pairs of them; with more laterals the next
// unit begins at the end of this one.
constexpr std::uint32_t kMaxLaterals = 256;
// [radii] minimum length of a row adjacent to that of the current lateral.
constexpr double kMinRow = 0.2;
// Share of the footprint of a lateral that must be within its row.
constexpr double kInRow = 0.75;
// Maximum share of the half width of a face used by a lateral.
constexpr double kFaceFilled = 0.85;

/// Unit before its ends are determined: it must contain [low, high], and is initially a cube from start to
/// end.
struct Cluster {
    Unit unit;
    double low = 0, high = 0;
};

struct Ends {
    double end = 0, start = 0, cost = 0;
};

class Planner {
  public:
    Planner(const Branches& branches, std::uint32_t branch, double from, double to, double alpha,
            const RamificationOptions& options, RamificationReport& report)
        : path_(branches.path(branch)),
          from_(from),
          to_(to),
          alpha_(alpha),
          options_(options),
          report_(report) {
        for (const std::uint32_t l : branches.laterals(branch))
            plan_.laterals.push_back(find_lateral(branches, l));
        std::ranges::stable_sort(plan_.laterals, {}, &Lateral::center);
    }

    UnitPlan plan() && {
        for (std::uint32_t l = 0; l < plan_.laterals.size(); ++l) {
            clusters_.push_back(cluster(l, 1));
            while (clusters_.size() > 1 && must_join(clusters_[clusters_.size() - 2], clusters_.back()))
                join();
        }
        share_space();
        for (const Cluster& c : clusters_) plan_.units.push_back(c.unit);
        hold_order();
        for (Unit& unit : plan_.units) classify(unit);
        report_.units += static_cast<std::uint32_t>(plan_.units.size());
        return std::move(plan_);
    }

  private:
    Cluster cluster(std::uint32_t first, std::uint32_t count) const {
        const auto begin = plan_.laterals.begin() + first;
        const Lateral& current = *std::max_element(
            begin, begin + count, [](const Lateral& a, const Lateral& b) { return a.radius < b.radius; });
        Cluster out;
        Unit& unit = out.unit;
        unit.center = std::clamp(current.center, from_, to_);
        unit.out = current.out;
        unit.first_lateral = first;
        unit.count = count;
        unit.radius = path_.radius(unit.center);
        // The crease of a lateral as thick as its parent extends beyond the corners of a cube.
        const double crease = std::asin(std::min(1.0, current.radius / unit.radius));
        unit.spread = std::clamp(crease + kCreaseMargin, kPi / 4, kWidest);
        out.low = out.high = unit.center;
        for (auto l = begin; l != begin + count; ++l) {
            out.low = std::min(out.low, std::clamp(l->center - l->half, from_, to_));
            out.high = std::max(out.high, std::clamp(l->center + l->half, from_, to_));
        }
        unit.start = std::max(from_, std::min(out.low, unit.center - unit.radius));
        unit.end = std::min(to_, std::max(out.high, unit.center + unit.radius));
        return out;
    }

    void join() {
        const Cluster last = clusters_.back();
        clusters_.pop_back();
        Cluster& into = clusters_.back();
        into = cluster(into.unit.first_lateral, into.unit.count + last.unit.count);
    }

    bool must_join(const Cluster& a, const Cluster& b) const {
        if (a.unit.count + b.unit.count > kMaxLaterals) return false;
        const double room = 0.1 * std::min(a.unit.radius, b.unit.radius);
        if (b.low < a.high + room) return true;
        return !options_.no_connection_optimisation && calibrate(a, b).cost > options_.additional_threshold;
    }

    /// Returns the angle between the faces of two units, at most an eighth of a turn in either direction.
    double twist(const Unit& a, const Unit& b) const {
        const Vec3d axis = path_.direction((a.center + b.center) / 2, (b.center - a.center) / 2);
        const double angle =
            std::atan2(dot(cross(a.out, b.out), axis), dot(a.out - axis * dot(a.out, axis), b.out));
        return std::remainder(angle, kQuarter);
    }

    static double half_distortion(double along, double side) { return unit_distortion(side, along, side); }

    /// Returns the ends of two neighbours with the minimum RU + RC, by alternating golden-section searches.
    Ends calibrate(const Cluster& a, const Cluster& b) const {
        const double turned = twist(a.unit, b.unit), diameter = a.unit.radius + b.unit.radius;
        const double tolerance = 1e-4 * diameter;
        const auto cost = [&](double end, double start) {
            return half_distortion(end - a.unit.center, a.unit.radius) +
                   half_distortion(b.unit.center - start, b.unit.radius) +
                   connection_distortion(turned, start - end, diameter);
        };
        Ends at{a.unit.end, b.unit.start, cost(a.unit.end, b.unit.start)};
        for (double before = at.cost + 1; before - at.cost > 1e-6;) {
            before = at.cost;
            const double end = find_minimum(a.high, std::max(a.high, a.unit.end), tolerance,
                                            [&](double e) { return cost(e, at.start); });
            if (cost(end, at.start) < at.cost) at = {end, at.start, cost(end, at.start)};
            const double start = find_minimum(std::min(b.low, b.unit.start), b.low, tolerance,
                                              [&](double s) { return cost(at.end, s); });
            if (cost(at.end, start) < at.cost) at = {at.end, start, cost(at.end, start)};
        }
        return at;
    }

    void share_space() {
        add_objective(report_.before);
        for (std::size_t i = 0; i + 1 < clusters_.size() && !options_.no_connection_optimisation; ++i) {
            const Ends ends = calibrate(clusters_[i], clusters_[i + 1]);
            clusters_[i].unit.end = ends.end;
            clusters_[i + 1].unit.start = ends.start;
        }
        add_objective(report_.after);
    }

    void add_objective(RamificationObjective& sums) const {
        for (std::size_t i = 0; i < clusters_.size(); ++i) {
            const Unit& u = clusters_[i].unit;
            sums.units += unit_distortion(u.center - u.start, u.end - u.center, u.radius);
            if (i == 0) continue;
            const Unit& before = clusters_[i - 1].unit;
            sums.connections +=
                connection_distortion(twist(before, u), u.start - before.end, before.radius + u.radius);
        }
    }

    /// Restores the order of the rings, with small gaps. Units that overlap because they must not be
    /// optimised remain.
    void hold_order() {
        const double step = (to_ - from_) / static_cast<double>(4 * plan_.units.size() + 4);
        double least = from_;
        for (Unit& u : plan_.units) {
            if (!options_.no_connection_optimisation) u.start = std::max(u.start, least);
            u.end = std::max(u.end, u.start + std::min(step, 0.2 * u.radius));
            least = u.end + std::min(step, 0.05 * u.radius);
        }
        double most = to_;
        for (auto u = plan_.units.rbegin(); u != plan_.units.rend(); ++u) {
            if (!options_.no_connection_optimisation || u->end > to_) u->end = std::min(u->end, most);
            u->start = std::min(u->start, u->end - std::min(step, 0.2 * u->radius));
            most = u->start - std::min(step, 0.05 * u->radius);
        }
    }

    /// Creates the rings between rows of faces: one row for the current lateral, and adjacent ones if there
    /// are others.
    void lay_rows(Unit& unit) const {
        const auto laterals = std::span(plan_.laterals).subspan(unit.first_lateral, unit.count);
        unit.rings = {unit.start, unit.end};
        if (unit.count > 1) {
            const double half = std::ranges::max_element(laterals, {}, &Lateral::radius)->half;
            const double low = unit.center - half, high = unit.center + half, least = kMinRow * unit.radius;
            if (high + least < unit.end) unit.rings.insert(unit.rings.begin() + 1, high);
            if (low - least > unit.start) unit.rings.insert(unit.rings.begin() + 1, low);
            std::vector<double> finer;
            for (std::size_t i = 0; i + 1 < unit.rings.size(); ++i) {
                const double from = unit.rings[i], way = unit.rings[i + 1] - from;
                const bool holds_current = unit.center >= from && unit.center <= unit.rings[i + 1];
                const double pieces = holds_current ? 1 : std::max(1.0, std::round(way / unit.radius));
                for (double k = 0; k < pieces; ++k) finer.push_back(from + way * k / pieces);
            }
            finer.push_back(unit.end);
            unit.rings = std::move(finer);
        }
        while (unit.rows() * kLateralsOfRow < unit.count) {
            std::size_t longest = 0;
            const auto way = [&](std::size_t i) { return unit.rings[i + 1] - unit.rings[i]; };
            for (std::size_t i = 1; i < unit.rows(); ++i) longest = way(i) > way(longest) ? i : longest;
            unit.rings.insert(unit.rings.begin() + static_cast<std::ptrdiff_t>(longest) + 1,
                              unit.rings[longest] + way(longest) / 2);
        }
    }

    void classify(Unit& unit) {
        lay_rows(unit);
        const auto laterals = std::span(plan_.laterals).subspan(unit.first_lateral, unit.count);
        std::vector<std::uint32_t> order(unit.count);
        for (std::uint32_t i = 0; i < unit.count; ++i) order[i] = i;
        std::ranges::stable_sort(order, std::greater<>{},
                                 [&](std::uint32_t i) { return laterals[i].radius; });
        std::vector<bool> taken(std::size_t{4} * unit.rows(), false);
        for (const std::uint32_t i : order) {
            Lateral& l = laterals[i];
            l.additional |= options_.all_additional || !fits(unit, l) || taken[4 * l.row + l.face];
            if (!l.additional) taken[4 * l.row + l.face] = true;
            ++(l.additional ? report_.additional : report_.connectable);
        }
    }

    /// Returns whether the lateral fits on a face of the unit, regardless of other laterals; finds the face.
    bool fits(const Unit& unit, Lateral& l) const {
        if (l.on_cap) return false;
        const Vec3d axis = path_.direction(l.center, unit.radius / 2);
        const double angle = std::atan2(dot(cross(unit.out, l.out), axis), dot(unit.out, l.out));
        const double quarters = std::round(angle / kQuarter);
        const double off = std::abs(angle - quarters * kQuarter);
        l.face = static_cast<std::uint32_t>(static_cast<int>(quarters) + 4) % 4;
        if (options_.printed_angles && std::abs(angle) > 1e-6 &&
            (std::fmod(std::abs(angle), kPrintedPeriod) < kPrintedReach || l.face != 0))
            return false;
        if (off > kOffFace) return false;
        const double side = alpha_ * unit.radius, wanted = std::min(alpha_ * l.radius, kFaceFilled * side);
        if (wanted > 1.3 * (side - side * std::tan(off))) return false;
        const auto after = std::upper_bound(unit.rings.begin() + 1, unit.rings.end() - 1, l.center);
        l.row = static_cast<std::uint32_t>(after - unit.rings.begin()) - 1;
        const double half = kInRow * l.half;
        return l.center - half >= unit.rings[l.row] && l.center + half <= unit.rings[l.row + 1];
    }

    const Path path_;
    const double from_, to_, alpha_;
    const RamificationOptions& options_;
    RamificationReport& report_;
    UnitPlan plan_;
    std::vector<Cluster> clusters_;
};

}  // namespace

Lateral find_lateral(const Branches& branches, std::uint32_t lateral) {
    constexpr int kMaxSteps = 64;
    const Branch& at = branches[lateral];
    const Path path = branches.path(lateral), parent = branches.path(at.parent);
    const double around = parent.radius(at.joint);
    std::uint32_t segment = parent.segment_at(at.joint);
    Lateral out{.branch = lateral};
    Path::Near near;
    for (int step = 0; step < kMaxSteps; ++step) {
        near = parent.nearest(segment, path.position(out.exit_arc));
        if (near.outside > -1e-3 * around || out.exit_arc >= path.length()) break;
        out.exit_arc = std::min(path.length(), out.exit_arc + std::max(-near.outside, 0.02 * around));
    }
    out.center = near.t;
    out.exit = path.position(out.exit_arc);
    out.radius = path.radius(out.exit_arc);
    const double wide = parent.radius(out.center);
    const Vec3d axis = parent.direction(out.center, wide / 2);
    const Vec3d offset = out.exit - parent.position(out.center);
    const Vec3d across = offset - axis * dot(offset, axis);
    out.on_cap = length(across) < 0.5 * length(offset);
    out.out = normalized(across, perpendicular(axis));
    const double sine = length(cross(path.direction(out.exit_arc, out.radius / 2), axis));
    out.half = std::min(kFootprint * out.radius / std::max(sine, kMinSine), 2 * wide);
    return out;
}

UnitPlan plan_units(const Branches& branches, std::uint32_t branch, double from, double to, double alpha,
                    const RamificationOptions& options, RamificationReport& report) {
    return Planner(branches, branch, from, to, alpha, options, report).plan();
}

}  // namespace coppice::ramification_internal
