#include "coppice/extract/plot/terrain.h"

#include <Eigen/Dense>
#include <limits>

#include "coppice/base/box.h"
#include "coppice/base/median.h"
#include "coppice/base/progress.h"

namespace coppice {
namespace {

constexpr double kFineCell = 0.25;      // [m] edge of the cells of which the lowest point is used
constexpr double kFinest = 0.5;         // [m] edge of the cells of the last raster
constexpr std::size_t kMaxCells = 500;  // maximum number of cells along an axis
constexpr double kSlope = 0.15;         // maximum slope of a correction, in addition to kRough
constexpr double kRough = 0.06;         // [m]
constexpr double kLowShare = 0.15;      // share of the lowest points of a cell that may be outliers
constexpr double kTie = 0.7;  // weight of each neighbour of a cell; its own points have a weight of at most 1
constexpr int kRounds = 4, kSweeps = 40;
constexpr double kGroundShare = 0.5;
constexpr std::size_t kMinCells = 12;
constexpr double kMinRise = 0.5;  // [m] minimum height of the cloud above the ground

struct Low {
    double x, y, z;
    double off = 0;  // [m] height above the current surface
};

/// Returns the weight of a low `off` above a surface: points above it are not ground, points far below it are
/// outliers.
double compute_weight(double off, double tolerance) {
    const double t = off > 0 ? off / tolerance : off / (4 * tolerance);
    return 1 / (1 + t * t * t * t);
}

/// Returns the lowest point of every non-empty fine cell.
std::vector<Low> find_lows(std::span<const Vec3> points, const Box3& box, double edge, const Context& ctx) {
    const auto cells = [&](float size) { return static_cast<std::size_t>(double{size} / edge) + 1; };
    const std::size_t nx = cells(box.size().x), ny = cells(box.size().y);
    constexpr auto kEmpty = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> lowest(nx * ny, kEmpty);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        poll_stop(ctx, i);
        if (points[i].x < box.low.x || points[i].y < box.low.y) continue;
        const auto x = static_cast<std::size_t>(double{points[i].x - box.low.x} / edge);
        const auto y = static_cast<std::size_t>(double{points[i].y - box.low.y} / edge);
        if (x >= nx || y >= ny) continue;
        std::uint32_t& low = lowest[x + nx * y];
        if (low == kEmpty || points[i].z < points[low].z) low = i;
    }
    std::vector<Low> found;
    for (const std::uint32_t i : lowest) {
        if (i != kEmpty) found.push_back({points[i].x, points[i].y, points[i].z});
    }
    return found;
}

/// Returns the box of the points without a few outliers, which would make the cells coarse.
Box3 make_plan(std::span<const Vec3> points) {
    constexpr std::size_t kSample = 100'000;
    constexpr double kStrays = 0.0005, kRoom = 0.1;
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    if (points.size() < 1000) return box;
    const std::size_t step = (points.size() + kSample - 1) / kSample;
    for (const int axis : {0, 1}) {
        std::vector<float> values;
        for (std::size_t i = 0; i < points.size(); i += step) values.push_back(points[i][axis]);
        const auto out = static_cast<std::size_t>(kStrays * static_cast<double>(values.size())) + 1;
        std::ranges::sort(values);
        const float low = values[out], high = values[values.size() - 1 - out];
        const auto room = static_cast<float>(kRoom * double{high - low});
        box.low[axis] = std::max(box.low[axis], low - room);
        box.high[axis] = std::min(box.high[axis], high + room);
    }
    return box;
}

/// Raster over the box, with heights at the centres of its cells.
struct Raster {
    double x0, y0, cell;
    std::size_t columns, rows;
    std::vector<double> height;

