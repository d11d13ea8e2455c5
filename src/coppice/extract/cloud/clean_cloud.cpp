#include <fmt/format.h>

#include <limits>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/extract/cloud/clean_cloud_internal.h"
#include "coppice/extract/points/clean_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kFewestPoints = 20;

std::uint64_t erase_ground(Buffer<Vec3>& points, Vec3d origin, const CloudOptions& options) {
    const std::size_t before = points.size();
    if (options.ground == GroundRule::height) {
        const double height = double{options.ground_height} - origin.z;
        std::erase_if(points, [&](Vec3 p) { return p.z < height; });
    } else if (options.ground == GroundRule::automatic) {
        const Ground ground = find_ground(points);
        if (ground.found) {
            std::erase_if(points, [&](Vec3 p) { return p.z < ground.height(p.x, p.y) + ground.clearance; });
        }
    }
    return before - points.size();
}

}  // namespace

void check_point_count(std::size_t count, std::string_view what) {
    if (count >= kFewestPoints) return;
    throw InvalidInput(fmt::format("extract: {} points are left {}, but a skeleton needs at least {}", count,
                                   what, kFewestPoints));
}

Buffer<Vec3> clean_cloud(const PointSet& set, const CloudOptions& options, CloudReport& report,
                         const Context& ctx) {
    report.points = set.size();
    check_point_count(set.size(), "in the cloud");
    if (set.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
        throw InvalidInput(
            fmt::format("extract: {} points are too many; downsample the cloud to 2^31 first", set.size()));
    }
    Buffer<Vec3> points = sorted_without_duplicates(set.positions, ctx);
    report.duplicates = set.size() - points.size();
    ctx.throw_if_cancelled();
    const std::size_t whole = points.size();
    if (options.voxel > 0) points = voxel_downsample(points, options.voxel, ctx);
    points = downsample_to(std::move(points), static_cast<std::size_t>(options.max_points), ctx);
    report.downsampled = whole - points.size();
    report.ground = erase_ground(points, set.origin, options);
    check_point_count(points.size(), "after cleaning");
    return points;
}

}  // namespace coppice::extract_internal
