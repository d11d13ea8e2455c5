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

/// How a cloud is held against a surface.
struct CloudDistanceOptions {
    int samples = 0;    ///< points of the surface; 0 = as many as the cloud has, 10,000 to 1 million
    float support = 0;  ///< [m] surface with no point nearer is bare; 0 = three median spacings of the cloud
    float fork_reach = 2;  ///< [radius] of a fork's node, around it: what lies within is at the fork
};

template <class Self, class Visitor>
requires SameOptions<Self, CloudDistanceOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"samples",
                "points of the surface that are looked up in the cloud; 0 takes as many as it has, 10,000 at "
                "least and a million at most",
                Unit::none, 0, 1e8},
          o.samples);
    visit(Field{"support",
                "surface with no point nearer than this is bare; 0 takes three times the median spacing",
                Unit::metre, 0, 1e6},
          o.support);
    visit(Field{"fork_reach", "what lies within so many radii of a fork's node is at the fork", Unit::radius,
                0.1, 100},
          o.fork_reach);
}

/// Distances without their sign, but for the bias. Quantiles are members of the sample, as in Statistics.
struct DistanceSummary {
    std::uint64_t n = 0;         ///< number of distances; the others are 0 without any
    double mean = 0;             ///< their mean
    double p50 = 0;              ///< the median
    double p95 = 0;              ///< 5 % are greater
    double max = 0;              ///< the greatest
    std::optional<double> bias;  ///< mean with sign, negative inside; of points to a closed surface alone
    friend bool operator==(const DistanceSummary&, const DistanceSummary&) = default;  ///< member by member
};

/// Both ways between points and surface, of one part of space.
struct CloudDistanceSummary {
    DistanceSummary to_surface;         ///< [m] from the points of the cloud to the surface
    DistanceSummary to_surface_radius;  ///< the same over the radius of the nearest segment at its foot
    DistanceSummary to_cloud;           ///< [m] from points spread evenly over the surface to the cloud
    DistanceSummary to_cloud_radius;    ///< the same over that radius
    double bare_percent = 0;            ///< of the surface: farther from all points than `support`
    friend bool operator==(const CloudDistanceSummary&,
                           const CloudDistanceSummary&) = default;  ///< member by member
};

/// How far a cloud and a surface lie apart.
struct CloudDistanceReport {
    bool closed = false;                 ///< the surface has an inside: watertight, with a positive volume
    double support = 0;                  ///< [m] the one that was taken
    CloudDistanceSummary whole;          ///< of everything
    std::optional<std::uint64_t> forks;  ///< nodes with three neighbours or more; none without a skeleton
    CloudDistanceSummary at_forks;       ///< of what is near them
    friend bool operator==(const CloudDistanceReport&,
                           const CloudDistanceReport&) = default;  ///< member by member
};

/// What `cloud_distances` returns.
struct CloudDistances {
    CloudDistanceReport report;    ///< of all of them
    std::vector<float> of_points;  ///< [m] of each point, negative behind the nearest face
};

/// Measures a cloud from a surface and back: what the surface misses, and what of it no point supports.
/// `skeleton`, which may be null, tells where forks are and what radii there are. Each has its own origin.
///
/// Every point looks for the nearest face, and as many points spread evenly over the surface look for the
/// nearest point: O((n + m) log(n + m)) [n points, m faces] while both lie near each other; about 70 bytes
/// per point and 90 per face. The same bits for any number of threads.
///
/// Throws InvalidInput for a mesh that is not valid or has no area, a cloud without points, options out of
/// their range, and before any long work where the two hardly meet: where they lie apart, or where one is a
/// power of ten larger, as millimetres and metres differ. Cancelled within a fraction of a second.
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

/// Calls visit(name, figure) for every figure, in order; those of forks begin with "fork_".
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
