#include "coppice/cage/cage.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/cage/hub_internal.h"
#include "coppice/cage/openings_internal.h"
#include "coppice/cage/sides_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice {
namespace {

using cage_internal::Branch;
using cage_internal::Frame;
using cage_internal::Hub;
using cage_internal::Openings;
using cage_internal::QuadKind;
using cage_internal::Ring;

constexpr float kHalfPi = std::numbers::pi_v<float> / 2;
// Mean radius of a closed cubic B-spline with corners at radius 1 on a square, octagon or 16-gon; the cage is
// enlarged by the inverse.
float shrinkage(int sides) { return sides == 4 ? 0.657f : sides == 8 ? 0.902f : 0.975f; }
// [radii] Position of the last ring of a round end: ahead of the end node and away from the axis.
constexpr float kRoundEndAhead = 1.0f;
constexpr float kRoundEndOut = 1.1f;
// Rings of a flat end, in radii of the tube's ring: the inner one keeps the cap's faces square, and the width
// of the rim is such that subdivision brings it to the tube's radius.
constexpr float kInnerRing = 0.5f;
constexpr float kRim = (6 - 1 - kInnerRing) / 4;
constexpr std::uint32_t kFlatEndQuads = 5;
constexpr std::size_t kCageGrain = 256;

class CageBuilder {
  public:
    CageBuilder(const Skeleton& s, std::span<const NodeId> source, std::span<const NodeId> round_roots,
                std::span<const NodeJoin> joins, const ControlOptions& options, const Context& ctx)
        : s_(s),
          source_(source),
          round_roots_(round_roots),
          options_(options),
          ctx_(ctx),
          shrinkage_(shrinkage(options.sides)),
          node_(s.size()),
          ends_at_(compress_rows<NodeId>(s.size(), [&](const auto& put) {
              for (const NodeJoin& join : joins) put(join.node.index(), join.end);
          })) {
        out_.joins.assign(joins.begin(), joins.end());
        for (const NodeJoin& join : joins) at(join.end).joined = join.node;
    }

    ControlMesh build() && {
        make_hubs();
        count();
        fill_hubs();
        fill_chains();
        fill_tubes();
        for (int sides = 4; sides < options_.sides; sides *= 2) cage_internal::double_sides(out_, kind_);
        return std::move(out_);
    }

  private:
    struct Node {
        std::uint32_t first_vertex = 0;
        std::uint32_t first_quad = 0;
        std::uint32_t hub = 0;  ///< index + 1
        NodeId joined;          ///< node of another branch in which its tube ends
        Ring upper{};           ///< at the parent, where the tube from it begins
        Ring lower{};           ///< at this node, where it ends; both counter-clockwise about its direction
    };

    Node& at(NodeId n) { return node_[n.index()]; }
    const Node& at(NodeId n) const { return node_[n.index()]; }
    std::span<const NodeId> ends_at(NodeId n) const { return ends_at_[n.index()]; }
    // Number of branches that begin at a node, including those that end there.
    std::uint32_t branch_count(NodeId n) const {
        return static_cast<std::uint32_t>(s_.children(n).size() + ends_at(n).size());
    }
    std::uint32_t degree(NodeId n) const { return branch_count(n) + (s_.is_root(n) ? 0 : 1); }
    // Returns whether the orientation of a ring or hub is independent of the chains that meet there.
    bool is_fixed(NodeId n) const {
        return degree(n) >= 3 || (degree(n) == 2 && (s_.is_root(n) || !ends_at(n).empty()));
    }
    bool ends_fixed(NodeId n) const { return is_fixed(n) || at(n).joined; }

    Branch branch_to_parent(NodeId n) const {
        const Segment seg = s_.segment(n);
        return {normalized(seg.a - seg.b), seg.radius_b, distance(seg.a, seg.b)};
    }
    Branch branch_to_child(NodeId c) const {
        const Segment seg = s_.segment(c);
        return {normalized(seg.b - seg.a), seg.radius_a, distance(seg.a, seg.b)};
    }
    // Returns the branches to the children, in their order, those that end there, and then the one to the
    // parent.
    std::vector<Branch> branches(NodeId n) const {
        std::vector<Branch> out;
        out.reserve(degree(n));
        for (const NodeId c : s_.children(n)) out.push_back(branch_to_child(c));
        for (const NodeId e : ends_at(n)) out.push_back(branch_to_parent(e));
        if (!s_.is_root(n)) out.push_back(branch_to_parent(n));
        return out;
    }
    std::uint32_t number_among_siblings(NodeId c) const { return place(s_.children(s_.parent(c)), c); }
    static std::uint32_t place(std::span<const NodeId> in, NodeId n) {
        return static_cast<std::uint32_t>(std::find(in.begin(), in.end(), n) - in.begin());
    }
    // Returns the branch that continues towards the tip: the leader, or the first that ends there.
    std::uint32_t onward(NodeId n) const { return s_.is_tip(n) ? 0 : number_among_siblings(s_.leader(n)); }

