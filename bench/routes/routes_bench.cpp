#include "routes_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "clock.h"
#include "coppice/measure/axes.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/png.h"
#include "coppice/render/render.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/system/file.h"
#include "machine.h"

namespace coppice::bench {
namespace {

constexpr int kMinRuns = 2;

/// Result of one run of a route.
struct Made {
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
    PolygonMesh mesh;  ///< only if requested; conversion is not included in the seconds
    std::uint64_t faces = 0, tetrahedra = 0, sampled = 0;
    std::vector<std::pair<std::string, double>> stages;
};
using Make = std::function<Made(bool want_mesh)>;

MeshOptions round_options(MeshMethod method) {
    MeshOptions options;
    options.method = method;
    options.control.base = BaseShape::round;
    return options;
}

MeshOptions tetra_options(double edge, int levels = TetraOptions{}.march.levels) {
    MeshOptions options = round_options(MeshMethod::tetrahedra);
    options.tetra.edge = static_cast<float>(edge);
    options.tetra.march.levels = levels;
    return options;
}

Make by_skeleton(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx) {
    return [&skeleton, options, &ctx](bool want_mesh) {
        const Clock clock;
        const MeshResult result = mesh_skeleton(skeleton, options, ctx);
        Made made{.seconds = clock.seconds(), .peak_bytes = peak_resident_bytes()};
        if (const auto* const quads = std::get_if<QuadSurface>(&result.surface)) {
            made.faces = quads->mesh.quads.size();
        } else {
            made.faces = result.tetrahedra().mesh.triangles.size();
            made.tetrahedra = result.tetrahedra().march.tetra;
            made.sampled = result.tetrahedra().march.vertices;
        }
        made.stages = result.stages;
        if (want_mesh) made.mesh = to_polygons(result);
        return made;
    };
}

Make by_grid(const Skeleton& skeleton, const Grid& grid, const Context& ctx) {
    return [&skeleton, grid, &ctx](bool want_mesh) {
        const Clock clock;
        GridResult result = mesh_by_grid(skeleton, grid, tetra_options(TetraOptions{}.edge), ctx);
        Made made{.seconds = clock.seconds(), .peak_bytes = peak_resident_bytes()};
        made.faces = result.surface.triangles.size();
        made.sampled = grid.corners();
        made.stages = result.stages;
        if (want_mesh) {
            result.surface.origin = skeleton.origin();
            made.mesh = to_polygons(result.surface);
        }
        return made;
    };
}

void draw(const PolygonMesh& mesh, const std::filesystem::path& file, const Context& ctx) {
    constexpr int kSize = 640;
    constexpr int kSamples = 16;
    write_file(file,
               encode_png(render({.mesh = &mesh, .skeleton = nullptr, .deviation = {}},
                                 {.camera = {.width = kSize, .height = kSize}, .samples = kSamples}, ctx)));
}

/// Executes an untimed run, which determines memory and figures, then the timed ones.
class Bench {
  public:
    Bench(const Scene& scene, const RoutesOptions& options, const Context& ctx)
        : scene_(scene), options_(options), ctx_(ctx) {
        out_.scene = scene.name;
        out_.segments = scene.skeleton.size() - scene.skeleton.tree_count();
    }

    RouteResult& measure(const std::string& name, double size, const Make& make) {
        RouteResult route;
        route.name = name;
        route.size = size;
        look_at(make, route);
        time(make, route);
        out_.routes.push_back(std::move(route));
        return out_.routes.back();
    }

    RouteResult& measure_grid(const std::string& name, const Grid& grid) {
        return measure(name, grid.cell, by_grid(scene_.skeleton, grid, ctx_));
    }

    void add_brute_force(RouteResult& route, const Grid& grid) {
        route.brute = time_brute_force(scene_.skeleton, grid, tetra_options(TetraOptions{}.edge),
                                       options_.brute_seconds, ctx_);
    }

    RoutesResult take() { return std::move(out_); }

