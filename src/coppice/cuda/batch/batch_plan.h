#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// What is done at once: some consecutive jobs as one, or a piece of one job.
struct BatchRound {
    IndexRange jobs;        ///< of those given
    bool is_piece = false;  ///< only some quads of the one job
    IndexRange quads = {};  ///< of that job's cage: see QuadPiece
};

/// [bytes] What a job takes: see bytes_of_job() and bytes_of_field().
struct JobBytes {
    std::uint64_t job = 0;                             ///< all but its field
    std::uint64_t field = 0;                           ///< with what its lists are made of
    std::uint64_t sum() const { return job + field; }  ///< both
};

/// Puts as many jobs together as there is room for. Those that do not fit by themselves are cut into pieces
/// of about as many quads each, which may still turn out too large: see split().
std::vector<BatchRound> plan_batch(std::span<const QuadJob> jobs, std::span<const JobBytes> bytes,
                                   std::uint64_t room);

/// Half of a piece that is too large, and the other half. Throws DeviceError, which says how much `needed`
/// was [bytes], where it cannot be cut any more.
std::array<BatchRound, 2> split(const BatchRound& piece, const QuadJob& job, std::uint64_t needed,
                                std::uint64_t room);

}  // namespace coppice::cuda
