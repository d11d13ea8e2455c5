#include "gpu_costs.h"

#include <cmath>

#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/quads/quad_kernels_internal.h"
#include "printed_march_kernels.h"

namespace coppice::bench {
namespace {

constexpr double kPoint = sizeof(Vec3), kNumber = sizeof(std::uint32_t), kQuad = sizeof(Quad);

// Coordinates along the segment, distance and ends; the result of the derivatives; the sum of the values.
constexpr double kPlace = 29, kGradient = 25, kSum = 2;

}  // namespace

double flops_per_pair(Kernel kernel, bool with_gradient) {
    constexpr double kAngle = 23;  // fast_atan2: nine coefficients
    switch (kernel) {
        case Kernel::quartic:
            return kPlace + kSum + (with_gradient ? 32 + kGradient : 18);
        case Kernel::cauchy:
            return kPlace + kSum + kAngle + (with_gradient ? 37 + kGradient : 25);
        default:
            return NAN;  // not measured
    }
}

FieldWork::FieldWork(const ConvolutionField& field, std::span<const double> weight)
    : kernel(field.kernel().kernel) {
    double points = 0, pairs = 0;
    for (std::uint32_t r = 0; r < field.region_count(); ++r) {
        points += weight[r];
        pairs += weight[r] * static_cast<double>(field.candidates(r).size() + field.competitors(r).size());
    }
    list = points > 0 ? pairs / points : 0;
    const std::size_t entries = field.own_lists().segments.size() + field.competitor_lists().segments.size() +
                                2 * std::size_t{field.region_count()};
    bytes = static_cast<double>(sizeof(cuda::DeviceSegment) * field.segments().size()) +
            kNumber * static_cast<double>(entries);
}

std::vector<KernelCost> quad_costs(const cuda::QuadJob& job, const FieldWork& field, double evaluations) {
    // Average over a grid's points, by their position between the coarser ones: 48, 30, 30 and 18.
    constexpr double kRefine = 31.5;
    // From the sample to the next point of a ray: read_on_ray, newton_rise, advance_ray.
    constexpr double kRayStep = 66;
    constexpr double kBadFace = 162, kNormal = 82;
    KernelCost refine{"refine"};
    for (int level = 0; level < job.levels; ++level) {
        const double from = cuda::refined_counts(job.cage, level).vertices,
                     to = cuda::refined_counts(job.cage, level + 1).vertices;
        refine.bytes += 2 * kPoint * (from + to);
        refine.flops += 2 * kRefine * to;
    }
    const auto [v, q] = cuda::refined_counts(job.cage, job.levels);
    const double vertices = v, quads = q;
    constexpr double kStatus = sizeof(cuda::ProjectionStatus);
    return {refine,
            {"project", (3 * kPoint + kStatus) * vertices + field.bytes,
             evaluations * (field.list * flops_per_pair(field.kernel) + kRayStep)},
            {"sum up", kStatus * vertices, 0},
            {"find folds", 2 * kPoint * vertices, kBadFace * quads},
            {"normals", 2 * kPoint * vertices, kNormal * vertices},
            {"quads", kQuad * quads, 0}};
}

std::vector<KernelCost> printed_quad_costs(const cuda::QuadJob& job, const FieldWork& field, int steps) {
    constexpr double kStep = 19;  // from the sample to the next point
    constexpr double kSides = 4 * kNumber, kPair = 2 * kNumber;
    KernelCost faces{"face points"}, edges{"edge points"}, vertices{"vertex points"};
    double v = job.cage.vertex_count(), e = job.cage.edge_count(), f = job.cage.face_count();
    for (int level = 0; level < job.levels; ++level) {
        faces.bytes += kPoint * v + (kQuad + kSides) * f +
                       (kPoint + kNumber + 4 * (kQuad + kSides + kPair + kNumber)) * f;
        faces.flops += 15 * f;
        edges.bytes +=
            kPair * e + kQuad * f + kPoint * (v + f) + (kPoint + kNumber + 2 * kPair + 4 * kNumber) * e;
        edges.flops += 12 * e;
        vertices.bytes += (kNumber + kPoint) * v + (4 * kNumber + kQuad + kPoint) * f +
                          (kPoint + kNumber) * v + 4 * kNumber * f;
        vertices.flops += 13 * v + 9 * 4 * f;
        const double next = 4 * f;
        v += e + f;
        e = 2 * e + next;
        f = next;
    }
    return {faces,
            edges,
            vertices,
            {"evolve", (2 * kPoint + 2 * kNumber) * v + field.bytes,
             steps * v * (field.list * flops_per_pair(field.kernel) + kStep)}};
}

std::vector<KernelCost> printed_tetra_costs(TetraCounts counts, int levels, double triangles,
                                            const FieldWork& field) {
    constexpr double kEdge = sizeof(ExplicitTetra::Edge), kFace = sizeof(ExplicitTetra::Face),
                     kCell = sizeof(ExplicitTetra::Cell), kVertex = kPoint + kNumber;
    KernelCost keep{"vertices"}, edges{"CalcEdgePoints"}, faces{"SubdivideFaces"},
        cells{"SubdivideTetrahedra"};
    for (int level = 1; level <= levels; ++level) {
        const auto& [v, e, f, t] = counts;
        const double with_faces = level < levels ? 1 : 0;
        keep.bytes += 2 * kVertex * v;
        edges.bytes += kPoint * v + kEdge * e + (kVertex + 2 * kEdge) * e;
        edges.flops += 6 * e;
        faces.bytes += kFace * f + kEdge * e + (3 * kEdge + with_faces * 4 * kFace) * f;
        cells.bytes += kPoint * v + kCell * t + kFace * f + (kEdge + 8 * kCell + with_faces * 8 * kFace) * t;
        cells.flops += 3 * 14 * t;
        counts = counts.cut();
    }
    const auto& [v, e, f, t] = counts;
    constexpr double kIndex = 1;
    // A point on an edge: its share and lerp; each triangle makes three.
    constexpr double kShare = 3 + 9;
    return {keep,
            edges,
            faces,
            cells,
            {"CalcFields", (kVertex + kNumber) * v + field.bytes,
             v * field.list * flops_per_pair(field.kernel, false)},
            {"CalcTetrahedralIndice", kNumber * v + sizeof(Tetra) * t + (kIndex + kNumber) * t, 0},
            {"scan", 2 * kNumber * t, 0},
            {"ExtractIsoTriangles", (kIndex + kNumber) * t + 3 * kPoint * triangles, 3 * kShare * triangles}};
}

std::vector<KernelCost> march_costs(const MarchReport& march, const FieldWork& field) {
    const auto vertices = static_cast<double>(march.vertices);
    constexpr double kWritten = sizeof(float) + 2.0 / 8;  // the height, and two bits
    return {
        {"field", kWritten * vertices + field.bytes, vertices * field.list * flops_per_pair(field.kernel)}};
}

}  // namespace coppice::bench
