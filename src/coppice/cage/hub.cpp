#include "coppice/cage/hub_internal.h"

#include <algorithm>
#include <numbers>

#include "coppice/cage/division_internal.h"

namespace coppice::cage_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
// Maximum distance of the ring at a branch from the node, as a share of the shorter branch: the next ring
// must be beyond it.
constexpr float kMaxSeam = 0.7f;
// A cell contains a cone around its branch that is this many times wider than the branch where it leaves the
// union ...
constexpr float kRoom = 1.6f;
// ... but at most this share of the angle to the closest other branch, and at most this angle.
constexpr float kShareOfRoom = 0.7f;
constexpr float kWidestCone = 1.2f;
constexpr float kNarrowestCone = 0.02f;
// Branches with an angle greater than this one, by its cosine, are approximately in line.
constexpr float kCosInLine = -std::numbers::sqrt2_v<float> / 2;
constexpr int kRelaxationPasses = 2;
// Maximum number of branches that are checked when a position among them is searched.
constexpr std::size_t kMaxNeighbours = 256;

// For one lateral, or two with at least this difference of azimuths, the edges between the cells are computed
// exactly.
constexpr float kMinGap = 0.6f;

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
        division_.cell.resize(branch_.size());
        division_.corner.reserve(branch_.size() + 2);
        if (lateral_.size() == 1) {
            divide_fork();
        } else if (lateral_.size() == 2 && std::min(gap_after(0), gap_after(1)) >= kMinGap) {
            divide_between_two();
        } else {
            division_ = divide_sphere(cones, stem_, leader_);
        }
        even_out(division_, cones, kRelaxationPasses);
        for (Vec3& corner : division_.corner) corner *= exit_distance(corner);
        return {std::move(division_.corner), {}, {}, std::move(division_.cell)};
    }

  private:
    Vec3 main_axis() const {
        const Vec3 a = branch_[leader_].direction, p = branch_[stem_].direction;
        const Vec3 axis = a - p;
        return length_squared(axis) > 1e-4f ? normalized(axis) : a;
    }

    void find_laterals() {
        lateral_.reserve(branch_.size() - 2);
        for (std::uint32_t i = 0; i < branch_.size(); ++i) {
            if (i == stem_ || i == leader_) continue;
            lateral_.push_back({i, frame_.azimuth(branch_[i].direction)});
        }
        std::sort(lateral_.begin(), lateral_.end(), [](const Lateral& a, const Lateral& b) {
            return a.azimuth != b.azimuth ? a.azimuth < b.azimuth : a.branch < b.branch;
        });
    }

    float gap_after(std::size_t i) const {
        const bool last = i + 1 == lateral_.size();
        return last ? lateral_[0].azimuth + 2 * kPi - lateral_[i].azimuth
                    : lateral_[i + 1].azimuth - lateral_[i].azimuth;
    }

    std::span<const Branch> neighbours() const {
        return branch_.first(std::min(branch_.size(), kMaxNeighbours));
    }

    // Returns the distance in a direction up to which it is inside the union of the rounded cones: the union
    // is star-shaped around the node.
    float exit_distance(Vec3 direction) const {
        float t = 0;
        for (const Branch& b : neighbours()) t = std::max(t, exit_distance(b, direction));
        return t;
    }
    static float exit_distance(const Branch& b, Vec3 direction) {
        const float c = dot(b.direction, direction);
        if (c <= 0) return b.radius;
        const float s = std::sqrt(std::max(0.0f, 1 - c * c));
        return std::min(b.radius / std::max(s, 1e-3f), std::max(b.radius, kMaxSeam * b.length));
    }

    // Returns the distance at which a branch's axis leaves the other branches.
    float root_distance(std::uint32_t i) const {
        float t = 0;
        for (std::uint32_t j = 0; j < neighbours().size(); ++j) {
            if (j == i) continue;
            t = std::max(t, exit_distance(branch_[j], branch_[i].direction));
        }
        return std::min(t, kMaxSeam * branch_[i].length);
    }

    Vec3 nearest_direction(std::uint32_t i) const {
        const Vec3 d = branch_[i].direction;
        Vec3 nearest = -d;
        for (std::uint32_t j = 0; j < neighbours().size(); ++j) {
            if (j != i && dot(d, branch_[j].direction) > dot(d, nearest)) nearest = branch_[j].direction;
        }
        return nearest;
    }

    std::vector<Site> sites() const {
        std::vector<Site> out;
        out.reserve(branch_.size());
        for (std::uint32_t i = 0; i < branch_.size(); ++i) {
            const Branch& b = branch_[i];
            const float room = angle_between(b.direction, nearest_direction(i));
            const float cone =
                std::min({fast_atan2(kRoom * b.radius, root_distance(i)), kShareOfRoom * room, kWidestCone});
            out.push_back({b.direction, std::max(cone, kNarrowestCone)});
        }
        return out;
    }

    std::uint32_t add(Vec3 direction) {
        division_.corner.push_back(direction);
        return static_cast<std::uint32_t>(division_.corner.size() - 1);
    }

    // Returns the normal of the plane of stem, leader and a lateral: seen from its tip, the order is leader,
    // lateral, stem.
    Vec3 plane_normal(std::uint32_t lateral) const {
        const Vec3 a = branch_[leader_].direction, p = branch_[stem_].direction,
                   d = branch_[lateral].direction;
        return normalized(cross(a, d) + cross(d, p) + cross(p, a), perpendicular(frame_.axis));
    }

    // Returns the direction between branches i and j, adjacent around the normal, that leaves both cylinders
    // at the same distance; the bisector if the two are nearly in line or the sector between them is more
    // than half a turn.
    Vec3 seam(std::uint32_t i, std::uint32_t j, Vec3 normal) const {
        const auto flat = [&](Vec3 d) {
            return normalized(d - normal * dot(d, normal), perpendicular(normal));
        };
        const Vec3 di = flat(branch_[i].direction), dj = flat(branch_[j].direction);
        const Vec3 across = cross(normal, di);
        const float c = dot(di, dj), s = dot(across, dj), ratio = branch_[j].radius / branch_[i].radius;
        if (s >= 0 && c >= kCosInLine) return normalized(di * (ratio + c) + across * s, across);
        float phi = fast_atan2(s, c);
        if (phi < 0) phi += 2 * kPi;
        const float equal_exit = fast_atan2(s, ratio + c);
        const float in_line = std::clamp((phi / kPi - 0.75f) / 0.2f, 0.0f, 1.0f);
        const float theta = in_line < 1 ? equal_exit + in_line * (phi / 2 - equal_exit) : phi / 2;
        return di * std::cos(theta) + across * std::sin(theta);
    }

    // A lateral opens a corner of the stem's ring: the corner becomes its bottom, a new vertex its top, and
    // the corner's neighbours are its sides. The remaining ring on top is the leader's.
    void open(Ring& ring, std::size_t corner, std::uint32_t lateral) {
        const std::uint32_t top = add(seam(leader_, lateral, plane_normal(lateral)));
        division_.cell[lateral] = {ring[(corner + 1) % 4], top, ring[(corner + 3) % 4], ring[corner]};
        ring[corner] = top;
    }

    // The poles of the plane of the three branches, and the edges between their cells within it.
    void divide_fork() {
        const std::uint32_t i = lateral_[0].branch;
        const Vec3 normal = plane_normal(i);
        Ring ring{add(seam(i, stem_, normal)), add(normal), add(seam(stem_, leader_, normal)), add(-normal)};
        division_.cell[stem_] = {ring[0], ring[3], ring[2], ring[1]};
        open(ring, 0, i);
        division_.cell[leader_] = ring;
    }

    // Inserts two laterals, the lower one first, at the corners that leave the others most evenly
    // distributed.
    void divide_between_two() {
        const std::array<float, 2> gap{gap_after(0), gap_after(1)};
        const std::size_t steps = std::numbers::sqrt3_v<float> * gap[0] < gap[1]   ? 1
                                  : std::numbers::sqrt3_v<float> * gap[1] < gap[0] ? 3
                                                                                   : 2;
        const std::array<std::size_t, 2> corner{0, steps}, steps_after{steps, 4 - steps};
        std::array<Vec3, 4> direction;
        for (std::size_t l = 0; l < 2; ++l) {
            const std::uint32_t i = lateral_[l].branch;
            direction[corner[l]] = seam(i, stem_, plane_normal(i));
            const float step = gap[l] / static_cast<float>(steps_after[l]);
            for (std::size_t e = 1; e < steps_after[l]; ++e)
                direction[corner[l] + e] = frame_.around(lateral_[l].azimuth + step * static_cast<float>(e));
        }
        Ring ring;
        for (std::size_t k = 0; k < 4; ++k) ring[k] = add(direction[k]);
        division_.cell[stem_] = {ring[0], ring[3], ring[2], ring[1]};
        const std::size_t lower = height(1) < height(0) ? 1 : 0;
        for (const std::size_t l : {lower, 1 - lower}) open(ring, corner[l], lateral_[l].branch);
        division_.cell[leader_] = ring;
    }
    float height(std::size_t l) const {
        const std::uint32_t i = lateral_[l].branch;
        return root_distance(i) * dot(branch_[i].direction, frame_.axis);
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

}  // namespace coppice::cage_internal
