#include "device_printed_quads.h"

#include <optional>

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/field/upload_field_internal.h"
#include "printed_quad_stages.h"

namespace coppice::bench {

struct DevicePrintedQuads::Impl {
    cuda::CudaExecutor exec;
    std::optional<PrintedQuadStages<cuda::CudaExecutor>> stages;
    cuda::FieldArrays field;
    KernelConstants kernel;
    Evolution how;

    explicit Impl(const Context& ctx) : exec(ctx) {}

    void run() {
        stages->refine();
        cuda::with_formula(
            kernel, [&](const auto& formula) { stages->evolve(cuda::FieldView(formula, field), how); });
    }
};

DevicePrintedQuads::DevicePrintedQuads(const Context& ctx) {
    require_device();
    impl_ = std::make_unique<Impl>(ctx);
}
DevicePrintedQuads::~DevicePrintedQuads() = default;
DevicePrintedQuads::DevicePrintedQuads(DevicePrintedQuads&&) noexcept = default;
DevicePrintedQuads& DevicePrintedQuads::operator=(DevicePrintedQuads&&) noexcept = default;

QuadMesh DevicePrintedQuads::make(const cuda::QuadJob& job, const ConvolutionField& field,
                                  const Evolution& how) {
    impl_->stages.reset();
    impl_->exec.reset();
    impl_->kernel = field.kernel();
    impl_->how = how;
    impl_->field = cuda::upload_field(impl_->exec, field);
    impl_->stages.emplace(impl_->exec, job);
    impl_->run();
    QuadMesh out;
    out.positions.resize(impl_->stages->positions().size());
    impl_->exec.download(impl_->stages->positions(), std::span(out.positions));
    out.quads.resize(impl_->stages->mesh().face_count());
    impl_->exec.download(impl_->stages->mesh().quads, std::span(out.quads));
    return out;
}

void DevicePrintedQuads::repeat() {
    impl_->run();
    impl_->exec.wait();
}

void DevicePrintedQuads::measure() { impl_->exec.measure(); }

std::vector<cuda::KernelTime> DevicePrintedQuads::take_times() { return impl_->exec.take_times(); }

std::uint64_t DevicePrintedQuads::bytes_used() const { return impl_->exec.bytes_used(); }

}  // namespace coppice::bench
