#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/implicit/polygonize/block_lattice_internal.h"

namespace coppice {

ValueFunction to_value_function(FieldRef field, std::uint32_t region) {
    return [field, region](std::span<const Vec3> points, std::span<float> out) {
        std::vector<FieldSample> samples(points.size());
        field.sample(region, points, samples);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = samples[i].value;
    };
}

Box3 BlockLattice::box(std::size_t block) const {
    const auto [x, y, z] = place(block);
    return {node(kCells * x, kCells * y, kCells * z),
            node(kCells * (x + 1), kCells * (y + 1), kCells * (z + 1))};
}

std::array<std::array<std::uint32_t, 3>, 2> BlockLattice::blocks_touching(const Box3& box) const {
    constexpr double kRoundingMargin = 1e-3;  // [cells] greater than the rounding of a node
    std::array<std::array<std::uint32_t, 3>, 2> range{};
    if (box.empty()) return range;
    for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        const auto place = [&](double x, double hair) {
            const double cells = (x - origin[axis]) / cell + hair;
            return std::clamp(std::floor(cells / kCells), -1.0, double(blocks[i]));
        };
        range[0][i] = static_cast<std::uint32_t>(std::max(place(box.low[axis], -kRoundingMargin), 0.0));
        range[1][i] = static_cast<std::uint32_t>(
            std::min(place(box.high[axis], kRoundingMargin) + 1, static_cast<double>(blocks[i])));
    }
    return range;
}

void BlockLattice::find_nodes(std::size_t block, std::span<Vec3> out) const {
    const auto [bx, by, bz] = place(block);
    std::size_t i = 0;
    for (std::uint32_t z = 0; z < kNodes; ++z) {
        for (std::uint32_t y = 0; y < kNodes; ++y) {
            for (std::uint32_t x = 0; x < kNodes; ++x) {
                out[i++] = node(kCells * bx + x, kCells * by + y, kCells * bz + z);
            }
        }
    }
}

BlockLattice cover(const Box3& box, float cell, std::string_view subject, std::size_t max_blocks) {
    if (box.empty()) return {{}, 1, {0, 0, 0}};
    if (!is_finite(box.low) || !is_finite(box.high)) {
        throw InvalidInput(fmt::format("{}: the box must be finite", subject));
    }
    const Vec3d low(box.low), size = Vec3d(box.high) - low;
    const double longest = std::max({size.x, size.y, size.z, 1e-6});
    if (!(cell == 0 || (cell > 0 && cell <= 1e9f))) {
        throw InvalidInput(
            fmt::format("{}: cell must be 0 or a length up to 1e9 m, but is {}", subject, cell));
    }
    BlockLattice lattice;
    lattice.cell = cell > 0 ? double(cell) : longest / 64;
    // One additional cell on every side, so that the surface never touches the sides.
    lattice.origin = low - Vec3d{1, 1, 1} * lattice.cell;
    double count = 1;
    std::array<double, 3> blocks;
    for (int i = 0; i < 3; ++i) {
        blocks[static_cast<std::size_t>(i)] = std::ceil((size[i] / lattice.cell + 2) / BlockLattice::kCells);
        count *= blocks[static_cast<std::size_t>(i)];
    }
    if (!(count <= static_cast<double>(max_blocks))) {
        throw InvalidInput(
            fmt::format("{}: cells of {} m would make {:.3g} cells, but the maximum is {:.3g}; set cell to "
                        "at least {:.3g} m",
                        subject, lattice.cell, 512 * count, 512 * double(max_blocks),
                        longest / (6 * std::cbrt(double(max_blocks)))));
    }
    for (std::size_t i = 0; i < 3; ++i) lattice.blocks[i] = static_cast<std::uint32_t>(blocks[i]);
    return lattice;
}

std::vector<ValueRange> block_ranges(const BlockLattice& lattice, const SolidField& field,
                                     const Context& ctx) {
    std::vector<ValueRange> out(lattice.block_count());
    parallel_for_ranges(ctx, out.size(), 64, [&](IndexRange r) {
        std::array<Box3, 64> boxes;
        for (std::size_t i = r.begin; i < r.end; ++i) boxes[i - r.begin] = lattice.box(i);
        field.ranges(std::span(boxes).first(r.size()), std::span(out).subspan(r.begin, r.size()));
    });
    return out;
}

}  // namespace coppice
