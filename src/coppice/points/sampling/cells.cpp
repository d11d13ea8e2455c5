#include <fmt/format.h>

#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/points/sampling/cells_internal.h"

namespace coppice::points_internal {
namespace {

/// Field samples at N + 1 lattice points along each axis: the corners of N^3 cubes.
template <std::uint32_t N>
struct Lattice {
    static constexpr std::uint32_t kLine = N + 1, kPoints = kLine * kLine * kLine, kCubes = N * N * N;
    std::array<Vec3, kPoints> points;
    std::array<FieldSample, kPoints> samples;
    std::array<float, kPoints> value, gx, gy, gz;

    void evaluate(const PointRegion& region, Vec3d low, double edge) {
        std::size_t n = 0;
        for (std::uint32_t z = 0; z < kLine; ++z) {
            for (std::uint32_t y = 0; y < kLine; ++y) {
                for (std::uint32_t x = 0; x < kLine; ++x) points[n++] = Vec3(low + edge * Vec3d(x, y, z));
            }
        }
        region.field.sample(0, points, samples);
        const auto half = static_cast<float>(0.5 * edge);
        for (std::uint32_t i = 0; i < kPoints; ++i) {
            value[i] = samples[i].value;
            gx[i] = samples[i].gradient.x * half;
            gy[i] = samples[i].gradient.y * half;
            gz[i] = samples[i].gradient.z * half;
        }
    }

    /// Bounds the values in the cubes of a row along x from their corners: each corner represents its eighth,
    /// to second order, with the second derivatives estimated from the change of the gradient over the cube.
    void ranges(std::uint32_t y, std::uint32_t z, std::array<float, N>& low,
                std::array<float, N>& high) const {
        constexpr float kFar = std::numeric_limits<float>::max();
        std::array<float, N> not_finite{}, change{};
        low.fill(kFar);
        high.fill(-kFar);
        for (unsigned k = 0; k < 8; ++k) {
            const std::uint32_t first = (k & 1) + kLine * (y + (k >> 1 & 1) + kLine * (z + (k >> 2)));
            const float sx = k & 1 ? -1 : 1, sy = k & 2 ? -1 : 1, sz = k & 4 ? -1 : 1;
            for (std::uint32_t x = 0; x < N; ++x) {
                const std::uint32_t i = first + x;
                const float dx = sx * gx[i], dy = sy * gy[i], dz = sz * gz[i];
                const float up = value[i] + (std::max(0.0f, dx) + std::max(0.0f, dy) + std::max(0.0f, dz));
                const float down = value[i] + (std::min(0.0f, dx) + std::min(0.0f, dy) + std::min(0.0f, dz));
                not_finite[x] += 0 * up + 0 * down;
                low[x] = std::min(low[x], down);
                high[x] = std::max(high[x], up);
            }
        }
        for (const auto* g : {&gx, &gy, &gz}) add_change(*g, y, z, change);
        constexpr float kAny = std::numeric_limits<float>::infinity();
        for (std::uint32_t x = 0; x < N; ++x) {
            const bool known = not_finite[x] == 0;
            low[x] = known ? low[x] - 0.5f * change[x] : -kAny;
            high[x] = known ? high[x] + 0.5f * change[x] : kAny;
        }
    }

    /// Returns bounds on the density in every cube, x first: 0 without density, negative if the density is
    /// constant.
    void bounds(const DensityCurve& curve, std::array<float, kCubes>& out) const {
        std::array<float, N> low, high;
        for (std::uint32_t row = 0; row < N * N; ++row) {
            ranges(row % N, row / N, low, high);
            for (std::uint32_t x = 0; x < N; ++x) {
                const DensityCurve::Range range = curve.over(low[x], high[x]);
                const auto bound = static_cast<float>(range.largest);
                out[N * row + x] = range.least == range.largest ? -bound : bound;
            }
        }
    }

