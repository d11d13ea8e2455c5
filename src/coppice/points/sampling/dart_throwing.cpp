#include "coppice/points/sampling/dart_throwing.h"

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
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/points/sampling/cells_internal.h"
#include "coppice/points/sampling/dart_throwing_internal.h"
#include "coppice/points/sampling/point_hash_internal.h"
#include "coppice/points/sampling/sum_pyramid_internal.h"
#include "coppice/spatial/kd_tree.h"

namespace coppice {
namespace points_internal {
namespace {

constexpr std::uint64_t kStage = 0x6c616e65;
constexpr double kMaxWork = 1e10;                 // maximum total number of cells modified by kernels
constexpr double kVoxelsPerPoint = 8;             // if the grid is limited by the count and not by the core
constexpr double kMinVoxels = 32768;              // minimum resolution of the solid
constexpr double kMaxVoxels = 1 << 27;            // for sets without a count
constexpr double kCellsInReach = 8;               // number of cells along the reach of a soft kernel
constexpr std::uint64_t kMaxRejections = 100000;  // number of rejected draws at the deepest level
// maximum number of consecutive rejected draws: the field is invalid
constexpr std::uint64_t kMaxInARow = 1 << 23;
constexpr std::size_t kRound = 4096;    // number of draws before any point is placed
constexpr std::size_t kSoftRound = 32;  // number for soft kernels
constexpr std::size_t kRoundGrain = 256;
constexpr std::uint64_t kTrial = 512;   // number of draws that estimates the rejection rate
constexpr double kSubdividingCost = 4;  // cost of the subdivision of a cell, in draws
// minimum nonzero factor of a soft kernel: preserves the precision of sums
constexpr double kMinFactor = 1e-9;

Voxels choose_voxels(const Box3& box, const RadialKernel& kernel, const DartThrowingOptions& options) {
    const Vec3 size = box.size();
    if (options.resolution > 0) {
        const double edge = std::max({size.x, size.y, size.z}) / static_cast<double>(options.resolution);
        return Voxels::over(box, kMaxVoxels * 8, edge);
    }
    // A cell with at most this edge is covered by a point in it.
    const double covered = kernel.core() / std::sqrt(3.0);
    const double soft = kernel.is_soft() ? kernel.reach() / kCellsInReach : 0;
    const double volume = static_cast<double>(size.x) * size.y * size.z;
    const double least = std::min(std::max(covered, soft), std::cbrt(volume / kMinVoxels));
    const double wanted = options.count > 0 ? kVoxelsPerPoint * options.count : kMaxVoxels;
    return Voxels::over(box, std::clamp(wanted, kMinVoxels, kMaxVoxels), least);
}

/// Input of a run.
struct Task {
    const PointRegion& region;
    const RadialKernel& kernel;
    const DartThrowingOptions& options;
    const DensityLaw* law = nullptr;  ///< if the kernel consists only of a core that depends on the density

    /// Returns the minimum distance [m] of points at this density.
    double core(double density) const {
        return law == nullptr ? kernel.core() : kernel.core() * std::cbrt(law->mean / density);
    }
    std::size_t wanted() const { return static_cast<std::size_t>(options.count); }  ///< 0: as many as fit
};

/// Density remaining after the points placed so far.
struct RemainingDensity {
    Cells cells;
    SumPyramid sums;                     ///< sums of the weights of the cells
    std::vector<std::uint32_t> changed;  ///< temporary
};

/// Points with a minimum distance from new ones.
struct Points {
    Points(const Task& task, const PointSet& given, const Context& ctx);

