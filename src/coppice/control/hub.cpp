#include "coppice/control/hub_internal.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numbers>

#include "coppice/control/division_internal.h"

namespace coppice::control {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
// A seam is not placed farther out than this share of the shorter branch: the next ring must lie beyond it.
constexpr float kGreatestSeam = 0.7f;
// A cell holds a cone about its branch that is this many times wider than the branch where it leaves the
// union ...
constexpr float kRoom = 1.6f;
// ... but no wider than this share of the way to the nearest other branch, nor than this angle.
constexpr float kShareOfRoom = 0.7f;
constexpr float kWidestCone = 1.2f;
constexpr float kNarrowestCone = 0.02f;
constexpr int kEvenings = 2;
// Of more branches than this only the first are looked at when a place among them is sought.
constexpr std::size_t kMostNeighbours = 256;

constexpr int kSlots = 4;
constexpr std::uint32_t kNone = 0xffffffffu;
// So few laterals, no nearer to each other in azimuth than this, get slots: their seams are known exactly.
constexpr std::size_t kMostInSlots = 2;
constexpr float kLeastGap = 0.6f;

struct Lateral {
    std::uint32_t branch;
    float azimuth;
};

class HubBuilder {
  public:
    HubBuilder(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader)
        : branch_(branches), stem_(stem), leader_(leader), frame_(main_axis()) {
        find_laterals();
    }

    Hub build() && {
        const std::vector<Site> cones = sites();
        if (lateral_.size() <= kMostInSlots && widely_spaced()) {
            fill_slots();
        } else {
            division_ = divide_sphere(cones, stem_, leader_);
        }
        even_out(division_, cones, kEvenings);
        Hub hub{{}, std::move(division_.cell)};
        for (const Vec3 direction : division_.corner)
            hub.position.push_back(direction * exit_distance(direction));
        return hub;
    }

  private:
    Vec3 main_axis() const {
        const Vec3 a = branch_[leader_].direction, p = branch_[stem_].direction;
        const Vec3 axis = a - p;
        return length_squared(axis) > 1e-4f ? normalized(axis) : a;
    }

    void find_laterals() {
        for (std::uint32_t i = 0; i < branch_.size(); ++i) {
            if (i == stem_ || i == leader_) continue;
            lateral_.push_back({i, frame_.azimuth(branch_[i].direction)});
        }
        std::sort(lateral_.begin(), lateral_.end(), [](const Lateral& a, const Lateral& b) {
            return a.azimuth != b.azimuth ? a.azimuth < b.azimuth : a.branch < b.branch;
        });
    }

    bool widely_spaced() const {
        for (std::size_t i = 0; i < lateral_.size(); ++i) {
            if (lateral_.size() > 1 && gap_after(i) < kLeastGap) return false;
        }
        return true;
    }
    float gap_after(std::size_t i) const {
        const bool last = i + 1 == lateral_.size();
        return last ? lateral_[0].azimuth + 2 * kPi - lateral_[i].azimuth
                    : lateral_[i + 1].azimuth - lateral_[i].azimuth;
    }

    std::span<const Branch> neighbours() const {
        return branch_.first(std::min(branch_.size(), kMostNeighbours));
    }

    // How far a direction stays inside the union of the rounded cones: the union is star-shaped about the
    // node.
    float exit_distance(Vec3 direction) const {
        float t = 0;
        for (const Branch& b : neighbours()) t = std::max(t, exit_distance(b, direction));
        return t;
    }
    static float exit_distance(const Branch& b, Vec3 direction) {
        const float c = dot(b.direction, direction);
        if (c <= 0) return b.radius;
        const float s = std::sqrt(std::max(0.0f, 1 - c * c));
        return std::min(b.radius / std::max(s, 1e-3f), std::max(b.radius, kGreatestSeam * b.length));
    }

    // Where a branch's axis leaves the other branches.
    float root_distance(std::uint32_t i) const {
        float t = 0;
        for (std::uint32_t j = 0; j < neighbours().size(); ++j) {
            if (j == i) continue;
            t = std::max(t, exit_distance(branch_[j], branch_[i].direction));
        }
        return std::min(t, kGreatestSeam * branch_[i].length);
    }

    std::vector<Site> sites() const {
        std::vector<Site> out;
        for (std::uint32_t i = 0; i < branch_.size(); ++i) {
            const Branch& b = branch_[i];
            float nearest = kPi;
            for (std::uint32_t j = 0; j < neighbours().size(); ++j) {
                if (j != i) nearest = std::min(nearest, angle_between(b.direction, branch_[j].direction));
            }
            const float cone = std::min(
                {std::atan2(kRoom * b.radius, root_distance(i)), kShareOfRoom * nearest, kWidestCone});
            out.push_back({b.direction, std::max(cone, kNarrowestCone)});
        }
        return out;
    }

    std::uint32_t add(Vec3 direction) {
        division_.corner.push_back(direction);
        return static_cast<std::uint32_t>(division_.corner.size() - 1);
    }

