#include "coppice/measure/match/cloud_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/forks_internal.h"
#include "coppice/measure/match/area_points_internal.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/points/spacing.h"
#include "coppice/spatial/kd_tree.h"

namespace coppice {
namespace {

using measure_internal::AreaPoints;
using measure_internal::Forks;

constexpr std::size_t kCloudDistanceGrain = 256;
constexpr std::size_t kBlock = 1 << 16;  // [points] between two reports of progress
constexpr double kSpacings = 3;  // [median spacings of the cloud] distance beyond which the surface is bare
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kMinSamples = 10'000, kMaxSamples = 1'000'000;

/// Runs body(i) for all i < count, and reports progress between the values `from` and `to`.
template <class Body>
void for_blocks(const Context& ctx, std::size_t count, float from, float to, const Body& body) {
    for (std::size_t begin = 0; begin < count; begin += kBlock) {
        parallel_for(ctx, std::min(kBlock, count - begin), kCloudDistanceGrain,
                     [&](std::size_t i) { body(begin + i); });
        const double done = static_cast<double>(std::min(begin + kBlock, count)) / static_cast<double>(count);
        ctx.report(from + (to - from) * static_cast<float>(done));
    }
}

/// Local properties of the skeleton.
class Surroundings {
  public:
    Surroundings(const Skeleton& skeleton, Vec3d origin, double fork_reach, const Context& ctx)
        : capsules_(skeleton, origin, ctx), forks_(skeleton, origin, fork_reach, ctx) {}

    std::size_t fork_count() const { return forks_.size(); }
    bool is_at_fork(Vec3d p) const { return forks_.contain(p); }
    /// [m] NaN if there is no segment
    float radius(Vec3d p) const {
        const std::uint32_t nearest = capsules_.nearest(p).capsule;
        if (nearest == kNoIndex) return kUnknown;
        return static_cast<float>(capsules_.cone(nearest).closest_point(p).radius);
    }

  private:
    CapsuleTree capsules_;
    Forks forks_;
};

/// The results for every point of one side.
struct Found {
    std::vector<float> distance;  ///< [m]
    std::vector<float> radius;    ///< [m] of the nearest segment; empty without a skeleton
    std::vector<char> at_fork;    ///< empty without a skeleton

    Found(std::size_t count, bool with_skeleton)
        : distance(count), radius(with_skeleton ? count : 0), at_fork(with_skeleton ? count : 0) {}

    void note(std::size_t i, Vec3d p, double d, const Surroundings* surroundings) {
        distance[i] = static_cast<float>(d);
        if (surroundings == nullptr) return;
        radius[i] = surroundings->radius(p);
        at_fork[i] = surroundings->is_at_fork(p) ? 1 : 0;
    }
};

/// Summarizes the distances for which use(i) is true, optionally in radii.
template <class Use>
DistanceSummary summary(const Found& found, bool in_radii, bool with_bias, const Use& use) {
    std::vector<float> sizes;
    double sum = 0, signed_sum = 0;
    for (std::size_t i = 0; i < found.distance.size(); ++i) {
        if (!use(i) || (in_radii && std::isnan(found.radius[i]))) continue;
        const float d = in_radii ? found.distance[i] / found.radius[i] : found.distance[i];
        sizes.push_back(std::fabs(d));
        sum += double{std::fabs(d)};
        signed_sum += double{d};
    }
    const std::size_t n = sizes.size();
    DistanceSummary out{.n = n};
    if (n == 0) return out;
    const auto rank = [&](std::size_t k) {
        const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(k);
        std::nth_element(sizes.begin(), at, sizes.end());
        return double{*at};
    };
    out.mean = sum / static_cast<double>(n);
    out.p50 = rank(n / 2);
    out.p95 = rank(n - 1 - n / 20);
    out.max = double{*std::max_element(sizes.begin(), sizes.end())};
    if (with_bias) out.bias = signed_sum / static_cast<double>(n);
    return out;
}

/// Summarizes the points for which use(found, i) is true.
template <class Use>
CloudDistanceSummary summary(const Found& points, const Found& surface, const CloudDistanceReport& report,
                             const Use& use) {
    const auto of_points = [&](std::size_t i) { return use(points, i); };
    const auto of_surface = [&](std::size_t i) { return use(surface, i); };
    CloudDistanceSummary out;
    out.to_surface = summary(points, false, report.closed, of_points);
    out.to_cloud = summary(surface, false, false, of_surface);
    if (!points.radius.empty()) {
        out.to_surface_radius = summary(points, true, report.closed, of_points);
        out.to_cloud_radius = summary(surface, true, false, of_surface);
    }
    std::size_t bare = 0;
    for (std::size_t i = 0; i < surface.distance.size(); ++i)
        bare += use(surface, i) && double{surface.distance[i]} > report.support ? 1 : 0;
    if (out.to_cloud.n > 0)
        out.bare_percent = 100.0 * static_cast<double>(bare) / static_cast<double>(out.to_cloud.n);
    return out;
}

/// Spatial indices of cloud and surface, in the mesh's frame.
class Both {
  public:
    Both(const PolygonMesh& mesh, const PointSet& cloud, std::size_t samples, const Context& ctx)
        : cloud_(cloud),
          shift_(cloud.origin - mesh.origin),
          surface_(mesh, ctx),
          points_(std::span(cloud.positions.data(), cloud.size()), ctx),
          samples_(mesh, samples) {
        if (samples_.size() == 0) throw InvalidInput("check: the mesh has no area to measure a cloud from");
    }

