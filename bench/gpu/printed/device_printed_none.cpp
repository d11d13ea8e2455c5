#include "device_printed_march.h"
#include "device_printed_quads.h"

// Without a GPU the constructors throw, so the other functions are never called.

namespace coppice::bench {

struct DevicePrintedMarch::Impl {};

DevicePrintedMarch::DevicePrintedMarch(const Context&) { require_device(); }
DevicePrintedMarch::~DevicePrintedMarch() = default;
DevicePrintedMarch::DevicePrintedMarch(DevicePrintedMarch&&) noexcept = default;
DevicePrintedMarch& DevicePrintedMarch::operator=(DevicePrintedMarch&&) noexcept = default;

TriMesh DevicePrintedMarch::make(const TetraMesh&, int, const CutConvolution&, const Context&) { return {}; }
void DevicePrintedMarch::repeat() {}
void DevicePrintedMarch::measure() {}
std::vector<cuda::KernelTime> DevicePrintedMarch::take_times() { return {}; }
std::uint64_t DevicePrintedMarch::bytes_used() const { return 0; }

struct DevicePrintedQuads::Impl {};

DevicePrintedQuads::DevicePrintedQuads(const Context&) { require_device(); }
DevicePrintedQuads::~DevicePrintedQuads() = default;
DevicePrintedQuads::DevicePrintedQuads(DevicePrintedQuads&&) noexcept = default;
DevicePrintedQuads& DevicePrintedQuads::operator=(DevicePrintedQuads&&) noexcept = default;

QuadMesh DevicePrintedQuads::make(const cuda::QuadJob&, const ConvolutionField&, const Evolution&) {
    return {};
}
void DevicePrintedQuads::repeat() {}
void DevicePrintedQuads::measure() {}
std::vector<cuda::KernelTime> DevicePrintedQuads::take_times() { return {}; }
std::uint64_t DevicePrintedQuads::bytes_used() const { return 0; }

}  // namespace coppice::bench