  private:
    /// Adds the difference of a component of the gradient between the corners of each cube in a row.
    static void add_change(const std::array<float, kPoints>& g, std::uint32_t y, std::uint32_t z,
                           std::array<float, N>& change) {
        std::array<float, kLine> least, most;
        const float* const r0 = &g[kLine * (y + kLine * z)];
        const float* const r1 = r0 + kLine;
        const float* const r2 = r0 + kLine * kLine;
        const float* const r3 = r2 + kLine;
        for (std::uint32_t x = 0; x < kLine; ++x) {
            least[x] = std::min(std::min(r0[x], r1[x]), std::min(r2[x], r3[x]));
            most[x] = std::max(std::max(r0[x], r1[x]), std::max(r2[x], r3[x]));
        }
        for (std::uint32_t x = 0; x < N; ++x)
            change[x] += std::max(most[x], most[x + 1]) - std::min(least[x], least[x + 1]);
    }
};

bool is_beyond(Vec3d low, const Box3& box) {
    return low.x > box.high.x || low.y > box.high.y || low.z > box.high.z;
}

Cell make_cell(std::uint32_t voxel, std::uint32_t part, float bound, float factor) {
    return {voxel, bound < 0 ? part | Cell::kFlat : part, std::abs(bound), factor};
}

}  // namespace

Voxels Voxels::over(const Box3& box, double wanted, double min_edge) {
    const Vec3d size(box.size());
    const double longest = std::max({size.x, size.y, size.z});
    // A flat box has fewer voxels across, but at least one.
    double edge = std::cbrt(size.x * size.y * size.z / wanted);
    edge = std::max({edge, min_edge, longest / 4096});
    Voxels v;
    v.low = Vec3d(box.low);
    do {
        v.edge = edge;
        for (int axis = 0; axis < 3; ++axis) {
            const double n = std::ceil(size[axis] / edge / kSide);
            v.blocks[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(std::max(1.0, n));
        }
        edge *= 1.25;
    } while (v.count() > std::uint64_t{1} << 31);
    return v;
}

std::array<std::uint32_t, 2> Voxels::range(int axis, double center, double radius) const {
    const double side = kSide * blocks[static_cast<std::size_t>(axis)];
    const double a = std::floor((center - radius - low[axis]) / edge);
    const double b = std::floor((center + radius - low[axis]) / edge) + 1;
    return {static_cast<std::uint32_t>(std::clamp(a, 0.0, side)),
            static_cast<std::uint32_t>(std::clamp(b, 0.0, side))};
}

Cells::Cells(const PointRegion& region, const Voxels& voxels, const Context& ctx)
    : voxels_(voxels), edge_(voxels.edge) {
    const auto count = static_cast<std::size_t>(voxels.count());
    Buffer<float> bound(count);
    first_.resize(count + 1);
    parallel_for(ctx, count / Voxels::kBlock, 4, [&](std::size_t block) {
        const auto begin = static_cast<std::uint32_t>(block * Voxels::kBlock);
        Lattice<Voxels::kSide> lattice;
        std::array<float, Voxels::kBlock> bounds;
        lattice.evaluate(region, voxels.corner(begin), voxels.edge);
        lattice.bounds(region.density, bounds);
        for (std::uint32_t i = 0; i < Voxels::kBlock; ++i) {
            // The last blocks extend beyond the box.
            const bool empty = is_beyond(voxels.corner(begin + i), region.box);
            bound[begin + i] = empty ? 0 : bounds[i];
            first_[begin + i] = bound[begin + i] != 0;
        }
    });
    first_[count] = 0;
    const std::uint32_t active = exclusive_scan(std::span<std::uint32_t>(first_));
    cells_.resize(active);
    parallel_for(ctx, count, std::size_t{1} << 14, [&](std::size_t v) {
        if (bound[v] != 0) cells_[first_[v]] = make_cell(static_cast<std::uint32_t>(v), 0, bound[v], 1);
    });
}

void Cells::subdivide(const PointRegion& region, const Losses& losses, const Context& ctx) {
    COPPICE_ASSERT(level_ < Cell::kDeepest);
    const double half = edge_ / 2;
    Buffer<std::array<float, 8>> bound(cells_.size());
    Buffer<std::uint32_t> first(cells_.size());
    parallel_for(ctx, cells_.size(), 256, [&](std::size_t c) {
        const Cell& cell = cells_[c];
        const bool flat = (cell.part & Cell::kFlat) != 0;
        const unsigned lost = cell.factor > 0 ? losses(cell) : 255;
        Lattice<2> lattice;
        std::array<float, 8> bounds;
        bounds.fill(-cell.bound);
        if (lost != 255 && !flat) {
            lattice.evaluate(region, low(cell), half);
            lattice.bounds(region.density, bounds);
        }
        first[c] = 0;
        for (unsigned k = 0; k < 8; ++k) {
            float& b = bound[c][k] = 0;
            const Vec3d corner = low(cell) + half * Vec3d(k & 1, k >> 1 & 1, k >> 2);
            if ((lost >> k & 1) != 0 || is_beyond(corner, region.box)) continue;
            b = bounds[k];
            first[c] += b != 0;
        }
    });
    const std::uint32_t count = exclusive_scan(std::span<std::uint32_t>(first));
    Buffer<Cell> parts(count);
    parallel_for(ctx, cells_.size(), 1024, [&](std::size_t c) {
        std::uint32_t next = first[c];
        const std::uint32_t part = (cells_[c].part & ~Cell::kFlat) << 1;
        for (unsigned k = 0; k < 8; ++k) {
            if (bound[c][k] == 0) continue;
            const std::uint32_t place = part | (k & 1) | (k >> 1 & 1) << 10 | (k >> 2) << 20;
            parts[next++] = make_cell(cells_[c].voxel, place, bound[c][k], cells_[c].factor);
        }
    });
    cells_ = std::move(parts);
    edge_ = half;
    ++level_;
    number_voxels();
}

void Cells::number_voxels() {
    std::fill(first_.begin(), first_.end(), 0u);
    for (const Cell& cell : cells_) ++first_[cell.voxel];
    exclusive_scan(std::span<std::uint32_t>(first_));
}

CellSums::CellSums(const Cells& cells) : sum_(cells.size()) {
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
        sum_[i] = total_;
        total_ += cells[i].bound;
    }
}

std::uint32_t CellSums::find(double share) const {
    const auto above = std::upper_bound(sum_.begin(), sum_.end(), share * total_);
    return static_cast<std::uint32_t>(above - sum_.begin()) - 1;
}

Capacity measure_capacity(const PointRegion& region, const Cells& cells, std::uint64_t seed,
                          const Context& ctx, std::uint32_t samples) {
    constexpr std::uint32_t kBatch = 256;
    samples = (samples + kBatch - 1) / kBatch * kBatch;
    const double count = samples;
    constexpr std::uint64_t kStage = 0x726f6f6d;
    Capacity capacity;
    if (cells.size() == 0) return capacity;
    const CounterRandom random(seed, kStage);
    double hits = 0, density = 0, steepness = 0;
    std::array<Vec3, kBatch> points;
    std::array<FieldSample, kBatch> fields;
    // Cells in order: a batch consists of neighbours, which fields evaluate fast.
    for (std::uint32_t begin = 0; begin < samples; begin += kBatch) {
        ctx.throw_if_cancelled();
        for (std::uint32_t k = 0; k < kBatch; ++k) {
            const std::uint64_t i = begin + k;
            const double share = (static_cast<double>(i) + random.uniform(4 * i)) / count;
            const Cell& cell = cells[static_cast<std::uint32_t>(share * cells.size())];
            const Vec3d in(random.uniform(4 * i + 1), random.uniform(4 * i + 2), random.uniform(4 * i + 3));
            points[k] = Vec3(cells.low(cell) + cells.edge() * in);
        }
        region.field.sample(0, points, fields);
        for (std::uint32_t k = 0; k < kBatch; ++k) {
            const double d = region.contains(points[k]) ? region.density.at(fields[k].value) : 0;
            if (!(d > 0)) continue;
            ++hits;
            capacity.met.push_back({fields[k].value, d});
            density += d;
            capacity.largest = std::max(capacity.largest, d);
            const double slope = length(Vec3d(fields[k].gradient));
            if (std::isfinite(slope)) steepness += slope;
        }
    }
    const double whole = cells.size() * cells.edge() * cells.edge() * cells.edge();
    capacity.volume = whole * hits / count;
    if (hits > 0) capacity.mass = whole * density / capacity.largest / count;
    if (steepness > 0) capacity.thickness = region.density.shell_width() * hits / steepness;
    return capacity;
}

double Capacity::packing_distance(double count) const {
    // Balls of diameter d about the points: count * pi/6 d^3 = 0.384 * (volume + 0.95 d * area), where the
    // second term yields a share of 0.547 for disks on a thin shell. Solved by an increasing fixed-point
    // iteration.
    constexpr double kBalls = 0.384 * 6 * std::numbers::inv_pi, kRim = 0.95;
    const double area = thickness > 0 ? volume / thickness : 0;
    double d = std::cbrt(kBalls * volume / count);
    for (int i = 0; i < 64; ++i) d = std::cbrt(kBalls * (volume + kRim * d * area) / count);
    return d;
}

void refuse_empty_region() {
    throw InvalidInput(
        "points: the density is 0 in the whole box at the resolution of its grid; check the box and the "
        "width, or increase the resolution");
}

void check_box(const Box3& box) {
    const Vec3 size = box.size();
    const float least = std::min({size.x, size.y, size.z}), longest = std::max({size.x, size.y, size.z});
    if (!is_finite(box.low) || !is_finite(box.high) || !(least > 0)) {
        throw InvalidInput("points: the box to fill must be finite and have a volume");
    }
    const float reach = std::max(length(box.low), length(box.high));
    if (!(reach < 1e12f) || !(longest > 1e-12f) || longest < 1e-4f * reach) {
        throw InvalidInput(
            fmt::format("points: the box to fill is {} m long and up to {} m from the origin; move it closer "
                        "to the origin or scale it",
                        longest, reach));
    }
}

void check_memory(double bytes, double limit_mib) {
    constexpr double kMebi = 1 << 20;
    if (bytes <= limit_mib * kMebi) return;
    throw InvalidInput(fmt::format(
        "points: this needs about {:.0f} MiB, but max_memory is {:.0f} MiB; lower count or resolution",
        std::ceil(bytes / kMebi), limit_mib));
}

}  // namespace coppice::points_internal
