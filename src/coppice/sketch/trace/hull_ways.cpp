#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/sketch/trace/hull_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr double kGround = 0.05;     // [height] the base is searched at the widest cell within this height
constexpr double kCovered = 2;       // [thickness], plus
constexpr double kCoveredCells = 3;  // [cells]: distance from a path within which no other path ends
constexpr double kSpur = 1.5;        // [thickness at the fork], plus
constexpr double kSpurCells = 2;     // [cells]: minimum length of a path; shorter ones are bumps

/// Adjacency of cells.
class Neighbours {
  public:
    explicit Neighbours(const std::vector<Cell>& cells) : at_(26 * cells.size(), kNoIndex) {
        std::size_t direction = 0;
        for (int z = 0; z <= 1; ++z)
            for (int y = z == 0 ? 0 : -1; y <= 1; ++y)
                for (int x = z == 0 && y == 0 ? 1 : -1; x <= 1; ++x) join(cells, {x, y, z}, direction++);
    }
    std::span<const std::uint32_t> of(std::uint32_t i) const {
        return {at_.data() + 26 * std::size_t{i}, 26};
    }

  private:
    /// Shifting all cells preserves their order, so that both lists are traversed in parallel.
    void join(const std::vector<Cell>& cells, Cell by, std::size_t direction) {
        const auto key = [](const Cell& c) { return std::tuple(c[2], c[1], c[0]); };
        std::size_t other = 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const Cell wanted{cells[i][0] + by[0], cells[i][1] + by[1], cells[i][2] + by[2]};
            while (other < cells.size() && key(cells[other]) < key(wanted)) ++other;
            if (other == cells.size() || cells[other] != wanted) continue;
            at_[26 * i + 2 * direction] = static_cast<std::uint32_t>(other);
            at_[26 * other + 2 * direction + 1] = static_cast<std::uint32_t>(i);
        }
    }
    std::vector<std::uint32_t> at_;
};

class WayFinder {
  public:
    WayFinder(const Hull& hull, const Context& ctx)
        : hull_(hull), ctx_(ctx), count_(static_cast<std::uint32_t>(hull.cells.size())), near_(hull.cells) {}

    std::vector<HullPath> run() {
        if (count_ == 0) return {};
        find_base();
        find_ways();
        find_tips();
        return cut();
    }

  private:
    double apart(std::uint32_t a, std::uint32_t b) const {
        return distance(hull_.center(a), hull_.center(b));
    }
    template <class Visit>
    void for_neighbours(std::uint32_t i, const Visit& visit) const {
        for (const std::uint32_t n : near_.of(i))
            if (n != kNoIndex) visit(n);
    }

    /// Returns the cells of the largest connected component.
    std::vector<std::uint32_t> largest_part() const {
        DisjointSets sets(count_);
        std::vector<std::uint32_t> size(count_, 0), out;
        for (std::uint32_t i = 0; i < count_; ++i)
            for_neighbours(i, [&](std::uint32_t n) { sets.join(n, i); });
        for (std::uint32_t i = 0; i < count_; ++i) ++size[sets.find(i)];
        const auto most = static_cast<std::uint32_t>(std::ranges::max_element(size) - size.begin());
        for (std::uint32_t i = 0; i < count_; ++i)
            if (sets.find(i) == most) out.push_back(i);
        return out;
    }

    /// Finds the lowest cell below the widest one near the ground. Cells are sorted by height.
    void find_base() {
        const std::vector<std::uint32_t> part = largest_part();
        const double low = hull_.center(part.front()).z, high = hull_.center(part.back()).z;
        std::uint32_t widest = part.front();
        for (const std::uint32_t i : part)
            if (hull_.center(i).z <= low + kGround * (high - low) &&
                hull_.thickness(i) > hull_.thickness(widest))
                widest = i;
        base_width_ = hull_.thickness(widest);
        base_ = *std::ranges::find_if(part, [&](std::uint32_t i) {
            const Vec3d off = hull_.center(i) - hull_.center(widest);
            return std::hypot(off.x, off.y) <= 0.5 * hull_.thickness(widest);
        });
    }

