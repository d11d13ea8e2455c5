#include "coppice/extract/mesh/contraction_internal.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/mesh/cholesky_internal.h"
#include "coppice/extract/mesh/collapse_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kFirstStep = 0.25;        // [mean triangle area] initial time step
constexpr double kGrowth = 2;              // factor of the time step per iteration
constexpr double kLongestStep = 1.0 / 16;  // [squared extent] maximum time step
constexpr double kThin = 0.1;              // [initial area] one-ring area at which a vertex stops moving
constexpr double kRest = 1e-4;  // [time step at which the vertex stopped] time step of stopped vertices
constexpr float kSmoothingShare = 0.9f;         // share of the progress used by smoothing
constexpr double kMinCot = 0.05, kMaxCot = 20;  // clamps the cotangents of degenerate triangles

using Matrix = SparseCholesky::Matrix;
using Points = SparseCholesky::Columns;

Vec3d point(const Points& p, std::uint32_t v) { return {p(v, 0), p(v, 1), p(v, 2)}; }

/// Returns the area of every vertex, a third of the area of its triangles.
std::vector<double> one_ring_areas(const Surface& s, const Points& at) {
    std::vector<double> area(s.size(), 0);
    for (const Triangle& t : s.triangles) {
        const Vec3d a = point(at, t[0]);
        const double third = length(cross(point(at, t[1]) - a, point(at, t[2]) - a)) / 6;
        for (const std::uint32_t v : t) area[v] += third;
    }
    return area;
}

/// Returns the Laplacian matrix: off-diagonal entries are the sums of the clamped cotangents across each
/// edge; rows sum to zero.
Matrix laplacian(const Surface& s, const Points& at) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(12 * s.triangles.size());
    for (const Triangle& t : s.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t i = t[(k + 1) % 3], j = t[(k + 2) % 3];
            const Vec3d u = point(at, i) - point(at, t[k]), v = point(at, j) - point(at, t[k]);
            const double sine = length(cross(u, v));
            const double w = std::clamp(sine > 0 ? dot(u, v) / sine : kMaxCot, kMinCot, kMaxCot);
            for (const auto& [a, b] : {std::pair{i, j}, std::pair{j, i}}) {
                entries.emplace_back(a, b, w);
                entries.emplace_back(a, a, -w);
            }
        }
    }
    Matrix l(static_cast<Eigen::Index>(s.size()), static_cast<Eigen::Index>(s.size()));
    l.setFromTriplets(entries.begin(), entries.end());
    return l;
}

/// Returns the vertices after implicit smoothing with increasing time steps; each vertex stops when the
/// surface around it has become a line. The Laplacian of the initial surface is used throughout
/// [Kazhdan2012]. A Laplacian that is recomputed in each step, as in [Au2008], degenerates with the
/// triangles, in thin twigs long before thick branches; it then shortens the twigs and opens webs at forks.
/// With positive weights every vertex moves to a mean of vertices, so that the result is inside the convex
/// hull of the surface.
Points smoothed(const Surface& s, const Context& ctx) {
    Points at(s.size(), 3);
    for (std::uint32_t v = 0; v < s.size(); ++v)
        for (int k = 0; k < 3; ++k) at(v, k) = static_cast<double>(s.positions[v][k]);
    const std::vector<double> first = one_ring_areas(s, at);
    const double whole = std::accumulate(first.begin(), first.end(), 0.0);
    if (!(whole > 0)) return at;
    const double least = 1e-12 * whole / static_cast<double>(s.size());
    const double extent = (at.colwise().maxCoeff() - at.colwise().minCoeff()).norm();
    const double first_step = kFirstStep * whole / static_cast<double>(s.triangles.size());
    const double longest = kLongestStep * extent * extent;
    const Matrix pull = -laplacian(s, at);
    std::vector<double> rested(s.size(), 0);  // time step at which each vertex stopped; 0 while it moves
    SparseCholesky solver;
    for (double step = first_step; step <= std::max(first_step, longest); step *= kGrowth) {
        ctx.throw_if_cancelled();
        Matrix a = pull;
        Points right = at;
        for (std::uint32_t v = 0; v < s.size(); ++v) {
            const double hold = std::max(first[v], least) / (rested[v] > 0 ? kRest * rested[v] : step);
            a.coeffRef(v, v) += hold;
            right.row(v) *= hold;
        }
        if (step == first_step) solver.analyze(a);
        if (!solver.factorize(a, ctx)) break;
        const Points next = solver.solve(right);
        if (!next.allFinite()) break;
        at = next;
        const std::vector<double> area = one_ring_areas(s, at);
        for (std::uint32_t v = 0; v < s.size(); ++v)
            if (rested[v] == 0 && area[v] < kThin * first[v]) rested[v] = step;
        ctx.report(static_cast<float>(std::log2(step / first_step) / std::log2(longest / first_step)));
    }
    return at;
}