    void make_hubs() {
        std::vector<NodeId> branching;
        for (const NodeId n : nodes(s_)) {
            if (degree(n) < 3) continue;
            branching.push_back(n);
            at(n).hub = static_cast<std::uint32_t>(branching.size());
        }
        std::vector<std::optional<Openings>> plan(branching.size());
        parallel_for(ctx_, branching.size(), kCageGrain, [&](std::size_t i) {
            const NodeId n = branching[i];
            if (s_.is_root(n)) return;
            plan[i] = Openings::plan(branches(n), branch_count(n), onward(n));
        });
        hub_.resize(branching.size());
        parallel_for(ctx_, branching.size(), kCageGrain, [&](std::size_t i) {
            std::optional<Hub> openings;
            if (plan[i]) openings = plan[i]->build(rooms(branching[i], plan));
            hub_[i] = openings ? std::move(*openings) : make_hub(branching[i]);
        });
    }

    // [m] Returns the length of each branch that is available to the hub of a node, without the hub at the
    // other end.
    std::vector<float> rooms(NodeId n, std::span<const std::optional<Openings>> plan) const {
        std::vector<float> out;
        for (const NodeId c : s_.children(n)) out.push_back(room_towards_tip(c, plan));
        for (const NodeId e : ends_at(n))
            out.push_back(room(branch_to_parent(e).length, s_.parent(e), number_among_siblings(e), plan));
        out.push_back(room(branch_to_parent(n).length, s_.parent(n), number_among_siblings(n), plan));
        return out;
    }
    float room_towards_tip(NodeId c, std::span<const std::optional<Openings>> plan) const {
        const float length = branch_to_child(c).length;
        const NodeId node = at(c).joined;
        if (!node) return room(length, c, branch_count(c), plan);
        const auto number = static_cast<std::uint32_t>(s_.children(node).size()) + place(ends_at(node), c);
        return room(length, node, number, plan);
    }
    float room(float length, NodeId other_end, std::uint32_t branch,
               std::span<const std::optional<Openings>> plan) const {
        constexpr float kOfHub = 1.2f;  // [radii]
        constexpr float kMin = 0.15f;   // of the length
        float taken = kMin * length;
        if (const std::uint32_t hub = node_[other_end.index()].hub; hub > 0) {
            taken = plan[hub - 1] ? plan[hub - 1]->reach(branch)
                                  : std::min(kOfHub * s_.radius(other_end), 0.5f * length);
        }
        return length - taken;
    }

    Hub make_hub(NodeId n) const {
        std::vector<Branch> branch = branches(n);
        const auto straightest_from = [&](std::uint32_t from, std::size_t count) {
            std::uint32_t best = from == 0 ? 1 : 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                if (i != from && dot(branch[i].direction, branch[from].direction) <
                                     dot(branch[best].direction, branch[from].direction)) {
                    best = i;
                }
            }
            return best;
        };
        const std::uint32_t count = branch_count(n);
        const std::uint32_t stem = s_.is_root(n) ? onward(n) : count;
        const std::uint32_t leader = straightest_from(stem, count);
        const bool of_root = s_.is_root(n) || is_round_root(s_.parent(n));
        if (!of_root || !is_ball(s_, n)) return cage_internal::build_hub(branch, stem, leader);
        // Branches get an equal share of a ball, independent of their radii.
        for (Branch& b : branch) b.radius = s_.radius(n);
        Hub hub = cage_internal::build_hub(branch, stem, leader);
        for (Vec3& p : hub.position) p = normalized(p, Vec3{0, 0, 1}) * s_.radius(n);
        return hub;
    }

