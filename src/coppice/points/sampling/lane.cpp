#include "coppice/points/sampling/lane.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/points/nearest_internal.h"
#include "coppice/points/sampling/cells_internal.h"
#include "coppice/points/sampling/lane_internal.h"
#include "coppice/points/sampling/point_hash_internal.h"
#include "coppice/points/sampling/sum_pyramid.h"

namespace coppice {
namespace points_internal {
namespace {

constexpr std::uint64_t kStage = 0x6c616e65;
constexpr double kMaxWork = 1e10;                  // cells that kernels may touch all in all
constexpr double kVoxelsPerPoint = 8;              // where count and not the core limits the grid
constexpr double kLeastVoxels = 32768;             // so that the grid resolves the solid
constexpr double kMostVoxels = 1 << 27;            // for sets without a count
constexpr double kCellsInReach = 8;                // cells along the reach of a soft kernel
constexpr std::uint64_t kPatience = 100000;        // draws in vain at the deepest level
constexpr std::uint64_t kLongestStreak = 1 << 23;  // of draws in vain: the field is no field
constexpr std::size_t kRound = 4096;               // draws that are made before any point is placed
constexpr std::size_t kRoundGrain = 256;
constexpr std::uint64_t kTrial = 512;  // draws that tell how many are in vain
constexpr double kCuttingCost = 4;     // of a cell, in draws
constexpr std::size_t kAhead = 32;     // the same for soft kernels
constexpr double kLeastFactor = 1e-9;  // of a soft kernel that is not 0: sums keep their digits

Voxels choose_voxels(const Box3& box, const RadialKernel& kernel, const LaneOptions& options) {
    const Vec3 size = box.size();
    if (options.resolution > 0) {
        const double edge = std::max({size.x, size.y, size.z}) / static_cast<double>(options.resolution);
        return Voxels::over(box, kMostVoxels * 8, edge);
    }
    // A cell that is not wider than this is covered by a point in it.
    const double covered = kernel.core() / std::sqrt(3.0);
    const double soft = kernel.is_soft() ? kernel.reach() / kCellsInReach : 0;
    const double volume = static_cast<double>(size.x) * size.y * size.z;
    const double least = std::min(std::max(covered, soft), std::cbrt(volume / kLeastVoxels));
    const double wanted = options.count > 0 ? kVoxelsPerPoint * options.count : kMostVoxels;
    return Voxels::over(box, std::clamp(wanted, kLeastVoxels, kMostVoxels), least);
}

/// One run of Lane's method.
class Lane {
  public:
    Lane(const PointRegion& region, const RadialKernel& kernel, const PointSet& existing,
         const LaneOptions& options, std::optional<Cells> surveyed, const Context& ctx)
        : region_(region),
          kernel_(kernel),
          options_(options),
          ctx_(ctx),
          cells_(make_cells(std::move(surveyed))),
          placed_(hash_edge(), static_cast<std::size_t>(std::min(options.count, 1 << 20))),
          random_(static_cast<std::uint64_t>(options.seed), kStage) {
        check_work(static_cast<double>(existing.size()));
        for (std::size_t i = 0; i < existing.size(); ++i) before_.push_back(Vec3(existing.world(i)));
        if (kernel_.core() > 0 && !before_.empty()) nearest_.emplace(before_);
        build_pyramid();
        for (const Vec3 p : before_) apply_kernel(p);
    }

    LaneResult run() {
        LaneResult result;
        while (wanted() == 0 || points_.size() < wanted()) {
            if (!(pyramid_.total() > 0)) {
                result.stop = PointStop::full;
                break;
            }
            if (draws_ >= next_check_) check_in();
            if (misses_ > patience() || cutting_pays() || streak_ > kLongestStreak) {
                if (streak_ <= kLongestStreak && refine()) continue;
                result.stop = cells_.level() == Cell::kDeepest ? PointStop::full : PointStop::stalled;
                break;
            }
            play_round();
        }
        ctx_.report(1);
        result.points.positions = std::move(points_);
        result.tries = draws_;
        return result;
    }

