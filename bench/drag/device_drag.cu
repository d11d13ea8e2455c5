#include "drag/device_drag.h"

#include <optional>

#include "coppice/cuda/quads/device_quads.h"
#include "coppice/cuda/quads/project_field.cuh"
#include "drag/drag_stages.h"
#include "drag/shared_buffers.cuh"

namespace coppice::bench {
namespace {

using cuda::CudaExecutor;

// Returns the approximate memory for frames.
std::uint64_t count_bytes(const DragJob& job) {
    return cuda::kSlackBytes + cuda::bytes_of_job(job.quads) +
           cuda::bytes_of_contacts(job.contacts.field.segments().size(),
                                   job.contacts.control.region_node.size()) +
           job.drawn.size_bytes() + job.shaded() * sizeof(Vec3) + job.from.size_bytes() +
           job.fan_first.size_bytes() + job.fan_quads.size_bytes() + job.quads_about.size_bytes();
}

}  // namespace

int find_drawing_device() { return SharedBuffers::find_drawing_device(); }

struct DeviceDrag::Impl {
    int device;
    std::string name;
    CudaExecutor exec;
    std::optional<SharedBuffers> shared;
    std::optional<DragStages<CudaExecutor>> stages;
    DrawnVertices own;  // used without shared buffers
    KernelConstants kernel;

    Impl(int number, const Context& ctx) : device(number), name(require_device(number).name), exec(ctx) {}

    void begin(const DragMoves& moves, const DrawnVertices& drawn) {
        stages->begin(moves, drawn,
                      [&](cuda::QuadStages<CudaExecutor>& quads, const cuda::FieldArrays& field) {
                          cuda::project(quads, kernel, field);
                      });
    }
    void make(const DragMoves& moves) {
        CudaExecutor::choose(device);
        do {
            if (shared) {
                shared->lend(exec, [&](const DrawnVertices& drawn) { begin(moves, drawn); });
            } else {
                begin(moves, own);
            }
        } while (!stages->has_room());
    }
};

DeviceDrag::DeviceDrag(int device, const Context& ctx) : impl_(std::make_unique<Impl>(device, ctx)) {}
DeviceDrag::~DeviceDrag() = default;

const std::string& DeviceDrag::name() const { return impl_->name; }

void DeviceDrag::attach(const DrawnBuffers& buffers) { impl_->shared.emplace(buffers); }

void DeviceDrag::begin(const DragJob& job, const DragMoves& rest) {
    Impl& impl = *impl_;
    impl.stages.reset();
    impl.exec.reset();
    impl.exec.reserve(count_bytes(job));
    impl.kernel = job.contacts.field.kernel();
    if (!impl.shared) {
        impl.own = {impl.exec.array<Vec3>(job.drawn.size()), impl.exec.array<Vec3>(job.shaded())};
        impl.exec.write(job.drawn, impl.own.positions);
    }
    impl.stages.emplace(impl.exec, job);
    impl.make(rest);
}

void DeviceDrag::make(const DragMoves& moves) { impl_->make(moves); }

void DeviceDrag::download(std::span<Vec3> positions, std::span<Vec3> normals) {
    const auto copy = [&](std::span<const Vec3> from, std::span<Vec3> to) {
        impl_->exec.download(from.first(to.size()), to);
    };
    copy(impl_->own.positions, positions);
    copy(impl_->own.normals, normals);
}

}  // namespace coppice::bench
