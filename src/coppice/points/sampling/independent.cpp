#include "coppice/points/sampling/independent_internal.h"

#include <fmt/format.h>

#include <bit>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"

namespace coppice::points_internal {
namespace {

constexpr std::uint64_t kUniformStage = 0x756e69, kJitterStage = 0x6a6974;
constexpr std::size_t kRound = std::size_t{1} << 20;  // maximum number of candidates of a round
constexpr std::size_t kBatch = 256;                   // number of points per call of the field

struct Candidate {
    std::uint32_t cell;
    std::uint32_t index;  ///< in the round
};

/// Appends the accepted points in order, at most `most` of them.
void append_accepted(const Buffer<Vec3>& points, const Buffer<std::uint8_t>& accepted, std::size_t most,
                     Buffer<Vec3>& out) {
    for (std::size_t i = 0; i < points.size() && most > 0; ++i) {
        if (accepted[i] == 0) continue;
        out.push_back(points[i]);
        --most;
    }
}

/// Evaluates the field in batches: place(k) returns the k-th point, keep(k, point, density) receives its
/// density.
template <class Place, class Keep>
void evaluate(const PointRegion& region, std::size_t count, const Context& ctx, const Place& place,
              const Keep& keep) {
    parallel_for_ranges(ctx, count, kBatch, [&](IndexRange range) {
        std::array<Vec3, kBatch> points;
        std::array<FieldSample, kBatch> samples;
        const std::size_t n = range.size();
        for (std::size_t k = 0; k < n; ++k) points[k] = place(range.begin + k);
        region.field.sample(0, std::span(points).first(n), std::span(samples).first(n));
        for (std::size_t k = 0; k < n; ++k) {
            const double density = region.contains(points[k]) ? region.density.at(samples[k].value) : 0;
            keep(range.begin + k, points[k], density);
        }
    });
}

}  // namespace

double independent_bytes(double count) {
    const double round = std::min(2 * count + 4096, static_cast<double>(kRound));
    return 2 * count * sizeof(Vec3) + round * (2 * sizeof(Candidate) + sizeof(Vec3) + 1);
}

Draws draw_independent(const PointRegion& region, const Cells& cells, std::size_t count, std::uint64_t seed,
                       const Context& ctx) {
    const CounterRandom random(seed, kUniformStage);
    const CellSums sums(cells);
    const unsigned bits = static_cast<unsigned>(std::bit_width(cells.size()));
    Draws draws;
    draws.points.reserve(count);
    Buffer<Candidate> candidates;
    Buffer<Vec3> points;
    Buffer<std::uint8_t> accepted;
    while (draws.points.size() < count) {
        ctx.throw_if_cancelled();
        const std::size_t missing = count - draws.points.size();
        // The number required at the current acceptance rate, and a few more.
        const double share = draws.tries == 0 ? 1
                                              : std::max(0.001, static_cast<double>(draws.points.size()) /
                                                                    static_cast<double>(draws.tries));
        const double wanted = static_cast<double>(missing) / share * 1.02 + 1024;
        const auto round = static_cast<std::size_t>(std::min(wanted, static_cast<double>(kRound)));
        const std::uint64_t before = draws.tries;
        candidates.resize(round);
        points.resize(round);
        accepted.resize(round);
        parallel_for(ctx, round, std::size_t{1} << 12, [&](std::size_t i) {
            candidates[i] = {sums.find(random.uniform(5 * (before + i))), static_cast<std::uint32_t>(i)};
        });
        radix_sort(ctx, candidates, bits, [](const Candidate& c) { return c.cell; });
        evaluate(
            region, round, ctx,
            [&](std::size_t k) {
                const Candidate c = candidates[k];
                const std::uint64_t n = 5 * (before + c.index);
                const Vec3d in(random.uniform(n + 1), random.uniform(n + 2), random.uniform(n + 3));
                return Vec3(cells.low(cells[c.cell]) + cells.edge() * in);
            },
            [&](std::size_t k, Vec3 p, double density) {
                const Candidate c = candidates[k];
                points[c.index] = p;
                const double limit = random.uniform(5 * (before + c.index) + 4) * cells[c.cell].bound;
                accepted[c.index] = limit < density;
            });
        append_accepted(points, accepted, missing, draws.points);
        draws.tries += round;
        ctx.report(static_cast<float>(draws.points.size()) / static_cast<float>(count));
        if (draws.tries > 64 * kRound && draws.points.size() < draws.tries / 10000) break;
    }
    return draws;
}

Draws draw_jittered(const PointRegion& region, const Capacity& capacity, double count, std::uint64_t seed,
                    const Context& ctx) {
    constexpr double kMaxCubes = 2e8;
    const CounterRandom random(seed, kJitterStage);
    const double edge = std::cbrt(capacity.mass / count);
    const Vec3d size(region.box.size());
    std::array<std::uint64_t, 3> n{};
    double cubes = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = std::ceil(size[axis] / edge);
        cubes *= along;
        n[static_cast<std::size_t>(axis)] = static_cast<std::uint64_t>(along);
    }
    if (cubes > kMaxCubes) {
        throw InvalidInput(fmt::format(
            "points: a jittered set of this density has {:.0f} cubes in the box; use another pattern or a "
            "wider shell",
            cubes));
    }
    Draws draws;
    const Vec3d low(region.box.low);
    const auto all = static_cast<std::uint64_t>(cubes);
    Buffer<Vec3> points;
    Buffer<std::uint8_t> accepted;
    for (std::uint64_t begin = 0; begin < all; begin += kRound) {
        ctx.throw_if_cancelled();
        const auto round = static_cast<std::size_t>(std::min<std::uint64_t>(kRound, all - begin));
        points.resize(round);
        accepted.resize(round);
        evaluate(
            region, round, ctx,
            [&](std::size_t k) {
                const std::uint64_t i = begin + k;
                const Vec3d in(random.uniform(4 * i), random.uniform(4 * i + 1), random.uniform(4 * i + 2));
                const std::uint64_t row = i / n[0], layer = row / n[1];
                const Vec3d cube(static_cast<double>(i % n[0]), static_cast<double>(row % n[1]),
                                 static_cast<double>(layer));
                return Vec3(low + edge * (cube + in));
            },
            [&](std::size_t k, Vec3 p, double density) {
                points[k] = p;
                accepted[k] = random.uniform(4 * (begin + k) + 3) * capacity.largest < density;
            });
        append_accepted(points, accepted, round, draws.points);
        draws.tries += round;
        ctx.report(static_cast<float>(begin) / static_cast<float>(all));
    }
    return draws;
}

}  // namespace coppice::points_internal
