#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/points/clean_internal.h"
#include "coppice/extract/points/cloud_frame_internal.h"

namespace coppice::extract_internal {
namespace {

/// Returns the horizontal positions of the points that are not far from all others.
std::vector<Vec3d> exclude_far_points(std::span<const Vec3> points) {
    constexpr double kFar = 100;  // [median distance from the middle]
    std::vector<float> x, y;
    for (const Vec3 p : points) {
        x.push_back(p.x);
        y.push_back(p.y);
    }
    const double middle_x = median_in_place(x), middle_y = median_in_place(y);
    std::vector<double> off;
    for (const Vec3 p : points) off.push_back(std::hypot(p.x - middle_x, p.y - middle_y));
    const double reach = kFar * median(off);
    std::vector<Vec3d> near;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (off[i] <= reach) near.push_back({points[i].x, points[i].y, 0});
    return near;
}

constexpr std::size_t kPointGrain = 4096;

}  // namespace

CloudFrame find_cloud_frame(std::span<const Vec3> points) {
    auto near = exclude_far_points(points);
    Vec3d middle;
    for (const Vec3d p : near) middle += p / static_cast<double>(near.size());
    double xx = 0, xy = 0, yy = 0;
    for (Vec3d& p : near) {
        p -= middle;
        xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
    }
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const CloudFrame frame{middle.x, middle.y, std::cos(angle), std::sin(angle)};
    double skew = 0;
    for (const Vec3d p : near) {
        const double along = frame.cosine * p.x + frame.sine * p.y;
        skew += along * along * along;
    }
    return skew < 0 ? CloudFrame{frame.x, frame.y, -frame.cosine, -frame.sine} : frame;
}

Buffer<Vec3> enter_frame(const CloudFrame& frame, std::span<const Vec3> points, const Context& ctx) {
    Buffer<Vec3> out(points.size());
    parallel_for(ctx, points.size(), kPointGrain,
                 [&](std::size_t i) { out[i] = Vec3(frame.to_frame(Vec3d(points[i]))); });
    return out;
}

Buffer<Vec3> leave_frame(const CloudFrame& frame, std::span<const Vec3> points, std::span<const Vec3> cloud,
                         const Context& ctx) {
    Buffer<Vec3> out;
    for (const Vec3 p : points) out.emplace_back(frame.to_cloud(Vec3d(p)));
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, comes_before, [&](std::uint32_t i) { return points[i]; });
    const Buffer<Vec3> entered = enter_frame(frame, cloud, ctx);
    std::vector<std::uint32_t> place(cloud.size(), kNoIndex);
    parallel_for(ctx, cloud.size(), kPointGrain, [&](std::size_t i) {
        const auto at = std::ranges::lower_bound(order, entered[i], comes_before,
                                                 [&](std::uint32_t k) { return points[k]; });
        if (at != order.end() && points[*at] == entered[i]) place[i] = *at;
    });
    std::vector<std::uint8_t> is_found(points.size(), 0);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const std::uint32_t k = place[i];
        if (k == kNoIndex || (is_found[k] != 0 && !comes_before(cloud[i], out[k]))) continue;
        out[k] = cloud[i];  // of points that round to the same one, the first by position
        is_found[k] = 1;
    }
    return out;
}

}  // namespace coppice::extract_internal
