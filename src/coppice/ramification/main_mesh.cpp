#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "coppice/base/frame.h"
#include "coppice/base/id.h"
#include "coppice/ramification/main_mesh_internal.h"
#include "coppice/ramification/objective_internal.h"

namespace coppice::ramification_internal {
namespace {

using Ring = std::array<std::uint32_t, 4>;

constexpr double kPi = std::numbers::pi;
// Ends as those of build_control_mesh, in radii: the last ring of a round end, the rings of a flat one.
constexpr double kRoundAhead = 1.0, kRoundOut = 1.1;
constexpr double kFlatInner = 0.5, kFlatRim = 1.125;
// [radii] minimum distance of rings at nodes from those of units and ends.
constexpr double kClear = 0.3;
// Maximum share of a face used by the boundary of a lateral.
constexpr double kFaceFilled = 0.85;
constexpr std::uint32_t kStubQuads = 9;  // six faces, of which one is divided into four about the boundary

enum class End { none, round, flat };

struct RingPlan {
    double t = 0;
    bool turned = false;      ///< whether the azimuth is specified
    double azimuth = 0;       ///< azimuth of the middle of its first face, in its frame
    double spread = kPi / 4;  ///< angle from there to the corners of that face
    Vec3d center, axis, x, y;
    Ring vertices{};

    void look_at(Vec3d out) {
        turned = true;
        azimuth = std::atan2(dot(out, y), dot(out, x));
    }
};

class Builder {
  public:
    Builder(const Branches& branches, const Skeleton& skeleton, std::span<const NodeId> round_roots,
            const ControlOptions& ends, double alpha, const RamificationOptions& options,
            RamificationReport& report, const Context& ctx)
        : branches_(branches),
          skeleton_(skeleton),
          round_roots_(round_roots),
          ends_(ends),
          alpha_(alpha),
          options_(options),
          report_(report),
          ctx_(ctx),
          base_(branches.count()) {}

    MainMesh build() && {
        constexpr std::uint32_t kPoll = 256;
        for (std::uint32_t b = 0; b < branches_.count(); ++b) {
            if (b % kPoll == 0) ctx_.throw_if_cancelled();
            build_branch(b);
        }
        return std::move(out_);
    }

  private:
    /// Start of a lateral.
    struct Base {
        NodeId fork;  ///< node of the unit
        Ring ring{};
        double exit_arc = 0;
        double radius = 0, cotangent = 0;
        std::uint32_t paste = kNoIndex;
    };

    /// State of the construction of a branch.
    struct Front {
        Ring ring{};
        double t = 0;  ///< along the branch
        NodeId node;   ///< node of the last tube
        NodeId first;  ///< node of the first of the two tubes of the last sides
    };

    End start_end(std::uint32_t b) const {
        if (branches_[b].parent != kNoIndex) return End::none;
        const NodeId root = branches_.head(b);
        const bool flat = ends_.base == BaseShape::flat && skeleton_.children(root).size() == 1 &&
                          !std::ranges::binary_search(round_roots_, root.index(), {}, &NodeId::index);
        return flat ? End::flat : End::round;
    }
    End tip_end(std::uint32_t b) const {
        const bool lone = branches_[b].parent == kNoIndex && skeleton_.is_tip(branches_.head(b));
        return ends_.tips == TipShape::flat && !lone ? End::flat : End::round;
    }