    Buffer<Vec3> placed;
    Buffer<double> cores;  ///< [m] of the placed points, if they differ
    PointHash grid;        ///< of the placed points
    std::vector<Vec3> existing;
    std::optional<KdTree> nearest_existing;
};

struct DrawCounts {
    std::uint64_t all = 0;
    std::uint64_t rejected = 0, accepted = 0;              ///< since the last subdivision
    std::uint64_t evaluated = 0, accepted_by_density = 0;  ///< since the last subdivision
    std::uint64_t rejected_in_a_row = 0;                   ///< current number
};

/// Point drawn from the cells in the state at the start of its round.
struct Candidate {
    enum Verdict : std::uint8_t { too_near, off_density, accepted };
    Vec3 position;
    float value;      ///< value of the field, if evaluated
    double density;   ///< density, if evaluated
    Verdict verdict;  ///< too near to a point of an earlier round; rejected by the density; accepted so far
};

struct Draw {
    std::uint32_t cell;
    std::uint32_t index;  ///< in the round
};

struct Round {
    Buffer<Draw> draws;            ///< sorted by cell
    Buffer<Candidate> candidates;  ///< in the order of drawing
};

double weight(const Cell& cell) { return static_cast<double>(cell.bound) * cell.factor; }

SumPyramid compute_sums(const Cells& cells, const Context& ctx) {
    Buffer<double> weights(cells.size());
    parallel_for(ctx, weights.size(), std::size_t{1} << 14,
                 [&](std::size_t i) { weights[i] = weight(cells[static_cast<std::uint32_t>(i)]); });
    return SumPyramid(std::move(weights), ctx);
}

Cells make_cells(const Task& task, std::optional<Cells> surveyed, const Context& ctx) {
    const Voxels voxels = choose_voxels(task.region.box, task.kernel, task.options);
    const double per_voxel = Voxels::bytes_per_voxel() + sizeof(Cell) + sizeof(double) * 8 / 7.0;
    const double points = task.options.count;
    const double per_point = sizeof(Vec3) + (task.law == nullptr ? 0 : sizeof(double));
    check_memory(
        per_voxel * static_cast<double>(voxels.count()) + points * per_point + PointHash::bytes(points),
        task.options.max_memory);
    const bool fits = surveyed && surveyed->level() == 0 && surveyed->voxels() == voxels;
    return fits ? std::move(*surveyed) : Cells(task.region, voxels, ctx);
}

void check_work(const Task& task, const Cells& cells, std::size_t existing) {
    if (cells.size() == 0) refuse_empty_region();
    const double across = 2 * task.kernel.reach() / cells.edge() + 1;
    const double touched = std::min(across * across * across, static_cast<double>(cells.size()));
    const double points = static_cast<double>(existing) + task.options.count;
    if (!task.kernel.is_soft() || touched * points <= kMaxWork) return;
    throw InvalidInput(fmt::format(
        "points: the kernel extends over {:.0f} cells around each point; lower its reach or the resolution",
        touched));
}

double hash_edge(const Task& task) {
    const Vec3 size = task.region.box.size();
    return std::max(task.kernel.core(), 1e-6 * std::max({size.x, size.y, size.z}));
}

Points::Points(const Task& task, const PointSet& given, const Context& ctx)
    : grid(hash_edge(task), static_cast<std::size_t>(std::min(task.options.count, 1 << 20))) {
    for (std::size_t i = 0; i < given.size(); ++i) existing.push_back(Vec3(given.world(i)));
    if (task.kernel.core() > 0 && !existing.empty()) nearest_existing.emplace(existing, ctx);
}

/// Returns whether a point with a core is too close to one with the core `other`.
bool is_within_cores(double squared, double core, double other) {
    const double lesser = std::min(core, other);
    return squared < lesser * lesser;
}

bool is_too_near(const Task& task, const Points& points, Vec3 p, double core) {
    if (!(core > 0)) return false;
    if (task.law != nullptr) {
        return !points.grid.visit(
            p, core, [&](std::uint32_t n, double d2) { return !is_within_cores(d2, core, points.cores[n]); });
    }
    return points.grid.any_nearer(p, core) ||
           (points.nearest_existing && points.nearest_existing->nearest(p).squared < core * core);
}

/// Returns whether a ball covers a cube with its centre at `to_center` from that of the ball.
bool is_covered(Vec3d to_center, double half, double radius) {
    const Vec3d far(std::abs(to_center.x) + half, std::abs(to_center.y) + half, std::abs(to_center.z) + half);
    return length_squared(far) < radius * radius;
}

/// Returns the factor of a cell after a point with this core at `to_center` from its centre.
float factor_behind(const Task& task, const Cell& cell, double core, Vec3d to_center, double half) {
    const RadialKernel& kernel = task.kernel;
    const float factor = cell.factor;
    if (is_covered(to_center, half, std::min(core, task.core(double{cell.bound})))) return 0;
    if (!kernel.is_soft()) return factor;
    const double d = std::max(length(to_center), kernel.core());
    if (d >= kernel.reach()) return factor;
    const double by = kernel.at(d);
    const auto limit = static_cast<double>(task.options.max_factor);
    return by <= 0 ? 0 : static_cast<float>(std::clamp(factor * by, kMinFactor, limit));
}

/// Multiplies the density around a point with that core by the kernel.
void apply_kernel(const Task& task, Vec3 p, double core, RemainingDensity& density) {
    const double reach = task.law == nullptr ? task.kernel.reach() : core;
    if (!(reach > 0)) return;
    Cells& cells = density.cells;
    const Voxels& v = cells.voxels();
    const double half = cells.edge() / 2;
    const Vec3d to_middle(half, half, half), center(p);
    const auto [x0, x1] = v.range(0, p.x, reach);
    const auto [y0, y1] = v.range(1, p.y, reach);
    const auto [z0, z1] = v.range(2, p.z, reach);
    density.changed.clear();
    const auto change = [&](std::uint32_t i) {
        Cell& cell = cells[i];
        if (cell.factor <= 0) return;
        const float factor = factor_behind(task, cell, core, cells.low(cell) + to_middle - center, half);
        if (factor == cell.factor) return;
        cell.factor = factor;
        density.sums.set(i, weight(cell));
        density.changed.push_back(i);
    };
    for (std::uint32_t z = z0; z < z1; ++z) {
        for (std::uint32_t y = y0; y < y1; ++y) {
            for (std::uint32_t x = x0; x < x1; ++x) {
                const auto [first, end] = cells.of(v.index(x, y, z));
                for (std::uint32_t i = first; i < end; ++i) change(i);
            }
        }
    }
    density.sums.update(density.changed);
}

/// Returns a mask of the eighths of a cell covered by the core of one point.
unsigned covered_parts(const Task& task, const RemainingDensity& density, const Points& points,
                       const Cell& cell) {
    const double core = task.core(double{cell.bound});
    if (!(core > 0)) return 0;
    const double half = density.cells.edge() / 2, quarter = half / 2;
    const Vec3d low = density.cells.low(cell);
    const auto to_part = [&](unsigned k) {
        return low + Vec3d(k & 1, k >> 1 & 1, k >> 2) * half + Vec3d(quarter, quarter, quarter);
    };
    unsigned covered = 0;
    const auto cover = [&](Vec3 by, double radius) {
        for (unsigned k = 0; k < 8; ++k)
            covered |= unsigned{is_covered(to_part(k) - Vec3d(by), quarter, radius)} << k;
    };
    // A ball covers a part only if it contains its centre.
    const double reach = core + quarter * std::sqrt(3.0);
    points.grid.visit(Vec3(low + Vec3d(half, half, half)), reach, [&](std::uint32_t n, double) {
        cover(points.grid[n], task.law == nullptr ? core : std::min(core, points.cores[n]));
        return covered != 255;
    });
    if (!points.nearest_existing) return covered;
    for (unsigned k = 0; k < 8; ++k)
        cover(points.existing[points.nearest_existing->nearest(Vec3(to_part(k))).index], core);
    return covered;
}

bool can_subdivide(const Task& task, const Cells& cells) {
    constexpr double kMebi = 1 << 20;
    const double bytes = Voxels::bytes_per_voxel() * static_cast<double>(cells.voxels().count()) +
                         cells.subdivide_bytes() + 8.0 * cells.size() * sizeof(double) * 2;
    return cells.level() < Cell::kDeepest && cells.size() < (1u << 28) &&
           bytes <= task.options.max_memory * kMebi;
}

/// Returns the maximum number of rejected draws before a subdivision.
std::uint64_t patience(const Task& task, const Cells& cells) {
    if (!can_subdivide(task, cells)) return kMaxRejections + std::uint64_t{4} * cells.size();
    // A set without a count ends only if the cells show that no space is left.
    return kTrial + (task.wanted() == 0 ? cells.size() / 4 : std::uint64_t{4} * cells.size());
}

/// Returns whether the missing points cost more at the current rate than with smaller cells.
bool subdividing_pays(const Task& task, const Cells& cells, const DrawCounts& counts, std::size_t placed) {
    const std::uint64_t draws = counts.rejected + counts.accepted;
    if (task.wanted() == 0 || draws < kTrial || !can_subdivide(task, cells)) return false;
    const double for_each =
        static_cast<double>(draws) / static_cast<double>(std::max<std::uint64_t>(1, counts.accepted));
    const double expected = static_cast<double>(task.wanted() - placed) * for_each;
    return counts.accepted == 0 || expected > kSubdividingCost * cells.size();
}

std::size_t round_size(const Task& task, const DrawCounts& counts, std::size_t placed) {
    const auto at_most = [](std::size_t most, std::uint64_t size) {
        return static_cast<std::size_t>(std::min<std::uint64_t>(most, size));
    };
    if (task.kernel.is_soft()) return at_most(kSoftRound, 1 + counts.rejected_in_a_row);
    if (task.wanted() == 0) return kRound;
    // The number of draws for the missing points at the current rate.
    const std::uint64_t missing = task.wanted() - placed, draws = counts.rejected + counts.accepted + 1;
    return at_most(kRound, missing * draws / (counts.accepted + 1) + 1);
}

/// State of one run of the method.
struct Sampling {
    Task task;
    RemainingDensity density;
    Points points;
    CounterRandom random;
    DrawCounts counts;
    Round round;
    std::vector<std::uint64_t> in_shell;  ///< number of points placed in each shell of a law
    std::uint64_t held_back = 0;          ///< number of draws of the round rejected by their shell
    double ahead = 0;                     ///< number of points by which a shell may exceed its share