    // The normal of the plane of stem, leader and a lateral: seen from its tip, they follow as leader,
    // lateral, stem.
    Vec3 plane_normal(std::uint32_t lateral) const {
        const Vec3 a = branch_[leader_].direction, p = branch_[stem_].direction,
                   d = branch_[lateral].direction;
        return normalized(cross(a, d) + cross(d, p) + cross(p, a), perpendicular(frame_.axis));
    }

    // The direction between branches i and j, which follow each other about the normal, that leaves both
    // cylinders at the same distance; half-way where the two are nearly in line or the sector between them is
    // more than half a turn.
    Vec3 seam(std::uint32_t i, std::uint32_t j, Vec3 normal) const {
        const auto flat = [&](Vec3 d) {
            return normalized(d - normal * dot(d, normal), perpendicular(normal));
        };
        const Vec3 di = flat(branch_[i].direction), dj = flat(branch_[j].direction);
        float phi = std::atan2(dot(normal, cross(di, dj)), dot(di, dj));
        if (phi < 0) phi += 2 * kPi;
        const float equal_exit =
            std::atan2(std::sin(phi), branch_[j].radius / branch_[i].radius + std::cos(phi));
        const float in_line = std::clamp((phi / kPi - 0.75f) / 0.2f, 0.0f, 1.0f);
        const float theta = in_line < 1 ? equal_exit + in_line * (phi / 2 - equal_exit) : phi / 2;
        return di * std::cos(theta) + cross(normal, di) * std::sin(theta);
    }

    // The four corners of the stem's ring are slots; a lateral opens one: the corner becomes its bottom, a
    // new vertex its top, and its neighbours are its sides. The ring that is left on top is the leader's.
    void fill_slots() {
        division_.cell.resize(branch_.size());
        const auto slots = assign_slots();
        Ring ring;
        for (int k = 0; k < kSlots; ++k) {
            const std::uint32_t i = slots[k].branch;
            if (i != kNone) {
                ring[k] = add(seam(i, stem_, plane_normal(i)));
            } else if (lateral_.size() == 1 && (slots[(k + 2) % kSlots].branch != kNone)) {
                ring[k] = add(seam(stem_, leader_, plane_normal(lateral_[0].branch)));
            } else if (lateral_.size() == 1) {
                const Vec3 normal = plane_normal(lateral_[0].branch);
                ring[k] = add(slots[(k + 3) % kSlots].branch != kNone ? normal : -normal);
            } else {
                ring[k] = add(frame_.around(slots[k].azimuth));
            }
        }
        division_.cell[stem_] = {ring[0], ring[3], ring[2], ring[1]};
        std::array<int, kSlots> order{0, 1, 2, 3};
        std::sort(order.begin(), order.end(),
                  [&](int a, int b) { return slots[a].height < slots[b].height; });
        for (const int k : order) {
            const std::uint32_t i = slots[k].branch;
            if (i == kNone) continue;
            const std::uint32_t top = add(seam(leader_, i, plane_normal(i)));
            division_.cell[i] = {ring[(k + 1) % kSlots], top, ring[(k + 3) % kSlots], ring[k]};
            ring[k] = top;
        }
        division_.cell[leader_] = ring;
    }

    struct Slot {
        std::uint32_t branch = kNone;
        float azimuth = 0;
        float height = 0;
    };

    // The assignment, in order of azimuth, that leaves the corners most evenly spread.
    std::array<Slot, 4> assign_slots() const {
        const int k = static_cast<int>(lateral_.size());
        std::array<Slot, 4> best{};
        float best_cost = std::numeric_limits<float>::max();
        for (unsigned taken = 1; taken < 16; taken += 2) {  // the first lateral has slot 0
            if (std::popcount(taken) != k) continue;
            std::array<Slot, 4> slots{};
            int next = 0;
            for (int s = 0; s < kSlots; ++s) {
                if (!(taken >> s & 1)) continue;
                const Lateral& l = lateral_[next];
                slots[s] = {l.branch, l.azimuth,
                            root_distance(l.branch) * dot(branch_[l.branch].direction, frame_.axis)};
                int empty = 0;
                while (empty < 3 && !(taken >> ((s + empty + 1) % kSlots) & 1)) ++empty;
                const float step = gap_after(static_cast<std::size_t>(next)) / static_cast<float>(empty + 1);
                for (int e = 1; e <= empty; ++e) {
                    slots[(s + e) % kSlots].azimuth = l.azimuth + step * static_cast<float>(e);
                }
                ++next;
            }
            float cost = 0;
            for (int s = 0; s < kSlots; ++s) {
                const float gap = wrap_angle(slots[(s + 1) % kSlots].azimuth - slots[s].azimuth);
                cost += (gap - kPi / 2) * (gap - kPi / 2);
            }
            if (cost < best_cost) {
                best_cost = cost;
                best = slots;
            }
        }
        return best;
    }

    std::span<const Branch> branch_;
    std::uint32_t stem_, leader_;
    Frame frame_;
    std::vector<Lateral> lateral_;
    Division division_;
};

}  // namespace

Hub build_hub(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader) {
    return HubBuilder(branches, stem, leader).build();
}

}  // namespace coppice::control