    void build_branch(std::uint32_t b) {
        const Path path = branches_.path(b);
        const bool lateral = branches_[b].parent != kNoIndex;
        const double start = first_place(b, path), tip = path.length();
        const double last = std::max(tip - 0.05 * path.radius(tip), start + 0.2 * path.radius(start));
        const UnitPlan plan = plan_units(branches_, b, start, last, alpha_, options_, report_);
        if (lateral && base_[b].paste != kNoIndex) out_.pastes[base_[b].paste].first_of_tube = quad_count();
        std::vector<RingPlan> rings = lay_rings(b, path, plan, start, last);
        orient(rings, path, plan, b);
        for (RingPlan& ring : rings) make_ring(ring, alpha_ * std::numbers::sqrt2 * path.radius(ring.t));
        std::size_t unit = 0;
        const auto is_start = [&](std::size_t i) {
            return unit < plan.units.size() && i < rings.size() && rings[i].t == plan.units[unit].start;
        };
        // A lateral may be pasted on a round end, which is then part of the adjacent unit.
        const bool in_unit = !lateral && start_end(b) == End::round && is_start(0);
        Front front = begin_branch(b, path, plan, rings, in_unit);
        for (std::size_t i = 0; i < rings.size(); ++i) {
            const Unit* u = is_start(i) ? &plan.units[unit++] : nullptr;
            if (i == 0 && in_unit) {
                connect(front.ring, rings[i].vertices, rings[i].axis, TubeFace::fork, front.node);
            } else {
                add_tubes(b, front, rings[i].t, u != nullptr ? meeting_point(plan, *u) : rings[i].t);
                connect(front.ring, rings[i].vertices, rings[i].axis, TubeFace::side, front.first);
            }
            if (u != nullptr) {
                build_unit(b, path, *u, std::span(rings).subspan(i, u->rings.size()), plan, front.node,
                           i == 0 && in_unit);
                i += u->rows();
            }
            front.ring = rings[i].vertices;
            front.t = rings[i].t;
        }
        end_tip(b, path, rings, front);
    }

    /// Starts a branch: a lateral continues from its base, a root is closed, within its first unit if that
    /// includes it.
    Front begin_branch(std::uint32_t b, const Path& path, const UnitPlan& plan,
                       std::span<const RingPlan> rings, bool in_unit) {
        if (branches_[b].parent != kNoIndex) return {base_[b].ring, base_[b].exit_arc, base_[b].fork, {}};
        Front front;
        front.node = out_.tubes.add_root(branches_, b, in_unit ? meeting_point(plan, plan.units[0]) : 0);
        front.ring = begin_root(b, path, rings.empty() ? RingPlan{} : rings.front(),
                                in_unit ? TubeFace::fork : TubeFace::start, front.node);
        return front;
    }

    /// Returns the mean position where the axes of the laterals of a unit begin; mostly before the unit,
    /// which is where they exit.
    double meeting_point(const UnitPlan& plan, const Unit& unit) const {
        double sum = 0;
        for (const Lateral& l : std::span(plan.laterals).subspan(unit.first_lateral, unit.count))
            sum += branches_[l.branch].joint;
        return std::min(sum / unit.count, unit.end);
    }

    /// Adds the two tubes of the sides from the current position of a branch up to a ring at t; the second
    /// ends at `end`.
    void add_tubes(std::uint32_t b, Front& front, double t, double end) {
        const double middle = (front.t + t) / 2;
        front.first = out_.tubes.add(branches_, b, front.node, middle, {front.t, middle});
        front.node = out_.tubes.add(branches_, b, front.first, end, {middle, t});
    }

    /// Returns the minimum position of the first unit.
    double first_place(std::uint32_t b, const Path& path) const {
        if (branches_[b].parent != kNoIndex) return base_[b].exit_arc + 0.3 * base_[b].radius;
        return start_end(b) == End::flat ? 0.2 * path.radius(0) : -0.8 * path.radius(0);
    }

