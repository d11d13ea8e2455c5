#include "scene_bench.h"

#include <fmt/format.h>

#include <algorithm>

#include "clock.h"
#include "coppice/base/hash.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/png.h"
#include "coppice/render/render.h"
#include "machine.h"
#include "opensubdiv.h"

namespace coppice::bench {
namespace {

constexpr int kMinRuns = 3;
constexpr int kFileRuns = 3;
constexpr int kPictureSize = 1024;  // [pixels]

std::uint64_t compute_hash(const QuadMesh& mesh) {
    return Hash().add(std::span<const Vec3>(mesh.positions)).add(std::span<const Quad>(mesh.quads)).value();
}

QuadMesh measure_memory(const Scene& scene, const MeshOptions& options, const Context& ctx,
                        SceneResult& out) {
    reset_peak();
    const std::size_t before = resident_bytes();
    QuadSurface surface = std::move(mesh_skeleton(scene.skeleton, options, ctx).quads());
    const std::size_t peak = peak_resident_bytes();
    out.peak_bytes = peak > before ? peak - before : 0;
    out.cage_quads = surface.cage.cage.quads.size();
    out.quads = surface.mesh.quads.size();
    out.vertices = surface.mesh.positions.size();
    out.hash = compute_hash(surface.mesh);
    time_opensubdiv(surface.cage.cage, options.levels);
    return std::move(surface.mesh);
}

void measure_meshing(const Scene& scene, const MeshOptions& options, const BenchOptions& bench,
                     const Context& ctx, Measures& measures, std::uint64_t hash) {
    const Clock budget;
    for (int run = 0; run < bench.repeat && (run < kMinRuns || budget.seconds() < bench.seconds); ++run) {
        const Clock clock;
        const MeshResult result = mesh_skeleton(scene.skeleton, options, ctx);
        measures.add("mesh", clock.seconds());
        for (const auto& [stage, seconds] : result.stages) measures.add("mesh: " + stage, seconds);
        if (compute_hash(result.quads().mesh) != hash) {
            throw Error(fmt::format("two runs of the scene {} gave different meshes", scene.name));
        }
        const OpenSubdivTime time = time_opensubdiv(result.quads().cage.cage, options.levels);
        measures.add("opensubdiv", time.total());
        measures.add("opensubdiv: topology", time.topology);
        measures.add("opensubdiv: points", time.points);
    }
}

void measure_output(const QuadMesh& mesh, const BenchOptions& bench, const Context& ctx, Measures& measures) {
    for (const char* ending : {"ply", "obj"}) {
        const std::filesystem::path file = bench.folder / fmt::format("coppice_bench.{}", ending);
        write_mesh(file, mesh, {}, ctx);
        for (int run = 0; run < std::min(kFileRuns, bench.repeat); ++run) {
            measures.time(fmt::format("write {}", ending), [&] { write_mesh(file, mesh, {}, ctx); });
        }
        std::filesystem::remove(file);
    }
    const RenderOptions options{.camera = {.width = kPictureSize, .height = kPictureSize},
                                .samples = bench.samples};
    measures.time("render", [&] {
        const PolygonMesh polygons = to_polygons(mesh);
        encode_png(render({.mesh = &polygons, .skeleton = nullptr, .deviation = {}}, options, ctx));
    });
}

}  // namespace

const Measure* SceneResult::find(const std::string& name) const {
    const auto it =
        std::find_if(measures.begin(), measures.end(), [&](const Measure& m) { return m.name == name; });
    return it == measures.end() ? nullptr : &*it;
}

double SceneResult::microseconds_per_segment() const {
    return find("mesh")->median() * 1e6 / static_cast<double>(std::max<std::uint64_t>(1, segments));
}

double SceneResult::ratio_to_opensubdiv() const {
    return find("mesh")->median() / find("opensubdiv")->median();
}

SceneResult bench_scene(const Scene& scene, const BenchOptions& options, const Context& ctx) {
    SceneResult out;
    out.scene = scene.name;
    out.segments = scene.skeleton.size() - scene.skeleton.tree_count();
    MeshOptions mesh_options;
    mesh_options.levels = options.levels;
    Measures measures(out.measures);
    const QuadMesh mesh = measure_memory(scene, mesh_options, ctx, out);
    measure_meshing(scene, mesh_options, options, ctx, measures, out.hash);
    if (out.quads <= options.largest_output) measure_output(mesh, options, ctx, measures);
    return out;
}

}  // namespace coppice::bench
