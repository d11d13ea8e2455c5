#include <cmath>
#include <queue>
#include <tuple>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/match/match_points_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::measure_internal {
namespace {

constexpr std::size_t kMatchPointsGrain = 256;
constexpr int kMaxTries = 32;

std::vector<Box3> compute_boxes(std::span<const Vec3d> points) {
    std::vector<Box3> boxes(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) extend_outward(boxes[i], points[i]);
    return boxes;
}

/// Points that can be removed: the boxes count the remaining points, so that a search skips empty boxes.
class FreePoints {
  public:
    FreePoints(std::span<const Vec3d> points, const Context& ctx)
        : points_(points),
          tree_(compute_boxes(points), ctx),
          place_(points.size()),
          left_(tree_.level_count()) {
        for (std::uint32_t l = 0; l < tree_.level_count(); ++l) left_[l].resize(tree_.level(l).size());
        for (std::uint32_t place = 0; place < tree_.size(); ++place) {
            place_[tree_.item(place)] = place;
            add(place, 1);
        }
    }

    bool is_free(std::uint32_t point) const { return left_[0][place_[point]] > 0; }
    void take(std::uint32_t point) { add(place_[point], -1); }

    struct Nearest {
        std::uint32_t point = kNoIndex;
        double distance_squared = 0;
    };
    Nearest nearest(Vec3d p, double reach) const {
        constexpr double kNever = std::numeric_limits<double>::infinity();
        Nearest best;
        double limit = reach * reach;
        const auto bound = [&](std::uint32_t l, std::uint32_t i) {
            return left_[l][i] > 0 ? distance_squared(tree_.level(l)[i], p) : kNever;
        };
        tree_.search(bound, limit, [&](std::uint32_t i) {
            const double d2 = length_squared(points_[i] - p);
            if (!(d2 <= limit)) return;
            best = {i, d2};
            limit = std::nextafter(d2, -1.0);  // equal distances are not better, however many there are
        });
        return best;
    }

  private:
    void add(std::uint32_t place, int count) {
        for (auto& level : left_) {
            level[place] += count;
            place /= BoxTree::kWidth;
        }
    }

    std::span<const Vec3d> points_;
    BoxTree tree_;
    std::vector<std::uint32_t> place_;
    std::vector<std::vector<int>> left_;  ///< by level and box
};

struct Offer {
    double distance_squared;
    std::uint32_t a, b;
    friend bool operator>(const Offer& x, const Offer& y) {
        return std::tie(x.distance_squared, x.a, x.b) > std::tie(y.distance_squared, y.a, y.b);
    }
};

}  // namespace

std::vector<std::uint32_t> match_points(std::span<const Vec3d> a, std::span<const double> reach,
                                        std::span<const Vec3d> b, const Context& ctx) {
    FreePoints left(b, ctx);
    std::vector<FreePoints::Nearest> first(a.size());
    parallel_for(ctx, a.size(), kMatchPointsGrain, [&](std::size_t i) {
        if (!ctx.stop.stop_requested()) first[i] = left.nearest(a[i], reach[i]);
    });

    ctx.throw_if_cancelled();
    std::priority_queue<Offer, std::vector<Offer>, std::greater<>> offers;
    const auto offer = [&](std::uint32_t i, const FreePoints::Nearest& nearest) {
        if (nearest.point != kNoIndex) offers.push({nearest.distance_squared, i, nearest.point});
    };
    for (std::uint32_t i = 0; i < a.size(); ++i) offer(i, first[i]);
    std::vector<std::uint32_t> match(a.size(), kNoIndex);
    std::vector<int> tries(a.size());
    while (!offers.empty()) {
        ctx.throw_if_cancelled();
        const Offer best = offers.top();
        offers.pop();
        if (left.is_free(best.b)) {
            match[best.a] = best.b;
            left.take(best.b);
        } else if (++tries[best.a] < kMaxTries) {
            offer(best.a, left.nearest(a[best.a], reach[best.a]));
        }
    }
    return match;
}

}  // namespace coppice::measure_internal