  private:
    Cells make_cells(std::optional<Cells> surveyed) const {
        const Voxels voxels = choose_voxels(region_.box, kernel_, options_);
        const double per_voxel = Voxels::bytes_per_voxel() + sizeof(Cell) + sizeof(double) * 8 / 7.0;
        const double points = options_.count;
        check_memory(per_voxel * static_cast<double>(voxels.count()) + points * sizeof(Vec3) +
                         PointHash::bytes(points),
                     options_.max_memory);
        const bool fits = surveyed && surveyed->level() == 0 && surveyed->voxels() == voxels;
        return fits ? std::move(*surveyed) : Cells(region_, voxels, ctx_);
    }

    double hash_edge() const {
        const Vec3 size = region_.box.size();
        return std::max(kernel_.core(), 1e-6 * std::max({size.x, size.y, size.z}));
    }

    void check_work(double existing) const {
        if (cells_.size() == 0) {
            throw InvalidInput(
                "points: the density is 0 all over the box, as far as its grid shows; check the box and the "
                "width, or "
                "give a higher resolution");
        }
        const double across = 2 * kernel_.reach() / cells_.edge() + 1;
        const double touched = std::min(across * across * across, static_cast<double>(cells_.size()));
        if (kernel_.is_soft() && touched * (existing + options_.count) > kMaxWork) {
            throw InvalidInput(fmt::format(
                "points: the kernel reaches over {:.0f} cells around each point; lower its reach or the "
                "resolution",
                touched));
        }
    }

    void build_pyramid() {
        Buffer<double> weights(cells_.size());
        for (std::uint32_t i = 0; i < cells_.size(); ++i) weights[i] = weight(cells_[i]);
        pyramid_ = SumPyramid(std::move(weights), ctx_);
    }
    static double weight(const Cell& cell) { return static_cast<double>(cell.bound) * cell.factor; }

    /// A point drawn from the cells as they were when its round began.
    struct Dart {
        enum State : std::uint8_t { near, off, met };
        Vec3 position;
        State state;  ///< too near to a point of an earlier round; refused by the density; neither
    };
    struct Draw {
        std::uint32_t cell;
        std::uint32_t index;  ///< in the round
    };

    /// Draws a round of points and places, one after the other, those that are not refused.
    ///
    /// Cells that a point of the round covers go on to be drawn in it, but whatever falls there is refused as
    /// too near: the points follow the same law as if each was drawn from what the one before it left. With a
    /// soft kernel that does not hold, so there a round ends with the first point that is placed.
    void play_round() {
        const std::size_t count = round_size();
        throw_darts(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Dart& dart = darts_[i];
            ++draws_;
            asked_ += dart.state != Dart::near;
            met_ += dart.state == Dart::met;
            if (dart.state != Dart::met || is_too_near(dart.position)) {
                ++misses_;
                ++streak_;
                continue;
            }
            place(dart.position);
            if (kernel_.is_soft() || points_.size() == wanted()) return;
        }
    }

    void check_in() {
        ctx_.throw_if_cancelled();
        if (wanted() > 0) ctx_.report(static_cast<float>(points_.size()) / static_cast<float>(wanted()));
        next_check_ = draws_ + kRound;
    }
    std::size_t wanted() const { return static_cast<std::size_t>(options_.count); }
    std::size_t round_size() const {
        if (kernel_.is_soft()) return static_cast<std::size_t>(std::min<std::uint64_t>(kAhead, 1 + streak_));
        if (wanted() == 0) return kRound;
        // As many as the points that are missing take at this rate.
        const std::uint64_t missing = wanted() - points_.size(), draws = misses_ + hits_ + 1;
        return static_cast<std::size_t>(std::min<std::uint64_t>(kRound, missing * draws / (hits_ + 1) + 1));
    }

    void throw_darts(std::size_t count) {
        round_.resize(count);
        darts_.resize(count);
        parallel_for(ctx_, count, kRoundGrain, [&](std::size_t i) {
            round_[i] = {pyramid_.find(random_.uniform(5 * (draws_ + i))), static_cast<std::uint32_t>(i)};
        });
        // Fields are quick to tell of neighbours.
        if (count > kAhead) {
            const auto bits = static_cast<unsigned>(std::bit_width(cells_.size()));
            radix_sort(ctx_, round_, bits, [](const Draw& d) { return d.cell; });
        }
        // Where few draws meet the density, it is the quicker test, and else the distance to other points.
        const bool density_first = asked_ > 4 * met_;
        parallel_for_ranges(ctx_, count, kRoundGrain, [&](IndexRange range) { judge(range, density_first); });
    }

