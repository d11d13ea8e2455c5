#include "coppice/scene/mesh_memory.h"

#include <cmath>

namespace coppice {
namespace {

double memory_of_quads(const Skeleton& skeleton, int levels, Fit fit) {
    constexpr double kCageQuads = 5;  // per segment
    double quads = kCageQuads * skeleton.size();
    for (int i = 0; i < levels; ++i) quads *= 4;
    return memory_of_faces(quads, fit);
}

/// Returns the length of all axes in units of the local radius, plus a ball at both ends of each tree.
double length_in_radii(const Skeleton& skeleton) {
    double sum = 2.0 * skeleton.tree_count();
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.is_root(n)) continue;
        const Segment s = skeleton.segment(n);
        const double a = double{s.radius_a}, b = double{s.radius_b}, l = distance(Vec3d(s.a), Vec3d(s.b));
        const double difference = a - b;
        // The integral of 1 / r along a truncated cone.
        sum += std::abs(difference) < 1e-3 * a ? l / a : l * std::log(a / b) / difference;
    }
    return sum;
}

/// Estimates the memory from the number of tetrahedra of the octree, which increases as its cells get
/// smaller, and of those that the surface crosses: per radius of length along the axes, the maximum measured
/// in trees of 300 to 3,000 segments, times the maximum number of bytes.
double memory_of_lattice(const Skeleton& skeleton, const TetraOptions& options) {
    constexpr double kBytesOfTetra = 180, kBytesOfCrossed = 75;
    const double edge = double{options.edge}, cell = std::ldexp(edge, options.march.levels);
    const double tetra = 16 / (cell * cell * cell) + 40 / (cell * cell) + 18 / cell;
    const double crossed = 14 / (edge * edge) + 16 / edge;
    return length_in_radii(skeleton) * (kBytesOfTetra * tetra + kBytesOfCrossed * crossed);
}

/// Estimates the memory from the number of segments: several tetrahedra per segment, each subdivided into
/// eight, with most of their vertices sampled.
double memory_of_polyhedron(const Skeleton& skeleton, const TetraOptions& options) {
    // Maximum measured number of coarse tetrahedra per segment (16 in a tree of 3,000 segments, which used
    // 115 MB in addition to the program).
    constexpr double kTetra = 26, kBytesOfTetra = 500, kBytesOfFine = 5;
    const double fine = std::ldexp(1.0, 3 * polyhedron_levels(options));
    return kTetra * skeleton.size() * (kBytesOfTetra + kBytesOfFine * fine);
}

/// Estimates the memory of quads. Cylinders need as much, because they have fewer vertices and more sides;
/// ramifications need twice as much, because they have additional rings.
double memory_of_surface(const Skeleton& skeleton, const MeshOptions& options) {
    if (options.method == MeshMethod::tetrahedra) {
        return options.tetra.base == TetraBase::polyhedron ? memory_of_polyhedron(skeleton, options.tetra)
                                                           : memory_of_lattice(skeleton, options.tetra);
    }
    const double quads = memory_of_quads(skeleton, options.levels, options.fit);
    if (options.method == MeshMethod::cylinders) return quads * options.control.sides / 4;
    return options.method == MeshMethod::ramifications ? 2 * quads : quads;
}

}  // namespace

double memory_of_faces(double quads, Fit fit) {
    constexpr double kBytesOfQuad = 120, kBytesOfFit = 150;
    return quads * (kBytesOfQuad + (fit == Fit::surface ? 0 : kBytesOfFit));
}

double memory_of_mesh(const Skeleton& skeleton, const MeshOptions& options) {
    constexpr double kBytesOfNode = 1600;  // of the prepared skeleton and the field
    return kBytesOfNode * skeleton.size() + memory_of_surface(skeleton, options);
}

}  // namespace coppice