    Raster(const Box3& box, double cell_)
        : x0(box.low.x + 0.5 * cell_),
          y0(box.low.y + 0.5 * cell_),
          cell(cell_),
          columns(static_cast<std::size_t>(double{box.size().x} / cell_) + 1),
          rows(static_cast<std::size_t>(double{box.size().y} / cell_) + 1),
          height(columns * rows, 0.0) {}
    std::size_t place(double x, double y) const {
        const double u = (x - x0) / cell + 0.5, v = (y - y0) / cell + 0.5;
        const auto i = std::min(static_cast<std::size_t>(std::max(u, 0.0)), columns - 1);
        const auto j = std::min(static_cast<std::size_t>(std::max(v, 0.0)), rows - 1);
        return i + columns * j;
    }
    Terrain terrain() const { return {x0, y0, cell, columns, height}; }
};

/// Fits a plane to the lowest points of coarse cells by least squares with decreasing weights of the points
/// above it.
Eigen::Vector3d plane_below(const std::vector<Low>& lows, Vec3d middle, double wide) {
    Eigen::Vector3d plane = Eigen::Vector3d::Zero();
    std::vector<double> heights;
    for (const Low& p : lows) heights.push_back(p.z);
    std::ranges::nth_element(heights, heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 20));
    const double least = heights[heights.size() / 20];
    plane(0) = least;
    double tolerance = 0.3 * wide;
    for (int pass = 0; pass < 24; ++pass) {
        Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-6;
        Eigen::Vector3d b = Eigen::Vector3d::Zero();
        b(0) = 1e-6 * least;
        for (const Low& p : lows) {
            const Eigen::Vector3d row(1, p.x - middle.x, p.y - middle.y);
            const double w = compute_weight(p.z - row.dot(plane), tolerance);
            a += w * row * row.transpose();
            b += w * p.z * row;
        }
        plane = a.ldlt().solve(b);
        tolerance = std::max(0.75 * tolerance, 0.02 * wide + kRough);
    }
    return plane;
}

/// Fits a plane above a hundredth of the lows, by absolute distances (quantile regression): without ground,
/// the bases of stems are the lowest points, and few.
Eigen::Vector3d plane_of_feet(const std::vector<Low>& lows, Vec3d middle) {
    constexpr double kBelow = 0.01, kSmooth = 0.02;  // [m]
    double least = lows.front().z;
    for (const Low& p : lows) least = std::min(least, p.z);
    Eigen::Vector3d plane(least, 0, 0);
    for (int pass = 0; pass < 100; ++pass) {
        Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-6;
        Eigen::Vector3d b = Eigen::Vector3d::Zero();
        b(0) = 1e-6 * least;
        for (const Low& p : lows) {
            const Eigen::Vector3d row(1, p.x - middle.x, p.y - middle.y);
            const double off = p.z - row.dot(plane);
            const double w = (off > 0 ? kBelow : 1 - kBelow) / (std::abs(off) + kSmooth);
            a += w * row * row.transpose();
            b += w * p.z * row;
        }
        plane = a.ldlt().solve(b);
    }
    return plane;
}

/// Returns the height of the surface above the previous one according to the lows of each cell; NaN without
/// lows.
std::vector<double> offs_of_cells(const std::vector<Low>& lows, const Raster& raster) {
    std::vector<std::pair<std::size_t, double>> of;
    of.reserve(lows.size());
    for (const Low& p : lows) of.emplace_back(raster.place(p.x, p.y), p.off);
    std::ranges::sort(of);
    std::vector<double> offs(raster.height.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t first = 0; first < of.size();) {
        std::size_t last = first;
        while (last < of.size() && of[last].first == of[first].first) ++last;
        const auto low = static_cast<std::size_t>(kLowShare * static_cast<double>(last - first - 1));
        offs[of[first].first] = of[first + low].second;
        first = last;
    }
    return offs;
}

/// Computes the correction of one raster: each cell is a weighted mean of the height of its lows and of its
/// neighbours.
void bend(Raster& raster, const std::vector<Low>& lows, const Context& ctx) {
    const std::vector<double> offs = offs_of_cells(lows, raster);
    const double tolerance = kSlope * raster.cell + kRough;
    std::vector<double>& u = raster.height;
    std::vector<double> weight(u.size(), 0.0);
    for (int round = 0; round < kRounds; ++round) {
        ctx.throw_if_cancelled();
        for (std::size_t i = 0; i < u.size(); ++i) {
            if (!std::isnan(offs[i])) weight[i] = compute_weight(offs[i] - u[i], tolerance);
        }
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            for (std::size_t j = 0; j < raster.rows; ++j) {
                for (std::size_t i = 0; i < raster.columns; ++i) {
                    const std::size_t at = i + raster.columns * j;
                    double sum = weight[at] > 0 ? weight[at] * offs[at] : 0, total = weight[at];
                    const auto tie = [&](std::size_t to) {
                        sum += kTie * u[to];
                        total += kTie;
                    };
                    if (i > 0) tie(at - 1);
                    if (i + 1 < raster.columns) tie(at + 1);
                    if (j > 0) tie(at - raster.columns);
                    if (j + 1 < raster.rows) tie(at + raster.columns);
                    if (total > 0) u[at] = sum / total;
                }
            }
        }
    }
}

