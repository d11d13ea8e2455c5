#include <fmt/format.h>

#include <limits>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/extract/cloud/clean_cloud_internal.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/points/clean_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kMinPoints = 20;

/// Removes points of the ground; returns the terrain if it was searched and found.
Terrain erase_ground(Buffer<Vec3>& points, Vec3d origin, const CloudOptions& options, const Context& ctx) {
    if (options.ground == GroundRule::height) {
        const double height = double{options.ground_height} - origin.z;
        std::erase_if(points, [&](Vec3 p) { return p.z < height; });
    }
    if (options.ground != GroundRule::automatic) return {};
    Terrain terrain = find_terrain(points, ctx);
    if (!terrain.is_ground) return {};
    std::erase_if(points, [&](Vec3 p) { return p.z < terrain.height(p.x, p.y) + terrain.clearance; });
    return terrain;
}

}  // namespace

void check_point_count(std::size_t count, std::string_view subject) {
    if (count >= kMinPoints) return;
    throw InvalidInput(fmt::format("extract: {} points are left {}, but a skeleton needs at least {}", count,
                                   subject, kMinPoints));
}

CleanCloud clean_cloud(const PointSet& set, const CloudOptions& options, CloudReport& report,
                       const Context& ctx) {
    report.points = set.size();
    check_point_count(set.size(), "in the cloud");
    if (set.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
        throw InvalidInput(
            fmt::format("extract: {} points are too many; downsample the cloud to 2^31 first", set.size()));
    }
    CleanCloud out{sorted_without_duplicates(set.positions, ctx), {}, {}};
    Buffer<Vec3>& points = out.points;
    out.frame = find_cloud_frame(points);
    points = sorted_without_duplicates(enter_frame(out.frame, points, ctx), ctx);
    report.duplicates = set.size() - points.size();
    ctx.throw_if_cancelled();
    const std::size_t whole = points.size();
    if (options.voxel > 0) points = voxel_downsample(points, options.voxel, ctx);
    points = downsample_to(std::move(points), static_cast<std::size_t>(options.max_points), ctx);
    report.downsampled = whole - points.size();
    const std::size_t before = points.size();
    out.terrain = erase_ground(points, set.origin, options, ctx);
    report.ground = before - points.size();
    check_point_count(points.size(), "after cleaning");
    return out;
}

}  // namespace coppice::extract_internal
