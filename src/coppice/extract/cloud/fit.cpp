#include "coppice/extract/cloud/fit_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/extract/stage_internal.h"
#include "coppice/extract/tree/circle_fit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kEnough = 30;  // points for a circle
constexpr int kFarthest = 12;        // nodes of an axis on either side that a fit may ask
constexpr double kReach = 0.75;      // [radius] of a fit on either side at least

struct Measured {
    Vec3d position;
    double radius;
    float weight, residual;
};

/// Unit directions of the axes at the nodes, away from the root.
std::vector<Vec3d> axis_directions(const CloudTree& tree, std::span<const std::uint32_t> next) {
    std::vector<Vec3d> direction(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t above = tree.parent[n];
        // A lateral's first node lies beside its parent: the way there is not its direction.
        const bool starts = above == kNone || next[above] != n;
        const std::uint32_t from = starts && next[n] != kNone ? n : above;
        const std::uint32_t to = next[n] == kNone ? n : next[n];
        const Vec3d back = from == kNone ? tree.position[n] : tree.position[from];
        direction[n] = normalized(tree.position[to] - back);
    }
    return direction;
}

class AxisFitter {
  public:
    AxisFitter(const CloudTree& tree, std::span<const Vec3> points)
        : tree_(tree),
          points_(points),
          next_(axis_children(tree, longest_)),
          direction_(axis_directions(tree, next_)),
          members_(group_by(tree.node_of_point, tree.size())) {}

    std::uint32_t next(std::uint32_t n) const { return next_[n]; }
    /// The node before on the same axis.
    std::uint32_t previous(std::uint32_t n) const {
        const std::uint32_t above = tree_.parent[n];
        return above != kNone && next_[above] == n ? above : kNone;
    }

    Measured measure(std::uint32_t n, std::vector<PlanePoint>& plane) const {
        gather(n, plane);
        Measured out{tree_.position[n], tree_.radius[n], 0, 0};
        if (plane.empty()) return out;
        double far = 0, mx = 0, my = 0, sum = 0;
        for (const PlanePoint& p : plane) {
            mx += p.weight * p.x;
            my += p.weight * p.y;
            sum += p.weight;
        }
        mx /= sum;
        my /= sum;
        for (const PlanePoint& p : plane) far = std::max(far, std::hypot(p.x - mx, p.y - my));
        const CircleFit fit = fit_circle(plane, 1.5 * far);
        const Vec3d u = perpendicular(direction_[n]), v = cross(direction_[n], u);
        if (fit.good) {
            out.position += fit.x * u + fit.y * v;
            out.radius = fit.radius;
            out.weight = static_cast<float>(fit.used);
            out.residual = static_cast<float>(fit.residual);
        } else {
            out.position += mx * u + my * v;
            double spread = 0;
            for (const PlanePoint& p : plane) spread += p.weight * std::hypot(p.x - mx, p.y - my);
            out.radius = spread / sum;
        }
        return out;
    }

  private:
    /// Points of one node as seen along the axis at `eye`, `way` [m] off.
    void add(std::uint32_t node, std::uint32_t eye, double weight, std::vector<PlanePoint>& plane) const {
        const Vec3d u = perpendicular(direction_[eye]), v = cross(direction_[eye], u), t = direction_[node];
        for (const std::uint32_t i : members_[node]) {
            Vec3d off = Vec3d(points_[i]) - tree_.position[node];
            off -= t * dot(off, t);
            plane.push_back({dot(off, u), dot(off, v), weight});
        }
    }

    void gather(std::uint32_t n, std::vector<PlanePoint>& plane) const {
        plane.clear();
        add(n, n, 1, plane);
        std::uint32_t up = n, down = n;
        double way_up = 0, way_down = 0;
        for (int step = 1; step <= kFarthest; ++step) {
            const bool enough = plane.size() >= kEnough;
            const double reach = kReach * tree_.radius[n];
            const double weight = 1.0 / (1.0 + 0.25 * step);
            bool grown = false;
            if (up != kNone && (!enough || way_up < reach) && (up = next_[up]) != kNone) {
                way_up += distance(tree_.position[up], tree_.position[tree_.parent[up]]);
                add(up, n, weight, plane);
                grown = true;
            }
            if (down != kNone && (!enough || way_down < reach)) {
                const std::uint32_t before = previous(down);
                if (before != kNone) {
                    way_down += distance(tree_.position[before], tree_.position[down]);
                    add(before, n, weight, plane);
                    grown = true;
                }
                down = before;
            }
            if (!grown) break;
        }
    }

    const CloudTree& tree_;
    std::span<const Vec3> points_;
    std::vector<double> longest_;
    std::vector<std::uint32_t> next_;
    std::vector<Vec3d> direction_;
    CompressedRows<std::uint32_t> members_;
};

/// Draws nodes to the middle of their neighbours along the axis, those with poor fits farther.
void smooth(CloudTree& tree, std::uint32_t first, const AxisFitter& axes) {
    std::vector<Vec3d> moved = tree.position;
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        const std::uint32_t a = axes.previous(n), b = axes.next(n);
        if (a == kNone || b == kNone) continue;
        const double trust = tree.weight[n] / (tree.weight[n] + 10.0);
        const Vec3d middle = 0.5 * (tree.position[a] + tree.position[b]);
        moved[n] = lerp(tree.position[n], middle, 0.5 * (1 - trust) + 0.1);
    }
    tree.position = std::move(moved);
}

}  // namespace

void fit_axes(CloudTree& tree, std::uint32_t first, std::span<const Vec3> points, int passes,
              const Context& ctx) {
    for (int pass = 0; pass < passes; ++pass) {
        const AxisFitter axes(tree, points);
        std::vector<Measured> measured(tree.size());
        stoppable_for_ranges(ctx, tree.size(), 64, [&](IndexRange range) {
            std::vector<PlanePoint> plane;
            for (std::size_t n = std::max<std::size_t>(range.begin, first); n < range.end; ++n) {
                measured[n] = axes.measure(static_cast<std::uint32_t>(n), plane);
            }
        });
        for (std::uint32_t n = first; n < tree.size(); ++n) {
            tree.position[n] = measured[n].position;
            tree.radius[n] = measured[n].radius;
            tree.weight[n] = measured[n].weight;
            tree.residual[n] = measured[n].residual;
        }
        smooth(tree, first, axes);
    }
}

}  // namespace coppice::extract_internal
