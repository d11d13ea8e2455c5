#include <functional>

#include "coppice/cuda/batch/march_tiles_internal.h"
#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/tetra/device_marcher.h"
#include "coppice/cuda/tetra/march_stages_internal.h"

namespace coppice {

using cuda::CudaExecutor;

struct DeviceMarcher::Impl {
    Impl(const Context& ctx, std::size_t most) : exec(ctx, most) {}

    /// Marches without tiles.
    MarchResult march_whole(const cuda::MarchInput& in, const Context& ctx) {
        again = {};
        exec.reset();
        const cuda::MarchJob job = cuda::upload_march(exec, in, ctx);
        const auto uploaded = exec.mark();
        const auto made = cuda::march(exec, job, ctx);
        if (!made) cuda::refuse_mesh(in.mesh, in.options.levels, ctx);
        again = [this, job, uploaded] {
            exec.rewind(uploaded);
            cuda::march(exec, job);
        };
        return cuda::downloaded(exec, *made);
    }

    CudaExecutor exec;
    std::function<void()> again;  ///< see repeat(); refers to data in the memory of `exec`
};

DeviceMarcher::DeviceMarcher(const Context& ctx, std::size_t most) {
    require_device();
    impl_ = std::make_unique<Impl>(ctx, most);
}
DeviceMarcher::~DeviceMarcher() = default;
DeviceMarcher::DeviceMarcher(DeviceMarcher&&) noexcept = default;
DeviceMarcher& DeviceMarcher::operator=(DeviceMarcher&&) noexcept = default;

MarchResult DeviceMarcher::march(const TetraMesh& mesh, const CutConvolution& field, const InsideAxes& axes,
                                 const MarchOptions& options, const Context& ctx) {
    const cuda::MarchInput in{mesh, field, axes, options};
    try {
        return impl_->march_whole(in, ctx);
    } catch (const DeviceFull&) {
        return cuda::march_in_tiles(impl_->exec, in, ctx);
    }
}

void DeviceMarcher::repeat() {
    if (!impl_->again) throw DeviceError("there is no march without tiles that could be repeated");
    impl_->again();
}

void DeviceMarcher::measure() { impl_->exec.measure(); }
std::vector<cuda::KernelTime> DeviceMarcher::take_times() { return impl_->exec.take_times(); }
std::uint64_t DeviceMarcher::bytes_used() const { return impl_->exec.bytes_used(); }

}  // namespace coppice
