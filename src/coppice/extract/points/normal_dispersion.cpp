#include "coppice/extract/points/normal_dispersion_internal.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/clean_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kNormalDispersionGrain = 4096;
constexpr std::uint32_t kNormalNeighbours = 8;  // number of neighbours that determine a normal
constexpr std::uint32_t kSpacingRank = 4;       // rank of the neighbour that defines the spacing
constexpr int kPasses = 8;                      // number of averaging passes
constexpr float kHigh = 0.15f;                  // minimum dispersion of the points counted in the share

/// Symmetric matrix: xx, yy, zz, xy, xz, yz.
using Tensor = std::array<float, 6>;

Tensor normal_squared(std::span<const Vec3> points, const Neighbours& near, std::size_t i) {
    const std::uint32_t count = std::min(kNormalNeighbours, near.count);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const std::uint32_t j : near.of(i).first(count)) {
        const Vec3d d = Vec3d(points[j]) - Vec3d(points[i]);
        const Eigen::Vector3d v(d.x, d.y, d.z);
        mean += v;
        sum += v * v.transpose();
    }
    sum -= mean * mean.transpose() / (count + 1.0);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(sum);
    const Eigen::Vector3f n = solver.eigenvectors().col(0).cast<float>();
    return {n[0] * n[0], n[1] * n[1], n[2] * n[2], n[0] * n[1], n[0] * n[2], n[1] * n[2]};
}

float min_eigenvalue(const Tensor& t) {
    Eigen::Matrix3f m;
    m << t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2];
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(m, Eigen::EigenvaluesOnly);
    return std::max(solver.eigenvalues()[0], 0.0f);
}

void average(Buffer<Tensor>& tensor, Buffer<Tensor>& scratch, const Neighbours& near, const Context& ctx) {
    const std::uint32_t count = std::min(kDispersionNeighbours, near.count);
    parallel_for(ctx, tensor.size(), kNormalDispersionGrain, [&](std::size_t i) {
        Tensor sum = tensor[i];
        for (const std::uint32_t j : near.of(i).first(count)) {
            for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += tensor[j][k];
        }
        for (float& s : sum) s /= static_cast<float>(count + 1);
        scratch[i] = sum;
    });
    tensor.swap(scratch);
}

struct OtsuSplit {
    float threshold = 0;
    double low_mean = 0, high_mean = 0;  // means of the values on both sides
};

/// Returns the threshold that minimizes the variance within both classes of values in [0, 1/3] [Otsu1979].
OtsuSplit otsu_threshold(std::span<const float> values) {
    constexpr std::size_t kBins = 256;
    constexpr double kWidth = 1.0 / (3 * kBins);
    std::array<double, kBins> count{};
    for (const float v : values) ++count[std::min(static_cast<std::size_t>(v / kWidth), kBins - 1)];
    double sum = 0;
    for (std::size_t b = 0; b < kBins; ++b) sum += (static_cast<double>(b) + 0.5) * count[b];
    const auto all = static_cast<double>(values.size());
    double low_count = 0, low_sum = 0, best = -1;
    OtsuSplit split;
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
        low_count += count[b];
        low_sum += (static_cast<double>(b) + 0.5) * count[b];
        if (low_count == 0 || low_count == all) continue;
        const double low = low_sum / low_count, high = (sum - low_sum) / (all - low_count);
        const double between = low_count * (all - low_count) * (high - low) * (high - low);
        if (between <= best) continue;
        best = between;
        split = {static_cast<float>(kWidth * static_cast<double>(b + 1)), kWidth * low, kWidth * high};
    }
    return split;
}

/// Returns for each point the first point in its voxel.
Buffer<std::uint32_t> first_in_voxel(std::span<const Vec3> points, double edge, const Context& ctx) {
    const Buffer<MortonPlace> sorted = morton_order(points, edge, ctx);
    Buffer<std::uint32_t> first(points.size());
    for (std::size_t begin = 0, i = 0; i < sorted.size(); ++i) {
        if (sorted[i].key != sorted[begin].key) begin = i;
        first[sorted[i].index] = sorted[begin].index;
    }
    return first;
}

}  // namespace

NormalDispersion normal_dispersion(std::span<const Vec3> points, const Neighbours& near, const Context& ctx) {
    NormalDispersion out;
    const std::size_t count = points.size();
    Buffer<Tensor> tensor(count), scratch(count);
    parallel_for(ctx, count, kNormalDispersionGrain,
                 [&](std::size_t i) { tensor[i] = normal_squared(points, near, i); });
    for (int pass = 0; pass < kPasses; ++pass) {
        average(tensor, scratch, near, ctx);
    }
    out.value.resize(count);
    parallel_for(ctx, count, kNormalDispersionGrain,
                 [&](std::size_t i) { out.value[i] = min_eigenvalue(tensor[i]); });
    out.spacing = median(local_spacing(near, kSpacingRank));
    out.share = static_cast<double>(std::ranges::count_if(out.value, [](float v) { return v > kHigh; })) /
                static_cast<double>(count);
    const OtsuSplit split = otsu_threshold(out.value);
    out.threshold = split.threshold;
    out.low_mean = split.low_mean;
    out.high_mean = split.high_mean;
    return out;
}

VoxelGrid voxel_grid(std::span<const Vec3> points, double edge, const Context& ctx) {
    const Buffer<std::uint32_t> first = first_in_voxel(points, edge, ctx);
    VoxelGrid voxels;
    voxels.of_point.resize(points.size());
    std::vector<std::uint32_t> count;
    std::vector<Vec3d> sum;
    for (std::size_t i = 0; i < points.size(); ++i) {
        poll_stop(ctx, i);
        if (first[i] == i) {
            voxels.of_point[i] = static_cast<std::uint32_t>(sum.size());
            sum.emplace_back();
            count.push_back(0);
        }
        const std::uint32_t k = voxels.of_point[i] = voxels.of_point[first[i]];
        sum[k] += Vec3d(points[i]);
        ++count[k];
    }
    voxels.centroid.resize(sum.size());
    for (std::size_t k = 0; k < sum.size(); ++k)
        voxels.centroid[k] = Vec3(sum[k] / static_cast<double>(count[k]));
    return voxels;
}

}  // namespace coppice::extract_internal
