#include "coppice/cuda/tetra/device_marcher.h"

namespace coppice {

struct DeviceMarcher::Impl {};

DeviceMarcher::DeviceMarcher(const Context&, std::size_t) { throw DeviceError(find_device().missing); }
DeviceMarcher::~DeviceMarcher() = default;
DeviceMarcher::DeviceMarcher(DeviceMarcher&&) noexcept = default;
DeviceMarcher& DeviceMarcher::operator=(DeviceMarcher&&) noexcept = default;

MarchResult DeviceMarcher::march(const TetraMesh&, const CutConvolution&, const InsideAxes&,
                                 const MarchOptions&, const Context&) {
    return {};
}
void DeviceMarcher::repeat() {}
void DeviceMarcher::measure() {}
std::vector<cuda::KernelTime> DeviceMarcher::take_times() { return {}; }
std::uint64_t DeviceMarcher::bytes_used() const { return 0; }

}  // namespace coppice
