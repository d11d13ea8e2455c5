#include "coppice/cage/graft_plan_internal.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/cage/segment_cuts_internal.h"

namespace coppice::cage_internal {
namespace {

// [radii] Minimum visible length of a section.
constexpr float kMinShown = 1.0f;
constexpr float kMinTip = 0.5f;    // the same for a section with a tip
constexpr float kTipShown = 0.6f;  // the same for the ball of a tip alone,
constexpr float kTipAxis = 0.65f;  // which gets this length of its axis
// [radii] A section that enters another branch ends at this distance before the bark: its round end reaches
// it.
constexpr float kEndAhead = 0.5f;
// Minimum cosine of the angle of entry; flatter branches are treated as if they had this one.
constexpr float kFlattest = 0.5f;
// From the position where it leaves a branch, a section is extended back to that branch's axis by at most
// this many times the distance to it: flatter laterals would run inside for a long distance.
constexpr float kMaxTracedBack = 1.2f;
// [radii] The end of a section closer to a node than this is moved to the node.
constexpr float kSnapEnd = 0.3f;
// Maximum number of checked branches that enclose the same position.
constexpr std::ptrdiff_t kMaxHosts = 16;
constexpr std::uint32_t kAxesPerLook = 1024;  // number of axes between checks for cancellation

struct Input {
    const AxisGeometry& axes;
    const Enclosure& enclosure;
    SectionEnd end;
    const Skeleton& skeleton() const { return axes.skeleton; }
};

using Chain = std::span<const NodeId>;

bool is_enclosed(const GraftPlan& plan, NodeId n) {
    return static_cast<bool>(plan.enclosed_at[n.index()].segment);
}

SegmentRange visible_part(const Skeleton& s, const GraftPlan& plan, NodeId n) {
    const auto [from, to] = plan.visible[n.index()];
    return {s.segment(n), from, to};
}

// ---- sections of an axis inside others

void find_enclosed(const Input& in, const GraftPlan& plan, NodeId n, NodeId parent_node,
                   std::vector<EnclosedInterval>& out) {
    if (plan.visible[parent_node.index()].empty()) return;
    const Enclosure& enclosure = in.enclosure;
    const Segment own = in.skeleton().segment(n);
    const SegmentRange parent = visible_part(in.skeleton(), plan, parent_node);
    const float nearest = nearest_parameter(own, parent);
    if (enclosure.clearance(parent, own, nearest).gap >= 0) return;
    const float clear = kClear * own.radius_b;
    const float enter =
        enclosure.clearance(parent, own, 0).gap < 0 ? 0 : enclosure.exit(parent, own, nearest, 0);
    const float exit =
        enclosure.clearance(parent, own, 1).gap < clear ? 1 : enclosure.exit(parent, own, nearest, 1, clear);
    const float start = in.axes.start(n), size = in.axes.axes.arc(n) - start;
    const Clearance at_enter = enclosure.clearance(parent, own, enter);
    out.push_back({start + enter * size, start + exit * size, parent_node, at_enter.t,
                   enclosure.clearance(parent, own, exit).t,
                   std::max(0.0f, -dot(normalized(own.b - own.a), normalized(at_enter.offset)))});
}

std::vector<EnclosedInterval> enclosed_intervals(const Input& in, const GraftPlan& plan,
                                                 const CompressedRows<Crossing>& crossings, Chain chain) {
    std::vector<EnclosedInterval> out;
    for (const NodeId n : chain) {
        for (const Crossing& c : crossings[n.index()]) find_enclosed(in, plan, n, c.parent, out);
    }
    std::sort(out.begin(), out.end(), [](const EnclosedInterval& a, const EnclosedInterval& b) {
        return a.from != b.from ? a.from < b.from : a.to < b.to;
    });
    return out;
}

// ---- beginnings and ends of visible sections

// Returns the arc length of a node that is close to a point, otherwise that of the point.
float snapped(const Input& in, Chain chain, float arc) {
    const AxisPoint p = in.axes.at(chain, arc);
    const float near = kSnapEnd * in.axes.radius(p);
    const float start = in.axes.start(p.segment), end = in.axes.axes.arc(p.segment);
    if (arc - start < near) return start;
    return end - arc < near ? end : arc;
}

float radius_on(const Input& in, Chain chain, float arc) { return in.axes.radius(in.axes.at(chain, arc)); }

// Returns the position of the last ring of a section: at the bark, or clear of a branch that it joins.
float find_end_ahead(const Input& in, const EnclosedInterval& interval, float radius) {
    const float parent = in.axes.radius({interval.parent, interval.parent_t});
    const float ahead = in.end == SectionEnd::joined
                            ? kClear * radius
                            : parent + kEndAhead * radius - in.enclosure.min_distance(parent, radius);
    return interval.from - std::max(0.0f, ahead) / std::max(interval.approach, kFlattest);
}

// Returns the position of the last ring of a section that begins at an arc length.
float last_ring(const Input& in, Chain chain, float from, const EnclosedInterval& next, float radius) {
    const float to = snapped(in, chain, find_end_ahead(in, next, radius));
    return in.end == SectionEnd::joined ? std::max(to, from) : to;
}

// Moves a point along the axis, within its visible sections of lower rank than the given one.
AxisPoint moved(const Input& in, const GraftPlan& plan, AxisPoint p, float by, std::uint32_t rank) {
    const Axes& axes = in.axes.axes;
    while (true) {
        const float size = axes.arc(p.segment) - in.axes.start(p.segment);
        const float at = p.t * size + by;
        const auto [from, to] = plan.visible[p.segment.index()];
        NodeId next;
        if (at < 0 && from <= 0 && !axes.is_first(p.segment)) next = in.skeleton().parent(p.segment);
        if (at > size && to >= 1) next = axes.next(p.segment);
        if (!next || axes.rank(next) >= rank || plan.visible[next.index()].empty())
            return {p.segment, std::clamp(at / std::max(size, 1e-30f), from, to)};
        by = at < 0 ? at : at - size;
        p = {next, at < 0 ? 1.0f : 0.0f};
    }
}

// Extends a section from the point where it leaves or enters its parent branch as if it were straight up to
// the parent's axis.
AxisPoint traced_back(const Input& in, const GraftPlan& plan, AxisPoint out, AxisPoint on_parent,
                      bool enters) {
    const Segment own = in.skeleton().segment(out.segment), parent = in.skeleton().segment(on_parent.segment);
    const Vec3 along = normalized(parent.b - parent.a), direction = normalized(own.b - own.a);
    const float d = distance(in.axes.position(out), in.axes.position(on_parent));
    const float c = dot(along, direction);
    const float way = c / std::max(std::sqrt(std::max(0.0f, 1 - c * c)), 1e-3f);
    const float by = (enters ? d : -d) * std::clamp(way, -kMaxTracedBack, kMaxTracedBack);
    return moved(in, plan, on_parent, by, in.axes.axes.rank(out.segment));
}

// Returns the place at which a section begins; none for a lateral that leaves its own parent in the regular
// way. `left` is the interval that the section leaves, if any.
std::uint32_t attachment(const Input& in, GraftPlan& plan, Chain chain, float from,
                         const EnclosedInterval* left) {
    const NodeId base = in.skeleton().parent(chain[0]);
    if (!is_enclosed(plan, base)) {
        if (!left) return kNoIndex;
        const bool at_base = left->parent == base, child_of_base = in.skeleton().parent(left->parent) == base;
        const bool in_between = (at_base && left->parent_t > 0) || (child_of_base && left->parent_t < 1);
        if (in_between && from <= in.axes.axes.arc(chain[0])) return kNoIndex;
    }
    ++plan.report.grafted;
    const AxisPoint at =
        left ? traced_back(in, plan, in.axes.at(chain, from), {left->parent, left->parent_t}, false)
             : plan.enclosed_at[base.index()];
    return place_near(in.axes, plan.visible[at.segment.index()], at, plan.cuts);
}

// Returns the place of the parent branch in which a section that enters it ends.
std::uint32_t join_place(const Input& in, GraftPlan& plan, Chain chain, const EnclosedInterval& enclosed) {
    const AxisPoint at = traced_back(in, plan, in.axes.at(chain, enclosed.from),
                                     {enclosed.parent, enclosed.parent_from}, true);
    return place_near(in.axes, plan.visible[at.segment.index()], at, plan.cuts);
}

// [radii of the tip] Returns the length by which the ball of the tip extends beyond the branch that encloses
// the end of its axis.
float tip_shown(const Input& in, const GraftPlan& plan, Chain chain, const EnclosedInterval& last) {
    const Segment own = in.skeleton().segment(chain.back());
    const SegmentRange parent = visible_part(in.skeleton(), plan, last.parent);
    return in.enclosure.clearance(parent, own, 1).gap / own.radius_b + 1;
}

// Returns the sections between the intervals that are long enough.
std::vector<VisibleSection> divide(const Input& in, GraftPlan& plan, Chain chain,
                                   std::span<const EnclosedInterval> enclosed) {
    std::vector<VisibleSection> sections;
    const float end = in.axes.axes.arc(chain.back());
    float from = 0;
    const EnclosedInterval* left = nullptr;  // that the section leaves
    auto next = enclosed.begin();
    const auto last = enclosed.end();
    while (true) {
        for (; next != last && next->from - from < kMinShown * radius_on(in, chain, next->from); ++next) {
            if (next->to < from) continue;
            from = next->to;
            left = &*next;
        }
        const bool is_tip = next == last;
        const float r = radius_on(in, chain, is_tip ? end : next->from);
        // If only the ball of the tip is visible, it gets a short section of the axis.
        const bool is_ball =
            is_tip && left && end - from < kMinTip * r && tip_shown(in, plan, chain, *left) >= kTipShown;
        if (is_ball) {
            from = std::max(end - kTipAxis * r, 0.5f * (left->from + end));
            if (!sections.empty()) sections.back().resume = std::min(sections.back().resume, from);
        }
        from = snapped(in, chain, from);
        const float to = is_tip ? end : last_ring(in, chain, from, *next, r);
        const bool is_whole = is_tip && !left && !is_enclosed(plan, in.skeleton().parent(chain[0]));
        const float shown = in.end == SectionEnd::joined && !is_tip ? next->from - from : to - from;
        if (is_whole || is_ball || shown >= (is_tip ? kMinTip : kMinShown) * r) {
            const std::uint32_t attach = attachment(in, plan, chain, from, left);
            sections.push_back({attach == kNoIndex ? 0 : from, to, attach});
            if (!is_tip) {
                VisibleSection& section = sections.back();
                section.resume = std::min(next->to, next->from + r / std::max(next->approach, kFlattest));
                if (in.end == SectionEnd::joined) {
                    // The next section may begin where this one has left.
                    section.resume = std::min(section.resume, 0.5f * (next->from + next->to));
                    if (section.resume > to) section.join = join_place(in, plan, chain, *next);
                }
                ++plan.report.truncated;
            }
        }
        if (is_tip) break;
        from = next->to;
        left = &*next++;
    }
    return sections;
}

// ---- results for the nodes

std::uint32_t place_at(const Input& in, GraftPlan& plan, Chain chain, float arc) {
    const AxisPoint p = in.axes.at(chain, arc);
    if (p.t <= 0) return in.skeleton().parent(p.segment).index();
    return place_of_cut(in.axes, p, plan.cuts);
}

// Cuts the axis where a section begins and ends, and records the visible range of each segment.
void mark_visible(const Input& in, GraftPlan& plan, Chain chain, VisibleSection& section) {
    if (section.attach != kNoIndex) section.start = place_at(in, plan, chain, section.from);
    const std::uint32_t last = place_at(in, plan, chain, section.to);
    if (section.resume > section.to) section.end = place_at(in, plan, chain, section.resume);
    if (section.end == last) section.join = kNoIndex;
    for (auto n = in.axes.first_node_at(chain, section.from);
         n != chain.end() && in.axes.start(*n) < section.to; ++n) {
        const float start = in.axes.start(*n), size = std::max(in.axes.axes.arc(*n) - start, 1e-30f);
        auto& [from, to] = plan.visible[n->index()];
        from = std::min(from, std::max(0.0f, (section.from - start) / size));
        to = std::max(to, std::min(1.0f, (section.to - start) / size));
    }
}

void plan_axis(const Input& in, GraftPlan& plan, const CompressedRows<Crossing>& crossings,
               std::uint32_t axis) {
    const Chain chain = in.axes.axes.find_nodes(axis);
    plan.of_axis[axis] = static_cast<std::uint32_t>(plan.plans.size());
    plan.plans.emplace_back().enclosed = enclosed_intervals(in, plan, crossings, chain);
    AxisPlan& own = plan.plans.back();
    own.sections = divide(in, plan, chain, own.enclosed);
    for (const NodeId n : chain) plan.visible[n.index()] = {1.0f, 0.0f};
    for (VisibleSection& section : own.sections) mark_visible(in, plan, chain, section);
    for (const NodeId n : chain) {
        const float arc = in.axes.axes.arc(n);
        if (own.is_visible(arc)) continue;
        plan.enclosed_at[n.index()] = parent_at(in.axes, in.enclosure, plan, axis, arc);
        ++plan.report.nodes_inside;
    }
}

}  // namespace

const VisibleSection* AxisPlan::last_section_before(float arc) const {
    const auto after = std::upper_bound(sections.begin(), sections.end(), arc,
                                        [](float a, const VisibleSection& p) { return a < p.from; });
    return after == sections.begin() ? nullptr : &*std::prev(after);
}

bool AxisPlan::is_visible(float arc) const {
    const VisibleSection* const section = last_section_before(arc);
    return section && arc <= section->to;
}

const VisibleSection* AxisPlan::section_ended_before(float arc) const {
    const VisibleSection* const section = last_section_before(arc);
    return section && section->to <= arc && arc <= section->resume ? section : nullptr;
}

AxisPoint parent_at(const AxisGeometry& axes, const Enclosure& enclosure, const GraftPlan& plan,
                    std::uint32_t axis, float arc) {
    const Chain chain = axes.axes.find_nodes(axis);
    const auto& enclosed = plan.plans[plan.of_axis[axis]].enclosed;
    const auto after = std::upper_bound(enclosed.begin(), enclosed.end(), arc,
                                        [](float a, const EnclosedInterval& in) { return a < in.from; });
    const auto first = after - std::min(after - enclosed.begin(), kMaxHosts);
    const auto last = after + std::min<std::ptrdiff_t>(enclosed.end() - after, 1);
    if (first == last) return plan.enclosed_at[axes.skeleton.parent(chain[0]).index()];
    const auto off = [&](const EnclosedInterval& in) { return std::max({in.from - arc, arc - in.to, 0.0f}); };
    const NodeId parent =
        std::min_element(first, last, [&](const auto& a, const auto& b) { return off(a) < off(b); })->parent;
    const AxisPoint own = axes.at(chain, arc);
    const SegmentRange part = visible_part(axes.skeleton, plan, parent);
    return {parent, enclosure.clearance(part, axes.skeleton.segment(own.segment), own.t).t};
}

GraftPlan plan_grafts(const AxisGeometry& axes, const Enclosure& enclosure, SectionEnd end,
                      const Context& ctx) {
    const Input in{axes, enclosure, end};
    const Skeleton& s = axes.skeleton;
    const std::vector<Crossing> all = find_crossings(s, axes.axes, enclosure, ctx);
    const auto crossings = compress_rows<Crossing>(s.size(), [&](const auto& put) {
        for (const Crossing& c : all) put(c.segment.index(), c);
    });
    std::vector<bool> extraordinary(axes.axes.count(), false);
    for (const Crossing& c : all) {
        if (!c.ordinary) extraordinary[axes.axes.find_axis(c.segment)] = true;
    }
    GraftPlan plan;
    plan.visible.resize(s.size());
    plan.of_axis.assign(axes.axes.count(), kNoIndex);
    plan.enclosed_at.resize(s.size());
    plan.cuts.newest.assign(s.size(), kNoIndex);
    for (std::uint32_t a = 0; a < axes.axes.count(); ++a) {
        if (a % kAxesPerLook == 0) ctx.throw_if_cancelled();
        if (extraordinary[a] || is_enclosed(plan, s.parent(axes.axes.find_nodes(a)[0])))
            plan_axis(in, plan, crossings, a);
    }
    return plan;
}

}  // namespace coppice::cage_internal
