#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/progress.h"
#include "coppice/points/sampling/eliminate_internal.h"
#include "coppice/points/sampling/point_grid_internal.h"

namespace coppice::points_internal {
namespace {

// maximum number of neighbours of a point: about 40 times that of an even set
constexpr int kMaxNeighbours = 1024;
// number of points that are weighted or removed between two checks of the stop token
constexpr std::size_t kLook = 1024;
constexpr float kWeighed = 0.25f;  // progress after the computation of the weights

/// Weight of a neighbour as a function of the distance. Source: [Yuksel2015], with its alpha of 8.
struct NeighbourWeight {
    double reach;  ///< [m] distance beyond which a neighbour has no weight
    double least;  ///< [m] distance below which the weight is constant

    NeighbourWeight(double radius, double share) : reach(2 * radius) {
        constexpr double kBeta = 0.65, kGamma = 1.5;
        least = radius * (1 - std::pow(share, kGamma)) * kBeta;
    }
    double at(double squared) const {
        const double d = std::min(1.0, std::max(std::sqrt(squared), 2 * least) / reach);
        const double u = 1 - d, u2 = u * u, u4 = u2 * u2;
        return u4 * u4;
    }
};

struct HeapEntry {
    double weight;
    std::uint32_t item, number;
};

/// Heap of points, largest weight on top; weights may decrease. Among equal weights the smallest number
/// precedes. The four children of a node share a cache line.
class Heap {
  public:
    static constexpr double kBytes = sizeof(HeapEntry) + sizeof(std::uint32_t);  ///< bytes per point

    Heap(const PointGrid& grid, const Buffer<double>& weight, const Context& ctx)
        : entry_(weight.size()), place_(weight.size()) {
        for (std::uint32_t i = 0; i < entry_.size(); ++i) put(i, {weight[i], i, grid.number(i)});
        for (std::size_t i = entry_.size() / kWidth + 1; i-- > 0;) {
            if (i % (kLook * kLook) == 0) ctx.throw_if_cancelled();
            if (i < entry_.size()) sink(i);
        }
    }
    std::uint32_t pop() {
        const std::uint32_t top = entry_.front().item;
        put(0, entry_.back());
        entry_.pop_back();
        place_[top] = kGone;
        if (!entry_.empty()) sink(0);
        return top;
    }
    void lower(std::uint32_t item, double by) {
        if (place_[item] == kGone) return;
        entry_[place_[item]].weight -= by;
        sink(place_[item]);
    }
    bool holds(std::uint32_t item) const { return place_[item] != kGone; }

  private:
    static constexpr std::uint32_t kGone = 0xffffffffu;
    static constexpr std::size_t kWidth = 4;

    static bool before(const HeapEntry& a, const HeapEntry& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.number < b.number;
    }
    void put(std::size_t place, const HeapEntry& entry) {
        entry_[place] = entry;
        place_[entry.item] = static_cast<std::uint32_t>(place);
    }
    void sink(std::size_t place) {
        const HeapEntry entry = entry_[place];
        for (;;) {
            const std::size_t first = kWidth * place + 1, end = std::min(first + kWidth, entry_.size());
            if (first >= end) break;
            std::size_t child = first;
            for (std::size_t k = first + 1; k < end; ++k) {
                if (before(entry_[k], entry_[child])) child = k;
            }
            if (!before(entry_[child], entry)) break;
            put(place, entry_[child]);
            place = child;
        }
        put(place, entry);
    }

    Buffer<HeapEntry> entry_;
    Buffer<std::uint32_t> place_;  // by item
};

/// Returns the total weight of the neighbours of each point.
Buffer<double> weigh(const PointGrid& grid, const NeighbourWeight& weight, const Context& ctx) {
    Buffer<double> weights(grid.size());
    std::atomic<bool> crowded = false;
    parallel_with_progress(ctx, grid.size(), kLook, [&](IndexRange range) {
        for (auto i = static_cast<std::uint32_t>(range.begin); i < range.end; ++i) {
            int neighbours = 0;
            double sum = 0;
            const bool ended = !grid.visit(grid[i], weight.reach, [&](std::uint32_t n, double d2) {
                if (n != i) sum += weight.at(d2);
                return ++neighbours < kMaxNeighbours;
            });
            if (ended) crowded = true;
            weights[i] = sum;
        }
    });
    if (!crowded) return weights;
    throw InvalidInput("points: too many points coincide to be spread evenly; lower count");
}

}  // namespace

double eliminate_bytes(double points) {
    return points * (sizeof(Vec3) + sizeof(double) + Heap::kBytes) + PointGrid::bytes(points);
}

Buffer<Vec3> eliminate(const Buffer<Vec3>& points, std::size_t count, double radius, const Context& ctx) {
    if (count >= points.size()) return points;
    const NeighbourWeight weight(radius, static_cast<double>(count) / static_cast<double>(points.size()));
    const PointGrid grid(points, weight.reach, ctx);
    Heap heap(grid, weigh(grid, weight, narrow_progress(ctx, 0, kWeighed)), ctx);
    const Context removing = narrow_progress(ctx, kWeighed, 1);
    const std::size_t all = points.size() - count;
    for (std::size_t gone = 0; gone < all; ++gone) {
        if (gone % kLook == 0) check_in(removing, gone, all);
        grid.visit(grid[heap.pop()], weight.reach, [&](std::uint32_t n, double d2) {
            heap.lower(n, weight.at(d2));
            return true;
        });
    }
    std::vector<bool> stays(points.size());
    for (std::uint32_t i = 0; i < grid.size(); ++i) stays[grid.number(i)] = heap.holds(i);
    Buffer<Vec3> kept;
    kept.reserve(count);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (stays[i]) kept.push_back(points[i]);
    }
    return kept;
}

}  // namespace coppice::points_internal
