#include "coppice/implicit/polygonize/cached_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"
#include "coppice/implicit/polygonize/block_lattice_internal.h"

namespace coppice {
namespace {

constexpr std::uint32_t kConstant = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMaxBlocks = 2000000;
constexpr float kRanged = 0.3f;  // progress after the search for blocks near the iso value
constexpr std::size_t kMaxStored = 500000;
constexpr std::size_t kNodes = BlockLattice::kNodes;
constexpr std::size_t kBlockNodes = BlockLattice::kBlockNodes;

/// The values at a cell's corners, and the relative position of a point in the cell, in [0, 1].
struct Corners {
    const float* first;
    float x, y, z;

    float at(std::size_t dx, std::size_t dy, std::size_t dz) const {
        return first[dx + kNodes * (dy + kNodes * dz)];
    }
    ValueRange range() const {
        ValueRange r{first[0], first[0]};
        for (std::size_t c = 1; c < 8; ++c) {
            const float v = at(c & 1, c >> 1 & 1, c >> 2);
            r = {std::min(r.low, v), std::max(r.high, v)};
        }
        return r;
    }
    /// Interpolates along x at one of the four edges.
    float along(std::size_t dy, std::size_t dz) const {
        return at(0, dy, dz) + x * (at(1, dy, dz) - at(0, dy, dz));
    }
    float value() const {
        const float low = along(0, 0) + y * (along(1, 0) - along(0, 0));
        const float high = along(0, 1) + y * (along(1, 1) - along(0, 1));
        return low + z * (high - low);
    }
    /// Returns the gradient per cell.
    Vec3 gradient() const {
        const auto slope = [&](std::size_t dy, std::size_t dz) { return at(1, dy, dz) - at(0, dy, dz); };
        const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
        const float low = mix(along(0, 0), along(1, 0), y), high = mix(along(0, 1), along(1, 1), y);
        return {mix(mix(slope(0, 0), slope(1, 0), y), mix(slope(0, 1), slope(1, 1), y), z),
                mix(along(1, 0) - along(0, 0), along(1, 1) - along(0, 1), z), high - low};
    }
};

/// Returns the range of a field in every block, from the values at the corners of cells.
std::vector<ValueRange> sampled_ranges(const BlockLattice& lattice, const ValueFunction& field,
                                       const Context& ctx) {
    std::vector<ValueRange> out(lattice.block_count());
    parallel_with_progress(narrow_progress(ctx, 0, kRanged), out.size(), 1, [&](IndexRange range) {
        const std::size_t b = range.begin;
        std::array<Vec3, kBlockNodes> nodes;
        std::array<float, kBlockNodes> values;
        lattice.find_nodes(b, nodes);
        field(nodes, values);
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        out[b] = {*low, *high};
    });
    return out;
}

}  // namespace

struct CachedField::Place {
    std::size_t block;
    Corners corners;  ///< first is null if the value is constant
};

struct CachedField::Builder {
    CachedField& out;
    const BlockLattice& lattice;
    const ValueFunction& field;
    const Context& ctx;

    void build(std::span<const ValueRange> ranges, float band) {
        choose(ranges, band);
        out.values_.resize(out.boxes_.size() * kBlockNodes);
        std::vector<std::size_t> blocks;
        for (std::size_t b = 0; b < ranges.size(); ++b) {
            if (out.stored_[b] != kConstant) blocks.push_back(b);
        }
        std::vector<float> error(blocks.size());
        parallel_with_progress(narrow_progress(ctx, kRanged, 1), blocks.size(), 1,
                               [&](IndexRange r) { error[r.begin] = fill(r.begin, blocks[r.begin]); });
        for (const float e : error) out.error_ = std::max(out.error_, e);
    }

    void choose(std::span<const ValueRange> ranges, float band) {
        out.cell_ = static_cast<float>(lattice.cell);
        out.origin_ = lattice.origin;
        out.per_cell_ = 1 / lattice.cell;
        out.blocks_x_ = lattice.blocks[0];
        out.blocks_y_ = lattice.blocks[1];
        out.blocks_z_ = lattice.blocks[2];
        out.stored_.assign(ranges.size(), kConstant);
        out.constant_.resize(ranges.size());
        for (std::size_t b = 0; b < ranges.size(); ++b) {
            const auto [low, high] = ranges[b];
            out.constant_[b] = 0.5f * (low + high);
            if (high < out.level_ - band || low > out.level_ + band) continue;
            out.stored_[b] = static_cast<std::uint32_t>(out.boxes_.size());
            out.boxes_.push_back(lattice.box(b));
        }
        if (out.boxes_.size() > kMaxStored) {
            throw InvalidInput(
                fmt::format("cache: {} blocks of 512 cells are near the surface, but the maximum is {}; "
                            "increase cell above {} m or reduce band",
                            out.boxes_.size(), kMaxStored, lattice.cell));
        }
    }

