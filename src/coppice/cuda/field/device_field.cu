#include "coppice/cuda/field/device_field.h"

#include <type_traits>

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/field/sample_kernel_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"

namespace coppice {
namespace {

/// Samples once and then `repeat` times with time measurement; calls use(executor, out) at the end.
template <class Use>
void sample_repeatedly(const ConvolutionField& field, std::span<const Vec3> points, int repeat,
                       const Use& use) {
    require_device();
    cuda::CudaExecutor exec;
    const cuda::FieldArrays arrays = cuda::upload_field(exec, field);
    const std::span<const Vec3> at = exec.upload(points);
    const std::span<FieldSample> out = exec.array<FieldSample>(points.size());
    cuda::with_formula(field.kernel(), [&](const auto& formula) {
        const cuda::FieldView view(formula, arrays);
        const cuda::SamplePoints<std::remove_const_t<decltype(view)>> kernel{view, 0, at, out};
        exec.each("sample", points.size(), kernel);
        exec.measure();
        for (int i = 0; i < repeat; ++i) exec.each("sample", points.size(), kernel);
    });
    use(exec, std::span<const FieldSample>(out));
}

}  // namespace

void sample_on_device(const ConvolutionField& field, std::span<const Vec3> points,
                      std::span<FieldSample> out) {
    sample_repeatedly(field, points, 0, [&](auto& exec, auto samples) { exec.download(samples, out); });
}

std::vector<double> time_field(const ConvolutionField& field, std::span<const Vec3> points, int repeat) {
    std::vector<double> seconds;
    sample_repeatedly(field, points, repeat, [&](auto& exec, auto) {
        for (const cuda::KernelTime& t : exec.take_times()) seconds.push_back(t.seconds);
    });
    return seconds;
}

}  // namespace coppice
