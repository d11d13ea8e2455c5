#include "coppice/extract/cloud/fit_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/progress.h"
#include "coppice/extract/tree/circle_fit_internal.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kEnough = 30;  // number of points for a circle
constexpr int kFarthest = 12;        // maximum number of nodes of an axis on either side used by a fit
constexpr double kReach = 0.75;      // [radius] minimum length of a fit on either side

/// Tree with its axes and the points of its nodes.
struct Axes {
    const CloudTree& tree;
    std::span<const Vec3> points;
    std::vector<std::uint32_t> next;        // per node, the next one on its axis; kNoIndex at the end
    std::vector<Vec3d> direction;           // unit vectors, away from the root
    CompressedRows<std::uint32_t> members;  // points of each node

    /// Returns the previous node on the same axis.
    std::uint32_t previous(std::uint32_t n) const {
        const std::uint32_t parent = tree.parent[n];
        return parent != kNoIndex && next[parent] == n ? parent : kNoIndex;
    }
};

std::vector<Vec3d> axis_directions(const CloudTree& tree, std::span<const std::uint32_t> next) {
    std::vector<Vec3d> direction(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t parent = tree.parent[n];
        // The first node of a lateral is offset from its parent: the vector between them is not its
        // direction.
        const bool starts = parent == kNoIndex || next[parent] != n;
        const std::uint32_t from = starts && next[n] != kNoIndex ? n : parent;
        const std::uint32_t to = next[n] == kNoIndex ? n : next[n];
        const Vec3d back = from == kNoIndex ? tree.position[n] : tree.position[from];
        direction[n] = normalized(tree.position[to] - back);
    }
    return direction;
}

Axes find_axes(const CloudTree& tree, std::span<const Vec3> points) {
    std::vector<std::uint32_t> next = axis_children(tree);
    std::vector<Vec3d> direction = axis_directions(tree, next);
    return {tree, points, std::move(next), std::move(direction), group_by(tree.node_of_point, tree.size())};
}

/// Adds the points of one node, projected along the axis at `eye`.
void project_points(const Axes& axes, std::uint32_t node, std::uint32_t eye, double weight,
                    std::vector<PlanePoint>& plane) {
    const Vec3d u = perpendicular(axes.direction[eye]), v = cross(axes.direction[eye], u);
    const Vec3d t = axes.direction[node];
    for (const std::uint32_t i : axes.members[node]) {
        Vec3d off = Vec3d(axes.points[i]) - axes.tree.position[node];
        off -= t * dot(off, t);
        plane.push_back({dot(off, u), dot(off, v), weight});
    }
}

/// Projects the points of a node and of as many neighbours along the axis as needed onto a plane across it.
void gather_points(const Axes& axes, std::uint32_t n, std::vector<PlanePoint>& plane) {
    const CloudTree& tree = axes.tree;
    plane.clear();
    project_points(axes, n, n, 1, plane);
    std::uint32_t tipward = n, rootward = n;
    double way_tipward = 0, way_rootward = 0;
    for (int step = 1; step <= kFarthest; ++step) {
        const bool enough = plane.size() >= kEnough;
        const double reach = kReach * tree.radius[n];
        const double weight = 1.0 / (1.0 + 0.25 * step);
        bool grown = false;
        if (tipward != kNoIndex && (!enough || way_tipward < reach) &&
            (tipward = axes.next[tipward]) != kNoIndex) {
            way_tipward += distance(tree.position[tipward], tree.position[tree.parent[tipward]]);
            project_points(axes, tipward, n, weight, plane);
            grown = true;
        }
        if (rootward != kNoIndex && (!enough || way_rootward < reach)) {
            const std::uint32_t before = axes.previous(rootward);
            if (before != kNoIndex) {
                way_rootward += distance(tree.position[before], tree.position[rootward]);
                project_points(axes, before, n, weight, plane);
                grown = true;
            }
            rootward = before;
        }
        if (!grown) break;
    }
}

struct Measured {
    Vec3d position;
    double radius;
    float weight, residual;
};

/// Fits a circle about a node; if this fails, uses the mean of the points and their mean distance from it.
Measured measure(const Axes& axes, std::uint32_t n, std::vector<PlanePoint>& plane) {
    gather_points(axes, n, plane);
    Measured out{axes.tree.position[n], axes.tree.radius[n], 0, 0};
    if (plane.empty()) return out;
    double far = 0, mx = 0, my = 0, sum = 0;
    for (const PlanePoint& p : plane) {
        mx += p.weight * p.x;
        my += p.weight * p.y;
        sum += p.weight;
    }
    mx /= sum;
    my /= sum;
    for (const PlanePoint& p : plane) far = std::max(far, (p.x - mx) * (p.x - mx) + (p.y - my) * (p.y - my));
    const CircleFit fit = fit_circle(plane, 1.5 * std::sqrt(far));
    const Vec3d u = perpendicular(axes.direction[n]), v = cross(axes.direction[n], u);
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

/// Returns the positions, moved towards the middle of their neighbours along the axis; those with poor fits
/// move farther.
std::vector<Vec3d> smoothed(const Axes& axes, std::uint32_t first) {
    const CloudTree& tree = axes.tree;
    std::vector<Vec3d> moved = tree.position;
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        const std::uint32_t a = axes.previous(n), b = axes.next[n];
        if (a == kNoIndex || b == kNoIndex) continue;
        const double trust = tree.weight[n] / (tree.weight[n] + 10.0);
        const Vec3d middle = 0.5 * (tree.position[a] + tree.position[b]);
        moved[n] = lerp(tree.position[n], middle, 0.5 * (1 - trust) + 0.1);
    }
    return moved;
}

}  // namespace

void fit_axes(CloudTree& tree, std::uint32_t first, std::span<const Vec3> points, int passes,
              const Context& ctx) {
    for (int pass = 0; pass < passes; ++pass) {
        const Axes axes = find_axes(tree, points);
        std::vector<Measured> measured(tree.size());
        parallel_for_ranges(ctx, tree.size(), 64, [&](IndexRange range) {
            std::vector<PlanePoint> plane;
            for (std::size_t n = std::max<std::size_t>(range.begin, first); n < range.end; ++n) {
                measured[n] = measure(axes, static_cast<std::uint32_t>(n), plane);
            }
        });
        for (std::uint32_t n = first; n < tree.size(); ++n) {
            tree.position[n] = measured[n].position;
            tree.radius[n] = measured[n].radius;
            tree.weight[n] = measured[n].weight;
            tree.residual[n] = measured[n].residual;
        }
        tree.position = smoothed(axes, first);
    }
}

}  // namespace coppice::extract_internal
