#include "coppice/cage/openings_internal.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace coppice::cage_internal {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kQuarter = kPi / 2;
constexpr std::size_t kFaces = 4;
// Minimum sine of the angle between a lateral and the stem.
constexpr float kMinSine = 0.1f;
// Distance of the corners of a ring of four corners that subdivision brings to the radius 1; its edges are
// half as long as this times the square root of 2.
constexpr float kCornerRadius = 1.52f;
constexpr float kHalfEdge = kCornerRadius / std::numbers::sqrt2_v<float>;
// Half the azimuth range of a lateral above which there is no ring of quads between it and its face.
constexpr float kWide = 0.55f;
// Maximum of the same: beyond, the edges of the face are outside the stem.
constexpr float kMaxHalfWidth = 1.05f;
// Maximum azimuth between a wide lateral and the middle of its face.
constexpr float kMaxTurn = 0.35f;
// Minimum azimuth between a lateral and the next edge of its face.
constexpr float kMinGap = 0.1f;
// Maximum radius of a lateral, in radii of the stem.
constexpr float kMaxRatio = 1.05f;
// Margin between a lateral and the rings below and above, in radii of the stem and of the lateral.
constexpr float kMarginOfStem = 0.25f;
constexpr float kMarginOfLateral = 0.35f;
// Minimum share of the margin that has to be available.
constexpr float kMinMargin = 0.15f;
// Minimum length of the tube of a lateral outside the stem, in its radii.
constexpr float kMinTube = 0.6f;
// Preferred direction of the middle of a face if laterals allow a choice, so that faces of neighbours are
// aligned. It is almost never the direction of a branch.
constexpr Vec3 kPreferred{0.79f, 0.53f, 0.31f};

// Returns the face with the middle closest to an azimuth relative to the middle of face 0.
std::uint32_t find_face(float azimuth) {
    return static_cast<std::uint32_t>(std::lround(azimuth / kQuarter) + 8) % 4;
}

// Returns the corners of a face among those of the two rings, counter-clockwise seen from outside, the lower
// two first.
Ring get_corners(std::uint32_t face) {
    const std::uint32_t right = face, left = (face + 3) % 4;
    return {left, right, right + 4, left + 4};
}

}  // namespace

bool Openings::Lateral::is_wide() const { return half_width > kWide; }

Openings::Openings(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader)
    : stem_(branches[stem]),
      leader_(branches[leader]),
      stem_number_(stem),
      leader_number_(leader),
      radius_(std::max(stem_.radius, leader_.radius)),
      frame_(normalized(leader_.direction - stem_.direction, leader_.direction)) {}

std::optional<Openings> Openings::plan(std::span<const Branch> branches, std::uint32_t stem,
                                       std::uint32_t leader) {
    if (branches.size() > 2 + kFaces) return {};
    if (dot(branches[stem].direction, branches[leader].direction) > -kMinCosine) return {};
    Openings out(branches, stem, leader);
    for (std::uint32_t i = 0; i < branches.size(); ++i) {
        if (i != stem && i != leader && !out.add_lateral(i, branches[i])) return {};
    }
    if (!out.choose_phase()) return {};
    out.low_ = kInfinity;
    out.high_ = -kInfinity;
    for (const Lateral& l : out.lateral_) {
        out.low_ = std::min(out.low_, l.low);
        out.high_ = std::max(out.high_, l.high);
        const float own = kMarginOfLateral * l.radius;
        out.margin_ = std::max(out.margin_, l.is_wide() ? 0.5f * own : own + kMarginOfStem * out.radius_);
    }
    return out;
}

// Its corners are where lines along the lateral leave the stem.
bool Openings::add_lateral(std::uint32_t i, const Branch& b) {
    const float cosine = dot(b.direction, frame_.axis);
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const float across = kHalfEdge * b.radius;
    if (b.radius > kMaxRatio * radius_ || sine < kMinSine) return false;
    Lateral l;
    l.branch = i;
    l.radius = b.radius;
    l.azimuth = frame_.azimuth(b.direction);
    l.half_width = std::min(std::asin(std::min(across / radius_, 1.0f)), kMaxHalfWidth);
    const Vec3 out = frame_.around(l.azimuth), side = cross(frame_.axis, out);
    const float reach = std::sqrt(std::max(0.0f, radius_ * radius_ - across * across));
    l.low = kInfinity;
    l.high = -kInfinity;
    for (std::size_t k = 0; k < 4; ++k) {
        const float right = k == 1 || k == 2 ? across : -across, up = k < 2 ? -across : across;
        const float height = (reach * cosine + up) / sine;
        l.way = std::max(l.way, (reach + up * cosine) / sine);
        l.corner[k] = out * reach + side * right + frame_.axis * height;
        l.low = std::min(l.low, height);
        l.high = std::max(l.high, height);
    }
    lateral_.push_back(l);
    return true;
}

