#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// Work of one round: some consecutive jobs processed as one, or a tile of one job.
struct BatchRound {
    IndexRange jobs;        ///< among the given jobs
    bool is_tile = false;   ///< only some quads of one job
    IndexRange quads = {};  ///< quads of the cage of that job: see QuadTile
};

/// [bytes] Memory of a job: see bytes_of_job() and bytes_of_field().
struct JobBytes {
    std::uint64_t job = 0;    ///< except its field
    std::uint64_t field = 0;  ///< including the data from which its lists are computed
    std::uint64_t sum() const { return job + field; }  ///< total
};

/// Combines as many jobs as fit into memory. A job that does not fit by itself is divided into tiles of
/// roughly equal numbers of quads, which may still turn out too large: see split().
std::vector<BatchRound> plan_batch(std::span<const QuadJob> jobs, std::span<const JobBytes> bytes,
                                   std::uint64_t room);

/// Returns the two halves of a tile that is too large. Throws DeviceError with the required memory `needed`
/// [bytes] if it cannot be divided further.
std::array<BatchRound, 2> split(const BatchRound& tile, const QuadJob& job, std::uint64_t needed,
                                std::uint64_t room);

}  // namespace coppice::cuda
