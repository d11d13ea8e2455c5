#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/pipeline/repair/removed_rows_internal.h"

namespace coppice::pipeline_internal {
namespace {

// Limits for the position of a cut ring, in radii of the tube there.
constexpr float kWindow = 0.6f;       // distance along the tube that is checked in both directions
constexpr float kMinCosine = 0.5f;    // between the directions of the tube at the cut ring and in the window
constexpr float kMaxRatio = 1.8f;     // between radii in the window
constexpr float kOwnWay = 3.0f;       // distance along which the tube is not compared with itself
constexpr double kClearance = 1.05;   // minimum distance from other branches, in sums of radii,
constexpr double kSlabInside = 0.8;   // within a slab that extends to this distance on the removed side
constexpr double kSlabOutside = 0.3;  // and to this distance on the kept side
constexpr double kFarthest = 40;      // distance beyond which branches are ignored

// Returns whether a branch is clear of the tube at its cut ring, where triangles are cut off and joined to
// it: a slab across the tube, mostly on the removed side.
bool is_clear_of(const CutRing& cut_ring, const RoundCone& branch) {
    const Vec3d outward(cut_ring.outward), from = branch.a - Vec3d(cut_ring.center);
    const auto r = static_cast<double>(cut_ring.radius);
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

// Returns the boxes of cut rings' centres, inflated by twice their radii, for which a branch may not be
// clear.
std::vector<Box3> boxes_around(std::span<const RoundCone> branches) {
    std::vector<Box3> out;
    for (const RoundCone& c : branches) {
        const double reach = 2 * std::max(c.radius_a, c.radius_b());
        out.push_back(capsule_box(Vec3(c.a), Vec3(c.b()), static_cast<float>(reach)));
    }
    return out;
}

}  // namespace

std::vector<std::uint32_t> ring_vertices(const RowGroup& group) {
    std::vector<std::uint32_t> out;
    for (const CutRing& cut_ring : group.cut_rings)
        out.insert(out.end(), cut_ring.ring.begin(), cut_ring.ring.end());
    return out;
}

RemovedRows::RemovedRows(const TubeRows& tube_rows, const QuadMesh& mesh, std::vector<RoundCone> hidden,
                         const Context& ctx)
    : tube_rows_(tube_rows),
      mesh_(mesh),
      capsules_(tube_rows.tubes(), tube_rows.tubes().origin(), ctx),
      hidden_(std::move(hidden)),
      near_hidden_(boxes_around(hidden_), ctx),
      gone_(tube_rows.count(), 0),
      excluded_(tube_rows.count(), 0),
      needed_(tube_rows.count(), 0),
      together_(tube_rows.count()) {}

void RemovedRows::mark_removed(TubeRow s) {
    if (gone_[s] != 0 || excluded_[s] != 0) return;
    gone_[s] = 1;
    marked_.push_back(s);
}

// Marks rows as removed along the tube, beginning with one.
void RemovedRows::mark_along(TubeRow at, bool to_tip, float way) {
    const Skeleton& s = tube_rows_.tubes();
    while (at != kNoIndex && way > 0) {
        mark_removed(at);
        const NodeId t = tube_rows_.tube(at);
        if (s.is_root(t)) return;
        way -= distance(s.position(t), s.position(s.parent(t))) / static_cast<float>(tube_rows_.per_tube());
        const TubeRow next = tube_rows_.next(at, to_tip);
        // Beyond a root in the middle of a chain the direction towards the tip is reversed.
        if (next != kNoIndex && !to_tip && s.parent(t) == s.parent(tube_rows_.tube(next))) to_tip = true;
        at = next;
    }
}

void RemovedRows::move_on(const CutRing& cut_ring, float radii) {
    mark_along(cut_ring.kept, cut_ring.to_tip, radii * cut_ring.radius);
}

void RemovedRows::mark_around(TubeRow tube_row, float radii) {
    const float way = radii * tube_rows_.tubes().radius(tube_rows_.tube(tube_row));
    mark_along(tube_row, true, way);
    mark_along(tube_row, false, way);
}

void RemovedRows::require(TubeRow s) {
    needed_[s] = 1;
    mark_removed(s);
}

bool RemovedRows::needs(const RowGroup& group) const {
    return std::ranges::any_of(group.tube_rows, [&](TubeRow s) { return needed_[s] != 0; });
}

void RemovedRows::exclude(const RowGroup& group) {
    for (const TubeRow s : group.tube_rows) {
        gone_[s] = 0;
        excluded_[s] = 1;
    }
    std::erase_if(marked_, [&](TubeRow s) { return gone_[s] == 0; });
    closed_ = marked_.size();
    has_excluded_ = true;
}

void RemovedRows::mark_trees(std::span<const NodeId> trees, std::span<const NodeId> root) {
    for (const NodeId n : nodes(tube_rows_.tubes())) {
        const NodeId tree = root[n.index()];
        if (std::binary_search(trees.begin(), trees.end(), tree)) mark_tube(n, tube_rows_.first(tree));
    }
}

// Marks all rows of a tube as removed, including excluded ones, and joins them to the group of a row.
void RemovedRows::mark_tube(NodeId tube, TubeRow group) {
    for (TubeRow i = tube_rows_.first(tube); i <= tube_rows_.last(tube); ++i) {
        excluded_[i] = 0;
        mark_removed(i);
        join(group, i);
    }
}

void RemovedRows::mark_zone(TubeRow tube_row, float radii) {
    const Skeleton& s = tube_rows_.tubes();
    const NodeId first = tube_rows_.tube(tube_row);
    struct Step {
        NodeId tube;
        float left;  // [m] remaining distance beyond the tube
    };
    std::vector<Step> queue{{first, radii * s.radius(first)}};
    std::unordered_map<std::uint32_t, float> left{{first.index(), queue[0].left}};
    for (std::size_t k = 0; k < queue.size(); ++k) {
        const Step step = queue[k];
        mark_tube(step.tube, tube_rows_.first(first));
        if (step.left <= 0 || s.is_root(step.tube)) continue;
        for (const int end : {0, 1}) {
            tube_rows_.for_each_tube_at(tube_rows_.node(step.tube, end), [&](NodeId t) {
                const float rest = step.left - distance(s.position(t), s.position(s.parent(t)));
                const auto [at, is_new] = left.try_emplace(t.index(), rest);
                if (!is_new && rest <= at->second) return;
                at->second = rest;
                queue.push_back({t, rest});
            });
        }
    }
}

// Marks all rows at a branch node as removed once one of them is.
void RemovedRows::close_branch_node(NodeId n) {
    if (!tube_rows_.is_fork(n)) return;
    tube_rows_.for_each_tube_at(n, [&](NodeId t) { mark_removed(tube_rows_.at(t, n)); });
}

// Returns the cut ring at which the upper row begins.
CutRing RemovedRows::cut_ring_between(TubeRow lower, TubeRow upper) const {
    const bool upper_goes = contains(upper);
    CutRing cut_ring{upper_goes ? upper : lower,
                     upper_goes ? lower : upper,
                     !upper_goes,
                     tube_rows_.ring(upper, mesh_.quads),
                     {},
                     {},
                     0};
    if (!upper_goes) std::reverse(cut_ring.ring.begin(), cut_ring.ring.end());
    std::span<const Vec3> x = mesh_.positions;
    for (const std::uint32_t v : cut_ring.ring) cut_ring.center += x[v];
    cut_ring.center *= 1 / static_cast<float>(cut_ring.ring.size());
    Vec3 area;
    for (std::size_t k = 0; k < cut_ring.ring.size(); ++k) {
        const Vec3 a = x[cut_ring.ring[k]] - cut_ring.center;
        area += cross(a, x[cut_ring.ring[(k + 1) % cut_ring.ring.size()]] - cut_ring.center);
        cut_ring.radius += length(a);
    }
    cut_ring.radius /= static_cast<float>(cut_ring.ring.size());
    // Faces are counter-clockwise seen from outside: around the direction away from the row that the ring
    // ends.
    cut_ring.outward = -normalized(area);
    return cut_ring;
}

// Returns the rows before and after the cut ring on one side of a removed row; nullopt if no kept row
// follows.
std::optional<std::array<TubeRow, 2>> RemovedRows::adjacent_cut_ring(TubeRow gone, bool to_tip) const {
    const TubeRow kept = tube_rows_.next(gone, to_tip);
    if (kept == kNoIndex || contains(kept)) return {};
    if (to_tip) return {{gone, kept}};
    // At a root in the middle of a chain both tubes begin: the second is treated as the one that follows the
    // first.
    const Skeleton& s = tube_rows_.tubes();
    const NodeId a = tube_rows_.tube(gone), b = tube_rows_.tube(kept);
    if (a != b && s.parent(a) == s.parent(b)) return {{std::min(gone, kept), std::max(gone, kept)}};
    return {{kept, gone}};
}

// Returns whether a cut ring is at a suitable position: the tubes within the window around it are straight
// and of equal width, without a branch node or an end, and all other tubes are clear of it.
bool RemovedRows::is_valid_cut(const CutRing& cut_ring) const {
    const Skeleton& s = tube_rows_.tubes();
    std::vector<NodeId> own;
    for (const bool to_tip : {true, false}) {
        NodeId tube = tube_rows_.tube(cut_ring.to_tip == to_tip ? cut_ring.kept : cut_ring.gone);
        Vec3 at = cut_ring.center;
        bool up = to_tip;
        for (float way = 0;;) {
            own.push_back(tube);
            const NodeId node = tube_rows_.node(tube, up ? 1 : 0);
            const Vec3 along = s.position(node) - at;
            const bool begins_near = way < kWindow * cut_ring.radius;
            way += length(along);
            const float sense = to_tip == cut_ring.to_tip ? 1.0f : -1.0f;
            const bool is_long = length(along) > 0.2f * cut_ring.radius;
            if (begins_near && is_long && sense * dot(normalized(along), cut_ring.outward) < kMinCosine)
                return false;
            if (way >= kOwnWay * cut_ring.radius) break;
            const bool is_near = way < kWindow * cut_ring.radius;
            const float ratio = s.radius(node) / cut_ring.radius;
            if (is_near && (ratio > kMaxRatio || ratio * kMaxRatio < 1)) return false;
            NodeId onward;
            if (tube_rows_.is_fork(node) || tube_rows_.tube_count(node) != 2) {
                if (is_near) return false;
                // The continuation at a branch node is not an obstacle.
                if (up) onward = s.leader(node);
                if (!up && !s.is_root(node) && s.leader(node) == tube) onward = node;
                if (!onward) break;
            } else {
                tube_rows_.for_each_tube_at(node, [&](NodeId t) {
                    if (t != tube) onward = t;
                });
            }
            up = onward != node;
            tube = onward;
            at = s.position(node);
        }
    }
    const Vec3d c(cut_ring.center);
    const double reach = kFarthest * static_cast<double>(cut_ring.radius);
    const double limit = reach * reach;
    bool clear = true;
    capsules_.visit_near(c, limit, [&](std::uint32_t i, double) {
        if (!clear || std::find(own.begin(), own.end(), capsules_.node(i)) != own.end()) return;
        clear = is_clear_of(cut_ring, capsules_.cone(i));
    });
    const Box3 box = Box3{cut_ring.center, cut_ring.center}.inflated(2 * cut_ring.radius);
    near_hidden_.visit_overlapping(
        box, [&](std::uint32_t i) { clear = clear && is_clear_of(cut_ring, hidden_[i]); });
    return clear;
}

// Closed rows remain closed: whether a cut ring is at a suitable position does not depend on rows removed
// elsewhere.
void RemovedRows::close() {
    for (; closed_ < marked_.size(); ++closed_) {
        const TubeRow gone = marked_[closed_];
        const NodeId t = tube_rows_.tube(gone);
        if (!tube_rows_.tubes().is_root(t)) {
            if (gone == tube_rows_.first(t)) close_branch_node(tube_rows_.tubes().parent(t));
            if (gone == tube_rows_.last(t)) close_branch_node(tube_rows_.end_node(t));
        }
        for (const bool to_tip : {false, true}) {
            const auto cut_ring = adjacent_cut_ring(gone, to_tip);
            if (!cut_ring) continue;
            const TubeRow kept = (*cut_ring)[0] == gone ? (*cut_ring)[1] : (*cut_ring)[0];
            if (excluded_[kept] == 0 && !is_valid_cut(cut_ring_between((*cut_ring)[0], (*cut_ring)[1])))
                mark_removed(kept);
        }
    }
}

std::vector<RowGroup> RemovedRows::groups() {
    const Skeleton& s = tube_rows_.tubes();
    std::vector<TubeRow> gone = marked_;
    std::sort(gone.begin(), gone.end());
    std::vector<std::array<TubeRow, 2>> cut_rings;  // the second row begins there
    for (const TubeRow i : gone) {
        const TubeRow lower = tube_rows_.next(i, false);
        if (lower != kNoIndex && contains(lower)) join(lower, i);
        for (const bool to_tip : {false, true}) {
            if (const auto cut_ring = adjacent_cut_ring(i, to_tip)) cut_rings.emplace_back(*cut_ring);
        }
        const NodeId t = tube_rows_.tube(i);
        if (s.is_root(t)) continue;
        for (const NodeId n : {s.parent(t), tube_rows_.end_node(t)}) {
            if (tube_rows_.at(t, n) != i || !tube_rows_.is_fork(n)) continue;
            tube_rows_.for_each_tube_at(n, [&](NodeId other) { join(i, tube_rows_.at(other, n)); });
        }
    }
    std::sort(cut_rings.begin(), cut_rings.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; });
    std::vector<std::uint32_t> place(tube_rows_.count(), kNoIndex);
    std::vector<RowGroup> out;
    const auto find_group = [&](TubeRow i) -> RowGroup& {
        std::uint32_t& at = place[together_.find(i)];
        if (at == kNoIndex) {
            at = static_cast<std::uint32_t>(out.size());
            out.emplace_back();
        }
        return out[at];
    };
    for (const TubeRow i : gone) find_group(i).tube_rows.push_back(i);
    for (const auto [lower, upper] : cut_rings)
        find_group(contains(upper) ? upper : lower).cut_rings.push_back(cut_ring_between(lower, upper));
    return out;
}

}  // namespace coppice::pipeline_internal
