#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "coppice/cuda/quads/device_quads.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {

/// Whether work of so many faces goes to a card. Throws DeviceError where it has to and there is none.
bool goes_to_device(Device wanted, std::uint64_t faces, DeviceUse& use);

/// Notes that the CPU did the work, and why.
void note_refusal(DeviceUse& use, const std::string& why);

/// What work() on a card returns; nothing, and a note, where the card failed.
template <class Work>
auto on_device(DeviceUse& use, const Work& work) -> std::optional<decltype(work())> {
    try {
        return work();
    } catch (const DeviceError& e) {
        note_refusal(use, e.what());
        return {};
    }
}

/// Begins to subdivide a cage and to move it onto a field on a card, which also finds what counts in each
/// region of the field; where it cannot do that, `set_regions` is called first. What the job refers to has
/// to outlive DeviceQuads::finish(). Nothing where the card is too small.
std::optional<DeviceQuads> begin_on_device(const cuda::QuadJob& job, const cuda::ContactInput& contacts,
                                           const std::function<void()>& set_regions, DeviceUse& use,
                                           const Context& ctx);

}  // namespace coppice
