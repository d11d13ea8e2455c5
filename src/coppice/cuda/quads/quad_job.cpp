#include "coppice/cuda/quads/quad_job.h"

#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/quads/device_quads.h"
#include "coppice/cuda/quads/quad_kernels_internal.h"

namespace coppice {

namespace cuda {

QuadCounts refined_counts(std::uint32_t vertices, std::uint32_t edges, std::uint32_t quads, int levels) {
    const std::uint32_t inside = (1u << levels) - 1;
    return {vertices + inside * edges + inside * inside * quads, quads << (2 * levels)};
}

QuadCounts refined_counts(const CageView& cage, int levels) {
    return refined_counts(cage.vertex_count(), cage.edge_count(), cage.face_count(), levels);
}

std::uint64_t bytes_of_job(const QuadJob& job) {
    constexpr std::uint64_t kQuadsPerFold = 800, kBytesPerFold = 6400;  // as measured on crowded trees
    const QuadCounts out = refined_counts(job.cage, job.levels);
    std::uint64_t bytes = 0;
    for (int level = 0; level <= job.levels; ++level)
        bytes += 2 * sizeof(Vec3) * std::uint64_t{refined_counts(job.cage, level).vertices};
    bytes += sizeof(ProjectionStatus) * std::uint64_t{out.vertices};
    if (job.project.relax_passes > 0) bytes += sizeof(Vec3) * std::uint64_t{out.vertices};
    bytes += sizeof(std::uint32_t) * std::uint64_t{out.quads};          // for the search for folds
    bytes += (sizeof(Quad) + sizeof(Vec3)) * std::uint64_t{out.quads};  // quads and normals
    bytes += out.quads / kQuadsPerFold * kBytesPerFold;
    bytes += 2 * sizeof(Quad) * std::uint64_t{job.cage.face_count()} +
             sizeof(std::uint64_t) * std::uint64_t{job.cage.edge_count()} +
             sizeof(std::uint32_t) * (job.cage.vertex_count() + std::uint64_t{6} * job.cage.face_count());
    return bytes;
}

std::uint64_t bytes_of_field(std::uint64_t segments, std::uint64_t entries) {
    return sizeof(DeviceSegment) * segments + sizeof(std::uint32_t) * entries;
}

std::uint64_t bytes_of_contacts(std::uint64_t segments, std::uint64_t regions) {
    // segments with the data from which their lists are computed, in units of a segment
    constexpr std::uint64_t kTableSegments = 4;
    constexpr std::uint64_t kEntriesPerRegion = 100;  // including memory for the search
    return bytes_of_field(kTableSegments * segments, kEntriesPerRegion * regions);
}

}  // namespace cuda

std::uint64_t count_bytes(const cuda::QuadJob& job, std::uint64_t segments, std::uint64_t entries) {
    return cuda::kSlackBytes + cuda::bytes_of_job(job) + cuda::bytes_of_field(segments, entries);
}

}  // namespace coppice
