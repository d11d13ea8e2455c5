#include "coppice/spatial/box_tree.h"

#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 1 << 14;

struct Place {
    std::uint64_t key;
    std::uint32_t item;
};

Box3 compute_bounds(std::span<const Box3> boxes) {
    Box3 all;
    for (const Box3& b : boxes) all.extend(b);
    return all;
}

}  // namespace

BoxTree::BoxTree(std::span<const Box3> boxes, const Context& ctx) : item_(boxes.size()) {
    const BoxGrid grid = box_grid(compute_bounds(boxes));
    Buffer<Place> order(boxes.size());
    parallel_for(ctx, boxes.size(), kGrain, [&](std::size_t i) {
        order[i] = {box_code(grid, boxes[i]), static_cast<std::uint32_t>(i)};
    });
    radix_sort(ctx, order, 3 * kBoxCodeBits, [](const Place& p) { return p.key; });

    level_.emplace_back(boxes.size());
    parallel_for(ctx, boxes.size(), kGrain, [&](std::size_t i) {
        item_[i] = order[i].item;
        level_[0][i] = boxes[item_[i]];
    });
    // The loop ends with a level that has one parent; there are at least two levels unless there are no
    // items.
    for (std::size_t below = boxes.size(); below > kWidth || (below > 0 && level_.size() == 1);) {
        const std::size_t count = (below + kWidth - 1) / kWidth;
        std::vector<Box3> level(count);
        parallel_for(ctx, count, kGrain, [&](std::size_t i) {
            const std::size_t first = kWidth * i;
            level[i] = compute_bounds(
                std::span(level_.back()).subspan(first, std::min<std::size_t>(kWidth, below - first)));
        });
        level_.push_back(std::move(level));
        below = count;
    }
}

void extend_outward(Box3& box, Vec3d p) {
    constexpr float kMax = std::numeric_limits<float>::max();
    Box3 cell;
    for (int axis = 0; axis < 3; ++axis) {
        const float f = static_cast<float>(std::clamp<double>(p[axis], -kMax, kMax));
        cell.low[axis] = std::max(std::nextafter(f, -kMax), -kMax);
        cell.high[axis] = std::min(std::nextafter(f, kMax), kMax);
    }
    box.extend(cell);
}

void extend_outward(Box3& box, Vec3d center, double radius) {
    const Vec3d reach(radius, radius, radius);
    extend_outward(box, center - reach);
    extend_outward(box, center + reach);
}

}  // namespace coppice
