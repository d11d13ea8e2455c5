#include "opensubdiv.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <memory>
#include <vector>

#include "clock.h"

namespace coppice::bench {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// Vertex interface that OpenSubdiv requires; the names are its own.
struct Point {
    Vec3 value;
    void Clear() { value = {}; }                                                             // NOLINT
    void AddWithWeight(const Point& other, float weight) { value += other.value * weight; }  // NOLINT
};

using Refiner = std::unique_ptr<Far::TopologyRefiner>;

Refiner refine_topology(const Far::TopologyDescriptor& descriptor, int levels) {
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Refiner refiner(Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_CATMARK, Sdc::Options())));
    refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(levels));
    return refiner;
}

std::vector<Point> refine_points(const Far::TopologyRefiner& refiner, const QuadMesh& cage, int levels) {
    std::vector<Point> points(static_cast<std::size_t>(refiner.GetNumVerticesTotal()));
    for (std::size_t v = 0; v < cage.positions.size(); ++v) points[v].value = cage.positions[v];
    const Far::PrimvarRefiner primvar(refiner);
    Point* from = points.data();
    for (int level = 1; level <= levels; ++level) {
        Point* to = from + refiner.GetLevel(level - 1).GetNumVertices();
        primvar.Interpolate(level, from, to);
        from = to;
    }
    return points;
}

}  // namespace

OpenSubdivTime time_opensubdiv(const QuadMesh& cage, int levels) {
    const std::vector<int> sizes(cage.quads.size(), 4);
    std::vector<int> corners;
    corners.reserve(4 * cage.quads.size());
    for (const Quad& q : cage.quads) corners.insert(corners.end(), q.begin(), q.end());
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(cage.positions.size());
    descriptor.numFaces = static_cast<int>(cage.quads.size());
    descriptor.numVertsPerFace = sizes.data();
    descriptor.vertIndicesPerFace = corners.data();

    OpenSubdivTime time;
    const Clock topology;
    const Refiner refiner = refine_topology(descriptor, levels);
    time.topology = topology.seconds();
    const Clock points;
    const std::vector<Point> refined = refine_points(*refiner, cage, levels);
    time.points = points.seconds();
    return time;
}

}  // namespace coppice::bench