    /// Computes the shortest paths from the base; the cost is inversely proportional to the thickness.
    void find_ways() {
        std::vector<double> cost(count_, std::numeric_limits<double>::infinity());
        std::vector<char> done(count_, 0);
        length_.assign(count_, 0);
        from_.assign(count_, kNoIndex);
        using Entry = std::pair<double, std::uint32_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        cost[base_] = 0;
        queue.emplace(0, base_);
        while (!queue.empty()) {
            const std::uint32_t i = queue.top().second;
            queue.pop();
            if (done[i] != 0) continue;
            if (order_.size() % 4096 == 0) ctx_.throw_if_cancelled();
            done[i] = 1;
            order_.push_back(i);
            for_neighbours(i, [&](std::uint32_t n) {
                const double step = apart(i, n), thin = hull_.size / hull_.thickness(n);
                const double there = cost[i] + step * thin;
                if (done[n] != 0 || there >= cost[n]) return;
                cost[n] = there;
                from_[n] = i;
                length_[n] = length_[i] + step;
                queue.emplace(there, n);
            });
        }
    }

    /// Adds paths by decreasing distance of their ends, each up to an existing path; cells near a path are
    /// not ends.
    void find_tips() {
        std::vector<std::uint32_t> far = order_;
        std::ranges::stable_sort(far, std::greater<>{}, [&](std::uint32_t i) { return length_[i]; });
        covered_.assign(count_, 0);
        on_way_.assign(count_, 0);
        on_way_[base_] = 1;
        for (const std::uint32_t tip : far) {
            if (covered_[tip] > 0) continue;
            ctx_.throw_if_cancelled();
            std::vector<std::uint32_t> way;
            std::uint32_t i = tip;
            for (; on_way_[i] == 0; i = from_[i]) way.push_back(i);
            if (apart(tip, i) < kSpur * width_at(i) + kSpurCells * hull_.size) way.resize(0);
            for (const std::uint32_t w : way) on_way_[w] = 1;
            way.push_back(tip);
            cover_about(way);
        }
    }

    /// Returns the width [m] at a cell. The base is at the edge of the wide section there.
    double width_at(std::uint32_t i) const {
        return std::max(hull_.thickness(i), apart(i, base_) < base_width_ ? base_width_ : 0);
    }

    /// Stores in every cell the remaining covered distance, in decreasing order.
    void cover_about(const std::vector<std::uint32_t>& way) {
        std::priority_queue<std::pair<double, std::uint32_t>> queue;
        for (const std::uint32_t w : way)
            queue.emplace(kCovered * hull_.thickness(w) + kCoveredCells * hull_.size, w);
        while (!queue.empty()) {
            const double left = queue.top().first;
            const std::uint32_t i = queue.top().second;
            queue.pop();
            if (left <= covered_[i]) continue;
            covered_[i] = left;
            for_neighbours(i, [&](std::uint32_t n) {
                if (const double there = left - apart(i, n); there > covered_[n]) queue.emplace(there, n);
            });
        }
    }

    /// Splits paths at cells with several children.
    std::vector<HullPath> cut() const {
        std::vector<std::uint8_t> children(count_, 0);
        for (const std::uint32_t i : order_)
            if (on_way_[i] != 0 && i != base_) ++children[from_[i]];
        std::vector<HullPath> paths;
        std::vector<std::uint32_t> path_index(count_, kNoIndex);
        for (const std::uint32_t i : order_) {
            if (on_way_[i] == 0 || i == base_) continue;
            const std::uint32_t from = from_[i];
            path_index[i] = path_index[from];
            if (from == base_ || children[from] > 1) {
                path_index[i] = static_cast<std::uint32_t>(paths.size());
                paths.push_back({.cells = {from}, .before = path_index[from]});
            }
            paths[path_index[i]].cells.push_back(i);
            paths[path_index[i]].is_tip = children[i] == 0;
        }
        return paths;
    }

    const Hull& hull_;
    const Context& ctx_;
    std::uint32_t count_;
    Neighbours near_;
    std::uint32_t base_ = 0;
    double base_width_ = 0;             ///< [m] thickness above the base
    std::vector<double> length_;        ///< [m] by cell: length of its path from the base
    std::vector<std::uint32_t> from_;   ///< by cell: its predecessor on the path
    std::vector<std::uint32_t> order_;  ///< reached cells, predecessors first
    std::vector<char> on_way_;
    std::vector<double> covered_;  ///< [m] by cell
};

}  // namespace

std::vector<HullPath> find_paths(const Hull& hull, const Context& ctx) { return WayFinder(hull, ctx).run(); }

}  // namespace coppice::sketch_internal
