#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/extract/points/clean_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr int kCells = 24;            // of the plan along its longer side
constexpr int kFewest = 12;           // cells that tell ground from the base of a stem
constexpr int kPasses = 12;           // of the robust fit
constexpr double kClearance = 0.02;   // of the height of the cloud, half of it below the surface
constexpr double kGroundShare = 0.6;  // of the cells whose lowest point must lie on the ground

struct Low {
    double x = 0, y = 0, z = 0;
};

/// The lowest point of every cell of the plan that holds points.
std::vector<Low> lowest_of_cells(std::span<const Vec3> points, const Box3& box, double edge) {
    const auto cells = [&](float size) { return static_cast<std::size_t>(double{size} / edge) + 1; };
    const std::size_t nx = cells(box.size().x), ny = cells(box.size().y);
    std::vector<std::uint32_t> lowest(nx * ny, static_cast<std::uint32_t>(points.size()));
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const auto x = std::min(static_cast<std::size_t>(double{points[i].x - box.low.x} / edge), nx - 1);
        const auto y = std::min(static_cast<std::size_t>(double{points[i].y - box.low.y} / edge), ny - 1);
        std::uint32_t& low = lowest[x + nx * y];
        if (low == points.size() || points[i].z < points[low].z) low = i;
    }
    std::vector<Low> found;
    for (const std::uint32_t i : lowest) {
        if (i < points.size()) found.push_back({points[i].x, points[i].y, points[i].z});
    }
    return found;
}

/// Least squares in which what lies above the surface hardly counts: below it there is nothing but noise.
void fit(Ground& ground, std::span<const Low> cells, double tolerance) {
    for (int pass = 0; pass < kPasses; ++pass) {
        Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Identity() * 1e-9;
        Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
        for (const Low& p : cells) {
            const double u = (p.x - ground.x0) / ground.scale, v = (p.y - ground.y0) / ground.scale;
            const double off = std::max(p.z - ground.height(p.x, p.y), 0.0) / tolerance;
            const double w = pass == 0 ? 1 : 1 / (1 + off * off * off * off);
            Eigen::Matrix<double, 6, 1> row;
            row << 1, u, v, u * u, u * v, v * v;
            a += w * row * row.transpose();
            b += w * p.z * row;
        }
        const Eigen::Matrix<double, 6, 1> c = a.ldlt().solve(b);
        for (int i = 0; i < 6; ++i) ground.c[i] = c[i];
    }
}

}  // namespace

Ground find_ground(std::span<const Vec3> points) {
    Ground ground;
    Box3 box;
    for (const Vec3 p : points) box.extend(p);
    const Vec3d size = Vec3d(box.high) - Vec3d(box.low);
    const double wide = std::max(size.x, size.y);
    if (!(wide > 0) || !(size.z > 0)) return ground;
    const std::vector<Low> cells = lowest_of_cells(points, box, wide / kCells);
    if (cells.size() < kFewest) return ground;
    ground.x0 = box.center().x;
    ground.y0 = box.center().y;
    ground.scale = 0.5 * wide;
    ground.clearance = kClearance * size.z;
    fit(ground, cells, ground.clearance);
    std::size_t near = 0;
    for (const Low& p : cells) near += std::abs(p.z - ground.height(p.x, p.y)) < 0.5 * ground.clearance;
    ground.share = static_cast<double>(near) / static_cast<double>(cells.size());
    // A wall or a canopy may be smooth too; the ground has the cloud above it.
    std::size_t above = 0;
    for (const Vec3 p : points) above += p.z > ground.height(p.x, p.y) + 0.25 * size.z;
    ground.found = ground.share >= kGroundShare && 20 * above > points.size();
    return ground;
}

}  // namespace coppice::extract_internal
