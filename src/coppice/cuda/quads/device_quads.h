#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/exec/kernel_time.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"

namespace coppice {

/// Makes quads of cages on a card: what PatchRefinement::refine, project and untangle do, with the same
/// topology and positions within 1e-4 of the local radius. Keeps the memory that a job took for the next one.
/// One job at a time.
class DeviceQuads {
  public:
    /// Throws DeviceError where there is no card, or this build has no kernels.
    explicit DeviceQuads(const Context& ctx = {});
    ~DeviceQuads();                                  ///< gives the memory back
    DeviceQuads(DeviceQuads&&) noexcept;             ///< leaves the other one empty
    DeviceQuads& operator=(DeviceQuads&&) noexcept;  ///< leaves the other one empty

    /// Sends a job and the field with its regions, and begins with it: returns before it is done. Throws
    /// DeviceError when the card has too little memory: see bytes_of.
    void begin(const cuda::QuadJob& job, const ConvolutionField& field);
    /// The same of a field without regions: the card finds what counts in each. False where lists are so long
    /// that they have to be made on the CPU.
    bool begin(const cuda::QuadJob& job, const cuda::ContactInput& contacts);
    /// Waits, unfolds what was folded, and copies back the refined positions, and where it is asked for the
    /// refined anchors. Throws DeviceError when the card failed.
    cuda::QuadReport finish(Buffer<Vec3>& positions, Buffer<Vec3>* anchors = nullptr);

    /// The work of begin() and finish() once more from what lies on the card, for measuring: with normals and
    /// quads, but without copying them back. Waits.
    void repeat();

    /// From now on the time of every kernel is noted.
    void measure();
    /// What was noted since it was asked for the last time.
    std::vector<cuda::KernelTime> take_times();
    std::uint64_t bytes_used() const;  ///< of the card, by the job begun last

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Memory of the card that a job takes, if not more than a fiftieth of its quads is folded, about a field of
/// so many segments whose lists have so many entries.
std::uint64_t bytes_of(const cuda::QuadJob& job, std::uint64_t segments, std::uint64_t entries);

}  // namespace coppice
