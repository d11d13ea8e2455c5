#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of cloud_distances().
struct CloudDistanceOptions {
    int samples = 0;  ///< number of sample points on the surface; 0 = number of points of the cloud, limited
                      ///< to 10,000 to 1 million
    float support = 0;  ///< [m] maximum distance of surface to the nearest point, beyond which it is bare; 0
                        ///< = three median spacings of the cloud
    float fork_reach = 2;  ///< [radius] of a fork's node: radius of the ball that belongs to the fork
};

/// Lists the members for front ends.
void list_fields(CloudDistanceOptions& o, FieldList& list);

/// Statistics of unsigned distances, except for the bias. Quantiles are members of the sample, as in
/// Statistics.
struct DistanceSummary {
    std::uint64_t n = 0;         ///< number of distances; if it is 0, the others are 0
    double mean = 0;             ///< mean
    double p50 = 0;              ///< median
    double p95 = 0;              ///< 95 % quantile
    double max = 0;              ///< maximum
    std::optional<double> bias;  ///< signed mean, negative inside; only of points to a closed surface
    friend bool operator==(const DistanceSummary&, const DistanceSummary&) = default;  ///< member by member
};

/// Distances in both directions between points and surface, of all points or of those at forks.
struct CloudDistanceSummary {
    DistanceSummary to_surface;  ///< [m] from the points of the cloud to the surface
    /// The same, divided by the radius of the nearest segment at the closest point.
    DistanceSummary to_surface_radius;
    DistanceSummary to_cloud;         ///< [m] from points distributed evenly over the surface to the cloud
    DistanceSummary to_cloud_radius;  ///< the same, divided by that radius
    double bare_percent = 0;          ///< share of the surface that is farther from all points than `support`
    friend bool operator==(const CloudDistanceSummary&,
                           const CloudDistanceSummary&) = default;  ///< member by member
};

/// Distances between a cloud and a surface.
struct CloudDistanceReport {
    bool closed = false;         ///< whether the surface has an inside: watertight, with a positive volume
    double support = 0;          ///< [m] the value that was used
    CloudDistanceSummary whole;  ///< of all points
    /// Number of nodes with at least three neighbours; nullopt without a skeleton.
    std::optional<std::uint64_t> forks;
    CloudDistanceSummary at_forks;  ///< of the points near forks
    friend bool operator==(const CloudDistanceReport&,
                           const CloudDistanceReport&) = default;  ///< member by member
};

/// The result of cloud_distances().
struct CloudDistances {
    CloudDistanceReport report;    ///< summary of all distances
    std::vector<float> of_points;  ///< [m] of each point, negative behind the nearest face
};

/// Measures the distances from a cloud to a surface and back: the points that the surface misses, and the
/// surface that no point supports. `skeleton`, which may be null, provides forks and radii. Each input has
/// its own origin.
///
/// Finds the nearest face of every point, and the nearest points of the same number of points distributed
/// evenly over the surface: O((n + m) log(n + m)) [n points, m faces] while both are near each other; about
/// 70 bytes per point and 90 per face. The result does not depend on the number of threads.
///
/// Throws InvalidInput for a mesh that is invalid or has no area, a cloud without points, options out of
/// range, and before any long computation if the two hardly overlap: if they are far apart, or if one is
/// larger by a power of ten, as with millimetres and metres. Throws Cancelled within a fraction of a second.
CloudDistances cloud_distances(const PolygonMesh& mesh, const PointSet& cloud, const Skeleton* skeleton,
                               const CloudDistanceOptions& options = {}, const Context& ctx = {});

/// Calls visit(name, number) for every figure, in order.
template <class Visitor>
void visit_figures(const DistanceSummary& s, Visitor&& visit) {
    visit("n", s.n);
    if (s.n == 0) return;
    visit("mean", s.mean);
    visit("p50", s.p50);
    visit("p95", s.p95);
    visit("max", s.max);
    if (s.bias) visit("bias", *s.bias);
}

/// Calls visit(name, figure) for every figure, in order; the names of figures at forks begin with "fork_".
template <class Visitor>
void visit_figures(const CloudDistanceReport& r, Visitor&& visit) {
    const auto visit_part = [&](const std::string& prefix, const CloudDistanceSummary& s) {
        visit(prefix + "cloud_to_surface_m", s.to_surface);
        if (s.to_surface_radius.n > 0) visit(prefix + "cloud_to_surface_r", s.to_surface_radius);
        visit(prefix + "surface_to_cloud_m", s.to_cloud);
        if (s.to_cloud_radius.n > 0) visit(prefix + "surface_to_cloud_r", s.to_cloud_radius);
        visit(prefix + "surface_bare_percent", s.bare_percent);
    };
    visit("cloud_support_m", r.support);
    visit_part("", r.whole);
    if (!r.forks) return;
    visit("forks", *r.forks);
    visit_part("fork_", r.at_forks);
}

}  // namespace coppice