    /// Creates the rings of units, of nodes far enough from these, and of a lateral beyond its exit.
    std::vector<RingPlan> lay_rings(std::uint32_t b, const Path& path, const UnitPlan& plan, double start,
                                    double last) const {
        std::vector<RingPlan> rings;
        double clear_from = start;
        if (branches_[b].parent != kNoIndex) {
            const Base& base = base_[b];
            const double first_unit =
                plan.units.empty() ? last : plan.units.front().start - 0.15 * base.radius;
            const double wanted = base.exit_arc + base.radius * (0.6 + std::min(base.cotangent, 2.0));
            const double t = std::min(wanted, first_unit);
            if (t > base.exit_arc + 0.2 * base.radius) {
                rings.push_back({.t = t});
                clear_from = t + kClear * path.radius(t);
            }
        } else {
            clear_from = start_end(b) == End::flat ? kClear * path.radius(0) : -0.3 * path.radius(0);
        }
        std::uint32_t point = 0;
        const auto nodes_before = [&](double end) {
            for (; point < path.segment_count() + 1 && path.arc(point) < end; ++point) {
                const double t = path.arc(point), keep = kClear * path.radius(t);
                if (t < clear_from || t > end - keep) continue;
                rings.push_back({.t = t});
                clear_from = t + 1e-3 * path.radius(t);
            }
        };
        for (const Unit& unit : plan.units) {
            nodes_before(unit.start);
            for (const double t : unit.rings) rings.push_back({.t = t});
            clear_from = unit.end + kClear * unit.radius;
        }
        const double tip = path.length();
        nodes_before(tip_end(b) == End::flat ? tip - 0.2 * path.radius(tip) : tip - 1e-3 * path.radius(tip));
        return rings;
    }

    /// Computes frames with minimum rotation; at units and at the start of a lateral azimuths are specified,
    /// and between these the rings rotate evenly.
    void orient(std::vector<RingPlan>& rings, const Path& path, const UnitPlan& plan, std::uint32_t b) const {
        for (std::size_t i = 0; i < rings.size(); ++i) {
            RingPlan& r = rings[i];
            r.center = path.position(r.t);
            r.axis = path.direction(r.t, 0.5 * path.radius(r.t));
            r.x = i == 0 ? perpendicular(r.axis) : carried(rings[i - 1], r.axis);
            r.y = cross(r.axis, r.x);
        }
        std::size_t i = 0;
        for (const Unit& unit : plan.units) {
            while (rings[i].t != unit.start) ++i;
            for (std::size_t row = 0; row < unit.rings.size(); ++row) {
                rings[i].spread = unit.spread;
                rings[i++].look_at(unit.out);
            }
        }
        if (branches_[b].parent != kNoIndex && !rings.empty() && !rings.front().turned)
            rings.front().look_at(base_out(b));
        spread_turns(rings);
    }

    static Vec3d carried(const RingPlan& from, Vec3d axis) {
        if (dot(from.axis, axis) < -0.9999) return from.x;
        const Vec3d x = turned(from.x, from.axis, axis);
        return normalized(x - axis * dot(axis, x), perpendicular(axis));
    }

    /// Returns the direction from the centre of the boundary of a lateral to the middle of its first side.
    Vec3d base_out(std::uint32_t b) const {
        const Ring& r = base_[b].ring;
        return point(r[0]) + point(r[1]) - point(r[2]) - point(r[3]);
    }

    static void spread_turns(std::vector<RingPlan>& rings) {
        std::size_t last = rings.size();
        for (std::size_t i = 0; i < rings.size(); ++i) {
            if (!rings[i].turned) continue;
            if (last == rings.size()) {
                for (std::size_t k = 0; k < i; ++k) rings[k].azimuth = rings[i].azimuth;
            } else {
                const double turn = std::remainder(rings[i].azimuth - rings[last].azimuth, kPi / 2);
                const double way = rings[i].t - rings[last].t;
                for (std::size_t k = last + 1; k < i; ++k)
                    rings[k].azimuth = rings[last].azimuth + turn * (rings[k].t - rings[last].t) / way;
            }
            last = i;
        }
        if (last == rings.size()) return;
        for (std::size_t k = last + 1; k < rings.size(); ++k) rings[k].azimuth = rings[last].azimuth;
    }