/// Determines whether the terrain is ground, and its thickness.
void judge(Terrain& terrain, const std::vector<Low>& lows, double top) {
    std::vector<double> near;
    const double tolerance = kSlope * kFinest + kRough;
    for (const Low& p : lows) {
        const double off = std::abs(p.z - terrain.height(p.x, p.y));
        if (off < tolerance) near.push_back(off);
    }
    terrain.share = static_cast<double>(near.size()) / static_cast<double>(lows.size());
    terrain.is_ground = near.size() >= kMinCells && terrain.share >= kGroundShare && top >= kMinRise;
    if (!near.empty()) terrain.clearance = std::clamp(4 * median_in_place(near), 0.08, 0.25);
}

}  // namespace

Terrain find_terrain(std::span<const Vec3> points, const Context& ctx) {
    const Box3 box = make_plan(points);
    if (box.empty()) return {};
    const double wide = std::max({double{box.size().x}, double{box.size().y}, 1e-3});
    const double fine = std::max(kFineCell, wide / (2.0 * kMaxCells));
    std::vector<Low> lows = find_lows(points, box, fine, ctx);
    const Vec3d middle(box.center());
    const Eigen::Vector3d plane = plane_below(lows, middle, wide);
    const auto plane_at = [&](double x, double y) {
        return plane(0) + plane(1) * (x - middle.x) + plane(2) * (y - middle.y);
    };
    Raster last(box, 2 * fine);
    last.height.clear();
    for (std::size_t j = 0; j < last.rows; ++j) {
        for (std::size_t i = 0; i < last.columns; ++i) {
            last.height.push_back(plane_at(last.x0 + static_cast<double>(i) * last.cell,
                                           last.y0 + static_cast<double>(j) * last.cell));
        }
    }
    for (Low& p : lows) p.off = p.z - plane_at(p.x, p.y);
    for (double cell = wide / 3;; cell = std::max(0.5 * cell, last.cell)) {
        Raster raster(box, std::max(cell, last.cell));
        bend(raster, lows, ctx);
        const Terrain correction = raster.terrain();
        for (Low& p : lows) p.off -= correction.height(p.x, p.y);
        for (std::size_t j = 0, at = 0; j < last.rows; ++j) {
            for (std::size_t i = 0; i < last.columns; ++i, ++at) {
                last.height[at] += correction.height(last.x0 + static_cast<double>(i) * last.cell,
                                                     last.y0 + static_cast<double>(j) * last.cell);
            }
        }
        if (cell <= last.cell) break;
    }
    Terrain terrain = last.terrain();
    double top = -std::numeric_limits<double>::infinity();
    for (const Vec3 p : points) top = std::max(top, double{p.z} - terrain.height(p.x, p.y));
    judge(terrain, lows, top);
    if (terrain.is_ground) return terrain;
    const Eigen::Vector3d feet = plane_of_feet(lows, middle);
    const auto closest_point_at = [&](double x, double y) {
        return feet(0) + feet(1) * (x - middle.x) + feet(2) * (y - middle.y);
    };
    const double x0 = box.low.x, y0 = box.low.y, x1 = x0 + wide, y1 = y0 + wide;
    Terrain sloping(x0, y0, wide, 2,
                    {closest_point_at(x0, y0), closest_point_at(x1, y0), closest_point_at(x0, y1),
                     closest_point_at(x1, y1)});
    sloping.share = terrain.share;
    return sloping;
}

}  // namespace coppice