  private:
    void look_at(const Make& make, RouteResult& route) {
        reset_peak();
        const std::size_t before = resident_bytes();
        const Made made = make(true);
        route.peak_bytes = made.peak_bytes > before ? made.peak_bytes - before : 0;
        route.tetrahedra = made.tetrahedra;
        route.sampled = made.sampled;
        route.figures = compute_figures(made.mesh, scene_.skeleton, ctx_);
        if (!options_.pictures.empty()) {
            draw(made.mesh, options_.pictures / file_name(fmt::format("{} {}.png", scene_.name, route.name)),
                 ctx_);
        }
    }

    void time(const Make& make, RouteResult& route) {
        Measures measures(route.measures);
        const Clock budget;
        for (int run = 0; run < std::max(options_.repeat, 1); ++run) {
            if (run >= kMinRuns && budget.seconds() > options_.seconds) break;
            const Made made = make(false);
            measures.add("all", made.seconds);
            std::vector<Measure> parts;
            // A stage that is executed several times counts as one.
            Measures sums(parts);
            for (const auto& [stage, part] : made.stages) sums.add(stage, part);
            for (const Measure& m : parts) {
                double sum = 0;
                for (const double s : m.samples) sum += s;
                measures.add(m.name, sum);
            }
        }
    }

    static std::string file_name(std::string name) {
        std::erase(name, ',');
        std::replace(name.begin(), name.end(), ' ', '_');
        return name;
    }

    const Scene& scene_;
    const RoutesOptions& options_;
    const Context& ctx_;
    RoutesResult out_;
};

/// Returns the size of edges or cells with about `target` faces: their number is inversely proportional to
/// its square, but changes in steps if cells can only be halved. The best of a few trials.
double size_for(double target, double size, const std::function<std::uint64_t(double)>& count) {
    constexpr int kTrials = 8;
    constexpr double kNear = 0.01, kMaxStep = 4;
    double too_small = 0, too_large = std::numeric_limits<double>::infinity();
    double best = size, best_error = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < kTrials && best_error > kNear; ++trial) {
        const double ratio = static_cast<double>(std::max<std::uint64_t>(count(size), 1)) / target;
        if (std::abs(std::log(ratio)) < best_error) {
            best_error = std::abs(std::log(ratio));
            best = size;
        }
        (ratio > 1 ? too_small : too_large) = size;
        size *= std::clamp(std::sqrt(ratio), 1 / kMaxStep, kMaxStep);
        if (size <= too_small || size >= too_large) size = std::sqrt(too_small * too_large);
    }
    return best;
}

/// Returns the cell size of a grid with about this number of triangles.
double cell_for(std::uint64_t triangles, const Scene& scene, const Context& ctx) {
    const Vec3 size = scene.skeleton.bounds().size();
    constexpr double kFirst = 200;  // cells along the longest side
    return size_for(static_cast<double>(triangles), std::max({size.x, size.y, size.z}) / kFirst,
                    [&](double cell) {
                        const Grid grid = box_about(scene.skeleton, static_cast<float>(cell));
                        return by_grid(scene.skeleton, grid, ctx)(false).faces;
                    });
}

/// Returns the edge at which tetrahedra subdivided `levels` times have about this number of triangles.
double edge_for(std::uint64_t triangles, const Skeleton& skeleton, int levels, const Context& ctx) {
    return size_for(static_cast<double>(triangles), TetraOptions{}.edge, [&](double edge) {
        return by_skeleton(skeleton, tetra_options(edge, levels), ctx)(false).faces;
    });
}

void measure_equal_grid(Bench& bench, const Scene& scene, std::uint64_t triangles, bool brute,
                        const Context& ctx) {
    const Grid grid = box_about(scene.skeleton, static_cast<float>(cell_for(triangles, scene, ctx)));
    RouteResult& route = bench.measure_grid("grid, as many triangles", grid);
    if (brute) bench.add_brute_force(route, grid);
}

}  // namespace

