#include <fmt/format.h>

#include "coppice/pipeline/quads/quads_on_device_internal.h"

namespace coppice {
namespace {

// Smaller surfaces are complete before the driver of a GPU has started.
constexpr std::uint64_t kWorthwhile = std::uint64_t{1} << 22;

}  // namespace

void note_refusal(DeviceUse& use, const std::string& why) {
    use = {"CPU", fmt::format("{}; the CPU did the work", why)};
}

bool goes_to_device(Device wanted, std::uint64_t faces, DeviceUse& use) {
    if (wanted == Device::cpu || (wanted == Device::automatic && faces < kWorthwhile)) return false;
    if (wanted == Device::cuda) {
        use.name = require_device().name;
        return true;
    }
    const DeviceSearch search = find_device();
    if (!search.device) return false;
    use.name = search.device->name;
    return true;
}

std::optional<DeviceQuads> begin_on_device(const cuda::QuadJob& job, const cuda::ContactInput& contacts,
                                           const std::function<void()>& set_regions, DeviceUse& use,
                                           const Context& ctx) {
    return on_device(use, [&] {
        DeviceQuads device(ctx);
        const bool finds_lists = contacts.field.contact() != 0 && contacts.tubes.joins.empty();
        if (!finds_lists || !device.begin(job, contacts)) {
            set_regions();
            device.begin(job, contacts.field);
        }
        return device;
    });
}

}  // namespace coppice