// Turns the faces as little as possible relative to those of straight neighbours.
bool Openings::choose_phase() {
    const float preferred = frame_.azimuth(kPreferred);
    if (lateral_.size() == 1) {
        Lateral& l = lateral_[0];
        widened_ = std::max(0.0f, l.half_width + kMinGap - kPi / 4);
        const float slack = std::max(0.0f, kPi / 4 - kMinGap - l.half_width);
        const float off = std::remainder(l.azimuth - preferred, kQuarter);
        phase_ = l.azimuth - std::clamp(off, -slack, slack);
        return true;
    }
    constexpr int kSteps = 24;
    float least = kInfinity;
    for (int step = -kSteps / 2; step < kSteps / 2; ++step) {
        const float turn = kQuarter / kSteps * static_cast<float>(step);
        if (std::abs(turn) >= least || worst_side(preferred + turn) > kPi / 4 - kMinGap) continue;
        least = std::abs(turn);
        phase_ = preferred + turn;
    }
    if (least == kInfinity) return false;
    for (Lateral& l : lateral_) l.face = find_face(l.azimuth - phase_);
    return true;
}

// Returns the maximum angle between a side of a lateral and the middle of its face; infinite if two laterals
// share a face.
float Openings::worst_side(float phase) const {
    std::array<bool, kFaces> is_taken{};
    float worst = 0;
    for (const Lateral& l : lateral_) {
        const std::uint32_t face = find_face(l.azimuth - phase);
        if (is_taken[face]) return kInfinity;
        is_taken[face] = true;
        // A wide lateral covers all of its face, and may extend slightly beyond it.
        const float own = l.is_wide() ? kPi / 4 - kMinGap - kMaxTurn : l.half_width;
        worst = std::max(worst, std::abs(std::remainder(l.azimuth - phase, kQuarter)) + own);
    }
    return worst;
}

bool Openings::is_open(std::uint32_t face) const {
    return std::ranges::any_of(lateral_, [&](const Lateral& l) { return l.face == face; });
}

float Openings::reach(std::uint32_t branch) const {
    if (branch == stem_number_) return std::max(0.0f, -low_);
    if (branch == leader_number_) return std::max(0.0f, high_);
    const auto found = std::ranges::find(lateral_, branch, &Lateral::branch);
    return found->way + kMinTube * found->radius;
}

std::optional<Hub> Openings::build(std::span<const float> room) const {
    for (const Lateral& l : lateral_) {
        if (reach(l.branch) > room[l.branch]) return {};
    }
    // Half of the remaining length belongs to the other end.
    const float below = std::min(margin_, 0.45f * (room[stem_number_] - reach(stem_number_)));
    const float above = std::min(margin_, 0.45f * (room[leader_number_] - reach(leader_number_)));
    if (std::min(below, above) < kMinMargin * margin_) return {};
    Hub hub;
    add_ring(low_ - below, hub);
    add_ring(high_ + above, hub);
    hub.cell.resize(lateral_.size() + 2);
    hub.cell[stem_number_] = {0, 3, 2, 1};
    hub.cell[leader_number_] = {4, 5, 6, 7};
    for (const Lateral& l : lateral_) open(l, hub);
    for (std::uint32_t face = 0; face < kFaces; ++face) {
        if (!is_open(face)) hub.quads.push_back(get_corners(face));
    }
    return hub;
}

// Returns a point along the stem below the node, along the leader above it.
Vec3 Openings::on_axis(float height) const {
    return height < 0 ? stem_.direction * -height : leader_.direction * height;
}

void Openings::add_ring(float height, Hub& hub) const {
    const Frame frame = frame_.turned(height < 0 ? -stem_.direction : leader_.direction);
    // The corners of face 0 are first and last; the others share the remaining angle.
    const std::array<float, 4> by{widened_, widened_ / 3, -widened_ / 3, -widened_};
    const Vec3 center = on_axis(height);
    for (std::size_t k = 0; k < 4; ++k) {
        const float azimuth = phase_ + kPi / 4 + kQuarter * static_cast<float>(k) + by[k];
        hub.position.push_back(center + frame.around(azimuth) * (kCornerRadius * radius_));
        hub.anchor.push_back(center);
    }
}

void Openings::open(const Lateral& l, Hub& hub) const {
    const Ring edge = get_corners(l.face);
    if (l.is_wide()) {
        // The quads between these and the lateral's next ring are anchored at the lateral's axis.
        for (const std::uint32_t v : edge) hub.anchor[v] = {};
        hub.cell[l.branch] = edge;
        return;
    }
    const auto first = static_cast<std::uint32_t>(hub.position.size());
    for (const Vec3& corner : l.corner) {
        hub.position.push_back(corner);
        hub.anchor.emplace_back();
    }
    const Ring inner{first, first + 1, first + 2, first + 3};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        hub.quads.push_back({edge[k], edge[next], inner[next], inner[k]});
    }
    hub.cell[l.branch] = inner;
}

}  // namespace coppice::cage_internal
