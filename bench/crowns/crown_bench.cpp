#include "crown_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/implicit/polygonize/cached_field.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/points/sampling/generate.h"
#include "crown_scenes.h"
#include "machine.h"

namespace coppice::bench {
namespace {

constexpr int kMinRuns = 3;

/// Result of a run, for comparison with other runs.
struct Outcome {
    std::uint64_t size = 0;
    std::uint64_t hash = 0;
};

Outcome make_outcome(const PointSet& points) {
    return {points.size(), Hash().add(std::span<const Vec3>(points.positions)).value()};
}

Outcome make_outcome(const Skeleton& s) {
    return {s.size(), Hash().add(s.parents()).add(s.positions()).value()};
}

/// A run measures its work as "all", and its stages if it has any, and returns its result.
using Run = std::function<Outcome(Measures&)>;

class Bench {
  public:
    Bench(const CrownOptions& options, const Context& ctx) : options_(options), ctx_(ctx) {}

    void row(CrownResult row, const Run& run) {
        if (row.what.find(options_.only) == std::string::npos) return;
        fmt::print(stderr, "{} ...\n", row.what);
        measure(row, run);
        rows_.push_back(std::move(row));
    }
    bool wants(const std::string& word) const {
        return options_.only.empty() || options_.only.find(word) != std::string::npos ||
               word.find(options_.only) != std::string::npos;
    }
    const Context& ctx() const { return ctx_; }
    bool huge() const { return options_.huge; }
    std::vector<CrownResult> take() { return std::move(rows_); }

  private:
    void measure(CrownResult& row, const Run& run) {
        const Clock budget;
        reset_peak();
        const std::size_t before = resident_bytes();
        Measures measures(row.measures);
        const Outcome expected = run(measures);
        const std::size_t peak = peak_resident_bytes();
        row.peak_bytes = peak > before ? peak - before : 0;
        row.size = expected.size;
        row.hash = expected.hash;
        if (row.seconds() > options_.seconds) return;
        row.measures.clear();  // the first run was a warm-up
        for (int i = 0; i < options_.repeat && (i < kMinRuns || budget.seconds() < options_.seconds); ++i) {
            if (run(measures).hash != expected.hash) {
                throw Error(fmt::format("two runs of '{}' gave different results", row.what));
            }
        }
    }

