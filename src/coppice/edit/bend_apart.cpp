#include "coppice/edit/bend_apart.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "coppice/base/check_fields.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/skeleton/measure.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 1024;
// Over-relaxation of a push, so that a small remaining overlap converges quickly.
constexpr double kBeyond = 1.1;
// [gap] segments closer than this are pushed apart, although only overlaps count in the report.
constexpr double kEnough = 0.5;
// Ratio of the stiffness of a contact to the stiffness of the path that it bends.
constexpr double kContactStiffness = 30;
// Factor per round on the weight of a goal that is no longer pushed.
constexpr double kKept = 0.9;
constexpr double kMinShift = 2e-3;  // [radius]
// [path length from the root] maximum displacement of a node.
constexpr double kMaxBend = 0.5;

/// Two segments of different trees that are too close to each other.
struct Contact {
    NodeId one, other;
    ClosestParameters at;
    Vec3d away;      ///< unit vector from `other` to `one`
    double lacking;  ///< [m] missing distance
    bool overlaps;   ///< whether the branches overlap
};

/// A deformable forest. The path to every node has a compliance, contacts define goals of nodes, and the
/// displacements of all nodes minimize the bending energy for these goals.
class Bending {
  public:
    Bending(const Skeleton& s, const std::vector<char>& may_move, const BendApartOptions& options,
            const Context& ctx)
        : s_(s),
          options_(options),
          ctx_(ctx),
          root_(tree_roots(s)),
          shift_(s.size()),
          goal_(s.size()),
          weight_(s.size(), 0),
          compliance_(s.size(), 0),
          stiffness_(s.size(), 0),
          most_(s.size(), 0) {
        for (const NodeId n : nodes(s)) {
            if (s.is_root(n) || may_move[n.index()] == 0) continue;
            const std::uint32_t i = n.index(), p = s.parent(n).index();
            const Segment g = s.segment(n);
            const double length = distance(Vec3d(g.a), Vec3d(g.b));
            const double r = 0.5 * (double{g.radius_a} + g.radius_b);
            const double own = std::max(length, 1e-3 * r) / (r * r);
            stiffness_[i] = 1 / own;
            compliance_[i] = compliance_[p] + own;
            most_[i] = most_[p] + kMaxBend * length;
        }
    }

    BendApartReport run() {
        BendApartReport report;
        std::vector<Contact> found = contacts();
        report.before = overlapping(found);
        while (!found.empty() && report.rounds < options_.rounds) {
            check_in(ctx_, static_cast<std::size_t>(report.rounds),
                     static_cast<std::size_t>(options_.rounds));
            set_goals(found);
            relax();
            ++report.rounds;
            found = contacts();
        }
        report.after = overlapping(found);
        for (const NodeId n : nodes(s_)) {
            const Vec3d u = shift(n);
            if (u == Vec3d{}) continue;
            ++report.moved;
            report.farthest = std::max(report.farthest, static_cast<float>(length(u)));
        }
        ctx_.report(1);
        return report;
    }

    Vec3 place(NodeId n) const {
        const Vec3d u = shift(n);
        return u == Vec3d{} ? s_.position(n) : Vec3(Vec3d(s_.position(n)) + u);
    }

  private:
    // Invisibly small displacements are set to zero, so that most of a trunk is unchanged.
    Vec3d shift(NodeId n) const {
        const Vec3d& u = shift_[n.index()];
        return length(u) < kMinShift * s_.radius(n) ? Vec3d{} : u;
    }
    Vec3d at(NodeId n) const { return Vec3d(s_.position(n)) + shift(n); }

    static std::uint32_t overlapping(const std::vector<Contact>& all) {
        return static_cast<std::uint32_t>(std::ranges::count(all, true, &Contact::overlaps));
    }