double RouteResult::stage(const std::string& stage_name) const {
    const auto it = std::find_if(measures.begin(), measures.end(),
                                 [&](const Measure& m) { return m.name == stage_name; });
    return it == measures.end() ? 0 : it->median();
}

const RouteResult* RoutesResult::find(const std::string& name) const {
    const auto it =
        std::find_if(routes.begin(), routes.end(), [&](const RouteResult& r) { return r.name == name; });
    return it == routes.end() ? nullptr : &*it;
}

RoutesResult compare_routes(const Scene& scene, const RoutesOptions& options, const Context& ctx) {
    Bench bench(scene, options, ctx);
    const Skeleton& skeleton = scene.skeleton;
    const std::uint64_t quads =
        bench.measure("quads", 0, by_skeleton(skeleton, round_options(MeshMethod::quads), ctx))
            .figures.faces();
    const double edge = TetraOptions{}.edge;
    const std::uint64_t triangles =
        bench.measure("tetrahedra", edge, by_skeleton(skeleton, tetra_options(edge), ctx)).figures.faces();
    constexpr int kLevels = 2;
    const double as_quads = edge_for(2 * quads, skeleton, kLevels, ctx);
    bench.measure(fmt::format("tetrahedra, {} levels, as fine as quads", kLevels), as_quads,
                  by_skeleton(skeleton, tetra_options(as_quads, kLevels), ctx));
    measure_equal_grid(bench, scene, triangles, false, ctx);
    return bench.take();
}

RoutesResult compare_paper(const PaperTree& tree, const RoutesOptions& options, const Context& ctx) {
    constexpr std::uint64_t kSeed = 1;
    const std::uint32_t shrink = options.shrink;
    const Scene scene{tree.name, random_tree(tree.segments / (shrink * shrink), kSeed)};
    Bench bench(scene, options, ctx);
    // The triangles of the papers are small compared with the radius: many levels then waste little.
    constexpr int kLevels = 3;
    const double edge = edge_for(tree.tetrahedra.triangles / (shrink * shrink), scene.skeleton, kLevels, ctx);
    const std::uint64_t triangles =
        bench.measure("tetrahedra", edge, by_skeleton(scene.skeleton, tetra_options(edge, kLevels), ctx))
            .figures.faces();
    for (const PrintedGrid& printed : tree.grids) {
        const Grid grid = cube_about(scene.skeleton, printed.resolution / shrink);
        RouteResult& route =
            bench.measure_grid(fmt::format("grid {0} x {0} x {0}", printed.resolution), grid);
        bench.add_brute_force(route, grid);
    }
    measure_equal_grid(bench, scene, triangles, !tree.grids.empty(), ctx);
    if (!tree.quads.empty()) {
        bench.measure("quads", 0, by_skeleton(scene.skeleton, round_options(MeshMethod::quads), ctx));
    }
    return bench.take();
}

RoutesResult compare_twigs(const Scene& scene, const RoutesOptions& options, const Context& ctx) {
    constexpr double kFirst = 3, kStep = 1.25, kLast = 0.2;  // [radii of the thinnest twig]
    Bench bench(scene, options, ctx);
    const Skeleton& skeleton = scene.skeleton;
    const double edge = TetraOptions{}.edge;
    bench.measure("tetrahedra", edge, by_skeleton(skeleton, tetra_options(edge), ctx));
    const auto radii = skeleton.radii();
    const double thinnest = *std::min_element(radii.begin(), radii.end());
    for (double cells = kFirst; cells > kLast; cells /= kStep) {
        const Grid grid = box_about(skeleton, static_cast<float>(cells * thinnest));
        const Made made = by_grid(skeleton, grid, ctx)(true);
        const ConeUnion solid(skeleton, made.mesh.origin, EndShape::flat, EndShape::round, ctx);
        if (judge_axes(made.mesh, skeleton, solid, EndShape::round, ctx).report.severed > 0) continue;
        bench.add_brute_force(bench.measure_grid("grid that shows all twigs", grid), grid);
        break;
    }
    return bench.take();
}

}  // namespace coppice::bench