    const CrownOptions& options_;
    const Context& ctx_;
    std::vector<CrownResult> rows_;
};

/// The shell of the thesis: field values from 0.40 to 0.41, just outside the surface at 0.5.
DensityCurve thin_shell() { return DensityCurve({{0.40f, 1}, {0.41f, 1}}); }

template <class Field>
PointSet boundary_points(const Field& field, const Box3& box, const Context& ctx) {
    GenerateOptions options;
    options.count = 1000;
    return generate(PointRegion{FieldRef(field), box, thin_shell()}, options, ctx).points;
}

void bench_boundary(Bench& bench) {
    const Solid solid = crown_blob_tree();
    const CrownResult row{.what = {}, .goal = "<= 20 ms", .baseline = "8.67 s (thesis)", .unit = "points"};
    CrownResult cached = row, plain = row;
    cached.what = "1,000 Poisson disks at the boundary, cached";
    bench.row(cached, [&](Measures& stages) {
        const Clock clock;
        const SolidField field(solid);
        const CachedField cache(field, {.cell = 0.25f, .band = 0.11f}, bench.ctx());
        const double built = clock.seconds();
        const PointSet points = boundary_points(cache, field.bounds_at(0.4f), bench.ctx());
        stages.add("all", clock.seconds());
        stages.add("cache", built);
        stages.add("points", clock.seconds() - built);
        return make_outcome(points);
    });
    plain.what = "the same, from the field itself";
    plain.goal.clear();
    plain.baseline = "45.01 s (thesis)";
    bench.row(plain, [&](Measures& stages) {
        PointSet points;
        stages.time("all", [&] {
            const SolidField field(solid);
            points = boundary_points(field, field.bounds_at(0.4f), bench.ctx());
        });
        return make_outcome(points);
    });
}

/// Dart throwing: random points of the box in sequence; keeps those in the shell that have no other point
/// within `distance`. The reference method of the thesis.
template <class Field>
PointSet rejected_points(const Field& field, const Box3& box, float distance) {
    constexpr std::size_t kWanted = 1000;
    constexpr std::uint64_t kMaxDraws = 1'000'000'000;
    const CounterRandom random(3, 61);
    const DensityCurve shell = thin_shell();
    PointSet out;
    for (std::uint64_t draw = 0; out.size() < kWanted; ++draw) {
        if (draw == kMaxDraws) throw Error("the box of the shell has no room for so many points");
        Vec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = static_cast<float>(
                random.uniform(3 * draw + static_cast<std::uint64_t>(axis), box.low[axis], box.high[axis]));
        float value = 0;
        field.values(std::span(&p, 1), std::span(&value, 1));
        if (!(shell.at(value) > 0)) continue;
        const auto near = [&](Vec3 q) { return length(p - q) < distance; };
        if (distance > 0 && std::ranges::any_of(out.positions, near)) continue;
        out.positions.push_back(p);
    }
    return out;
}

/// Tables 6.1 and 6.2 of the thesis: points are drawn in the whole box and rejected outside the shell.
void bench_rejection(Bench& bench) {
    const SolidField field(crown_blob_tree());
    const Box3 box = field.bounds_at(0.4f);
    CrownResult row{.what = "1,000 points at the boundary, refused elsewhere in the box",
                    .goal = {},
                    .baseline = "94.7 s (thesis)",
                    .unit = "points"};
    bench.row(row, [&](Measures& stages) {
        PointSet points;
        stages.time("all", [&] { points = rejected_points(field, box, 0); });
        return make_outcome(points);
    });
    row.what = "the same, cached";
    row.baseline = "4.1 s (thesis)";
    bench.row(row, [&](Measures& stages) {
        PointSet points;
        stages.time("all", [&] {
            const CachedField cache(field, {.cell = 0.25f, .band = 0.11f}, bench.ctx());
            points = rejected_points(cache, box, 0);
        });
        return make_outcome(points);
    });
    row.what = "1,000 Poisson disks at the boundary, refused elsewhere in the box";
    row.baseline = "145.9 s (thesis)";
    const auto disks = [&] {
        GenerateOptions options;
        options.count = 1000;
        return generate(PointRegion{FieldRef(field), box, thin_shell()}, options, bench.ctx()).distance;
    };
    if (!bench.wants(row.what)) return;
    const float distance = disks();
    bench.row(row, [&](Measures& stages) {
        PointSet points;
        stages.time("all", [&] { points = rejected_points(field, box, distance); });
        return make_outcome(points);
    });
}

void bench_set(Bench& bench, const CrownResult& row, const Solid& solid, const GenerateOptions& options) {
    bench.row(row, [&](Measures& stages) {
        PointSet points;
        stages.time("all", [&] {
            const SolidField field(solid);
            points = generate(FieldRef(field), field.surface_bounds(), options, bench.ctx()).points;
        });
        return make_outcome(points);
    });
}

void bench_sets(Bench& bench) {
    CrownResult row{.what = "1,000,000 uniform points in it", .goal = "<= 1 s", .unit = "points"};
    bench_set(bench, row, crown_blob_tree(), {.pattern = PointPattern::uniform, .count = 1'000'000});
    row.what = "100,000 Poisson disks in a ball";
    row.goal = "<= 2 s";
    bench_set(bench, row, ball(), {.count = 100'000});
    row.what = "the same, at 0.9 of the distance at which no more fit";
    row.goal.clear();
    bench_set(bench, row, ball(), {.count = 100'000, .spacing = 0.9f});
    if (!bench.huge()) return;
    row.what = "Poisson disks in a ball until it is full";
    bench_set(bench, row, ball(), {.count = 0, .distance = 0.15f});
}

/// Returns points of a lattice of 256 per side over a box, in blocks of 4 x 4 x 4, the order in which grids
/// are sampled; only from blocks in which the field is not 0 everywhere.
Buffer<Vec3> lattice_points(const SolidField& field) {
    constexpr std::size_t kSide = 256, kBlock = 4, kBlocks = kSide / kBlock,
                          kPoints = kBlock * kBlock * kBlock;
    const Box3 box = field.bounds();
    const Vec3 cell = box.size() / static_cast<float>(kSide);
    Buffer<Vec3> points;
    std::array<Vec3, kPoints> block;
    std::array<float, kPoints> values;
    for (std::size_t b = 0; b < kBlocks * kBlocks * kBlocks; ++b) {
        for (std::size_t i = 0; i < kPoints; ++i) {
            const auto along = [&](std::size_t place, std::size_t in) {
                return static_cast<float>(kBlock * (place % kBlocks) + in % kBlock) + 0.5f;
            };
            block[i] = box.low + Vec3{cell.x * along(b, i), cell.y * along(b / kBlocks, i / kBlock),
                                      cell.z * along(b / kBlocks / kBlocks, i / kBlock / kBlock)};
        }
        field.values(block, values);
        if (*std::max_element(values.begin(), values.end()) > 0)
            points.insert(points.end(), block.begin(), block.end());
    }
    return points;
}

/// Returns the same points in random order.
Buffer<Vec3> scattered(Buffer<Vec3> points) {
    const CounterRandom random(1, 2);
    for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random.bits(i) % i]);
    return points;
}

void bench_field(Bench& bench) {
    constexpr std::size_t kGrain = 4096;
    const SolidField field(crown_blob_tree());
    if (!bench.wants("field values")) return;
    const Buffer<Vec3> points = lattice_points(field), mixed = scattered(points);
    const auto over = [&](const Buffer<Vec3>& at, auto& out, const auto& evaluate) {
        parallel_for_ranges(bench.ctx(), at.size(), kGrain, [&](IndexRange r) {
            evaluate(std::span<const Vec3>(at).subspan(r.begin, r.size()),
                     std::span(out).subspan(r.begin, r.size()));
        });
    };
    Buffer<float> values(points.size());
    CrownResult row{.what = "field values of that BlobTree", .goal = ">= 20 million/s", .unit = "values"};
    bench.row(row, [&](Measures& stages) -> Outcome {
        stages.time("all", [&] { over(points, values, [&](auto p, auto out) { field.values(p, out); }); });
        return {points.size(), Hash().add(std::span<const float>(values)).value()};
    });
    row.what = "field values at scattered points";
    row.goal.clear();
    bench.row(row, [&](Measures& stages) -> Outcome {
        stages.time("all", [&] { over(mixed, values, [&](auto p, auto out) { field.values(p, out); }); });
        return {points.size(), Hash().add(std::span<const float>(values)).value()};
    });
    Buffer<FieldSample> samples(points.size());
    row.what = "field values and gradients";
    bench.row(row, [&](Measures& stages) -> Outcome {
        stages.time("all",
                    [&] { over(points, samples, [&](auto p, auto out) { field.sample(0, p, out); }); });
        return {points.size(), Hash().add(std::span<const FieldSample>(samples)).value()};
    });
}

void bench_growth(Bench& bench, std::size_t count, const CrownResult& row) {
    if (!bench.wants(row.what)) return;
    const PointSet points = ellipsoid_points(count, bench.ctx());
    bench.row(row, [&](Measures& stages) {
        std::optional<GrowResult> grown;
        stages.time("all", [&] { grown = grow_in_ellipsoid(points, bench.ctx()); });
        return make_outcome(grown->skeleton);
    });
}

Outcome mesh_crown(Measures& stages, const Context& ctx) {
    PointSet points;
    std::optional<Skeleton> skeleton;
    QuadMesh mesh;
    stages.time("all", [&] {
        stages.time("points", [&] { points = ellipsoid_points(12000, ctx); });
        stages.time("grow", [&] { skeleton = grow_in_ellipsoid(points, ctx).skeleton; });
        stages.time("radii and tidy", [&] { skeleton = dressed(*skeleton, ctx); });
        stages.time("mesh", [&] { mesh = std::move(mesh_skeleton(*skeleton, {}, ctx).quads().mesh); });
    });
    return {skeleton->size() - skeleton->tree_count(),
            Hash().add(std::span<const Vec3>(mesh.positions)).value()};
}

}  // namespace

std::vector<CrownResult> bench_crowns(const CrownOptions& options, const Context& ctx) {
    Bench bench(options, ctx);
    bench_boundary(bench);
    bench_rejection(bench);
    bench_sets(bench);
    bench_field(bench);
    bench_growth(bench, 12000,
                 {.what = "growth, 12,000 attractors",
                  .goal = "<= 0.25 s",
                  .baseline = "0.56 s plain grid; 91 s infinigen",
                  .unit = "nodes"});
    if (bench.huge()) {
        bench_growth(bench, 1'000'000,
                     {.what = "growth, 1,000,000 attractors",
                      .goal = "<= 40 s, <= 2 GiB",
                      .baseline = {},
                      .unit = "nodes"});
    }
    bench.row({.what = "crown to closed mesh", .goal = "<= 1 s", .baseline = {}, .unit = "segments"},
              [&](Measures& stages) { return mesh_crown(stages, ctx); });
    return bench.take();
}

}  // namespace coppice::bench
