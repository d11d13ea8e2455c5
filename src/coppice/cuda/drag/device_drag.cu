// The header of the interoperation includes that of OpenGL, for the name of a type.
#include <cuda_gl_interop.h>

#include <array>
#include <optional>

#include "coppice/cuda/drag/device_drag.h"
#include "coppice/cuda/drag/drag_stages.h"
#include "coppice/cuda/quads/device_quads.h"
#include "coppice/cuda/quads/project_field.cuh"

namespace coppice {
namespace {

using cuda::check;
using cuda::CudaExecutor;
using cuda::DrawnVertices;
using BufferPair = std::array<cudaGraphicsResource_t, 2>;  // positions, normals

// Buffers of OpenGL that CUDA knows.
class RegisteredBuffers {
  public:
    explicit RegisteredBuffers(const DrawnBuffers& names) {
        // What a frame does not write has to stay: not to be discarded.
        constexpr unsigned kKeep = cudaGraphicsRegisterFlagsNone;
        check(cudaGraphicsGLRegisterBuffer(&buffers_[0], names.positions, kKeep), "share a buffer of OpenGL");
        const cudaError_t second = cudaGraphicsGLRegisterBuffer(&buffers_[1], names.normals, kKeep);
        if (second != cudaSuccess) cudaGraphicsUnregisterResource(buffers_[0]);
        check(second, "share a buffer of OpenGL");
    }
    ~RegisteredBuffers() {
        for (cudaGraphicsResource_t const buffer : buffers_) cudaGraphicsUnregisterResource(buffer);
    }
    RegisteredBuffers(const RegisteredBuffers&) = delete;
    RegisteredBuffers& operator=(const RegisteredBuffers&) = delete;

    BufferPair& buffers() { return buffers_; }

  private:
    BufferPair buffers_{};
};

// Buffers that are the card's for now: what OpenGL was told before comes before what the stream is told from
// now on, and once they are given back the other way around.
class MappedBuffers {
  public:
    MappedBuffers(BufferPair& buffers, cudaStream_t stream) : buffers_(buffers), stream_(stream) {
        check(cudaGraphicsMapResources(kCount, buffers_.data(), stream_), "take over buffers of OpenGL");
    }
    ~MappedBuffers() {
        if (is_mapped_) cudaGraphicsUnmapResources(kCount, buffers_.data(), stream_);
    }
    MappedBuffers(const MappedBuffers&) = delete;
    MappedBuffers& operator=(const MappedBuffers&) = delete;

    DrawnVertices vertices() const { return {vertices_of(buffers_[0]), vertices_of(buffers_[1])}; }
    void give_back() {
        is_mapped_ = false;
        check(cudaGraphicsUnmapResources(kCount, buffers_.data(), stream_), "give back buffers of OpenGL");
    }

  private:
    static constexpr int kCount = 2;

    static std::span<Vec3> vertices_of(cudaGraphicsResource_t buffer) {
        void* begin = nullptr;
        std::size_t bytes = 0;
        check(cudaGraphicsResourceGetMappedPointer(&begin, &bytes, buffer), "reach a buffer of OpenGL");
        return {static_cast<Vec3*>(begin), bytes / sizeof(Vec3)};
    }

    BufferPair& buffers_;
    cudaStream_t stream_;
    bool is_mapped_ = true;
};

// Memory that frames take, about.
std::uint64_t bytes_of(const cuda::DragJob& job) {
    return cuda::kSlackBytes + cuda::bytes_of_job(job.quads) +
           cuda::bytes_of_contacts(job.contacts.field.segments().size(),
                                   job.contacts.control.region_node.size()) +
           job.drawn.size_bytes() + job.shaded() * sizeof(Vec3) + job.from.size_bytes() +
           job.fan_first.size_bytes() + job.fan_quads.size_bytes() + job.quads_about.size_bytes();
}

}  // namespace

struct DeviceDrag::Impl {
    int device;
    std::string name;
    CudaExecutor exec;
    std::optional<RegisteredBuffers> registered;
    std::optional<cuda::DragStages<CudaExecutor>> stages;
    DrawnVertices own;  // where there are no buffers
    KernelConstants kernel;

    Impl(int number, const Context& ctx) : device(number), name(require_device(number).name), exec(ctx) {}

    void begin(const cuda::DragMoves& moves, const DrawnVertices& drawn) {
        stages->begin(moves, drawn,
                      [&](cuda::QuadStages<CudaExecutor>& quads, const cuda::FieldArrays& field) {
                          cuda::project(quads, kernel, field);
                      });
    }
    void make(const cuda::DragMoves& moves) {
        check(cudaSetDevice(device), "be chosen");
        do {
            if (registered) {
                MappedBuffers mapped(registered->buffers(), exec.stream());
                begin(moves, mapped.vertices());
                mapped.give_back();
            } else {
                begin(moves, own);
            }
        } while (!stages->has_room());
    }
};

DeviceDrag::DeviceDrag(int device, const Context& ctx) : impl_(std::make_unique<Impl>(device, ctx)) {}
DeviceDrag::~DeviceDrag() = default;

const std::string& DeviceDrag::name() const { return impl_->name; }

void DeviceDrag::attach(const DrawnBuffers& buffers) { impl_->registered.emplace(buffers); }

void DeviceDrag::begin(const cuda::DragJob& job, const cuda::DragMoves& rest) {
    Impl& impl = *impl_;
    impl.stages.reset();
    impl.exec.reset();
    impl.exec.reserve(bytes_of(job));
    impl.kernel = job.contacts.field.kernel();
    if (!impl.registered) {
        impl.own = {impl.exec.array<Vec3>(job.drawn.size()), impl.exec.array<Vec3>(job.shaded())};
        impl.exec.write(job.drawn, impl.own.positions);
    }
    impl.stages.emplace(impl.exec, job);
    impl.make(rest);
}

void DeviceDrag::make(const cuda::DragMoves& moves) { impl_->make(moves); }

void DeviceDrag::download(std::span<Vec3> positions, std::span<Vec3> normals) {
    const auto copy = [&](std::span<const Vec3> from, std::span<Vec3> to) {
        impl_->exec.download(from.first(to.size()), to);
    };
    copy(impl_->own.positions, positions);
    copy(impl_->own.normals, normals);
}

}  // namespace coppice
