#include "coppice/edit/animate/wind.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/random.h"

namespace coppice {
namespace {

using std::numbers::pi;

constexpr double kAir = 1.2;          // [kg/m^3] density of air
constexpr double kStiffness = 7e9;    // [Pa] modulus of elasticity of green wood
constexpr double kWood = 900;         // [kg/m^3] density of green wood
constexpr double kLongestLean = 0.9;  // [rad] upper limit of the deflection of an axis
constexpr double kSwing = 0.5;        // [deflection] amplitude of the oscillation along the wind
constexpr double kCrossSwing = 0.35;  // [deflection] maximum amplitude of the oscillation across the wind
constexpr double kMinSpeed = 0.5;     // [m/s] minimum speed at which gusts travel
constexpr int kGustWaves = 3;

// Returns the fraction of the tip angle at x in [0, 1] of the length of a beam under a uniform load.
double beam_slope(double x) { return 1 - (1 - x) * (1 - x) * (1 - x); }

// Returns the angle [rad] by which the wind pressure deflects the tip of a round beam.
double compute_lean(double length, double radius, const WindOptions& o) {
    const double pressure = 0.5 * kAir * double{o.speed} * double{o.speed};
    const double slender = length / radius;
    const double angle = pressure * double{o.load} * double{o.flexibility} * 4 * slender * slender * slender /
                         (3 * pi * kStiffness);
    return kLongestLean * std::tanh(angle / kLongestLean);
}

// Returns the natural frequency [1/s] of a round beam that carries `load` times its own weight.
double compute_frequency(double length, double radius, const WindOptions& o) {
    const double flexible = std::max(double{o.flexibility} * (1 + double{o.load}), 1e-6);
    return 0.28 * radius / (length * length) * std::sqrt(kStiffness / kWood / flexible);
}

}  // namespace

Wind::Wind(const Skeleton& s, const WindOptions& options, double period, int fastest)
    : options_(options),
      period_(period),
      blow_(std::cos(double{options.azimuth}), std::sin(double{options.azimuth}), 0),
      across_(-blow_.y, blow_.x, 0),
      parent_(s.parents().begin(), s.parents().end()),
      axis_of_(s.size()),
      slope_(s.size()) {
    check_fields(options, "wind");
    if (!(period > 0)) throw InvalidInput("wind: the period must be greater than 0 seconds");
    std::vector<double> along(s.size());  // [m] distance from the joint
    std::vector<double> radius;           // [m] by axis, at its first node
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        const NodeId parent = s.parent(n);
        const bool leads = parent && s.leader(parent) == n;
        if (!leads) {
            axis_of_[i] = static_cast<std::uint32_t>(joint_of_.size());
            joint_of_.push_back(parent ? parent : n);
            tip_of_.push_back(n);
            radius.push_back(double{s.radius(n)});
        } else {
            axis_of_[i] = axis_of_[parent.index()];
            tip_of_[axis_of_[i]] = n;
        }
        if (!parent) continue;
        const double before = leads ? along[parent.index()] : 0;
        along[i] = before + double{distance(s.position(parent), s.position(n))};
    }
    const CounterRandom random(static_cast<std::uint64_t>(options.seed), 0x77696e64);
    axes_.resize(joint_of_.size());
    for (std::size_t k = 0; k < axes_.size(); ++k) {
        const double length = std::max(along[tip_of_[k].index()], radius[k]);
        const Vec3d joint(s.position(joint_of_[k])), tip(s.position(tip_of_[k]));
        const double swings = std::round(compute_frequency(length, radius[k], options) * period);
        axes_[k] = {.place = (joint + tip) * 0.5,
                    .lean = compute_lean(length, radius[k], options),
                    .swings = std::clamp(swings, 1.0, static_cast<double>(std::max(fastest, 1))),
                    .phase = 2 * pi * random.uniform(2 * k),
                    .across = kCrossSwing * (2 * random.uniform(2 * k + 1) - 1)};
    }
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        if (s.is_root(n)) continue;
        const double whole = along[tip_of_[axis_of_[i]].index()];
        const double segment = double{distance(s.position(s.parent(n)), s.position(n))};
        slope_[i] = static_cast<float>(whole > 0 ? beam_slope((along[i] - 0.5 * segment) / whole) : 0);
    }
}

