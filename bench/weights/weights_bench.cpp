#include "weights_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clock.h"
#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/field/weights/nnls.h"
#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "scenes.h"

namespace coppice::bench {
namespace {

Scene straight_chain() {
    std::vector<NodeId> parent{NodeId{}};
    std::vector<Vec3> position{{0, 0, 0}};
    for (std::uint32_t i = 1; i <= 10; ++i) {
        parent.push_back(NodeId(i - 1));
        position.push_back({0, 0, 3.0f * static_cast<float>(i)});
    }
    return {"chain", Skeleton(parent, position, std::vector<float>(11, 1.0f))};
}

/// Creates five segments of trunk, then two children with 0.8 of its radius, 35 degrees to either side.
Scene even_fork() {
    const float angle = 35 * 3.14159265f / 180, s = std::sin(angle), c = std::cos(angle);
    std::vector<NodeId> parent{NodeId{}};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{1};
    for (std::uint32_t i = 1; i <= 5; ++i) {
        parent.push_back(NodeId(i - 1));
        position.push_back({0, 0, 3.0f * static_cast<float>(i)});
        radius.push_back(1);
    }
    for (const float side : {1.0f, -1.0f}) {
        for (std::uint32_t i = 1; i <= 5; ++i) {
            parent.push_back(i == 1 ? NodeId(5) : NodeId(static_cast<std::uint32_t>(position.size() - 1)));
            const float along = 3.0f * static_cast<float>(i);
            position.push_back({side * along * s, 0, 15 + along * c});
            radius.push_back(0.8f);
        }
    }
    return {"Y", Skeleton(parent, position, radius)};
}

/// Returns deviations of the vertices with a closest point on the nearest segment within a radius of a branch
/// node.
Statistics fork_deviation(const QuadMesh& mesh, const Skeleton& skeleton, const Context& ctx) {
    const CapsuleTree capsules(skeleton, mesh.origin, ctx);
    const auto near_branch = [&](NodeId n, Vec3d closest_point) {
        return skeleton.children(n).size() > 1 &&
               distance(closest_point, Vec3d(skeleton.position(n))) <= skeleton.radius(n);
    };
    std::vector<double> deviation;
    for (const Vec3 v : mesh.positions) {
        const CapsuleTree::Nearest nearest = capsules.nearest(Vec3d(v));
        if (nearest.capsule == kNoIndex) continue;
        const RoundCone& c = capsules.cone(nearest.capsule);
        const Vec3d closest_point = c.point(c.closest_point(Vec3d(v)).t);
        const NodeId child = capsules.node(nearest.capsule);
        if (near_branch(child, closest_point) || near_branch(skeleton.parent(child), closest_point))
            deviation.push_back(nearest.rho - 1);
    }
    return statistics(std::move(deviation));
}

/// Selects every second of the usual constraints in the lower half of them, every twentieth in the upper.
PointSet uneven_constraints(const Skeleton& skeleton, const FieldOptions& field) {
    const std::vector<WeightConstraint> all = surface_constraints(skeleton, field);
    std::vector<float> heights(all.size());
    std::transform(all.begin(), all.end(), heights.begin(), [](const auto& c) { return c.position.z; });
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    PointSet points;
    points.origin = skeleton.origin();
    for (std::size_t j = 0; j < all.size(); ++j)
        if (j % 20 == 0 || (j % 2 == 0 && all[j].position.z < *middle))
            points.positions.push_back(all[j].position);
    return points;
}

WeightsResult measure_weights(const Scene& scene, const std::string& kernel, const std::string& weights,
                              const FieldOptions& field, const PointSet& constraints, int repeat,
                              const Context& ctx) {
    WeightsResult out{.scene = scene.name, .kernel = kernel, .weights = weights};
    out.segments = scene.skeleton.size() - scene.skeleton.tree_count();
    MeshOptions options;
    options.field = field;
    Measures measures(out.measures);
    MeshResult result;
    for (int run = 0; run < repeat; ++run) {
        measures.time("mesh", [&] { result = mesh_skeleton(scene.skeleton, constraints, options, ctx); });
        for (const auto& [stage, seconds] : result.stages)
            if (stage == "weights") measures.add(stage, seconds);
    }
    const GlobalWeights fit =
        result.weights ? *result.weights : global_weights(scene.skeleton, field, {}, ctx);
    const WeightResidual& residual = result.weights ? fit.global : fit.local;
    out.residual_rms = residual.rms;
    out.residual_max = residual.largest;
    if (result.weights) {
        out.constraints = fit.constraints;
        out.zero = fit.zero;
    }
    const SurfaceReport report = check_surface(to_polygons(result.quads().mesh), &scene.skeleton, {}, ctx);
    out.regular = report.radius->regular;
    out.forks = fork_deviation(result.quads().mesh, scene.skeleton, ctx);
    out.missing = report.axes->missing;
    out.severed = report.axes->severed;
    out.crossings = report.intersections->total;
    return out;
}

SparseRows random_matrix(std::size_t rows, std::uint32_t columns) {
    const CounterRandom random(1, 0);
    SparseRows a;
    a.columns = columns;
    for (std::size_t j = 0; j < rows; ++j) {
        for (std::uint32_t i = 0; i < columns; ++i) {
            a.column.push_back(i);
            a.value.push_back(random.uniform(j * columns + i));
        }
        a.first.push_back(a.value.size());
    }
    return a;
}

NnlsTiming time_dense(int repeat, const Context& ctx) {
    const SparseRows a = random_matrix(1548, 300);
    const std::vector<double> b(a.rows(), 1.0);
    NnlsTiming out{.what = "dense, random", .unknowns = a.columns, .rows = a.rows(), .entries = a.entries()};
    NnlsResult solved;
    for (int run = 0; run < repeat; ++run) {
        const Clock clock;
        solved = nnls(a, b, {}, ctx);
        out.measure.samples.push_back(clock.seconds());
    }
    out.pivots = solved.pivots;
    out.zero = static_cast<std::uint64_t>(std::count(solved.x.begin(), solved.x.end(), 0.0));
    return out;
}

NnlsTiming time_tree(const std::string& scene, const std::string& kernel, const FieldOptions& field,
                     int repeat, const Context& ctx) {
    const Skeleton skeleton = make_scene(scene).skeleton;
    NnlsTiming out{.what = fmt::format("{}, {}, with constraints and matrix", scene, kernel)};
    GlobalWeights weights;
    for (int run = 0; run < repeat; ++run) {
        const Clock clock;
        weights = global_weights(skeleton, field, {}, ctx);
        out.measure.samples.push_back(clock.seconds());
    }
    out.unknowns = skeleton.size() - skeleton.tree_count();
    out.rows = weights.constraints;
    out.entries = weights.entries;
    out.pivots = weights.pivots;
    out.zero = weights.zero;
    return out;
}

std::vector<std::pair<std::string, FieldOptions>> kernels() {
    return {{"quartic 1.5", {}}, {"quartic 2", {.support = 2}}, {"Cauchy 2", {.kernel = Kernel::cauchy}}};
}

double compute_median(const WeightsResult& row, std::string_view name) {
    for (const Measure& m : row.measures)
        if (m.name == name) return m.median();
    return 0;
}

Scene find_scene(const std::string& name) {
    if (name == "chain") return straight_chain();
    return name == "Y" ? even_fork() : make_scene(name);
}

}  // namespace

std::vector<WeightsResult> bench_weights(const std::vector<std::string>& scenes, int repeat,
                                         const Context& ctx) {
    std::vector<WeightsResult> rows;
    for (const std::string& name : scenes) {
        const Scene scene = find_scene(name);
        for (const auto& named : kernels()) {
            const auto& kernel = named.second;
            FieldOptions plain = kernel, global = kernel;
            plain.blend = 1;
            global.weights = Weights::global;
            FieldOptions few = global;
            few.constraint_density = 4;
            const auto add = [&](const char* weights, const FieldOptions& field,
                                 const PointSet& constraints) {
                rows.push_back(measure_weights(scene, named.first, weights, field, constraints, repeat, ctx));
            };
            add("local, blend 4", kernel, {});
            add("local, plain sum", plain, {});
            add("global", global, {});
            add("global, 4 points a segment", few, {});
            add("global, uneven", global, uneven_constraints(scene.skeleton, global));
        }
    }
    return rows;
}

std::vector<NnlsTiming> bench_nnls(int repeat, const Context& ctx) {
    std::vector<NnlsTiming> rows{time_dense(repeat, ctx)};
    for (const char* scene : {"tree300", "tree3k", "tree30k"})
        for (const auto& [name, field] : kernels())
            rows.push_back(time_tree(scene, name, field, repeat, ctx));
    return rows;
}

std::string weights_markdown(const std::vector<WeightsResult>& rows) {
    std::string out =
        "| scene | kernel | weights | constraints | zero | residual rms, max | regular mean of absolute, p1, "
        "p99 "
        "| forks mean, mean of absolute, min, p99, max | missing, severed | crossings | weights ms | mesh ms "
        "|\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const WeightsResult& r : rows) {
        out += fmt::format(
            "| {} | {} | {} | {} | {} | {:.3f}, {:.2f} | {:.3f}, {:+.3f}, {:+.3f} | {:+.3f}, {:.3f}, "
            "{:+.2f}, "
            "{:+.2f}, {:+.2f} | {}, {} | {} | {:.2f} | {:.1f} |\n",
            r.scene, r.kernel, r.weights, r.constraints, r.zero, r.residual_rms, r.residual_max,
            r.regular.mean_abs, r.regular.p1, r.regular.p99, r.forks.mean, r.forks.mean_abs, r.forks.min,
            r.forks.p99, r.forks.max, r.missing, r.severed, r.crossings, 1e3 * compute_median(r, "weights"),
            1e3 * compute_median(r, "mesh"));
    }
    return out;
}

std::string nnls_markdown(const std::vector<NnlsTiming>& rows) {
    std::string out =
        "| problem | unknowns | rows | entries | systems solved | zero | seconds |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const NnlsTiming& r : rows)
        out += fmt::format("| {} | {} | {} | {} | {} | {} | {:.4f} |\n", r.what, r.unknowns, r.rows,
                           r.entries, r.pivots, r.zero, r.measure.median());
    return out;
}

}  // namespace coppice::bench