    void judge(IndexRange range, bool density_first) {
        std::array<std::uint32_t, kRoundGrain> asked;
        std::array<Vec3, kRoundGrain> points;
        std::array<FieldSample, kRoundGrain> samples;
        std::size_t n = 0;
        for (std::size_t k = range.begin; k < range.end; ++k) {
            const Draw draw = round_[k];
            const std::uint64_t r = 5 * (draws_ + draw.index);
            const Vec3d in(random_.uniform(r + 1), random_.uniform(r + 2), random_.uniform(r + 3));
            const Vec3 p(cells_.low(cells_[draw.cell]) + cells_.edge() * in);
            darts_[draw.index] = {p, Dart::near};
            if (!density_first && is_too_near(p)) continue;
            asked[n] = static_cast<std::uint32_t>(k);
            points[n++] = p;
        }
        if (n == 0) return;
        region_.field.sample(0, std::span(points).first(n), std::span(samples).first(n));
        for (std::size_t i = 0; i < n; ++i) {
            const Draw draw = round_[asked[i]];
            const double limit = random_.uniform(5 * (draws_ + draw.index) + 4) * cells_[draw.cell].bound;
            const bool met = region_.contains(points[i]) && limit < region_.density.at(samples[i].value);
            darts_[draw.index].state = met ? Dart::met : Dart::off;
        }
    }

    void place(Vec3 p) {
        streak_ = 0;
        ++hits_;
        points_.push_back(p);
        if (kernel_.core() > 0) placed_.insert(p);
        apply_kernel(p);
    }

    bool is_too_near(Vec3 p) const {
        if (!(kernel_.core() > 0)) return false;
        return placed_.any_nearer(p, kernel_.core()) ||
               (nearest_ && nearest_->squared_distance(p) < kernel_.core() * kernel_.core());
    }

    void apply_kernel(Vec3 p) {
        const double reach = kernel_.reach();
        if (!(reach > 0)) return;
        const Vec3d center(p);
        const Voxels& v = cells_.voxels();
        const auto [x0, x1] = v.range(0, p.x, reach);
        const auto [y0, y1] = v.range(1, p.y, reach);
        const auto [z0, z1] = v.range(2, p.z, reach);
        changed_.clear();
        for (std::uint32_t z = z0; z < z1; ++z) {
            for (std::uint32_t y = y0; y < y1; ++y) {
                for (std::uint32_t x = x0; x < x1; ++x) {
                    const auto [first, end] = cells_.of(v.index(x, y, z));
                    for (std::uint32_t i = first; i < end; ++i) change_cell(i, center);
                }
            }
        }
        pyramid_.update(changed_);
    }

    void change_cell(std::uint32_t i, Vec3d p) {
        Cell& cell = cells_[i];
        if (cell.factor <= 0) return;
        const double half = cells_.edge() / 2;
        const Vec3d to_center = cells_.low(cell) + Vec3d(half, half, half) - p;
        if (is_covered(to_center, half)) {
            cell.factor = 0;
        } else if (kernel_.is_soft()) {
            const double d = std::max(length(to_center), kernel_.core());
            if (d >= kernel_.reach()) return;
            const double factor = kernel_.at(d);
            const double product = cell.factor * factor;
            const auto limit = static_cast<double>(options_.greatest_factor);
            cell.factor = factor <= 0 ? 0 : static_cast<float>(std::clamp(product, kLeastFactor, limit));
        } else {
            return;
        }
        pyramid_.set(i, weight(cell));
        changed_.push_back(i);
    }

    /// Whether the core of a point covers a cube whose centre lies at `to_center` from it.
    bool is_covered(Vec3d to_center, double half) const {
        const Vec3d far(std::abs(to_center.x) + half, std::abs(to_center.y) + half,
                        std::abs(to_center.z) + half);
        return length_squared(far) < kernel_.core() * kernel_.core();
    }