    std::uint32_t quad_count() const { return static_cast<std::uint32_t>(out_.control.cage.quads.size()); }
    Vec3d point(std::uint32_t v) const { return Vec3d(out_.control.cage.positions[v]); }

    std::uint32_t add_vertex(Vec3d position, Vec3d anchor) {
        out_.control.cage.positions.push_back(Vec3(position));
        out_.control.anchors.push_back(Vec3(anchor));
        return static_cast<std::uint32_t>(out_.control.anchors.size()) - 1;
    }

    void add_quad(const Ring& corners, TubeFace part, NodeId region) {
        out_.control.cage.quads.push_back(corners);
        out_.control.part.push_back(part);
        out_.control.region.push_back(region.index());
    }

    /// Corner k is an eighth of a turn before the middle of face k.
    void make_ring(RingPlan& ring, double out) {
        ring.vertices = ring_at(ring, ring.center, out, ring.center);
    }
    Ring ring_at(const RingPlan& frame, Vec3d center, double out, Vec3d anchor) {
        Ring ring{};
        for (std::uint32_t k = 0; k < 4; ++k) {
            const double off = k < 2 ? frame.spread : kPi / 4;
            const double angle = frame.azimuth + (k == 0   ? -off
                                                  : k == 1 ? off
                                                  : k == 2 ? kPi - off
                                                           : kPi + off);
            ring[k] =
                add_vertex(center + (frame.x * std::cos(angle) + frame.y * std::sin(angle)) * out, anchor);
        }
        return ring;
    }

    /// Adds four quads from ring to ring, rotated by eq. 6.
    void connect(const Ring& from, const Ring& to, Vec3d axis, TubeFace part, NodeId region) {
        std::array<Vec3d, 4> first, second;
        for (std::size_t k = 0; k < 4; ++k) {
            first[k] = point(from[k]);
            second[k] = point(to[k]);
        }
        const std::uint32_t turn = best_turn(first, second, axis);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t next = (k + 1) % 4;
            add_quad({from[k], from[next], to[(next + turn) % 4], to[(k + turn) % 4]}, part, region);
        }
    }

    void build_unit(std::uint32_t b, const Path& path, const Unit& unit, std::span<const RingPlan> rings,
                    const UnitPlan& plan, NodeId fork, bool at_root) {
        const auto laterals = std::span(plan.laterals).subspan(unit.first_lateral, unit.count);
        std::vector<const Lateral*> in_face(std::size_t{4} * unit.rows(), nullptr);
        for (const Lateral& l : laterals) {
            if (!l.additional) in_face[4 * l.row + l.face] = &l;
        }
        Seat seat;
        if (at_root) seat.quads.push_back(root_cap_);
        for (std::uint32_t row = 0; row < unit.rows(); ++row) {
            const Ring &s = rings[row].vertices, &e = rings[row + 1].vertices;
            for (std::uint32_t k = 0; k < 4; ++k) {
                const std::uint32_t next = (k + 1) % 4;
                const Ring face{s[k], s[next], e[next], e[k]};
                const std::uint32_t first = quad_count();
                if (const Lateral* l = in_face[4 * row + k]) {
                    const double low = l->center - rings[row].t, high = rings[row + 1].t - l->center;
                    open_face(face, path, *l, low, high, fork);
                } else {
                    add_quad(face, TubeFace::fork, fork);
                }
                for (std::uint32_t q = first; q < quad_count(); ++q) seat.quads.push_back(q);
            }
        }
        add_stubs(b, path, laterals, fork, seat);
        if (!seat.pastes.empty()) out_.seats.push_back(std::move(seat));
    }