/// Moves each node to the area-weighted mean of the vertices that were merged into it.
void center_nodes(const Surface& s, Contraction& c) {
    std::vector<double> weight(c.tree.size(), 0);
    std::vector<Vec3d> sum(c.tree.size());
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        double area = 1e-300;
        for (const std::uint32_t h : s.outgoing(v)) {
            const Vec3d p(s.positions[v]);
            area += length(cross(Vec3d(s.positions[s.to(h)]) - p,
                                 Vec3d(s.positions[s.from(previous_half_edge<3>(h))]) - p));
        }
        weight[c.node[v]] += area;
        sum[c.node[v]] += Vec3d(s.positions[v]) * area;
    }
    for (std::uint32_t n = 0; n < c.tree.size(); ++n) c.tree.position[n] = sum[n] / weight[n];
}

/// Sets the radius of each node to the median or mean distance of its vertices from the adjacent segments.
void measure_radii(const Surface& s, Thickness thickness, const Context& ctx, Contraction& c) {
    const InitialTree& t = c.tree;
    const InitialTreeLinks links(t);
    std::vector<std::vector<double>> distances(t.size());
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        const std::uint32_t n = c.node[v];
        const Vec3d p(s.positions[v]);
        double best = distance(p, t.position[n]);
        const auto look = [&](std::uint32_t m) {
            const Vec3d d = t.position[m] - t.position[n];
            const double k = closest_parameter(p, t.position[n], d);
            best = std::min(best, distance(p, t.position[n] + d * k));
        };
        if (t.parent[n] != kNoIndex) look(t.parent[n]);
        for (const std::uint32_t m : links.children(n)) look(m);
        distances[n].push_back(best);
    }
    parallel_for(ctx, t.size(), 256, [&](std::size_t n) {
        c.tree.radius[n] = thickness == Thickness::median
                               ? median_in_place(distances[n])
                               : std::accumulate(distances[n].begin(), distances[n].end(), 0.0) /
                                     static_cast<double>(distances[n].size());
    });
    double least = 0;
    for (const double r : c.tree.radius) least = std::max(least, 1e-4 * r);
    for (double& r : c.tree.radius) r = std::max(r, least);
}

/// Throws InvalidInput if the sum of squared valences is too large: each collapse visits all neighbours of
/// the neighbours.
void check_valences(const Surface& s) {
    constexpr double kMaxLooks = 200;  // maximum visits per vertex; a regular mesh needs about 36
    double looks = 0;
    for (std::uint32_t v = 0; v < s.size(); ++v) {
        const auto n = static_cast<double>(s.outgoing(v).size());
        looks += n * n;
    }
    if (looks > kMaxLooks * s.size() + 1e6)
        throw InvalidInput(
            "vertices of the mesh have too many neighbours to be contracted; use the method rings");
}

}  // namespace

Contraction contract(const Surface& s, Thickness thickness, const Context& ctx) {
    check_valences(s);
    const Points thin = smoothed(s, narrow_progress(ctx, 0, kSmoothingShare));
    std::vector<Vec3d> at(s.size());
    for (std::uint32_t v = 0; v < s.size(); ++v) at[v] = point(thin, v);
    Contraction out = collapse_to_graph(s, at, narrow_progress(ctx, kSmoothingShare, 1));
    center_nodes(s, out);
    measure_radii(s, thickness, ctx, out);
    return out;
}

}  // namespace coppice::extract_internal