    /// Returns whether the shell of a point currently exceeds its share of all points.
    bool is_shell_ahead(std::size_t shell) const {
        const auto all = static_cast<double>(points.placed.size() + 1);
        return static_cast<double>(in_shell[shell]) >= task.law->shares[shell] * all + ahead;
    }
};

/// Evaluates the draws of a range of a round.
void judge(const Sampling& s, IndexRange range, bool density_first, Round& round) {
    const Cells& cells = s.density.cells;
    std::array<std::uint32_t, kRoundGrain> requested;
    std::array<Vec3, kRoundGrain> points;
    std::array<FieldSample, kRoundGrain> samples;
    std::size_t n = 0;
    for (std::size_t k = range.begin; k < range.end; ++k) {
        const Draw draw = round.draws[k];
        const std::uint64_t r = 5 * (s.counts.all + draw.index);
        const Vec3d in(s.random.uniform(r + 1), s.random.uniform(r + 2), s.random.uniform(r + 3));
        const Vec3 p(cells.low(cells[draw.cell]) + cells.edge() * in);
        round.candidates[draw.index] = {p, 0, 0, Candidate::too_near};
        if (!density_first && is_too_near(s.task, s.points, p, s.task.kernel.core())) continue;
        requested[n] = static_cast<std::uint32_t>(k);
        points[n++] = p;
    }
    if (n == 0) return;
    const PointRegion& region = s.task.region;
    region.field.sample(0, std::span(points).first(n), std::span(samples).first(n));
    for (std::size_t i = 0; i < n; ++i) {
        const Draw draw = round.draws[requested[i]];
        const double limit = s.random.uniform(5 * (s.counts.all + draw.index) + 4) * cells[draw.cell].bound;
        const double density = region.contains(points[i]) ? region.density.at(samples[i].value) : 0;
        Candidate& candidate = round.candidates[draw.index];
        candidate.value = samples[i].value;
        candidate.density = density;
        candidate.verdict = limit < density ? Candidate::accepted : Candidate::off_density;
        if (s.task.law != nullptr && limit < density &&
            is_too_near(s.task, s.points, points[i], s.task.core(density)))
            candidate.verdict = Candidate::too_near;
    }
}

void draw_candidates(Sampling& s, std::size_t count, const Context& ctx) {
    Round& round = s.round;
    round.draws.resize(count);
    round.candidates.resize(count);
    parallel_for(ctx, count, kRoundGrain, [&](std::size_t i) {
        round.draws[i] = {s.density.sums.find(s.random.uniform(5 * (s.counts.all + i))),
                          static_cast<std::uint32_t>(i)};
    });
    // Fields evaluate neighbours fast.
    if (count > kSoftRound) {
        const auto bits = static_cast<unsigned>(std::bit_width(s.density.cells.size()));
        radix_sort(ctx, round.draws, bits, [](const Draw& d) { return d.cell; });
    }
    // If few draws are accepted by the density, it is the faster test; otherwise the distance to other
    // points.
    const bool density_first = s.task.law != nullptr || s.counts.evaluated > 4 * s.counts.accepted_by_density;
    parallel_for_ranges(ctx, count, kRoundGrain,
                        [&](IndexRange range) { judge(s, range, density_first, round); });
}

void place(Sampling& s, Vec3 p, double core) {
    s.counts.rejected_in_a_row = 0;
    ++s.counts.accepted;
    s.points.placed.push_back(p);
    if (s.task.law != nullptr) s.points.cores.push_back(core);
    if (s.task.kernel.core() > 0) s.points.grid.insert(p);
    apply_kernel(s.task, p, core, s.density);
}

/// Places a candidate unless points placed earlier in the round are too close, or its shell exceeds its
/// share.
bool try_to_place(Sampling& s, const Candidate& candidate) {
    if (candidate.verdict != Candidate::accepted) return false;
    const double core = s.task.core(candidate.density);
    if (s.task.law == nullptr) {
        if (is_too_near(s.task, s.points, candidate.position, core)) return false;
    } else {
        const std::size_t shell = s.task.law->shell(candidate.value);
        if (is_too_near(s.task, s.points, candidate.position, core)) return false;
        if (s.is_shell_ahead(shell)) {
            ++s.held_back;
            return false;
        }
        ++s.in_shell[shell];
    }
    place(s, candidate.position, core);
    return true;
}

/// Draws a round of points and places those that are not rejected, in order.
///
/// Cells covered by a point of the round may still be drawn in it, but all their points are rejected as too
/// close: the points have the same distribution as if each was drawn from the density remaining after the
/// previous one. This is not true for a soft kernel, so that its rounds end with the first point placed.
void place_round(Sampling& s, const Context& ctx) {
    const std::size_t count = round_size(s.task, s.counts, s.points.placed.size());
    draw_candidates(s, count, ctx);
    const std::size_t before = s.points.placed.size();
    s.held_back = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Candidate& candidate = s.round.candidates[i];
        ++s.counts.all;
        s.counts.evaluated += candidate.verdict != Candidate::too_near;
        s.counts.accepted_by_density += candidate.verdict == Candidate::accepted;
        if (!try_to_place(s, candidate)) {
            ++s.counts.rejected;
            ++s.counts.rejected_in_a_row;
            continue;
        }
        if (s.task.kernel.is_soft() || s.points.placed.size() == s.task.wanted()) return;
    }
    // A full shell must not block the others.
    constexpr std::uint64_t kMaxHeldBack = 4;  // per placed point
    if (s.held_back > kMaxHeldBack * (s.points.placed.size() - before)) s.ahead *= 1.25;
}

bool subdivide(Sampling& s, const Context& ctx) {
    if (!can_subdivide(s.task, s.density.cells)) return false;
    s.density.cells.subdivide(
        s.task.region, [&](const Cell& cell) { return covered_parts(s.task, s.density, s.points, cell); },
        ctx);
    s.density.sums = compute_sums(s.density.cells, ctx);
    s.counts.rejected = s.counts.accepted = s.counts.evaluated = s.counts.accepted_by_density = 0;
    return true;
}

/// Progress of a run, from the number of points or from the consumed density.
class Progress {
  public:
    Progress(const Sampling& s, const Context& ctx) : s_(s), ctx_(ctx), whole_(s.density.sums.total()) {}
    void check_in() {
        ctx_.throw_if_cancelled();
        const auto wanted = static_cast<double>(s_.task.wanted());
        const double done = wanted > 0 ? static_cast<double>(s_.points.placed.size()) / wanted
                                       : 1 - s_.density.sums.total() / whole_;
        done_ = std::max(done_, static_cast<float>(done));
        ctx_.report(done_);
    }

