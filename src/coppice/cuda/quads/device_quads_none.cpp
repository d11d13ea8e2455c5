#include "coppice/cuda/quads/device_quads.h"

namespace coppice {

struct DeviceQuads::Impl {};

DeviceQuads::DeviceQuads(const Context&, std::size_t) { require_device(); }
DeviceQuads::~DeviceQuads() = default;
DeviceQuads::DeviceQuads(DeviceQuads&&) noexcept = default;
DeviceQuads& DeviceQuads::operator=(DeviceQuads&&) noexcept = default;

// Without a GPU the constructor throws, so these are never called.
void DeviceQuads::begin(const cuda::QuadJob&, const ConvolutionField&) {}
void DeviceQuads::begin(std::span<const cuda::QuadTask>) {}
bool DeviceQuads::begin(const cuda::QuadJob&, const cuda::ContactInput&) { return false; }
bool DeviceQuads::begin(std::span<const cuda::QuadJob>, std::span<const cuda::ContactInput>) { return false; }
cuda::QuadReport DeviceQuads::finish(Buffer<Vec3>&, Buffer<Vec3>*) { return {}; }
std::vector<cuda::QuadReport> DeviceQuads::finish(std::span<const cuda::QuadPlaces>) { return {}; }
void DeviceQuads::repeat() {}
std::size_t DeviceQuads::rounds() const { return 0; }
void DeviceQuads::measure() {}
std::vector<cuda::KernelTime> DeviceQuads::take_times() { return {}; }
std::uint64_t DeviceQuads::bytes_used() const { return 0; }

}  // namespace coppice
