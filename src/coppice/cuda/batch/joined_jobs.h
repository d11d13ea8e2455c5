#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/cuda/batch/job_arrays.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// Where what belongs to one of several jobs begins in what all of them are joined to.
struct JobOffsets {
    std::uint32_t vertices = 0;  ///< of the cage
    std::uint32_t edges = 0;     ///< of the cage
    std::uint32_t faces = 0;     ///< of the cage
    std::uint32_t regions = 0;   ///< of the field
};

/// Several jobs as one, each a part of it: their cages lie side by side and have nothing in common, so that
/// every number comes out as from the job alone. A single job is itself. O(n).
class JoinedJobs {
  public:
    /// Jobs with the same levels and options, one at least, which have to outlive it; `regions` has the
    /// number of regions of each one's field. Throws DeviceError when there are too many vertices to index.
    JoinedJobs(std::span<const QuadJob> jobs, std::span<const std::uint32_t> regions);
    JoinedJobs(const JoinedJobs&) = delete;
    JoinedJobs& operator=(const JoinedJobs&) = delete;

    const QuadJob& job() const { return job_; }               ///< all of them; refers to this object
    std::size_t size() const { return offsets_.size() - 1; }  ///< number of jobs
    /// Where each one begins, and where the last one ends.
    std::span<const JobOffsets> offsets() const { return offsets_; }

    /// Number of refined vertices of one of them.
    std::uint32_t vertex_count(std::size_t job) const;
    /// Copies what belongs to one of them out of an array over all refined vertices.
    void copy_part(std::size_t job, std::span<const Vec3> all, std::span<Vec3> out) const;

  private:
    void add(const QuadJob& job, const JobOffsets& at);
    void refer();

    std::vector<JobOffsets> offsets_;
    JobArrays arrays_;
    QuadJob job_;
};

}  // namespace coppice::cuda
