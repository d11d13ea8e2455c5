// coppice_poisson: a surface through points by the Poisson reconstruction of CGAL [Kazhdan2006], for
// comparison with ours; it links no code that creates our surfaces.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/write_ply_points.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "clock.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/measure/capsule_tree.h"
#include "program.h"

namespace {

using namespace coppice;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Oriented = std::pair<Kernel::Point_3, Kernel::Vector_3>;  // a point and its normal
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Place = CGAL::First_of_pair_property_map<Oriented>;
using Normal = CGAL::Second_of_pair_property_map<Oriented>;

auto named() { return CGAL::parameters::point_map(Place()).normal_map(Normal()); }

struct Flags {
    std::filesystem::path cloud, mesh, axes, oriented;
    unsigned neighbours = 18;  // number of neighbours for a normal, as in CGAL's manual
};

Vec3d to_vec(const auto& v) { return {v.x(), v.y(), v.z()}; }

// Orients every normal away from the axis of the nearest branch.
void turn_away(std::vector<Oriented>& points, const PointSet& cloud, const Flags& flags) {
    const CapsuleTree axes(read_skeleton(flags.axes).skeleton, cloud.origin);
    for (auto& [place, normal] : points) {
        const Vec3d p = to_vec(place);
        const CapsuleTree::Nearest branch = axes.nearest(p);
        if (branch.capsule == kNoIndex) throw InvalidInput("the skeleton has no segments");
        if (dot(axes.cone(branch.capsule).closest_point(p).offset, to_vec(normal)) < 0) normal = -normal;
    }
}

// Returns unique points with normals: oriented away from axes, or consistently with those of their
// neighbours, which omits points that no chain of neighbours reaches.
std::vector<Oriented> oriented(const PointSet& cloud, const Flags& flags) {
    std::vector<Oriented> points;
    for (const Vec3 p : cloud.positions)
        points.emplace_back(Kernel::Point_3(p.x, p.y, p.z), CGAL::NULL_VECTOR);
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    points.erase(std::unique(points.begin(), points.end(),
                             [](const auto& a, const auto& b) { return a.first == b.first; }),
                 points.end());
    if (points.size() <= flags.neighbours)
        throw InvalidInput(fmt::format("more than {} points are required", flags.neighbours));
    CGAL::pca_estimate_normals<CGAL::Sequential_tag>(points, flags.neighbours, named());
    if (flags.axes.empty())
        points.erase(CGAL::mst_orient_normals(points, flags.neighbours, named()), points.end());
    else
        turn_away(points, cloud, flags);
    return points;
}

PolygonMesh to_polygons(const Surface& surface, Vec3d origin) {
    PolygonMesh mesh;
    mesh.origin = origin;
    for (const auto v : surface.vertices()) {
        mesh.positions.push_back(Vec3(to_vec(surface.point(v))));
    }
    for (const auto f : surface.faces()) {
        std::vector<std::uint32_t> corners;
        for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface))
            corners.push_back(v.idx());
        mesh.add_face(corners);
    }
    return mesh;
}

void write_oriented(const std::filesystem::path& path, std::vector<Oriented> points, Vec3d origin) {
    for (Oriented& point : points) point.first += Kernel::Vector_3(origin.x, origin.y, origin.z);
    std::ofstream file(path);
    file.precision(15);
    if (!CGAL::IO::write_PLY(file, points, named()))
        throw IoError(fmt::format("cannot write '{}'", path.string()));
}

void run(const Flags& flags) {
    const PointSet cloud = read_points(flags.cloud);
    const bench::Clock normals;
    const std::vector<Oriented> points = oriented(cloud, flags);
    const double normals_seconds = normals.seconds();
    if (!flags.oriented.empty()) write_oriented(flags.oriented, points, cloud.origin);
    const bench::Clock surface;
    Surface found;
    const double spacing =
        CGAL::compute_average_spacing<CGAL::Sequential_tag>(points, 6, CGAL::parameters::point_map(Place()));
    if (!CGAL::poisson_surface_reconstruction_delaunay(points.begin(), points.end(), Place(), Normal(), found,
                                                       spacing))
        throw InvalidInput(fmt::format("'{}': no surface was found", flags.cloud.string()));
    const double surface_seconds = surface.seconds();
    write_mesh(flags.mesh, to_polygons(found, cloud.origin));
    fmt::print(
        "{{\"points\": {}, \"spacing_m\": {}, \"normals_seconds\": {:.4f}, \"surface_seconds\": {:.4f}}}\n",
        points.size(), spacing, normals_seconds, surface_seconds);
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Computes a surface through points by CGAL's Poisson reconstruction.", "coppice_poisson");
    app.add_option("cloud", flags.cloud, "Points, in any format that coppice reads.")->required();
    app.add_option("mesh", flags.mesh, "Surface to write; the file extension determines the format.")
        ->required();
    app.add_option("--axes", flags.axes,
                   "Skeleton from which normals point away; without it they are oriented consistently with "
                   "their neighbours.");
    app.add_option("--oriented", flags.oriented, "Also write the points with their normals (PLY).");
    app.add_option("--neighbours", flags.neighbours, "Number of neighbours of a point for its normal.")
        ->check(CLI::Range(3, 1000))
        ->capture_default_str();
    return coppice::bench::run_program(app, argc, argv, [&] { run(flags); });
}
