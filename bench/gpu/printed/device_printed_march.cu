#include "device_printed_march.h"

#include <functional>

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/field/upload_field_internal.h"
#include "printed_march_stages.h"

namespace coppice::bench {

struct DevicePrintedMarch::Impl {
    explicit Impl(const Context& ctx) : exec(ctx) {}

    cuda::CudaExecutor exec;
    std::function<void()> again;  ///< see repeat(); refers to data in the memory of `exec`
};

DevicePrintedMarch::DevicePrintedMarch(const Context& ctx) {
    require_device();
    impl_ = std::make_unique<Impl>(ctx);
}
DevicePrintedMarch::~DevicePrintedMarch() = default;
DevicePrintedMarch::DevicePrintedMarch(DevicePrintedMarch&&) noexcept = default;
DevicePrintedMarch& DevicePrintedMarch::operator=(DevicePrintedMarch&&) noexcept = default;

TriMesh DevicePrintedMarch::make(const TetraMesh& mesh, int levels, const CutConvolution& field,
                                 const Context& ctx) {
    cuda::CudaExecutor& exec = impl_->exec;
    impl_->again = {};
    exec.reset();
    TriMesh out;
    cuda::with_formula(field.field.kernel(), [&](const auto& formula) {
        const cuda::FieldView segments(formula, cuda::upload_field(exec, field.field));
        const float level = field.level();
        const auto view = cuda::upload_cuts(exec, segments, field.ends, level);
        const ExplicitTetra coarse = upload_explicit(exec, mesh, ctx);
        const auto before = exec.mark();
        const PrintedSurface found = march_as_printed(exec, coarse, levels, view, level, true);
        out.positions.resize(found.positions.size());
        out.triangles.resize(found.welded.size());
        exec.download(found.positions, std::span(out.positions));
        exec.download(found.welded, std::span(out.triangles));
        exec.rewind(before);
        impl_->again = [&exec, coarse, levels, view, before, level] {
            march_as_printed(exec, coarse, levels, view, level, false);
            exec.rewind(before);
        };
    });
    return out;
}

void DevicePrintedMarch::repeat() { impl_->again(); }

void DevicePrintedMarch::measure() { impl_->exec.measure(); }

std::vector<cuda::KernelTime> DevicePrintedMarch::take_times() { return impl_->exec.take_times(); }

std::uint64_t DevicePrintedMarch::bytes_used() const { return impl_->exec.bytes_used(); }

}  // namespace coppice::bench