    /// Draws in vain until the cells are cut.
    std::uint64_t patience() const {
        if (!can_refine()) return kPatience + std::uint64_t{4} * cells_.size();
        // A set without a count ends only when the cells show that there is no room.
        return kTrial + (wanted() == 0 ? cells_.size() / 4 : std::uint64_t{4} * cells_.size());
    }
    /// Whether the points that are missing cost more at this rate than with smaller cells.
    bool cutting_pays() const {
        if (wanted() == 0 || misses_ + hits_ < kTrial || !can_refine()) return false;
        const double draws =
            static_cast<double>(misses_ + hits_) / static_cast<double>(std::max<std::uint64_t>(1, hits_));
        const double expected = static_cast<double>(wanted() - points_.size()) * draws;
        return hits_ == 0 || expected > kCuttingCost * cells_.size();
    }
    bool can_refine() const {
        constexpr double kMebi = 1 << 20;
        const double bytes = Voxels::bytes_per_voxel() * static_cast<double>(cells_.voxels().count()) +
                             cells_.subdivide_bytes() + 8.0 * cells_.size() * sizeof(double) * 2;
        return cells_.level() < Cell::kDeepest && cells_.size() < (1u << 28) &&
               bytes <= options_.max_memory * kMebi;
    }

    bool refine() {
        if (!can_refine()) return false;
        cells_.subdivide(
            region_, [this](const Cell& cell) { return covered_parts(cell); }, ctx_);
        build_pyramid();
        misses_ = hits_ = asked_ = met_ = 0;
        return true;
    }

    /// Bit k for each eighth of a cell that the core of one point covers.
    unsigned covered_parts(const Cell& cell) const {
        if (!(kernel_.core() > 0)) return 0;
        const double half = cells_.edge() / 2, quarter = half / 2;
        const Vec3d low = cells_.low(cell);
        const auto to_part = [&](unsigned k) {
            return low + Vec3d(k & 1, k >> 1 & 1, k >> 2) * half + Vec3d(quarter, quarter, quarter);
        };
        unsigned covered = 0;
        const auto cover = [&](Vec3 by) {
            for (unsigned k = 0; k < 8; ++k)
                covered |= unsigned{is_covered(to_part(k) - Vec3d(by), quarter)} << k;
        };
        // A ball covers a part only when it holds its centre.
        const double reach = kernel_.core() + quarter * std::sqrt(3.0);
        placed_.visit(Vec3(low + Vec3d(half, half, half)), reach, [&](std::uint32_t n, double) {
            cover(placed_[n]);
            return covered != 255;
        });
        for (unsigned k = 0; nearest_ && k < 8; ++k) cover(before_[nearest_->index(Vec3(to_part(k)))]);
        return covered;
    }

    const PointRegion& region_;
    const RadialKernel& kernel_;
    const LaneOptions& options_;
    const Context& ctx_;
    Cells cells_;
    SumPyramid pyramid_;
    PointHash placed_;
    std::vector<Vec3> before_;
    std::optional<NearestPoint> nearest_;
    CounterRandom random_;
    Buffer<Vec3> points_;
    std::vector<std::uint32_t> changed_;
    Buffer<Draw> round_;  // sorted by cell
    Buffer<Dart> darts_;  // in the order of drawing
    std::uint64_t draws_ = 0, next_check_ = 0;
    std::uint64_t misses_ = 0, hits_ = 0;  ///< draws since cells were cut
    std::uint64_t asked_ = 0, met_ = 0;    ///< points that the field was asked for, and that met the density
    std::uint64_t streak_ = 0;             ///< of misses, up to now
};

}  // namespace

LaneResult lane_with_cells(const PointRegion& region, const RadialKernel& kernel, const LaneOptions& options,
                           Cells surveyed, const Context& ctx) {
    return Lane(region, kernel, {}, options, std::move(surveyed), ctx).run();
}

}  // namespace points_internal

LaneResult lane(const PointRegion& region, const RadialKernel& kernel, const PointSet& existing,
                const LaneOptions& options, const Context& ctx) {
    check_fields(options, "points");
    points_internal::check_box(region.box);
    if (options.count == 0 && !(kernel.core() > 0)) {
        throw InvalidInput("points: a count of 0 fills the solid, which needs a distance above 0");
    }
    return points_internal::Lane(region, kernel, existing, options, std::nullopt, ctx).run();
}

LaneResult lane(const PointRegion& region, const RadialKernel& kernel, const LaneOptions& options,
                const Context& ctx) {
    return lane(region, kernel, PointSet{}, options, ctx);
}

}  // namespace coppice