    std::vector<Contact> contacts() const {
        std::vector<Box3> boxes(s_.size());
        parallel_for(ctx_, s_.size(), kGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i)), from = s_.is_root(n) ? n : s_.parent(n);
            const float r = std::max(s_.radius(n), s_.radius(from));
            boxes[i] = capsule_box(place(from), place(n), r * (1 + options_.gap));
        });
        const BoxTree tree(boxes, ctx_);
        std::vector<std::vector<Contact>> found(tree.group_count());
        parallel_for(ctx_, found.size(), kGrain / BoxTree::kWidth, [&](std::size_t g) {
            tree.overlaps(static_cast<std::uint32_t>(g), [&](std::uint32_t p, std::uint32_t q) {
                const NodeId a(tree.item(p)), b(tree.item(q));
                if (root_[a.index()] == root_[b.index()]) return;
                if (const auto c = contact(std::min(a, b), std::max(a, b))) found[g].push_back(*c);
            });
        });
        std::vector<Contact> all;
        for (const auto& f : found) all.insert(all.end(), f.begin(), f.end());
        std::ranges::sort(all, {}, [](const Contact& c) { return std::pair(c.one, c.other); });
        return all;
    }

    std::optional<Contact> contact(NodeId one, NodeId other) const {
        // A root without children is a ball; otherwise its segments represent it.
        for (const NodeId n : {one, other}) {
            if (s_.is_root(n) && !s_.is_tip(n)) return {};
        }
        const Vec3d a = start(one), b = at(one), c = start(other), d = at(other);
        const ClosestParameters near = closest_parameters(a, b, c, d);
        const double radii = radius(one, near.on_a) + radius(other, near.on_b);
        const Vec3d between = lerp(a, b, near.on_a) - lerp(c, d, near.on_b);
        const double apart = length(between);
        if (apart >= radii * (1 + kEnough * options_.gap)) return {};
        const Vec3d across = normalized(cross(b - a, d - c), perpendicular(normalized(b - a, {0, 0, 1})));
        return Contact{one,
                       other,
                       near,
                       apart > 1e-6 * radii ? between / apart : across,
                       radii * (1 + double{options_.gap}) - apart,
                       apart < radii};
    }

    Vec3d start(NodeId n) const { return at(s_.is_root(n) ? n : s_.parent(n)); }
    double radius(NodeId n, double t) const {
        if (s_.is_root(n)) return s_.radius(n);
        const Segment g = s_.segment(n);
        return std::lerp(double{g.radius_a}, double{g.radius_b}, t);
    }
    double compliance(NodeId n, double t) const {
        const double end = compliance_[n.index()];
        return s_.is_root(n) ? end : std::lerp(compliance_[s_.parent(n).index()], end, t);
    }

    /// Nodes that are no longer pushed are held in place with decreasing weight, so that they neither fall
    /// back at once nor remain an obstacle.
    void set_goals(const std::vector<Contact>& found) {
        std::vector<Vec3d> push(s_.size());
        std::vector<double> pushes(s_.size(), 0);
        const auto add = [&](NodeId n, double t, Vec3d by) {
            for (const bool end : {false, true}) {
                if (!end && s_.is_root(n)) continue;
                const std::uint32_t i = (end ? n : s_.parent(n)).index();
                const double share = end ? t : 1 - t;
                push[i] += by * share;
                pushes[i] += share;
            }
        };
        for (const Contact& c : found) {
            const double one = compliance(c.one, c.at.on_a), other = compliance(c.other, c.at.on_b);
            if (one + other <= 0) continue;
            const Vec3d by = c.away * (kBeyond * c.lacking / (one + other));
            if (one > 0) add(c.one, c.at.on_a, by * one);
            if (other > 0) add(c.other, c.at.on_b, by * -other);
        }
        for (const NodeId n : nodes(s_)) {
            const std::uint32_t i = n.index();
            if (pushes[i] <= 0) {
                goal_[i] = shift_[i];
                weight_[i] *= kKept;
                continue;
            }
            if (most_[i] <= 0) continue;
            const Vec3d goal = shift_[i] + push[i] / std::max(pushes[i], 1.0);
            const double way = length(goal);
            goal_[i] = way > most_[i] ? goal * (most_[i] / way) : goal;
            weight_[i] = std::max(weight_[i], std::min(pushes[i], 1.0) * kContactStiffness / compliance_[i]);
        }
    }

    /// Minimizes the bending energy: solves a tree of springs from the tips to the roots and back.
    void relax() {
        std::vector<double> diagonal(s_.size());
        std::vector<Vec3d> right(s_.size());
        for (const NodeId n : nodes(s_)) {
            const std::uint32_t i = n.index();
            diagonal[i] += stiffness_[i] + weight_[i];
            right[i] = goal_[i] * weight_[i];
            if (!s_.is_root(n)) diagonal[s_.parent(n).index()] += stiffness_[i];
        }
        for (std::uint32_t i = s_.size(); i-- > 0;) {
            if (stiffness_[i] <= 0) continue;
            const std::uint32_t p = s_.parent(NodeId(i)).index();
            const double part = stiffness_[i] / diagonal[i];
            diagonal[p] -= part * stiffness_[i];
            right[p] += right[i] * part;
        }
        for (const NodeId n : nodes(s_)) {
            const std::uint32_t i = n.index();
            if (stiffness_[i] <= 0) continue;
            shift_[i] = (right[i] + shift_[s_.parent(n).index()] * stiffness_[i]) / diagonal[i];
        }
    }

    const Skeleton& s_;
    const BendApartOptions& options_;
    const Context& ctx_;
    std::vector<NodeId> root_;
    std::vector<Vec3d> shift_, goal_;
    std::vector<double> weight_;      // of the goals; 0: no goal
    std::vector<double> compliance_;  // [1/m] of the path from the root; 0: fixed
    std::vector<double> stiffness_;   // [m] of the segment; 0: fixed
    std::vector<double> most_;        // [m] maximum displacement of a node
};

}  // namespace