    std::uint32_t vertex_count(NodeId n) {
        if (at(n).joined) return 0;
        if (degree(n) == 0 || is_flat(n)) return 8;
        return degree(n) < 3 ? 4 : static_cast<std::uint32_t>(hub_[at(n).hub - 1].position.size());
    }
    std::uint32_t quad_count(NodeId n) {
        const std::uint32_t tube = s_.is_root(n) ? 0 : 4;
        if (degree(n) > 2) return tube + static_cast<std::uint32_t>(hub_[at(n).hub - 1].quads.size());
        if (degree(n) == 0) return 6;
        if (at(n).joined) return tube;
        if (degree(n) == 1) return tube + (is_open(n) ? 0 : is_flat(n) ? kFlatEndQuads : 1);
        return tube;
    }
    bool is_open(NodeId n) const { return has_base(n) && options_.base == BaseShape::open; }
    bool is_flat(NodeId n) const {
        if (degree(n) != 1 || at(n).joined) return false;
        return s_.is_root(n) ? has_base(n) && options_.base == BaseShape::flat
                             : options_.tips == TipShape::flat;
    }
    bool has_base(NodeId n) const { return s_.is_root(n) && degree(n) == 1 && !is_round_root(n); }
    bool is_round_root(NodeId n) const {
        return std::ranges::binary_search(round_roots_, n.index(), {}, &NodeId::index);
    }
    Vec3 outward(NodeId end) const {
        return s_.is_root(end) ? -branch_to_child(s_.children(end)[0]).direction
                               : branch_to_child(end).direction;
    }

    void count() {
        std::uint32_t vertices = 0, quads = 0;
        for (const NodeId n : nodes(s_)) {
            at(n).first_vertex = vertices;
            at(n).first_quad = quads;
            if (is_flat(n)) {
                const Vec3 normal = outward(n);
                out_.clip.push_back({normal, dot(normal, s_.position(n)), first_cap_quad(n), kFlatEndQuads});
            }
            vertices += vertex_count(n);
            quads += quad_count(n);
        }
        out_.cage.positions.resize(vertices);
        out_.cage.origin = s_.origin();
        out_.anchors.resize(vertices);
        out_.cage.quads.resize(quads);
        out_.region.resize(quads);
        out_.part.resize(quads);
        kind_.resize(quads);
        out_.region_node.assign(source_.begin(), source_.end());
    }

    void set_vertex(std::uint32_t v, Vec3 position, Vec3 anchor) {
        out_.cage.positions[v] = position;
        out_.anchors[v] = anchor;
    }
    void set_quad(std::uint32_t q, const Ring& corners, NodeId region, QuadKind kind, TubeFace part) {
        out_.cage.quads[q] = corners;
        out_.part[q] = part;
        kind_[q] = kind;
        out_.region[q] = region.index();
    }

    static Ring reversed(const Ring& r) { return {r[0], r[3], r[2], r[1]}; }