  private:
    const Sampling& s_;
    const Context& ctx_;
    double whole_;
    float done_ = 0;
};

Sampling begin_sampling(const Task& task, const PointSet& existing, std::optional<Cells> surveyed,
                        const Context& ctx) {
    Cells cells = make_cells(task, std::move(surveyed), ctx);
    check_work(task, cells, existing.size());
    SumPyramid sums = compute_sums(cells, ctx);
    Sampling s{.task = task,
               .density = {std::move(cells), std::move(sums), {}},
               .points = Points(task, existing, ctx),
               .random = CounterRandom(static_cast<std::uint64_t>(task.options.seed), kStage)};
    for (const Vec3 p : s.points.existing) {
        ctx.throw_if_cancelled();
        apply_kernel(task, p, task.kernel.core(), s.density);
    }
    if (task.law == nullptr) return s;
    constexpr double kAhead = 0.01;  // [share of a shell]
    s.in_shell.assign(task.law->shares.size(), 0);
    s.ahead = 1 + kAhead * static_cast<double>(task.options.count) / static_cast<double>(s.in_shell.size());
    return s;
}

DartThrowingResult sample(const Task& task, const PointSet& existing, std::optional<Cells> surveyed,
                          const Context& ctx) {
    Sampling s = begin_sampling(task, existing, std::move(surveyed), ctx);
    Progress progress(s, ctx);
    DartThrowingResult result;
    while (task.wanted() == 0 || s.points.placed.size() < task.wanted()) {
        const Cells& cells = s.density.cells;
        if (!(s.density.sums.total() > 0)) {
            result.stop = PointStop::full;
            break;
        }
        progress.check_in();
        const bool hopeless = s.counts.rejected_in_a_row > kMaxInARow;
        if (hopeless || s.counts.rejected > patience(task, cells) ||
            subdividing_pays(task, cells, s.counts, s.points.placed.size())) {
            if (!hopeless && subdivide(s, ctx)) continue;
            result.stop = cells.level() == Cell::kDeepest ? PointStop::full : PointStop::stalled;
            break;
        }
        place_round(s, ctx);
    }
    ctx.report(1);
    const auto least = std::ranges::min_element(s.points.cores);
    // Rounded down, so that the float does not exceed the exact distance.
    const double kept = least == s.points.cores.end() ? task.kernel.core() : *least;
    result.distance = static_cast<float>(kept);
    if (result.distance > kept) result.distance = std::nextafter(result.distance, 0.0f);
    result.points.positions = std::move(s.points.placed);
    result.tries = s.counts.all;
    return result;
}

}  // namespace

std::size_t DensityLaw::shell(float value) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(limits, value) - limits.begin());
}