    /// Stores the values at the corners; returns the maximum difference at the centres of some cells.
    float fill(std::size_t i, std::size_t block) const {
        const std::span values = std::span(out.values_).subspan(i * kBlockNodes, kBlockNodes);
        std::array<Vec3, kBlockNodes> nodes;
        lattice.find_nodes(block, nodes);
        field(nodes, values);

        std::array<Vec3, 64> centers;
        std::array<float, 64> exact;
        std::array<float, 64> interpolated;
        for (std::size_t c = 0; c < 64; ++c) {
            const std::size_t x = 2 * (c % 4), y = 2 * (c / 4 % 4), z = 2 * (c / 16) + (x + y) / 2 % 2;
            const std::size_t first = x + kNodes * (y + kNodes * z);
            centers[c] = 0.5f * (nodes[first] + nodes[first + 1 + kNodes + kNodes * kNodes]);
            interpolated[c] = Corners{&values[first], 0.5f, 0.5f, 0.5f}.value();
        }
        field(centers, exact);
        float error = 0;
        for (std::size_t c = 0; c < 64; ++c) error = std::max(error, std::abs(exact[c] - interpolated[c]));
        return error;
    }
};

CachedField::CachedField(const SolidField& field, const CacheOptions& options, const Context& ctx)
    : level_(field.level()) {
    check_fields(options, "cache");
    const Box3 box = field.bounds_at(std::max(level_ - options.band, 0.0f));
    const BlockLattice lattice = cover(box, options.cell, "cache", kMaxBlocks);
    const ValueFunction values = [&](std::span<const Vec3> p, std::span<float> out) { field.values(p, out); };
    Builder{*this, lattice, values, ctx}.build(block_ranges(lattice, field, ctx), options.band);
}

CachedField::CachedField(FieldRef field, const Box3& box, const CacheOptions& options, const Context& ctx)
    : level_(field.level()) {
    check_fields(options, "cache");
    const BlockLattice lattice = cover(box, options.cell, "cache", kMaxBlocks);
    const ValueFunction values = to_value_function(field);
    Builder{*this, lattice, values, ctx}.build(sampled_ranges(lattice, values, ctx), options.band);
}

/// Returns false outside the grid.
bool CachedField::locate(Vec3 p, Place& place) const {
    const double gx = (p.x - origin_.x) * per_cell_, gy = (p.y - origin_.y) * per_cell_,
                 gz = (p.z - origin_.z) * per_cell_;
    constexpr auto kCells = BlockLattice::kCells;
    // Written so that NaN is outside.
    const bool inside = gx >= 0 && gy >= 0 && gz >= 0 && gx < double(kCells) * blocks_x_ &&
                        gy < double(kCells) * blocks_y_ && gz < double(kCells) * blocks_z_;
    if (!inside) return false;
    const auto x = static_cast<std::uint32_t>(gx), y = static_cast<std::uint32_t>(gy),
               z = static_cast<std::uint32_t>(gz);
    place.block = (std::size_t{z / kCells} * blocks_y_ + y / kCells) * blocks_x_ + x / kCells;
    const std::uint32_t stored = stored_[place.block];
    if (stored == kConstant) {
        place.corners.first = nullptr;
        return true;
    }
    const std::size_t node = x % kCells + kNodes * (y % kCells + kNodes * std::size_t{z % kCells});
    place.corners = {values_.data() + (stored * kBlockNodes + node), static_cast<float>(gx - x),
                     static_cast<float>(gy - y), static_cast<float>(gz - z)};
    return true;
}

std::vector<Vec3> CachedField::cells_between(float low, float high, const Context& ctx) const {
    constexpr std::size_t kCells = BlockLattice::kCells;
    std::vector<std::vector<Vec3>> found(boxes_.size());
    parallel_for(ctx, boxes_.size(), 8, [&](std::size_t b) {
        for (std::size_t i = 0; i < kCells * kCells * kCells; ++i) {
            const std::size_t x = i % kCells, y = i / kCells % kCells, z = i / kCells / kCells;
            const Corners cell{&values_[b * kBlockNodes + x + kNodes * (y + kNodes * z)], 0, 0, 0};
            const auto [least, most] = cell.range();
            if (least > high || most < low) continue;
            found[b].push_back(boxes_[b].low + Vec3(Vec3d{double(x), double(y), double(z)} / per_cell_));
        }
    });
    std::vector<Vec3> out;
    for (const auto& cells : found) out.insert(out.end(), cells.begin(), cells.end());
    return out;
}

void CachedField::sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
    COPPICE_ASSERT(points.size() == out.size());
    const float per_cell = 1 / cell_;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Place place;
        out[i] = {};
        if (!locate(points[i], place)) continue;
        if (place.corners.first == nullptr) {
            out[i].value = constant_[place.block];
        } else {
            out[i] = {place.corners.value(), per_cell * place.corners.gradient()};
        }
    }
}

void CachedField::values(std::span<const Vec3> points, std::span<float> out) const {
    COPPICE_ASSERT(points.size() == out.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        Place place;
        if (!locate(points[i], place)) {
            out[i] = 0;
        } else {
            out[i] = place.corners.first == nullptr ? constant_[place.block] : place.corners.value();
        }
    }
}

void list_fields(CacheOptions& o, FieldList& list) {
    list.add(Field{"cell", "Side of a cell of the cached field; 0 uses 1/64 of the longest side.",
                   Unit::metre, 0, 1e6},
             o.cell);
    list.add(
        Field{"band", "Maximum difference from the iso value of the stored values.", Unit::none, 0.001, 10},
        o.band);
}

}  // namespace coppice
