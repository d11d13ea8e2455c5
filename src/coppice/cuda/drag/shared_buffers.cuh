#pragma once

// The header of the interoperation includes that of OpenGL, for the name of a type.
#include <cuda_gl_interop.h>

#include <array>
#include <cstddef>
#include <span>

#include "coppice/cuda/drag/device_drag.h"
#include "coppice/cuda/drag/drag_stages.h"
#include "coppice/cuda/exec/cuda_executor.cuh"

namespace coppice::cuda {

/// Buffers of OpenGL that CUDA knows.
class SharedBuffers {
  public:
    /// see coppice::drawing_device()
    static int drawing_device() {
        unsigned count = 0;
        int device = -1;
        if (cudaGLGetDevices(&count, &device, 1, cudaGLDeviceListAll) == cudaSuccess && count > 0)
            return device;
        cudaGetLastError();  // it is told by what is returned
        return -1;
    }
    /// Throws DeviceError where the card does not draw from them.
    explicit SharedBuffers(const DrawnBuffers& names) {
        // What a frame does not write has to stay: not to be discarded.
        constexpr unsigned kKeep = cudaGraphicsRegisterFlagsNone;
        check(cudaGraphicsGLRegisterBuffer(&buffers_[0], names.positions, kKeep), "share a buffer of OpenGL");
        const cudaError_t second = cudaGraphicsGLRegisterBuffer(&buffers_[1], names.normals, kKeep);
        if (second != cudaSuccess) cudaGraphicsUnregisterResource(buffers_[0]);
        check(second, "share a buffer of OpenGL");
    }
    ~SharedBuffers() {
        for (cudaGraphicsResource_t const buffer : buffers_) cudaGraphicsUnregisterResource(buffer);
    }
    SharedBuffers(const SharedBuffers&) = delete;
    SharedBuffers& operator=(const SharedBuffers&) = delete;

    /// Calls write(vertices) while the buffers are the card's: what OpenGL was told before comes before what
    /// the executor is told by it, and what OpenGL is told later comes after.
    template <class Write>
    void lend(CudaExecutor& exec, const Write& write) {
        Mapped mapped(buffers_, exec.stream());
        write(DrawnVertices{vertices_of(buffers_[0]), vertices_of(buffers_[1])});
        mapped.give_back();
    }

  private:
    using Pair = std::array<cudaGraphicsResource_t, 2>;  // positions, normals
    static constexpr int kCount = 2;

    // Gives them back also where something throws.
    class Mapped {
      public:
        Mapped(Pair& buffers, cudaStream_t stream) : buffers_(buffers), stream_(stream) {
            check(cudaGraphicsMapResources(kCount, buffers_.data(), stream_), "take over buffers of OpenGL");
        }
        ~Mapped() {
            if (is_mapped_) cudaGraphicsUnmapResources(kCount, buffers_.data(), stream_);
        }
        Mapped(const Mapped&) = delete;
        Mapped& operator=(const Mapped&) = delete;

        void give_back() {
            is_mapped_ = false;
            check(cudaGraphicsUnmapResources(kCount, buffers_.data(), stream_),
                  "give back buffers of OpenGL");
        }

      private:
        Pair& buffers_;
        cudaStream_t stream_;
        bool is_mapped_ = true;
    };

    static std::span<Vec3> vertices_of(cudaGraphicsResource_t buffer) {
        void* begin = nullptr;
        std::size_t bytes = 0;
        check(cudaGraphicsResourceGetMappedPointer(&begin, &bytes, buffer), "reach a buffer of OpenGL");
        return {static_cast<Vec3*>(begin), bytes / sizeof(Vec3)};
    }

    Pair buffers_{};
};

}  // namespace coppice::cuda
