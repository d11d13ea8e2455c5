#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/cuda/quads/quad_job.h"

namespace coppice::cuda {

/// Storage for the data to which a derived job refers.
struct JobArrays {
    /// See CageView.
    /// @{
    std::vector<Quad> quads;
    std::vector<std::uint32_t> side;
    std::vector<std::array<std::uint32_t, 2>> edge_half;
    std::vector<std::uint32_t> fan_first, fan_half;
    std::vector<std::uint8_t> on_boundary;
    /// @}
    /// See QuadJob.
    /// @{
    std::vector<Vec3> positions, anchors;
    std::vector<std::uint32_t> region, part;
    std::vector<ClipPlane> clips;
    /// @}

    /// Makes a job refer to these arrays, which must not change afterwards.
    void lend(QuadJob& job) const {
        job.cage.quads = quads;
        job.cage.side = side;
        job.cage.edge_half = edge_half;
        job.cage.fan_first = fan_first;
        job.cage.fan_half = fan_half;
        job.cage.on_boundary = on_boundary;
        job.positions = positions;
        job.anchors = anchors;
        job.region = region;
        job.clips = clips;
        job.part = part;
    }
};

}  // namespace coppice::cuda