    std::size_t sample_count() const { return samples_.size(); }
    Vec3d point(std::size_t i) const { return Vec3d(cloud_.positions[i]) + shift_; }
    Vec3d sample(std::size_t i) const { return samples_[i]; }
    double to_surface(Vec3d p) const { return surface_.signed_distance(p); }
    double to_cloud(Vec3d p) const { return std::sqrt(points_.nearest(Vec3(p - shift_)).squared); }

  private:
    const PointSet& cloud_;
    Vec3d shift_;
    SurfaceTree surface_;
    KdTree points_;
    AreaPoints samples_;
};

struct Box3d {
    Vec3d low, high;
    double size() const { return distance(low, high); }
    double gap(const Box3d& other) const {
        Vec3d gap;
        for (int k = 0; k < 3; ++k) gap[k] = std::max({0.0, low[k] - other.high[k], other.low[k] - high[k]});
        return length(gap);
    }
};

Box3d world_box(const Box3& box, Vec3d origin) { return {Vec3d(box.low) + origin, Vec3d(box.high) + origin}; }

Box3 bounds_of_faces(const PolygonMesh& mesh) {
    Box3 box;
    for (const std::uint32_t v : mesh.corners) box.extend(mesh.positions[v]);
    return box;
}

/// Rejects a cloud that is far away, for which every search would visit most of the surface.
void check_place(const Box3d& mesh, const Box3d& cloud) {
    const double gap = mesh.gap(cloud);
    if (gap <= std::max(mesh.size(), cloud.size())) return;
    const Vec3d shift = 0.5 * (cloud.low + cloud.high - mesh.low - mesh.high);
    const auto without_noise = [&](double x) { return std::fabs(x) > 1e-3 * gap ? x : 0.0; };
    throw InvalidInput(
        fmt::format("check: the cloud is {:.4g} m away from the mesh; make sure that both are in the same "
                    "place and unit. Their centres differ by ({:.4g}, {:.4g}, {:.4g}) m",
                    gap, without_noise(shift.x), without_noise(shift.y), without_noise(shift.z)));
}

/// Returns the median over at most a thousand of `count` points.
template <class Distance>
double median(std::size_t count, const Distance& of) {
    constexpr std::size_t kMax = 1000;
    const std::size_t n = std::min(count, kMax);
    std::vector<double> distances;
    for (std::size_t k = 0; k < n; ++k) distances.push_back(std::fabs(of(k * count / n)));
    std::ranges::nth_element(distances, distances.begin() + static_cast<std::ptrdiff_t>(n / 2));
    return distances[n / 2];
}

/// Rejects files in different units, because the figures alone do not show that cause.
void check_units(const Both& both, std::size_t points, const Box3d& mesh, const Box3d& cloud,
                 const Context& ctx) {
    constexpr double kHardly = 0.05, kAbout = 0.15;  // share of the size, and tolerance in decimal logarithms
    const double ratio = cloud.size() / mesh.size(), power = std::round(std::log10(ratio));
    if (ratio == 0) return;  // the unit of points in one place is unknown
    if (!(std::fabs(power) >= 2) || std::fabs(std::log10(ratio) - power) > kAbout) return;
    ctx.throw_if_cancelled();
    if (median(points, [&](std::size_t i) { return both.to_surface(both.point(i)); }) <=
        kHardly * cloud.size())
        return;
    ctx.throw_if_cancelled();
    if (median(both.sample_count(), [&](std::size_t i) { return both.to_cloud(both.sample(i)); }) <=
        kHardly * mesh.size())
        return;
    throw InvalidInput(
        fmt::format("check: the cloud is about {:g} times as large as the mesh and hardly overlaps it; make "
                    "sure that both are in the same unit",
                    std::pow(10, power)));
}

bool has_inside(const PolygonMesh& mesh, const Context& ctx) {
    return topology(mesh, ctx).watertight() && shape(mesh, ctx).signed_volume > 0;
}

}  // namespace

CloudDistances cloud_distances(const PolygonMesh& mesh, const PointSet& cloud, const Skeleton* skeleton,
                               const CloudDistanceOptions& options, const Context& ctx) {
    check_fields(options, "check: cloud");
    validate(mesh);
    if (cloud.empty()) throw InvalidInput("check: the cloud has no points");
    if (mesh.face_count() == 0) throw InvalidInput("check: the mesh has no faces to measure a cloud from");
    const Box3d mesh_box = world_box(bounds_of_faces(mesh), mesh.origin),
                cloud_box = world_box(bounds(cloud), cloud.origin);
    check_place(mesh_box, cloud_box);
    const auto wanted = static_cast<std::size_t>(options.samples);
    const std::size_t samples = wanted > 0 ? wanted : std::clamp(cloud.size(), kMinSamples, kMaxSamples);
    const Both both(mesh, cloud, samples, ctx);
    check_units(both, cloud.size(), mesh_box, cloud_box, ctx);
    ctx.report(0.1f);

    CloudDistances out;
    CloudDistanceReport& report = out.report;
    report.closed = has_inside(mesh, ctx);
    report.support = options.support > 0 ? double{options.support} : kSpacings * median_spacing(cloud, ctx);
    std::optional<Surroundings> about;
    if (skeleton != nullptr) {
        about.emplace(*skeleton, mesh.origin, double{options.fork_reach}, ctx);
        report.forks = about->fork_count();
    }
    const Surroundings* surroundings = about ? &*about : nullptr;
    Found points(cloud.size(), skeleton != nullptr), surface(both.sample_count(), skeleton != nullptr);
    for_blocks(ctx, cloud.size(), 0.15f, 0.7f, [&](std::size_t i) {
        const Vec3d p = both.point(i);
        points.note(i, p, both.to_surface(p), surroundings);
    });
    for_blocks(ctx, both.sample_count(), 0.7f, 0.95f, [&](std::size_t i) {
        const Vec3d p = both.sample(i);
        surface.note(i, p, both.to_cloud(p), surroundings);
    });
    report.whole = summary(points, surface, report, [](const Found&, std::size_t) { return true; });
    ctx.throw_if_cancelled();
    if (skeleton != nullptr) {
        report.at_forks = summary(points, surface, report,
                                  [](const Found& found, std::size_t i) { return found.at_fork[i] != 0; });
    }
    out.of_points = std::move(points.distance);
    ctx.report(1);
    return out;
}

void list_fields(CloudDistanceOptions& o, FieldList& list) {
    list.add(Field{"samples",
                   "Number of sample points on the surface that are compared with the cloud; 0 "
                   "uses the number of points of the cloud, limited to 10,000 to 1,000,000.",
                   Unit::none, 0, 1e8},
             o.samples);
    list.add(Field{"support",
                   "Distance to the nearest point beyond which the surface is bare; 0 uses three times the "
                   "median spacing of the cloud.",
                   Unit::metre, 0, 1e6},
             o.support);
    list.add(Field{"fork_reach", "Distance from the node of a fork within which points belong to the fork.",
                   Unit::radius, 0.1, 100},
             o.fork_reach);
}

}  // namespace coppice