    /// Adds stubs of the additional laterals, thickest first.
    void add_stubs(std::uint32_t b, const Path& path, std::span<const Lateral> laterals, NodeId fork,
                   Seat& seat) {
        std::vector<const Lateral*> order;
        for (const Lateral& l : laterals) {
            if (l.additional) order.push_back(&l);
        }
        std::ranges::stable_sort(order, std::greater<>{}, [](const Lateral* l) { return l->radius; });
        for (const Lateral* l : order) {
            seat.pastes.push_back(static_cast<std::uint32_t>(out_.pastes.size()));
            base_[l->branch].paste = seat.pastes.back();
            out_.pastes.push_back({.lateral = *l,
                                   .diameter = 2 * path.radius(l->center),
                                   .joint = branches_[l->branch].joint,
                                   .parent = b,
                                   .first_quad = quad_count(),
                                   .quad_count = kStubQuads});
            add_stub(path, *l, fork);
        }
    }

    /// Adds a cube about the exit of the lateral.
    void add_stub(const Path& path, const Lateral& l, NodeId fork) {
        const double r = path.radius(l.center);
        std::array<Ring, 2> rings;
        for (const int side : {0, 1}) {
            RingPlan ring{.t = l.center};
            ring.axis = path.direction(l.center, r / 2);
            ring.center = path.position(l.center) + ring.axis * (side == 0 ? -r : r);
            ring.x = l.out;
            ring.y = cross(ring.axis, ring.x);
            make_ring(ring, alpha_ * std::numbers::sqrt2 * r);
            rings[static_cast<std::size_t>(side)] = ring.vertices;
        }
        const auto& [s, e] = rings;
        add_quad({s[3], s[2], s[1], s[0]}, TubeFace::fork, fork);
        add_quad(e, TubeFace::fork, fork);
        for (std::uint32_t k = 1; k < 4; ++k)
            add_quad({s[k], s[(k + 1) % 4], e[(k + 1) % 4], e[k]}, TubeFace::fork, fork);
        open_face({s[0], s[1], e[1], e[0]}, path, l, r, r, fork);
    }

    /// Adds four quads about the boundary of a lateral, which extends at most from `low` below its centre to
    /// `high` above it.
    void open_face(const Ring& face, const Path& path, const Lateral& l, double low, double high,
                   NodeId fork) {
        const Path own = branches_.path(l.branch);
        const double wide = path.radius(l.center);
        const Vec3d up = path.direction(l.center, wide / 2), side = cross(up, l.out);
        const Vec3d axis_point = path.position(l.center);
        const Vec3d center = axis_point + l.out * std::max(dot(l.exit - axis_point, l.out), alpha_ * wide);
        const double half_face = length(point(face[0]) - point(face[1])) / 2;
        const double across = std::min(alpha_ * l.radius, kFaceFilled * half_face);
        const double down_by = std::min(alpha_ * l.half, kFaceFilled * low);
        const double up_by = std::min(alpha_ * l.half, kFaceFilled * high);
        const Vec3d anchor = own.position(std::max(0.0, l.exit_arc - l.radius));
        Base& base = base_[l.branch];
        for (std::uint32_t k = 0; k < 4; ++k) {
            const double x = k == 1 || k == 2 ? across : -across, y = k >= 2 ? up_by : -down_by;
            base.ring[k] = add_vertex(center + side * x + up * y, anchor);
        }
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t next = (k + 1) % 4;
            add_quad({face[k], face[next], base.ring[next], base.ring[k]}, TubeFace::fork, fork);
        }
        base.fork = fork;
        const Vec3d way = own.direction(l.exit_arc, l.radius / 2);
        const double sine = length(cross(way, up));
        base.exit_arc = l.exit_arc;
        base.radius = l.radius;
        base.cotangent = std::abs(dot(way, up)) / std::max(sine, 1e-6);
    }

