#include "coppice/cuda/quads/device_printed_quads.h"

namespace coppice {

struct DevicePrintedQuads::Impl {};

DevicePrintedQuads::DevicePrintedQuads(const Context&) { require_device(); }
DevicePrintedQuads::~DevicePrintedQuads() = default;
DevicePrintedQuads::DevicePrintedQuads(DevicePrintedQuads&&) noexcept = default;
DevicePrintedQuads& DevicePrintedQuads::operator=(DevicePrintedQuads&&) noexcept = default;

// Without a GPU the constructor throws, so these are never called.
QuadMesh DevicePrintedQuads::make(const cuda::QuadJob&, const ConvolutionField&, const cuda::Evolution&) {
    return {};
}
void DevicePrintedQuads::repeat() {}
void DevicePrintedQuads::measure() {}
std::vector<cuda::KernelTime> DevicePrintedQuads::take_times() { return {}; }
std::uint64_t DevicePrintedQuads::bytes_used() const { return 0; }

}  // namespace coppice
