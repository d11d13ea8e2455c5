#include "coppice/control/hub_internal.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numbers>

namespace coppice::control {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
// A seam is not placed farther out than this share of the shorter branch: the next ring must lie beyond it.
constexpr float kGreatestSeam = 0.7f;

constexpr int kSlots = 4;
constexpr std::uint32_t kNone = 0xffffffffu;
// Laterals nearer in azimuth than this stand side by side, not in slots of their own.
constexpr float kLeastGap = 0.6f;

struct Lateral {
    std::uint32_t branch;
    float azimuth;
};

float angle_between(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

class HubBuilder {
  public:
    HubBuilder(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader)
        : branch_(branches), stem_(stem), leader_(leader), frame_(main_axis()) {
        hub_.cell.resize(branches.size());
        find_laterals();
    }

    Hub build() && {
        if (lateral_.size() <= kSlots && widely_spaced()) {
            scaffold();
        } else {
            belt();
        }
        return std::move(hub_);
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

    // How far a direction stays inside the union of the rounded cones: the union is star-shaped about the
    // node.
    float exit_distance(Vec3 direction) const {
        float t = 0;
        for (const Branch& b : branch_) t = std::max(t, exit_distance(b, direction));
        return t;
    }
    static float exit_distance(const Branch& b, Vec3 direction) {
        const float c = dot(b.direction, direction);
        if (c <= 0) return b.radius;
        const float s = std::sqrt(std::max(0.0f, 1 - c * c));
        return std::min(b.radius / std::max(s, 1e-3f), std::max(b.radius, kGreatestSeam * b.length));
    }

    std::uint32_t add(Vec3 position) {
        hub_.position.push_back(position);
        return static_cast<std::uint32_t>(hub_.position.size() - 1);
    }
    std::uint32_t add_towards(Vec3 direction) { return add(direction * exit_distance(direction)); }

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
    void scaffold() {
        const auto slots = assign_slots();
        Ring ring;
        for (int k = 0; k < kSlots; ++k) {
            const std::uint32_t i = slots[k].branch;
            if (i != kNone) {
                ring[k] = add_towards(seam(i, stem_, plane_normal(i)));
            } else if (lateral_.size() == 1 && (slots[(k + 2) % kSlots].branch != kNone)) {
                ring[k] = add_towards(seam(stem_, leader_, plane_normal(lateral_[0].branch)));
            } else if (lateral_.size() == 1) {
                const Vec3 normal = plane_normal(lateral_[0].branch);
                ring[k] = add_towards(slots[(k + 3) % kSlots].branch != kNone ? normal : -normal);
            } else {
                ring[k] = add_towards(frame_.around(slots[k].azimuth));
            }
        }
        hub_.cell[stem_] = {ring[0], ring[3], ring[2], ring[1]};
        std::array<int, kSlots> order{0, 1, 2, 3};
        std::sort(order.begin(), order.end(),
                  [&](int a, int b) { return slots[a].height < slots[b].height; });
        for (const int k : order) {
            const std::uint32_t i = slots[k].branch;
            if (i == kNone) continue;
            const std::uint32_t top = add_towards(seam(leader_, i, plane_normal(i)));
            hub_.cell[i] = {ring[(k + 1) % kSlots], top, ring[(k + 3) % kSlots], ring[k]};
            ring[k] = top;
        }
        hub_.cell[leader_] = ring;
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

    // Two rings about the axis with four faces between them, on which the laterals sit.
    void belt() {
        const auto border = belt_borders();
        float low = std::numeric_limits<float>::max(), high = -low;
        for (const Lateral& l : lateral_) {
            const Branch& b = branch_[l.branch];
            const float middle = root_distance(l.branch) * dot(b.direction, frame_.axis);
            low = std::min(low, middle - 1.6f * b.radius);
            high = std::max(high, middle + 1.6f * b.radius);
        }
        const Branch &stem = branch_[stem_], &leader = branch_[leader_];
        high = std::clamp(high, 0.25f * leader.radius, std::max(0.3f * leader.radius, 0.6f * leader.length));
        low = std::clamp(low, -std::max(0.3f * stem.radius, 0.6f * stem.length), 0.0f);
        const Frame upper = frame_.turned(leader.direction), lower = frame_.turned(-stem.direction);
        Ring top, bottom;
        for (int k = 0; k < 4; ++k) {
            top[k] = add(upper.around(border[k]) * leader.radius + leader.direction * high);
            bottom[k] = add(lower.around(border[k]) * stem.radius - stem.direction * low);
        }
        hub_.cell[leader_] = top;
        hub_.cell[stem_] = {bottom[0], bottom[3], bottom[2], bottom[1]};
        for (int k = 0; k < 4; ++k) {
            std::vector<std::uint32_t> inside;
            const int next = (k + 1) % 4;
            float width = border[next] - border[k];
            if (width <= 0) width += 2 * kPi;
            for (const Lateral& l : lateral_) {
                float offset = std::fmod(l.azimuth - border[k], 2 * kPi);
                if (offset < 0) offset += 2 * kPi;
                if (offset < width) inside.push_back(l.branch);
            }
            fill_face({bottom[k], bottom[next], top[next], top[k]}, inside);
        }
    }

    // Four azimuths, about evenly spread, each in a gap between laterals, with few laterals between any two.
    std::array<float, 4> belt_borders() const {
        constexpr int kTries = 24;
        float best_cost = std::numeric_limits<float>::max();
        std::array<float, 4> best{};
        for (int t = 0; t < kTries; ++t) {
            std::array<float, 4> border;
            std::array<int, 4> count{};
            const float start = t * (kPi / 2 / kTries);
            for (int k = 0; k < 4; ++k) border[k] = start + k * kPi / 2;
            float cost = 0;
            for (const Lateral& l : lateral_) {
                float offset = std::fmod(l.azimuth - start, 2 * kPi);
                if (offset < 0) offset += 2 * kPi;
                const int k = std::min(3, static_cast<int>(offset / (kPi / 2)));
                ++count[k];
                const float off_center = offset - (k + 0.5f) * kPi / 2;
                cost += off_center * off_center;
            }
            for (const int c : count) cost += 4.0f * static_cast<float>(c * c);
            if (cost < best_cost) {
                best_cost = cost;
                best = border;
            }
        }
        return best;
    }

    // Where a lateral's axis leaves the other branches.
    float root_distance(std::uint32_t i) const {
        float t = 0;
        for (std::uint32_t j = 0; j < branch_.size(); ++j) {
            if (j == i) continue;
            t = std::max(t, exit_distance(branch_[j], branch_[i].direction));
        }
        return std::min(t, kGreatestSeam * branch_[i].length);
    }

    // A face with several laterals is cut from corner to corner through a new vertex between them; with one,
    // it is inset to the lateral's size.
    void fill_face(const Ring& corner, std::span<const std::uint32_t> inside) {
        if (inside.empty()) {
            hub_.face.push_back({corner, QuadKind::face});
        } else if (inside.size() == 1) {
            inset(corner, inside[0]);
        } else {
            split_face(corner, {inside.begin(), inside.end()});
        }
    }

    void split_face(const Ring& corner, std::vector<std::uint32_t> inside) {
        const Vec3 q0 = hub_.position[corner[0]], q1 = hub_.position[corner[1]];
        const Vec3 q2 = hub_.position[corner[2]], q3 = hub_.position[corner[3]];
        // The side of a lateral about the plane through the node and a diagonal.
        const Vec3 normal[2] = {normalized(cross(q0, q2)), normalized(cross(q1, q3))};
        int diagonal = 0;
        std::size_t cut = inside.size() / 2;
        float widest = -1;
        for (int d = 0; d < 2; ++d) {
            sort_by_side(inside, normal[d]);
            for (std::size_t i = 1; i < inside.size(); ++i) {
                const float gap =
                    dot(branch_[inside[i]].direction - branch_[inside[i - 1]].direction, normal[d]);
                if (gap > widest) {
                    widest = gap;
                    diagonal = d;
                    cut = i;
                }
            }
        }
        sort_by_side(inside, normal[diagonal]);
        const std::span<const std::uint32_t> all = inside;
        const Vec3 between =
            normalized(branch_[inside[cut - 1]].direction + branch_[inside[cut]].direction, frame_.x);
        const std::uint32_t m = add_towards(between);
        if (diagonal == 0) {
            fill_face({corner[0], m, corner[2], corner[3]}, all.subspan(cut));
            fill_face({corner[0], corner[1], corner[2], m}, all.first(cut));
        } else {
            fill_face({corner[0], corner[1], m, corner[3]}, all.subspan(cut));
            fill_face({corner[1], corner[2], corner[3], m}, all.first(cut));
        }
    }

    void sort_by_side(std::vector<std::uint32_t>& inside, Vec3 normal) const {
        std::sort(inside.begin(), inside.end(), [&](std::uint32_t a, std::uint32_t b) {
            const float sa = dot(branch_[a].direction, normal), sb = dot(branch_[b].direction, normal);
            return sa != sb ? sa < sb : a < b;
        });
    }

    void inset(const Ring& corner, std::uint32_t i) {
        const Branch& b = branch_[i];
        float nearest = kPi;
        for (std::uint32_t j = 0; j < branch_.size(); ++j) {
            if (j != i) nearest = std::min(nearest, angle_between(b.direction, branch_[j].direction));
        }
        const float reach = root_distance(i);
        const float opening = std::min({std::atan2(1.3f * b.radius, reach), 0.5f * nearest, 1.2f});
        const Frame frame(b.direction);
        const float phase = frame.quarters_azimuth([&](int k) { return hub_.position[corner[k]]; }, Vec3{});
        const auto out = frame.quarters(phase);
        Ring ring;
        for (int k = 0; k < 4; ++k) {
            ring[k] = add_towards(b.direction * std::cos(opening) + out[k] * std::sin(opening));
        }
        hub_.cell[i] = ring;
        for (int k = 0; k < 4; ++k) {
            const int next = (k + 1) % 4;
            hub_.face.push_back({{corner[k], corner[next], ring[next], ring[k]}, QuadKind::tube});
        }
    }

    std::span<const Branch> branch_;
    std::uint32_t stem_, leader_;
    Frame frame_;
    std::vector<Lateral> lateral_;
    Hub hub_;
};

}  // namespace

Hub build_hub(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader) {
    return HubBuilder(branches, stem, leader).build();
}

}  // namespace coppice::control