/// Returns the relative deviation of the wind speed from its mean at a point: a sum of waves that travel with
/// the wind.
double Wind::gust(Vec3d place, double time) const {
    const CounterRandom random(static_cast<std::uint64_t>(options_.seed), 0x67757374);
    const double way = dot(place, blow_) / std::max(double{options_.speed}, kMinSpeed);
    double sum = 0;
    for (int k = 1; k <= kGustWaves; ++k) {
        const double phase = random.uniform(static_cast<std::uint64_t>(k));
        sum += std::sin(2 * pi * (k * (time - way) / period_ + phase)) / k;
    }
    return double{options_.gusts} * sum / 1.5;
}

/// Returns the rotation of the tip of an axis with the direction `way`, as a vector along the axis of
/// rotation.
Vec3d Wind::bend(const Axis& axis, Vec3d way, double time) const {
    const double speed = std::max(0.0, 1 + gust(axis.place, time));
    const double swing = std::sin(2 * pi * axis.swings * time / period_ + axis.phase);
    const double cross_swing = std::cos(2 * pi * axis.swings * time / period_ + axis.phase);
    const double along = axis.lean * speed * speed * (1 + kSwing * swing);
    const double sideways = axis.lean * speed * axis.across * cross_swing;
    return cross(way, blow_ * along + across_ * sideways);
}

Pose Wind::swayed(const Pose& still, double time) const {
    Pose out = still;
    std::vector<Rotation> sway(parent_.size());  // by node
    std::vector<Vec3d> axis_bend(axes_.size());  // by axis
    std::vector<std::uint8_t> is_known(axes_.size());
    for (std::size_t i = 0; i < parent_.size(); ++i) {
        const NodeId parent = parent_[i];
        if (!parent) continue;
        const std::uint32_t k = axis_of_[i];
        const Rotation& parent_sway = sway[joint_of_[k].index()];
        if (is_known[k] == 0) {
            const Vec3d way =
                Vec3d(still.positions[tip_of_[k].index()]) - Vec3d(still.positions[joint_of_[k].index()]);
            axis_bend[k] = bend(axes_[k], parent_sway(normalized(way, {0, 0, 1})), time);
            is_known[k] = 1;
        }
        sway[i] = unit(rotation_by(axis_bend[k] * double{slope_[i]}) * parent_sway);
        const std::uint32_t p = parent.index();
        out.positions[i] =
            Vec3(Vec3d(out.positions[p]) + sway[i](Vec3d(still.positions[i]) - Vec3d(still.positions[p])));
        out.turns[i] = unit(sway[i] * still.turns[i]);
    }
    return out;
}

void list_fields(WindOptions& o, FieldList& list) {
    list.add(common_field("speed", "Mean wind speed in metres per second; 0 is calm.", Unit::none, 0, 60),
             o.speed);
    list.add(Field{"azimuth", "Direction in which the wind blows, counter-clockwise from +x seen from above.",
                   Unit::radian, -6.2832, 6.2832},
             o.azimuth);
    list.add(Field{"gusts", "Amplitude of the gusts as a fraction of the mean wind speed.", Unit::none, 0, 1},
             o.gusts);
    list.add(common_field("flexibility", "Factor on the bending of green wood with the given radii.",
                          Unit::none, 0, 1000),
             o.flexibility);
    list.add(
        Field{"load",
              "Ratio of the width that catches the wind, including leaves and twigs, to the width of the "
              "branch.",
              Unit::none, 0, 1000},
        o.load);
    list.add(Field{"seed", "Seed of the gusts and of the phases of the branches.", Unit::none, 0, 2147483647},
             o.seed);
}

}  // namespace coppice
