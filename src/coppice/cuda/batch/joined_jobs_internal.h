#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/cuda/batch/job_arrays_internal.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// Offsets of the elements of one job in the joined job.
struct JobOffsets {
    std::uint32_t vertices = 0;  ///< of the cage
    std::uint32_t edges = 0;     ///< of the cage
    std::uint32_t faces = 0;     ///< of the cage
    std::uint32_t regions = 0;   ///< of the field
};

/// Several jobs as one: their cages are separate components, so that every result equals that of the
/// individual job. A single job is passed through. O(n).
class JoinedJobs {
  public:
    /// Requires at least one job; jobs must have the same levels and options, and must outlive this object.
    /// `regions` contains the number of regions of each field. Throws DeviceError if there are too many
    /// vertices to index.
    JoinedJobs(std::span<const QuadJob> jobs, std::span<const std::uint32_t> regions);
    JoinedJobs(const JoinedJobs&) = delete;
    JoinedJobs& operator=(const JoinedJobs&) = delete;

    const QuadJob& job() const { return job_; }               ///< the joined job; refers to this object
    std::size_t size() const { return offsets_.size() - 1; }  ///< number of jobs
    /// Start of each job, and end of the last one.
    std::span<const JobOffsets> offsets() const { return offsets_; }

    /// Returns the number of refined vertices of one job.
    std::uint32_t vertex_count(std::size_t job) const;
    /// Copies the elements of one job from an array over all refined vertices.
    void copy_part(std::size_t job, std::span<const Vec3> all, std::span<Vec3> out) const;

  private:
    void add(const QuadJob& job, const JobOffsets& at);
    void refer();

    std::vector<JobOffsets> offsets_;
    JobArrays arrays_;
    QuadJob job_;
};

}  // namespace coppice::cuda
