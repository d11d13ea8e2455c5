#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "coppice/cuda/quads/device_quads.h"
#include "coppice/pipeline/mesh_result.h"

namespace coppice {

/// Returns whether work of this number of faces is done on a GPU. Throws DeviceError if a GPU is required and
/// there is none.
bool goes_to_device(Device wanted, std::uint64_t faces, DeviceUse& use);

/// Records that the CPU did the work, and the reason.
void note_refusal(DeviceUse& use, const std::string& why);

/// Returns the result of work() on a GPU; nullopt, and a note, if the GPU failed.
template <class Work>
auto on_device(DeviceUse& use, const Work& work) -> std::optional<decltype(work())> {
    try {
        return work();
    } catch (const DeviceError& e) {
        note_refusal(use, e.what());
        return {};
    }
}

/// Begins to subdivide a cage and to move it onto a field on a GPU, which also finds the relevant segments in
/// each region of the field; if it cannot do that, `set_regions` is called first. The objects that the job
/// refers to have to outlive DeviceQuads::finish(). Returns nullopt if the GPU has too little memory.
std::optional<DeviceQuads> begin_on_device(const cuda::QuadJob& job, const cuda::ContactInput& contacts,
                                           const std::function<void()>& set_regions, DeviceUse& use,
                                           const Context& ctx);

}  // namespace coppice
