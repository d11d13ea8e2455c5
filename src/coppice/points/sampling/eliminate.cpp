#include "coppice/points/sampling/eliminate_internal.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/points/sampling/point_hash_internal.h"

namespace coppice::points_internal {
namespace {

constexpr int kMostNeighbours = 1024;  // of one point: about 40 times what an even set has

/// A heap of points, the heaviest on top, whose weights may fall; of equal ones the first comes first.
class Heap {
  public:
    explicit Heap(Buffer<double> weights) : weight_(std::move(weights)), item_(weight_.size()) {
        std::iota(item_.begin(), item_.end(), 0u);
        place_ = item_;
        for (std::size_t i = item_.size() / 2; i-- > 0;) sink(i);
    }
    std::uint32_t pop() {
        const std::uint32_t top = item_.front();
        put(0, item_.back());
        item_.pop_back();
        place_[top] = kGone;
        if (!item_.empty()) sink(0);
        return top;
    }
    void lower(std::uint32_t i, double by) {
        if (place_[i] == kGone) return;
        weight_[i] -= by;
        sink(place_[i]);
    }
    bool holds(std::uint32_t i) const { return place_[i] != kGone; }

  private:
    static constexpr std::uint32_t kGone = 0xffffffffu;

    bool before(std::uint32_t a, std::uint32_t b) const {
        return weight_[a] != weight_[b] ? weight_[a] > weight_[b] : a < b;
    }
    void put(std::size_t place, std::uint32_t item) {
        item_[place] = item;
        place_[item] = static_cast<std::uint32_t>(place);
    }
    void sink(std::size_t place) {
        const std::uint32_t item = item_[place];
        for (;;) {
            std::size_t child = 2 * place + 1;
            if (child >= item_.size()) break;
            if (child + 1 < item_.size() && before(item_[child + 1], item_[child])) ++child;
            if (!before(item_[child], item)) break;
            put(place, item_[child]);
            place = child;
        }
        put(place, item);
    }

    Buffer<double> weight_;
    Buffer<std::uint32_t> item_, place_;
};

}  // namespace

double eliminate_bytes(double points) {
    return points * (2 * sizeof(Vec3) + 8 + 4 + 4) + PointHash::bytes(points);
}

Buffer<Vec3> eliminate(const Buffer<Vec3>& points, std::size_t count, double radius, const Context& ctx) {
    if (count >= points.size()) return points;
    constexpr double kBeta = 0.65, kGamma = 1.5;
    const double share = static_cast<double>(count) / static_cast<double>(points.size());
    const double least = radius * (1 - std::pow(share, kGamma)) * kBeta;
    const double reach = 2 * radius;
    const auto weight = [&](double squared) {
        const double d = std::min(1.0, std::max(std::sqrt(squared), 2 * least) / reach);
        const double u = 1 - d, u2 = u * u, u4 = u2 * u2;
        return u4 * u4;
    };
    PointHash grid(reach, points.size());
    for (const Vec3 p : points) grid.insert(p);

    Buffer<double> weights(points.size());
    const auto gather = [&](IndexRange range) {
        int crowded = 0;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            int neighbours = 0;
            double sum = 0;
            const bool ended = !grid.visit(points[i], reach, [&](std::uint32_t n, double d2) {
                if (n != i) sum += weight(d2);
                return ++neighbours < kMostNeighbours;
            });
            crowded |= ended ? 1 : 0;
            weights[i] = sum;
        }
        return crowded;
    };
    if (parallel_reduce(ctx, points.size(), 1024, 0, gather, [](int a, int b) { return a | b; }) != 0) {
        throw InvalidInput(
            "points: the points lie on one another, so that they cannot be spread evenly; lower count");
    }
    Heap heap(std::move(weights));
    for (std::size_t gone = points.size() - count; gone > 0; --gone) {
        if (gone % 4096 == 0) ctx.throw_if_cancelled();
        const std::uint32_t i = heap.pop();
        grid.visit(points[i], reach, [&](std::uint32_t n, double d2) {
            heap.lower(n, weight(d2));
            return true;
        });
    }
    Buffer<Vec3> kept;
    kept.reserve(count);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (heap.holds(i)) kept.push_back(points[i]);
    }
    return kept;
}

}  // namespace coppice::points_internal
