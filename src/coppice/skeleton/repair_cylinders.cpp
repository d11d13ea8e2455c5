#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/skeleton/raw.h"
#include "coppice/skeleton/repair_internal.h"

namespace coppice {
namespace {

using namespace skeleton_internal;

constexpr double kShortest = 0.01;  // [radius] length below which cylinders are removed
constexpr double kSnapToEnd = 0.5;  // [parent's radius] distance below which laterals branch off at the end
constexpr double kSnapTogether = 0.1;  // [parent's radius] distance below which laterals share a node
constexpr double kWidestGap = 2;       // [larger radius] maximum gap that a continuation bridges
constexpr double kSharpestTurn = 0.5;  // cosine of the maximum angle of such a continuation
constexpr double kMaxShift = 0.5;      // [own radius] maximum distance of an axis from its own start
constexpr double kGapFrom = 1.05;  // [larger radius] TreeQSM starts laterals at 1.00 from the parent's axis
constexpr double kSmallestJump = 0.01;  // minimum relative change of radius that is preserved

/// A cylinder with the index of its parent; parents come first.
struct Axis {
    Vec3d start, end;
    double radius;
    std::uint32_t parent;
    std::uint32_t source;  // index of the raw cylinder
    Vec3d direction() const { return normalized(end - start); }
};

double distance_to_axis(Vec3d p, const Axis& axis) { return segment_distance(p, p, axis.start, axis.end); }

void check(const std::vector<RawCylinder>& cylinders, const std::string& source) {
    if (cylinders.empty()) throw InvalidInput(fmt::format("{}: there are no cylinders", source));
    if (cylinders.size() >= kNoIndex / 8)
        throw Unsupported(fmt::format("{}: more than 500 million cylinders", source));
    for (std::size_t i = 0; i < cylinders.size(); ++i) {
        const RawCylinder& c = cylinders[i];
        for (const double x : {c.start.x, c.start.y, c.start.z, c.end.x, c.end.y, c.end.z}) {
            check_number(x, "a coordinate", source, c.line, i);
        }
        if (!std::isnan(c.radius)) check_number(c.radius, "the radius", source, c.line, i);
    }
}

void fill_missing_radii(std::vector<Axis>& axes, RepairReport& report) {
    std::vector<std::uint32_t> parent;
    std::vector<double> step, radius;
    std::vector<Vec3d> points;
    for (const Axis& a : axes) {
        parent.push_back(a.parent);
        step.push_back(distance(a.start, a.end));
        radius.push_back(a.radius);
        points.insert(points.end(), {a.start, a.end});
    }
    report.missing_radii = fill_radii(parent, step, extent(points), radius);
    for (std::size_t i = 0; i < axes.size(); ++i) axes[i].radius = radius[i];
}

/// Removes cylinders without length; their children are attached to their parents.
std::vector<Axis> without_discs(const std::vector<Axis>& axes, RepairReport& report) {
    std::vector<Axis> kept;
    std::vector<std::uint32_t> new_index(axes.size());
    for (std::size_t i = 0; i < axes.size(); ++i) {
        Axis a = axes[i];
        if (a.parent != kNoIndex) {
            a.parent = new_index[a.parent];
            if (distance(a.start, a.end) < kShortest * a.radius) {
                new_index[i] = a.parent;
                ++report.zero_length;
                continue;
            }
        }
        new_index[i] = static_cast<std::uint32_t>(kept.size());
        kept.push_back(a);
    }
    return kept;
}

std::vector<Axis> read_axes(const std::vector<RawCylinder>& cylinders, const std::string& source,
                            RepairReport& report) {
    std::vector<Link> links;
    links.reserve(cylinders.size());
    for (const RawCylinder& c : cylinders) links.push_back({c.id, c.parent, c.line});
    const std::vector<std::uint32_t> parent = find_parents(links, source, report);
    const std::vector<std::uint32_t> order = parents_first(parent, links, source, report);
    std::vector<std::uint32_t> new_index(cylinders.size());
    std::vector<Axis> axes;
    axes.reserve(cylinders.size());
    for (const std::uint32_t i : order) {
        const RawCylinder& c = cylinders[i];
        new_index[i] = static_cast<std::uint32_t>(axes.size());
        axes.push_back(
            {c.start, c.end, c.radius, parent[i] == kNoIndex ? kNoIndex : new_index[parent[i]], i});
    }
    fill_missing_radii(axes, report);
    return without_discs(axes, report);
}

/// Joins the axes of cylinders to a tree; the radius of a node is that of the segment that ends there.
class Joiner {
  public:
    Joiner(const std::vector<Axis>& axes, RepairReport& report)
        : axes_(axes),
          report_(report),
          next_(axes.size(), kNoIndex),
          tip_(axes.size()),
          leaves_from_(axes.size()) {}

