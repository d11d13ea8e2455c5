#include <algorithm>
#include <cmath>

#include "coppice/growth/shade_grid_internal.h"

namespace coppice {
namespace {

constexpr double kUnits = 1 << 16;  // per full light: 32,000 leaves that absorb all of it fit into 32 bits

}  // namespace

ShadeGrid::ShadeGrid(const ShadeSettings& settings) : per_cell_(1 / double{settings.cell}) {
    double amount = settings.shade;
    for (int layer = 0; layer <= settings.depth; ++layer, amount *= settings.falloff)
        amount_.push_back(static_cast<std::int32_t>(std::lround(amount * kUnits)));
}

ShadeGrid::Cell ShadeGrid::compute_cell(Vec3 p) const {
    const auto index = [&](float x) { return static_cast<std::int32_t>(std::floor(x * per_cell_)); };
    return {index(p.x), index(p.y), index(p.z)};
}

std::uint64_t ShadeGrid::key(std::int32_t x, std::int32_t y, std::int32_t z) {
    const auto bits = [](std::int32_t i) { return static_cast<std::uint64_t>(i) & 0x1fffff; };
    return bits(x) | bits(y) << 21 | bits(z) << 42;
}

std::size_t ShadeGrid::within(std::int32_t x, std::int32_t y, std::int32_t z) {
    constexpr std::int32_t kMask = kEdge - 1;
    return static_cast<std::size_t>((z & kMask) << 2 * kBits | (y & kMask) << kBits | (x & kMask));
}

std::int32_t ShadeGrid::at(Cell c) const {
    const auto found = number_.find(key(c.x >> kBits, c.y >> kBits, c.z >> kBits));
    return found == number_.end() ? 0 : blocks_[found->second][within(c.x, c.y, c.z)];
}

ShadeGrid::Block& ShadeGrid::block(std::int32_t x, std::int32_t y, std::int32_t z) {
    const auto [found, is_new] =
        number_.try_emplace(key(x, y, z), static_cast<std::uint32_t>(blocks_.size()));
    if (is_new) blocks_.emplace_back();
    return blocks_[found->second];
}

void ShadeGrid::cast(Vec3 leaves, std::int32_t sign) {
    const Cell c = compute_cell(leaves);
    for (std::int32_t layer = 0; layer < static_cast<std::int32_t>(amount_.size()); ++layer) {
        const std::int32_t amount = amount_[static_cast<std::size_t>(layer)];
        if (amount != 0) cast_layer({c.x, c.y, c.z - layer}, layer, sign * amount);
    }
}

void ShadeGrid::cast_layer(Cell middle, std::int32_t reach, std::int32_t amount) {
    const std::int32_t low_x = middle.x - reach, high_x = middle.x + reach;
    const std::int32_t low_y = middle.y - reach, high_y = middle.y + reach;
    for (std::int32_t by = low_y >> kBits; by <= high_y >> kBits; ++by) {
        for (std::int32_t bx = low_x >> kBits; bx <= high_x >> kBits; ++bx) {
            Block& cells = block(bx, by, middle.z >> kBits);
            const std::int32_t last_x = std::min(high_x, bx * kEdge + kEdge - 1);
            const std::int32_t last_y = std::min(high_y, by * kEdge + kEdge - 1);
            for (std::int32_t y = std::max(low_y, by * kEdge); y <= last_y; ++y) {
                for (std::int32_t x = std::max(low_x, bx * kEdge); x <= last_x; ++x)
                    cells[within(x, y, middle.z)] += amount;
            }
        }
    }
}

double ShadeGrid::shade(Vec3 p) const { return at(compute_cell(p)) / kUnits; }

Vec3d ShadeGrid::brighter(Vec3 p) const {
    const Cell c = compute_cell(p);
    const auto fall = [](std::int32_t below, std::int32_t above) {
        return static_cast<double>(below) - above;
    };
    const Vec3d way{fall(at({c.x - 1, c.y, c.z}), at({c.x + 1, c.y, c.z})),
                    fall(at({c.x, c.y - 1, c.z}), at({c.x, c.y + 1, c.z})),
                    fall(at({c.x, c.y, c.z - 1}), at({c.x, c.y, c.z + 1}))};
    return normalized(way, Vec3d{});
}

}  // namespace coppice