BendApartResult bend_apart(const Skeleton& forest, const BendApartOptions& options, const Context& ctx) {
    check_fields(options, "apart");
    Bending bending(forest, std::vector<char>(forest.size(), 1), options, ctx);
    const BendApartReport report = bending.run();
    std::vector<Vec3> positions;
    for (const NodeId n : nodes(forest)) positions.push_back(bending.place(n));
    return {Skeleton({forest.parents().begin(), forest.parents().end()}, std::move(positions),
                     {forest.radii().begin(), forest.radii().end()}, forest.origin(),
                     {forest.stable_ids().begin(), forest.stable_ids().end()}),
            report};
}

EditChange bend_apart(EditableTree& tree, const NodeSet& nodes, const BendApartOptions& options,
                      const Context& ctx) {
    edit_internal::check_set(tree, nodes);
    check_fields(options, "apart");
    Column<StableId, char> chosen(tree.slots());
    for (const StableId top : nodes) {
        if (chosen[top] == 0) tree.visit_subtree(top, [&](StableId n) { chosen[n] = 1; });
    }
    const Skeleton forest = tree.skeleton();
    std::vector<char> may_move;
    for (const NodeId n : coppice::nodes(forest)) may_move.push_back(chosen[forest.stable_id(n)]);
    Bending bending(forest, may_move, options, ctx);
    bending.run();
    TreeEdit edit(tree);
    for (const NodeId n : coppice::nodes(forest)) {
        const Vec3 to = bending.place(n);
        if (to != forest.position(n)) edit.move(forest.stable_id(n), to);
    }
    return edit.commit();
}

void list_fields(BendApartOptions& o, FieldList& list) {
    list.add(
        Field{"gap",
              "Gap between the surfaces of branches of two trees, as a multiple of the sum of their radii.",
              Unit::none, 0, 10},
        o.gap);
    list.add(
        Field{"rounds", "Maximum number of rounds that find and resolve contacts.", Unit::none, 1, 10'000},
        o.rounds);
}

}  // namespace coppice
