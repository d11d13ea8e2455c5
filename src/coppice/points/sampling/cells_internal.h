#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/points/point_region.h"

namespace coppice::points_internal {

/// Cubic voxels over a box, numbered in blocks of 8 x 8 x 8, so that neighbours in space are close in memory
/// and a block is one batch of the field.
struct Voxels {
    static constexpr std::uint32_t kSide = 8, kBlock = kSide * kSide * kSide;

    bool operator==(const Voxels&) const = default;

    Vec3d low;
    double edge = 1;                        ///< [m]
    std::array<std::uint32_t, 3> blocks{};  ///< number of blocks along each axis

    /// Creates voxels over `box`: about `wanted`, fewer if `min_edge` requires it, at most 2^31.
    static Voxels over(const Box3& box, double wanted, double min_edge);
    static double bytes_per_voxel() { return 8; }

    std::uint64_t count() const { return std::uint64_t{kBlock} * blocks[0] * blocks[1] * blocks[2]; }
    std::uint32_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
        const std::uint32_t block = x / kSide + blocks[0] * (y / kSide + blocks[1] * (z / kSide));
        return block * kBlock + x % kSide + kSide * (y % kSide + kSide * (z % kSide));
    }
    std::array<std::uint32_t, 3> place(std::uint32_t index) const {
        const std::uint32_t block = index / kBlock, in = index % kBlock;
        const std::uint32_t bx = block % blocks[0], rest = block / blocks[0];
        return {bx * kSide + in % kSide, rest % blocks[1] * kSide + in / kSide % kSide,
                rest / blocks[1] * kSide + in / (kSide * kSide)};
    }
    Vec3d corner(std::uint32_t index) const {
        const auto [x, y, z] = place(index);
        return low + edge * Vec3d(x, y, z);
    }
    /// Returns the range of voxels along one axis that overlap the box of a ball.
    std::array<std::uint32_t, 2> range(int axis, double center, double radius) const;
};

/// Cube of a voxel: all cubes have the same size, a voxel divided into 8^level.
struct Cell {
    static constexpr unsigned kDeepest = 10;
    static constexpr std::uint32_t kFlat = 1u << 31;  ///< in `part`: the density is `bound` in the whole cell

    std::uint32_t voxel;
    std::uint32_t part;  ///< position in the voxel, 10 bits for each axis
    float bound;   ///< upper bound of the density in the cell; valid if the field is smooth at this scale
    float factor;  ///< product of the kernels of placed points at the centre
};

/// Cells with a possible density above 0, sorted by voxel.
class Cells {
  public:
    Cells(const PointRegion& region, const Voxels& voxels, const Context& ctx);

    const Voxels& voxels() const { return voxels_; }
    unsigned level() const { return level_; }
    double edge() const { return edge_; }
    std::uint32_t size() const { return static_cast<std::uint32_t>(cells_.size()); }
    Cell& operator[](std::uint32_t i) { return cells_[i]; }
    const Cell& operator[](std::uint32_t i) const { return cells_[i]; }
    Vec3d low(const Cell& cell) const { return voxels_.corner(cell.voxel) + edge_ * part(cell.part); }
    /// Returns the range of cells of a voxel: [first, second).
    std::array<std::uint32_t, 2> of(std::uint32_t voxel) const { return {first_[voxel], first_[voxel + 1]}; }

    /// Returns the parts of a cell to remove: bit k for the part on side k & 1, k & 2, k & 4 of the axes.
    using Losses = std::function<unsigned(const Cell&)>;
    /// Divides each cell into eight and keeps the parts with a possible density above 0 that `losses`, which
    /// must be thread-safe, does not select. Cells of factor 0 are removed.
    void subdivide(const PointRegion& region, const Losses& losses, const Context& ctx);
    /// Returns the maximum additional memory of `subdivide`.
    double subdivide_bytes() const { return 8.0 * size() * (sizeof(Cell) + sizeof(float)); }

  private:
    static Vec3d part(std::uint32_t p) { return Vec3d(p & 1023, p >> 10 & 1023, p >> 20 & 1023); }
    void number_voxels();

    Voxels voxels_;
    unsigned level_ = 0;
    double edge_;
    Buffer<Cell> cells_;
    Buffer<std::uint32_t> first_;
};

/// Capacity of a region, estimated from a seeded sample of its cells.
struct Capacity {
    double volume = 0;     ///< [m^3] volume of the region with a density above 0
    double mass = 0;       ///< [m^3] integral of the density divided by its maximum
    double thickness = 0;  ///< [m] thickness of a shell; 0 if the region is not a shell
    double largest = 0;    ///< maximum sampled density
    /// Sample with a density above 0.
    struct Met {
        float value;     ///< value of the field
        double density;  ///< density at the sample
    };
    std::vector<Met> met;  ///< all samples

    /// Returns the distance at which `count` random Poisson disks fill the region: densest random packing of
    /// balls (share 0.384), and of disks (0.547) if the shell is thinner than the distance.
    double packing_distance(double count) const;
};
/// Estimates the capacity from about `samples` samples, in whole batches.
Capacity measure_capacity(const PointRegion& region, const Cells& cells, std::uint64_t seed,
                          const Context& ctx, std::uint32_t samples = 16384);

/// Throws InvalidInput for a region without density.
[[noreturn]] void refuse_empty_region();

/// Throws InvalidInput unless the box is finite, has a volume and floats can represent its points.
void check_box(const Box3& box);

/// Throws InvalidInput if `bytes` exceeds `limit_mib`.
void check_memory(double bytes, double limit_mib);

/// Cumulative sums of the bounds, for draws from cells that do not change.
class CellSums {
  public:
    explicit CellSums(const Cells& cells);
    double total() const { return total_; }
    std::uint32_t find(double share) const;

  private:
    Buffer<double> sum_;  ///< sum before each cell
    double total_ = 0;
};

}  // namespace coppice::points_internal