DensityLaw density_law(const Capacity& capacity, std::size_t shells) {
    std::vector<Capacity::Met> met = capacity.met;
    std::ranges::sort(met, {}, &Capacity::Met::value);
    double whole = 0;
    for (const Capacity::Met& m : met) whole += m.density;
    DensityLaw law{whole / static_cast<double>(met.size()), {}, {0}};
    for (std::size_t i = 0; i < met.size(); ++i) {
        // Equal values are in one shell.
        const bool begins = i > 0 && met[i].value > met[i - 1].value;
        if (begins && law.shares.back() * static_cast<double>(shells) >= 1 - 1e-9) {
            law.limits.push_back(met[i].value);
            law.shares.push_back(0);
        }
        law.shares.back() += met[i].density / whole;
    }
    return law;
}

DartThrowingResult sample_lane_in_cells(const PointRegion& region, const RadialKernel& kernel,
                                        const DartThrowingOptions& options, const DensityLaw& law,
                                        Cells surveyed, const Context& ctx) {
    return sample({region, kernel, options, kernel.is_soft() ? nullptr : &law}, {}, std::move(surveyed), ctx);
}

}  // namespace points_internal

DartThrowingResult sample_dart_throwing(const PointRegion& region, const RadialKernel& kernel,
                                        const PointSet& existing, const DartThrowingOptions& options,
                                        const Context& ctx) {
    check_fields(options, "points");
    points_internal::check_box(region.box);
    if (options.count == 0 && !(kernel.core() > 0)) {
        throw InvalidInput("points: a count of 0 fills the solid, which needs a distance above 0");
    }
    return points_internal::sample({region, kernel, options}, existing, std::nullopt, ctx);
}

DartThrowingResult sample_dart_throwing(const PointRegion& region, const RadialKernel& kernel,
                                        const DartThrowingOptions& options, const Context& ctx) {
    return sample_dart_throwing(region, kernel, PointSet{}, options, ctx);
}

void list_fields(DartThrowingOptions& o, FieldList& list) {
    list.add(Field{"count", "Number of points to place; 0 places as many as fit.", Unit::none, 0, 1e8},
             o.count);
    list.add(
        Field{"resolution", "Number of voxels along the longest side of the box; 0 chooses it automatically.",
              Unit::none, 0, 2048},
        o.resolution);
    list.add(Field{"max_factor", "Maximum factor of the density by the kernels of all points together.",
                   Unit::none, 1, 1e6},
             o.max_factor);
    list.add(Field{"seed", "Seed of the random points.", Unit::none, 0, 2147483647}, o.seed);
    list.add(Field{"max_memory", "Maximum memory in MiB.", Unit::none, 1, 1e6}, o.max_memory);
}

}  // namespace coppice