    // Creates the rings with their own orientation: branch nodes, roots in the middle of a chain, single
    // nodes.
    void fill_hubs() {
        parallel_for(ctx_, s_.size(), kCageGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            if (degree(n) == 0) {
                fill_ball(n);
            } else if (degree(n) >= 3) {
                fill_hub(n);
            } else if (is_fixed(n)) {
                const auto branch = branches(n);
                const Frame frame(normalized(branch[0].direction - branch[1].direction));
                fill_ring(n, frame, 0);
                begin_branches(n, std::array{make_ring(n), reversed(make_ring(n))});
            }
        });
    }

    void fill_hub(NodeId n) {
        const Hub& hub = hub_[at(n).hub - 1];
        const std::uint32_t first = at(n).first_vertex;
        for (std::uint32_t v = 0; v < hub.position.size(); ++v) {
            const Vec3 anchor = hub.anchor.empty() ? Vec3{} : hub.anchor[v];
            set_vertex(first + v, s_.position(n) + hub.position[v], s_.position(n) + anchor);
        }
        const auto shifted = [&](Ring r) {
            for (auto& v : r) v += first;
            return r;
        };
        const std::uint32_t first_quad = at(n).first_quad + (s_.is_root(n) ? 0 : 4);
        for (std::uint32_t q = 0; q < hub.quads.size(); ++q)
            set_quad(first_quad + q, shifted(hub.quads[q]), n, QuadKind::face, TubeFace::fork);
        std::vector<Ring> cells;
        for (const Ring& cell : hub.cell) cells.push_back(shifted(cell));
        begin_branches(n, cells);
    }

    // Sets the first rings of the branches of a node, each counter-clockwise about its direction.
    void begin_branches(NodeId n, std::span<const Ring> cells) {
        std::size_t i = 0;
        for (const NodeId c : s_.children(n)) at(c).upper = cells[i++];
        for (const NodeId e : ends_at(n)) at(e).lower = reversed(cells[i++]);
        if (!s_.is_root(n)) at(n).lower = reversed(cells[i]);
    }

    void fill_ball(NodeId n) {
        const std::uint32_t v = at(n).first_vertex;
        const float r = s_.radius(n) / shrinkage_ / std::numbers::sqrt3_v<float>;
        for (std::uint32_t k = 0; k < 8; ++k) {
            const Vec3 corner{k & 1 ? r : -r, k & 2 ? r : -r, k & 4 ? r : -r};
            set_vertex(v + k, s_.position(n) + corner, s_.position(n));
        }
        constexpr Ring kCube[6] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
        for (std::uint32_t k = 0; k < 6; ++k) {
            Ring face = kCube[k];
            for (auto& corner : face) corner += v;
            set_quad(at(n).first_quad + k, face, n, QuadKind::face, TubeFace::end);
        }
    }

    Ring make_ring(NodeId n) {
        const std::uint32_t v = at(n).first_vertex;
        return {v, v + 1, v + 2, v + 3};
    }

    void fill_ring(NodeId n, const Frame& frame, float phase) {
        const float r = s_.radius(n) / shrinkage_;
        const auto out = frame.quarters(phase);
        for (std::uint32_t k = 0; k < 4; ++k) {
            set_vertex(at(n).first_vertex + k, s_.position(n) + out[k] * r, s_.position(n));
        }
    }

    // Chains extend from a root or branch node to the next branch node or tip.
    void fill_chains() {
        std::vector<NodeId> heads;
        for (const NodeId n : nodes(s_)) {
            if (!s_.is_root(n) && (is_fixed(s_.parent(n)) || s_.is_root(s_.parent(n)))) heads.push_back(n);
        }
        parallel_for(ctx_, heads.size(), kCageGrain / 4, [&](std::size_t i) { fill_chain(heads[i]); });
    }

    void fill_chain(NodeId head) {
        const NodeId start = s_.parent(head);
        std::vector<NodeId> chain{head};
        while (degree(chain.back()) == 2 && !is_fixed(chain.back()))
            chain.push_back(s_.children(chain.back())[0]);
        const NodeId end = chain.back();
        std::vector<Frame> frame;
        frame.reserve(chain.size());
        float total = 0;
        for (const NodeId n : chain) {
            const Vec3 d = branch_to_child(n).direction;
            frame.push_back(frame.empty() ? Frame(d) : frame.back().turned(d));
            total += branch_to_child(n).length;
        }
        const bool start_fixed = is_fixed(start), end_fixed = ends_fixed(end);
        float phase = 0, end_phase = 0;
        if (start_fixed) phase = ring_phase(at(head).upper, start, frame.front());
        if (end_fixed) {
            end_phase = ring_phase(at(end).lower, end, frame.back());
            if (!start_fixed) phase = end_phase;
        }
        const float twist = end_fixed ? std::remainder(end_phase - phase, kHalfPi) : 0;
        if (!start_fixed) {
            fill_end(start, Frame(-frame.front().axis, frame.front().x), -phase, head);
            Ring& upper = at(head).upper = reversed(make_ring(start));
            align(upper, phase - ring_phase(upper, start, frame.front()));
        }
        float way = 0;
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
            way += branch_to_child(chain[i]).length;
            const Vec3 tangent = normalized(frame[i].axis + frame[i + 1].axis, frame[i].x);
            fill_ring(chain[i], frame[i].turned(tangent), phase + twist * way / std::max(total, 1e-30f));
            at(chain[i]).lower = make_ring(chain[i]);
            at(chain[i + 1]).upper = make_ring(chain[i]);
        }
        if (end_fixed) {
            align(at(end).lower, phase + twist - end_phase);
        } else {
            fill_end(end, frame.back(), phase, end);
            at(end).lower = make_ring(end);
        }
    }

    float ring_phase(const Ring& ring, NodeId n, const Frame& frame) const {
        return frame.quarters_azimuth([&](std::size_t k) { return out_.cage.positions[ring[k]]; },
                                      s_.position(n));
    }

    // Renumbers a ring so that its first corner is rotated by an angle, a multiple of a quarter turn.
    static void align(Ring& ring, float by) {
        const int shift = (static_cast<int>(std::lround(cage_internal::wrap_angle(by) / kHalfPi)) + 4) % 4;
        std::rotate(ring.begin(), ring.begin() + shift, ring.end());
    }

    TubeFace cap_part(NodeId end) const { return s_.is_root(end) ? TubeFace::start : TubeFace::end; }
    std::uint32_t first_cap_quad(NodeId end) { return at(end).first_quad + (s_.is_root(end) ? 0 : 4); }

    // Creates the end of a tube at a tip or base, with make_ring(n) as its last ring. The frame points
    // outward.
    void fill_end(NodeId n, const Frame& frame, float phase, NodeId region) {
        if (is_flat(n)) return fill_flat_end(n, frame, phase, region);
        const float r = s_.radius(n);
        if (is_open(n)) return fill_end_ring(n, 0, frame.quarters(phase), r / shrinkage_, {});
        fill_end_ring(n, 0, frame.quarters(phase), kRoundEndOut * r, kRoundEndAhead * r * frame.axis);
        set_quad(first_cap_quad(n), make_ring(n), region, QuadKind::face, cap_part(n));
    }

    void fill_end_ring(NodeId n, std::uint32_t first, const std::array<Vec3, 4>& around, float out,
                       Vec3 ahead) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            set_vertex(at(n).first_vertex + first + k, s_.position(n) + around[k] * out + ahead,
                       s_.position(n));
        }
    }

    // Creates the rim and a ring within it, both in the plane of the cut. Anchors are behind the inner ring,
    // so that the cap has an outward direction.
    void fill_flat_end(NodeId n, const Frame& frame, float phase, NodeId region) {
        const float r = s_.radius(n);
        const auto around = frame.quarters(phase);
        fill_end_ring(n, 0, around, kRim * r / shrinkage_, {});
        fill_end_ring(n, 4, around, kInnerRing * r / shrinkage_, {});
        const std::uint32_t v = at(n).first_vertex;
        const std::uint32_t q = first_cap_quad(n);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t next = (k + 1) % 4;
            out_.anchors[v + 4 + k] -= frame.axis * r;
            set_quad(q + k, {v + k, v + next, v + 4 + next, v + 4 + k}, region, QuadKind::tube, cap_part(n));
        }
        set_quad(q + 4, {v + 4, v + 5, v + 6, v + 7}, region, QuadKind::face, cap_part(n));
    }

    void fill_tubes() {
        parallel_for(ctx_, s_.size(), kCageGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            if (s_.is_root(n)) return;
            const Ring &p = at(n).upper, &q = at(n).lower;
            for (std::uint32_t k = 0; k < 4; ++k) {
                const std::uint32_t next = (k + 1) % 4;
                set_quad(at(n).first_quad + k, {p[k], p[next], q[next], q[k]}, n, QuadKind::tube,
                         TubeFace::side);
            }
        });
    }

    const Skeleton& s_;
    std::span<const NodeId> source_, round_roots_;
    const ControlOptions& options_;
    const Context& ctx_;
    const float shrinkage_;
    std::vector<Node> node_;
    const CompressedRows<NodeId> ends_at_;  // per node: the tips of other branches that are joined to it
    std::vector<Hub> hub_;
    std::vector<QuadKind> kind_;
    ControlMesh out_;
};

}  // namespace

ControlMesh build_control_mesh(const Skeleton& skeleton, std::span<const NodeId> source,
                               const ControlOptions& options, const Context& ctx,
                               std::span<const NodeId> round_roots, std::span<const NodeJoin> joins) {
    COPPICE_ASSERT(source.size() == skeleton.size());
    if (options.sides != 4 && options.sides != 8 && options.sides != 16) {
        throw InvalidInput(fmt::format("control: sides must be 4, 8 or 16, but is {}", options.sides));
    }
    return CageBuilder(skeleton, source, round_roots, joins, options, ctx).build();
}

void list_fields(ControlOptions& o, FieldList& list) {
    list.add(common_field(
                 "sides",
                 "Number of quads around a branch before subdivision: 4, 8 or 16, or 3 to 32 for cylinders.",
                 Unit::none, 3, 32),
             o.sides);
    list.add(common_field("tips", "Shape of the ends of branches."), o.tips);
    list.add(Field{"base", "Shape of the end of a tree at a root with one child."}, o.base);
}

}  // namespace coppice
