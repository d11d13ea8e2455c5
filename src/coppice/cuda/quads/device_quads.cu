#include "coppice/cuda/quads/device_quads.h"

#include "coppice/cuda/batch/quad_run_internal.h"
#include "coppice/cuda/quads/project_field.cuh"

namespace coppice {

namespace cuda {

template void project<CudaExecutor>(QuadStages<CudaExecutor>&, const KernelConstants&, const FieldArrays&);
template std::vector<UntangleReport> unfold<CudaExecutor>(QuadStages<CudaExecutor>&,
                                                          const QuadStages<CudaExecutor>::FoldSearch&,
                                                          const KernelConstants&, const FieldArrays&);

}  // namespace cuda

struct DeviceQuads::Impl {
    cuda::CudaExecutor exec;
    cuda::QuadRun<cuda::CudaExecutor> run;

    Impl(const Context& ctx, std::size_t most) : exec(ctx, most), run(exec, ctx) {}
};

DeviceQuads::DeviceQuads(const Context& ctx, std::size_t most) {
    require_device();
    impl_ = std::make_unique<Impl>(ctx, most);
}
DeviceQuads::~DeviceQuads() = default;
DeviceQuads::DeviceQuads(DeviceQuads&&) noexcept = default;
DeviceQuads& DeviceQuads::operator=(DeviceQuads&&) noexcept = default;

void DeviceQuads::begin(const cuda::QuadJob& job, const ConvolutionField& field) {
    const cuda::QuadTask task{job, &field};
    impl_->run.begin({&task, 1});
}

void DeviceQuads::begin(std::span<const cuda::QuadTask> tasks) { impl_->run.begin(tasks); }

bool DeviceQuads::begin(const cuda::QuadJob& job, const cuda::ContactInput& contacts) {
    return impl_->run.begin({&job, 1}, {&contacts, 1});
}

bool DeviceQuads::begin(std::span<const cuda::QuadJob> jobs, std::span<const cuda::ContactInput> contacts) {
    return impl_->run.begin(jobs, contacts);
}

cuda::QuadReport DeviceQuads::finish(Buffer<Vec3>& positions, Buffer<Vec3>* anchors) {
    const cuda::QuadPlaces places{&positions, anchors};
    return impl_->run.finish({&places, 1}).front();
}

std::vector<cuda::QuadReport> DeviceQuads::finish(std::span<const cuda::QuadPlaces> out) {
    return impl_->run.finish(out);
}

void DeviceQuads::repeat() { impl_->run.repeat(); }

std::size_t DeviceQuads::rounds() const { return impl_->run.round_count(); }

void DeviceQuads::measure() { impl_->exec.measure(); }

std::vector<cuda::KernelTime> DeviceQuads::take_times() { return impl_->exec.take_times(); }

std::uint64_t DeviceQuads::bytes_used() const { return impl_->exec.bytes_used(); }

}  // namespace coppice
