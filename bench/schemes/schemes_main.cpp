// coppice_schemes_bench: subdivision schemes on a cube, as figure 2 of [Huang2017]; prints Markdown.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "coppice/io_mesh/writer.h"
#include "coppice/measure/smoothness.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "program.h"
#include "schemes.h"

namespace {

using namespace coppice;
using bench::Scheme;

// From -1 to 1 along each axis.
PolygonMesh cube() {
    PolygonMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(
            {(i & 1) != 0 ? 1.0f : -1.0f, (i & 2) != 0 ? 1.0f : -1.0f, (i & 4) != 0 ? 1.0f : -1.0f});
    mesh.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    for (std::uint32_t f = 1; f <= 6; ++f) mesh.first.push_back(4 * f);
    return mesh;
}

// A tree of one node, which is a ball of radius 1, on the same number of levels.
PolygonMesh ball(int levels) {
    MeshOptions options;
    options.levels = levels;
    return to_polygons(mesh_skeleton(Skeleton({NodeId::none()}, {{0, 0, 0}}, {1}), options));
}

// Vertices with irregular numbers of edges, and faces with irregular numbers of corners.
std::string irregular(const PolygonMesh& mesh, std::size_t edges, std::size_t corners) {
    std::vector<std::size_t> valence(mesh.positions.size());
    std::size_t vertices = 0, faces = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        faces += mesh.face(f).size() != corners;
        for (const std::uint32_t v : mesh.face(f)) ++valence[v];
    }
    for (const std::size_t n : valence) vertices += n != edges;
    return fmt::format("{}, {}", vertices, faces);
}

std::string row(const std::string& name, const PolygonMesh& mesh, bool triangles) {
    std::vector<double> radii;
    for (const Vec3 p : mesh.positions) radii.push_back(double{length(p)});
    const Statistics radius = statistics(radii);
    double away = 0;
    const SurfaceTree surface(mesh);
    for (const Vec3 corner : cube().positions) away = std::max(away, surface.distance(Vec3d(corner)));
    const SmoothnessReport smooth = smoothness(mesh, nullptr);
    const Statistics& angle = smooth.whole.face_angle;
    return fmt::format(
        "| {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {:.3f}, {:.3f} | {:.1f}, {:.1f} | {:.2f} |\n", name,
        mesh.face_count(), mesh.positions.size(), irregular(mesh, triangles ? 6 : 4, triangles ? 3 : 4),
        topology(mesh).watertight() ? "yes" : "no", shape(mesh).signed_volume / 8, away,
        radius.min / radius.mean, radius.max / radius.mean, angle.p95, angle.max,
        smooth.whole.bending / (8 * std::numbers::pi));
}

void write(const std::filesystem::path& folder, std::string name, const PolygonMesh& mesh) {
    if (folder.empty()) return;
    for (char& c : name)
        if (c == ' ' || c == ',' || c == '-') c = '_';
    write_mesh(folder / (name + ".obj"), mesh);
}

void run(int levels, const std::filesystem::path& folder) {
    if (!folder.empty()) std::filesystem::create_directories(folder);
    fmt::print(
        "| scheme | faces | vertices | irregular vertices, faces | watertight | volume over the cube's | "
        "corner "
        "to surface | radius over its mean, least, "
        "greatest | angle between faces, degrees, p95, greatest | bending over a sphere's |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    fmt::print("{}", row("the cube", cube(), false));
    write(folder, "cube", cube());
    for (const Scheme scheme : {Scheme::loop, Scheme::catmull_clark, Scheme::butterfly,
                                Scheme::modified_butterfly, Scheme::doo_sabin}) {
        const bool triangles = bench::takes_triangles(scheme);
        PolygonMesh mesh = triangles ? bench::triangulated(cube()) : cube();
        for (int i = 0; i < levels; ++i) mesh = bench::subdivided(mesh, scheme);
        fmt::print("{}", row(std::string(bench::name_of(scheme)), mesh, triangles));
        write(folder, std::string(bench::name_of(scheme)), mesh);
    }
    fmt::print("{}", row("ours, a lone node of radius 1", ball(levels), false));
    write(folder, "ours", ball(levels));
}

}  // namespace

int main(int argc, char** argv) {
    int levels = 3;
    std::filesystem::path folder;
    CLI::App app("Compares subdivision schemes on a cube.", "coppice_schemes_bench");
    app.add_option("--levels", levels, "Number of steps of each scheme.")
        ->check(CLI::Range(0, 6))
        ->capture_default_str();
    app.add_option("--meshes", folder, "Write the surfaces into this folder, as OBJ.");
    return coppice::bench::run_program(app, argc, argv, [&] { run(levels, folder); });
}