    NodeList run() {
        choose_continuations();
        children_ = compress_rows<std::uint32_t>(axes_.size(), [&](const auto& put) {
            for (std::uint32_t i = 0; i < axes_.size(); ++i) {
                if (axes_[i].parent != kNoIndex) put(axes_[i].parent, i);
            }
        });
        for (std::uint32_t i = 0; i < axes_.size(); ++i) add_axis(i);
        return std::move(list_);
    }

  private:
    /// Returns the distance between the start of a child and the end of its parent, relative to the larger
    /// radius; infinite if it cannot continue its parent.
    double misfit(const Axis& child) const {
        const Axis& parent = axes_[child.parent];
        const double cosine = dot(parent.direction(), child.direction());
        const double gap = distance(child.start, parent.end) / std::max(child.radius, parent.radius);
        if (gap <= 1 || (gap <= kWidestGap && cosine > kSharpestTurn)) return gap;
        const bool inside = distance_to_axis(child.start, parent) < 0.9 * parent.radius;
        const bool onwards = dot(child.end - parent.end, parent.direction()) > 0;
        if (inside && onwards && cosine > kSharpestTurn) return gap;
        return std::numeric_limits<double>::infinity();
    }

    void choose_continuations() {
        std::vector<double> least(axes_.size(), std::numeric_limits<double>::infinity());
        for (std::uint32_t i = 0; i < axes_.size(); ++i) {
            const std::uint32_t p = axes_[i].parent;
            if (p == kNoIndex) continue;
            const double m = misfit(axes_[i]);
            const bool ties =
                next_[p] != kNoIndex && m == least[p] && axes_[i].radius > axes_[next_[p]].radius;
            if (!(m < least[p]) && !ties) continue;
            least[p] = m;
            next_[p] = i;
        }
        for (std::uint32_t i = 0; i < axes_.size(); ++i) {
            tip_[i] = next_[i] == kNoIndex ? axes_[i].end : lerp(axes_[i].end, axes_[next_[i]].start, 0.5);
        }
    }

    /// Returns the point of the parent's axis at which a lateral originates.
    Vec3d source_point(const Axis& lateral) const {
        const Axis& parent = axes_[lateral.parent];
        const double closest = closest_parameter(lateral.start, parent.start, parent.end - parent.start);
        // Beyond an end it is that end: extended backwards along a collinear axis, all points would be
        // equally close.
        if (closest <= 0 || closest >= 1) return lerp(parent.start, parent.end, closest);
        const double reach = 4 * distance_to_axis(lateral.start, parent);
        const Vec3d back = lateral.start - lateral.direction() * reach;
        const ClosestParameters c = closest_parameters(parent.start, parent.end, lateral.start, back);
        const Vec3d on_parent = lerp(parent.start, parent.end, c.on_a);
        if (distance(on_parent, lerp(lateral.start, back, c.on_b)) <= parent.radius) return on_parent;
        return lerp(parent.start, parent.end, closest);
    }

    std::uint32_t add_node(std::uint32_t parent, Vec3d p, const Axis& a) {
        list_.source.push_back(a.source);
        return list_.add(parent, p, a.radius);
    }

    void add_axis(std::uint32_t i) {
        const Axis& a = axes_[i];
        std::uint32_t node = kNoIndex;
        if (a.parent == kNoIndex) {
            node = add_node(kNoIndex, a.start, a);
        } else {
            node = leaves_from_[i];
            if (distance_to_axis(a.start, axes_[a.parent]) >
                kGapFrom * std::max(a.radius, axes_[a.parent].radius)) {
                ++report_.bridged_gaps;
            }
            if (next_[a.parent] != i && needs_own_start(i, list_.position[node])) {
                node = add_node(node, a.start, a);
            }
        }
        add_body(i, node);
    }

    bool needs_own_start(std::uint32_t i, Vec3d from) const {
        const Axis& a = axes_[i];
        const Axis& parent = axes_[a.parent];
        if (distance_to_axis(a.start, parent) + a.radius <= parent.radius) return false;
        return segment_distance(a.start, a.start, from, tip_[i]) > kMaxShift * a.radius;
    }

    struct Attachment {
        double along;
        std::uint32_t child;
    };