    /// Closes a tree at its root; returns the ring from which the tube continues.
    Ring begin_root(std::uint32_t b, const Path& path, const RingPlan& next, TubeFace part, NodeId root) {
        RingPlan frame = next;
        frame.t = 0;
        frame.axis = path.direction(0, 0.5 * path.radius(0));
        frame.x = next.vertices == Ring{} ? perpendicular(frame.axis) : carried(next, frame.axis);
        frame.y = cross(frame.axis, frame.x);
        // A tube is identified by its next node.
        const NodeId region = part == TubeFace::start ? NodeId(root.index() + 1) : root;
        const Ring ring = close(path, frame, start_end(b), 0, -1, part, region);
        root_cap_ = quad_count() - 1;
        return ring;
    }

    void end_tip(std::uint32_t b, const Path& path, std::span<const RingPlan> rings, Front& front) {
        const double tip = path.length();
        RingPlan frame = rings.empty() ? RingPlan{} : rings.back();
        frame.t = tip;
        const Vec3d axis = path.direction(tip, 0.5 * path.radius(tip));
        frame.x = rings.empty() ? perpendicular(axis) : carried(rings.back(), axis);
        frame.axis = axis;
        frame.y = cross(axis, frame.x);
        if (rings.empty() && branches_[b].parent != kNoIndex) frame.look_at(base_out(b));
        const std::uint32_t first_cap = quad_count();
        add_tubes(b, front, tip, tip);
        const Ring ring = close(path, frame, tip_end(b), tip, 1, TubeFace::end, front.node);
        const std::uint32_t caps = quad_count() - first_cap;
        connect(front.ring, ring, axis, TubeFace::side, front.first);
        // The paste of a lateral without own rings requires the quads of its tube to come first.
        auto& control = out_.control;
        const auto put_caps_last = [&](auto& column) {
            std::rotate(column.end() - 4 - caps, column.end() - 4, column.end());
        };
        put_caps_last(control.cage.quads);
        put_caps_last(control.part);
        put_caps_last(control.region);
        if (tip_end(b) == End::flat) control.clip.back().first_quad += 4;
    }

    /// Adds the rings and quads of an end; `sign` is -1 at a root. Returns the outermost ring, about the
    /// axis.
    Ring close(const Path& path, const RingPlan& frame, End end, double t, double sign, TubeFace part,
               NodeId region) {
        const double r = path.radius(t);
        const Vec3d node = path.position(t), outward = frame.axis * sign;
        const auto facing = [&](const Ring& ring) {
            return sign > 0 ? ring : Ring{ring[3], ring[2], ring[1], ring[0]};
        };
        if (end == End::round) {
            const Ring ring = ring_at(frame, node + outward * (kRoundAhead * r), kRoundOut * r, node);
            add_quad(facing(ring), part, region);
            return ring;
        }
        const double out = alpha_ * std::numbers::sqrt2 * r;
        const Ring rim = ring_at(frame, node, kFlatRim * out, node);
        const Ring inner = ring_at(frame, node, kFlatInner * out, node - outward * r);
        const Vec3 normal(outward);
        out_.control.clip.push_back({normal, dot(normal, Vec3(node)), quad_count(), 5});
        const Ring a = facing(rim), c = facing(inner);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t next = (k + 1) % 4;
            add_quad({a[k], a[next], c[next], c[k]}, part, region);
        }
        add_quad(c, part, region);
        return rim;
    }

    const Branches& branches_;
    const Skeleton& skeleton_;
    std::span<const NodeId> round_roots_;
    const ControlOptions& ends_;
    const double alpha_;
    const RamificationOptions& options_;
    RamificationReport& report_;
    const Context& ctx_;
    std::vector<Base> base_;
    std::uint32_t root_cap_ = kNoIndex;
    MainMesh out_;
};

}  // namespace

MainMesh build_main_mesh(const Branches& branches, const Skeleton& skeleton,
                         std::span<const NodeId> round_roots, const ControlOptions& ends, double alpha,
                         const RamificationOptions& options, RamificationReport& report, const Context& ctx) {
    return Builder(branches, skeleton, round_roots, ends, alpha, options, report, ctx).build();
}

}  // namespace coppice::ramification_internal
