#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/pipeline/knots/knots_internal.h"

namespace coppice::pipeline_internal {
namespace {

// What makes a good seam, in radii of the tube there.
constexpr float kWindow = 0.6f;       // the piece of the tube that is looked at, both ways
constexpr float kLeastCosine = 0.5f;  // between the tube's direction at the seam and elsewhere in the window
constexpr float kGreatestRatio = 1.8f;  // between radii in the window
constexpr float kOwnWay = 3.0f;         // along which the own tube is not taken for another
constexpr double kClearance = 1.05;     // of other branches, in sums of radii,
constexpr double kSlabInside = 0.8;     // within a slab that reaches so far to the side that goes
constexpr double kSlabOutside = 0.3;    // and so far to the side that stays
constexpr double kFarthest = 40;        // radii of the seam at which no branch is looked for any more

// Whether a branch keeps away from the tube where its seam lies: where triangles are cut off and joined to
// it, which is a slab across the tube, mostly on the side that goes.
bool is_clear_of(const Seam& seam, const RoundCone& branch) {
    const Vec3d outward(seam.outward), from = branch.a - Vec3d(seam.center);
    const auto r = static_cast<double>(seam.radius);
    const double widest = std::max(branch.radius_a, branch.radius_b());
    const double height = dot(from, outward), rise = dot(branch.axis, outward);
    const double low = -kSlabInside * r - widest, high = kSlabOutside * r + widest;
    double begin = 0, end = 1;  // of the branch's axis, within the slab
    if (rise != 0) {
        const double t0 = (low - height) / rise, t1 = (high - height) / rise;
        begin = std::max(begin, std::min(t0, t1));
        end = std::min(end, std::max(t0, t1));
    } else if (height < low || height > high) {
        return true;
    }
    if (begin > end) return true;
    const Vec3d across = branch.axis - outward * rise, offset = from - outward * height;
    const double t = std::clamp(closest_parameter(Vec3d{}, offset, across), begin, end);
    return length(offset + across * t) > kClearance * (r + branch.radius(t));
}

}  // namespace

std::vector<std::uint32_t> ring_vertices(const KnotGroup& group) {
    std::vector<std::uint32_t> out;
    for (const Seam& seam : group.seams) out.insert(out.end(), seam.ring.begin(), seam.ring.end());
    return out;
}

Knots::Knots(const TubeMap& map, const Slices& slices, const QuadMesh& mesh, const Context& ctx)
    : map_(map),
      slices_(slices),
      mesh_(mesh),
      capsules_(map.tubes, map.tubes.origin(), ctx),
      gone_(slices.count(), 0),
      spared_(slices.count(), 0),
      needed_(slices.count(), 0),
      together_(slices.count()) {}

void Knots::take(Slice s) {
    if (gone_[s] != 0 || spared_[s] != 0) return;
    gone_[s] = 1;
    taken_.push_back(s);
}

// Takes slices from one on, one after the other.
void Knots::take_along(Slice at, bool to_tip, float way) {
    const Skeleton& s = map_.tubes;
    while (at != Slices::kNone && way > 0) {
        take(at);
        const NodeId t = slices_.tube(at);
        if (s.is_root(t)) return;
        way -= distance(s.position(t), s.position(s.parent(t))) / static_cast<float>(slices_.per_tube());
        const Slice next = slices_.next(at, to_tip);
        // Past a root in the middle of a chain the way to the tip turns round.
        if (next != Slices::kNone && !to_tip && s.parent(t) == s.parent(slices_.tube(next))) to_tip = true;
        at = next;
    }
}

void Knots::move_on(const Seam& seam, float radii) {
    take_along(seam.kept, seam.to_tip, radii * seam.radius);
}

void Knots::take_around(Slice slice, float radii) {
    const float way = radii * map_.tubes.radius(slices_.tube(slice));
    take_along(slice, true, way);
    take_along(slice, false, way);
}

void Knots::need(Slice s) {
    needed_[s] = 1;
    take(s);
}

bool Knots::needs(const KnotGroup& group) const {
    return std::ranges::any_of(group.slices, [&](Slice s) { return needed_[s] != 0; });
}

void Knots::spare(const KnotGroup& group) {
    for (const Slice s : group.slices) {
        gone_[s] = 0;
        spared_[s] = 1;
    }
    std::erase_if(taken_, [&](Slice s) { return gone_[s] == 0; });
    closed_ = taken_.size();
    spares_any_ = true;
}

void Knots::take_trees(std::span<const NodeId> trees, std::span<const NodeId> root) {
    for (const NodeId n : nodes(map_.tubes)) {
        const NodeId tree = root[n.index()];
        if (std::binary_search(trees.begin(), trees.end(), tree)) take_tube(n, slices_.first(tree));
    }
}

// All of a tube, spared or not, into the group of a slice.
void Knots::take_tube(NodeId tube, Slice group) {
    for (Slice i = slices_.first(tube); i <= slices_.last(tube); ++i) {
        spared_[i] = 0;
        take(i);
        join(group, i);
    }
}

void Knots::take_zone(Slice slice, float radii) {
    const Skeleton& s = map_.tubes;
    const NodeId first = slices_.tube(slice);
    struct Step {
        NodeId tube;
        float left;  // [m] of the way, beyond the tube
    };
    std::vector<Step> queue{{first, radii * s.radius(first)}};
    std::unordered_map<std::uint32_t, float> left{{first.index(), queue[0].left}};
    for (std::size_t k = 0; k < queue.size(); ++k) {
        const Step step = queue[k];
        take_tube(step.tube, slices_.first(first));
        if (step.left <= 0 || s.is_root(step.tube)) continue;
        for (const int end : {0, 1}) {
            slices_.for_each_tube_at(slices_.node(step.tube, end), [&](NodeId t) {
                const float rest = step.left - distance(s.position(t), s.position(s.parent(t)));
                const auto [at, is_new] = left.try_emplace(t.index(), rest);
                if (!is_new && rest <= at->second) return;
                at->second = rest;
                queue.push_back({t, rest});
            });
        }
    }
}

// All slices at a branch node, once one of them goes.
void Knots::close_branch_node(NodeId n) {
    if (!slices_.is_fork(n)) return;
    slices_.for_each_tube_at(n, [&](NodeId t) { take(slices_.at(t, n)); });
}

// The seam where the upper slice begins.
Seam Knots::seam_between(Slice lower, Slice upper) const {
    const bool upper_goes = contains(upper);
    Seam seam{upper_goes ? upper : lower,
              upper_goes ? lower : upper,
              !upper_goes,
              slices_.ring(upper, mesh_.quads),
              {},
              {},
              0};
    if (!upper_goes) std::reverse(seam.ring.begin(), seam.ring.end());
    std::span<const Vec3> x = mesh_.positions;
    for (const std::uint32_t v : seam.ring) seam.center += x[v];
    seam.center *= 1 / static_cast<float>(seam.ring.size());
    Vec3 area;
    for (std::size_t k = 0; k < seam.ring.size(); ++k) {
        const Vec3 a = x[seam.ring[k]] - seam.center;
        area += cross(a, x[seam.ring[(k + 1) % seam.ring.size()]] - seam.center);
        seam.radius += length(a);
    }
    seam.radius /= static_cast<float>(seam.ring.size());
    // Faces run counter-clockwise seen from outside: about the direction away from where the ring is the end.
    seam.outward = -normalized(area);
    return seam;
}

// The slice before and after a seam on one side of a slice that goes; none where no slice that stays follows.
std::optional<std::array<Slice, 2>> Knots::seam_beside(Slice gone, bool to_tip) const {
    const Slice kept = slices_.next(gone, to_tip);
    if (kept == Slices::kNone || contains(kept)) return {};
    if (to_tip) return {{gone, kept}};
    // At a root in the middle of a chain both tubes begin: the second of them looks back to the first.
    const Skeleton& s = map_.tubes;
    const NodeId a = slices_.tube(gone), b = slices_.tube(kept);
    if (a != b && s.parent(a) == s.parent(b)) return {{std::min(gone, kept), std::max(gone, kept)}};
    return {{kept, gone}};
}

// A seam lies well when the tubes within the window about it run on straight and in equal width, without a
// branch node or an end, and when all other tubes are clear of it.
bool Knots::lies_well(const Seam& seam) const {
    const Skeleton& s = map_.tubes;
    std::vector<NodeId> own;
    for (const bool to_tip : {true, false}) {
        NodeId tube = slices_.tube(seam.to_tip == to_tip ? seam.kept : seam.gone);
        Vec3 at = seam.center;
        bool up = to_tip;
        for (float way = 0;;) {
            own.push_back(tube);
            const NodeId node = slices_.node(tube, up ? 1 : 0);
            const Vec3 along = s.position(node) - at;
            const bool begins_near = way < kWindow * seam.radius;
            way += length(along);
            const float sense = to_tip == seam.to_tip ? 1.0f : -1.0f;
            const bool is_long = length(along) > 0.2f * seam.radius;
            if (begins_near && is_long && sense * dot(normalized(along), seam.outward) < kLeastCosine)
                return false;
            if (way >= kOwnWay * seam.radius) break;
            const bool is_near = way < kWindow * seam.radius;
            const float ratio = s.radius(node) / seam.radius;
            if (is_near && (ratio > kGreatestRatio || ratio * kGreatestRatio < 1)) return false;
            NodeId onward;
            if (slices_.is_fork(node) || slices_.tube_count(node) != 2) {
                if (is_near) return false;
                // What goes on at a branch node is not in the way.
                if (up) onward = s.leader(node);
                if (!up && !s.is_root(node) && s.leader(node) == tube) onward = node;
                if (!onward) break;
            } else {
                slices_.for_each_tube_at(node, [&](NodeId t) {
                    if (t != tube) onward = t;
                });
            }
            up = onward != node;
            tube = onward;
            at = s.position(node);
        }
    }
    const Vec3d c(seam.center);
    const double reach = kFarthest * static_cast<double>(seam.radius);
    const double limit = reach * reach;
    bool clear = true;
    capsules_.visit_near(c, limit, [&](std::uint32_t i, double) {
        if (!clear || std::find(own.begin(), own.end(), capsules_.node(i)) != own.end()) return;
        clear = is_clear_of(seam, capsules_.cone(i));
    });
    return clear;
}

// What was closed stays so: whether a seam lies well does not depend on what goes elsewhere.
void Knots::close() {
    for (; closed_ < taken_.size(); ++closed_) {
        const Slice gone = taken_[closed_];
        const NodeId t = slices_.tube(gone);
        if (!map_.tubes.is_root(t)) {
            if (gone == slices_.first(t)) close_branch_node(map_.tubes.parent(t));
            if (gone == slices_.last(t)) close_branch_node(slices_.end_node(t));
        }
        for (const bool to_tip : {false, true}) {
            const auto seam = seam_beside(gone, to_tip);
            if (!seam) continue;
            const Slice kept = (*seam)[0] == gone ? (*seam)[1] : (*seam)[0];
            if (spared_[kept] == 0 && !lies_well(seam_between((*seam)[0], (*seam)[1]))) take(kept);
        }
    }
}

std::vector<KnotGroup> Knots::groups() {
    const Skeleton& s = map_.tubes;
    std::vector<Slice> gone = taken_;
    std::sort(gone.begin(), gone.end());
    std::vector<std::array<Slice, 2>> seams;  // the second begins there
    for (const Slice i : gone) {
        const Slice lower = slices_.next(i, false);
        if (lower != Slices::kNone && contains(lower)) join(lower, i);
        for (const bool to_tip : {false, true}) {
            if (const auto seam = seam_beside(i, to_tip)) seams.emplace_back(*seam);
        }
        const NodeId t = slices_.tube(i);
        if (s.is_root(t)) continue;
        for (const NodeId n : {s.parent(t), slices_.end_node(t)}) {
            if (slices_.at(t, n) != i || !slices_.is_fork(n)) continue;
            slices_.for_each_tube_at(n, [&](NodeId other) { join(i, slices_.at(other, n)); });
        }
    }
    std::sort(seams.begin(), seams.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; });
    std::vector<std::uint32_t> place(slices_.count(), kNoRow);
    std::vector<KnotGroup> out;
    const auto group_of = [&](Slice i) -> KnotGroup& {
        std::uint32_t& at = place[together_.find(i)];
        if (at == kNoRow) {
            at = static_cast<std::uint32_t>(out.size());
            out.emplace_back();
        }
        return out[at];
    };
    for (const Slice i : gone) group_of(i).slices.push_back(i);
    for (const auto [lower, upper] : seams)
        group_of(contains(upper) ? upper : lower).seams.push_back(seam_between(lower, upper));
    return out;
}

}  // namespace coppice::pipeline_internal