    /// Adds the nodes at which laterals branch off, and the end.
    void add_body(std::uint32_t i, std::uint32_t node) {
        const Axis& a = axes_[i];
        const Vec3d from = list_.position[node];
        const Vec3d way = tip_[i] - from;
        const double length = distance(from, tip_[i]);
        std::vector<Attachment> attachments;
        for (const std::uint32_t c : children_[i]) {
            if (c == next_[i]) continue;
            const double along = length > 0 ? dot(source_point(axes_[c]) - from, way) / length : 0;
            attachments.push_back({std::max(along, 0.0), c});
        }
        std::stable_sort(attachments.begin(), attachments.end(),
                         [](const Attachment& x, const Attachment& y) { return x.along < y.along; });
        double at = 0;
        std::size_t f = 0;
        for (; f < attachments.size() && attachments[f].along < length - kSnapToEnd * a.radius; ++f) {
            if (attachments[f].along - at > kSnapTogether * a.radius) {
                at = attachments[f].along;
                node = add_node(node, from + way * (at / length), a);
            }
            if (at > 0) ++report_.attached_inside;
            leaves_from_[attachments[f].child] = node;
        }
        node = add_node(node, tip_[i], a);
        for (; f < attachments.size(); ++f) leaves_from_[attachments[f].child] = node;
        if (next_[i] != kNoIndex) leaves_from_[next_[i]] = node;
    }

    const std::vector<Axis>& axes_;
    RepairReport& report_;
    std::vector<std::uint32_t> next_;         // child that continues a cylinder
    std::vector<Vec3d> tip_;                  // end of the cylinder's axis after joining
    std::vector<std::uint32_t> leaves_from_;  // node to which a cylinder is attached
    CompressedRows<std::uint32_t> children_;
    NodeList list_;
};

/// Inserts short segments where the radius changes between a segment and its continuation.
class JumpKeeper {
  public:
    explicit JumpKeeper(const NodeList& list)
        : in_(list), leader_(list.size(), kNoIndex), children_(list.size(), 0) {
        for (std::uint32_t i = 0; i < list.size(); ++i) {
            const std::uint32_t p = list.parent[i];
            if (p == kNoIndex) continue;
            ++children_[p];
            if (leader_[p] == kNoIndex || list.radius[i] > list.radius[leader_[p]]) leader_[p] = i;
        }
    }

    NodeList run(RepairReport& report) {
        std::vector<std::uint32_t> new_index(in_.size()), leaving(in_.size());
        NodeList out;
        for (std::uint32_t i = 0; i < in_.size(); ++i) {
            const std::uint32_t p = in_.parent[i];
            const std::uint32_t from = p == kNoIndex ? kNoIndex : leader_[p] == i ? leaving[p] : new_index[p];
            new_index[i] = leaving[i] = out.add(from, in_.position[i], radius(i));
            out.source.push_back(in_.source[i]);
            if (!jumps_at(i)) continue;
            ++report.radius_jumps;
            const std::uint32_t next = leader_[i];
            const double ahead = room(i, next), behind = children_[i] == 1 ? room(i, i) : 0;
            out.position[new_index[i]] += toward(i, p) * behind;
            leaving[i] = out.add(new_index[i], in_.position[i] + toward(i, next) * ahead, in_.radius[next]);
            out.source.push_back(in_.source[next]);
        }
        return out;
    }

  private:
    /// Returns the radius of a node; a root gets that of its leader.
    double radius(std::uint32_t i) const {
        return in_.parent[i] == kNoIndex && leader_[i] != kNoIndex ? in_.radius[leader_[i]] : in_.radius[i];
    }
    bool jumps_at(std::uint32_t i) const {
        if (in_.parent[i] == kNoIndex || leader_[i] == kNoIndex) return false;
        return std::abs(in_.radius[leader_[i]] - in_.radius[i]) > kSmallestJump * in_.radius[i];
    }
    double length(std::uint32_t i) const { return distance(in_.position[i], in_.position[in_.parent[i]]); }
    Vec3d toward(std::uint32_t i, std::uint32_t j) const {
        return normalized(in_.position[j] - in_.position[i]);
    }

    /// Returns the length of the jump at i on the segment that ends at j.
    double room(std::uint32_t i, std::uint32_t j) const {
        const double a = in_.radius[i], b = in_.radius[leader_[i]];
        const double whole = std::max(std::abs(a - b), std::min(a, b));
        return std::min(children_[i] == 1 ? whole / 2 : whole, length(j) / 3);
    }

    const NodeList& in_;
    std::vector<std::uint32_t> leader_, children_;
};

}  // namespace

RepairResult repair(const std::vector<RawCylinder>& cylinders, const std::string& source) {
    check(cylinders, source);
    RepairReport report;
    const std::vector<Axis> axes = read_axes(cylinders, source, report);
    const NodeList joined = Joiner(axes, report).run();
    const NodeList nodes = JumpKeeper(joined).run(report);
    return assemble(nodes, report);
}

}  // namespace coppice
