#pragma once

// The header of the interoperation includes the header of OpenGL, for the name of a type.
#include <cuda_gl_interop.h>

#include <array>
#include <cstddef>
#include <span>

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "drag/device_drag.h"
#include "drag/drag_stages.h"

namespace coppice::bench {

/// OpenGL buffers that are registered with CUDA.
class SharedBuffers {
  public:
    /// See find_drawing_device().
    static int find_drawing_device() {
        unsigned count = 0;
        int device = -1;
        if (cudaGLGetDevices(&count, &device, 1, cudaGLDeviceListAll) == cudaSuccess && count > 0)
            return device;
        cudaGetLastError();  // the return value reports the error
        return -1;
    }
    /// Throws DeviceError if the GPU does not draw from them.
    explicit SharedBuffers(const DrawnBuffers& names) {
        // Elements that a frame does not write must be preserved, so the contents may not be discarded.
        constexpr unsigned kKeep = cudaGraphicsRegisterFlagsNone;
        cuda::check(cudaGraphicsGLRegisterBuffer(&buffers_[0], names.positions, kKeep),
                    "share a buffer of OpenGL");
        const cudaError_t second = cudaGraphicsGLRegisterBuffer(&buffers_[1], names.normals, kKeep);
        if (second != cudaSuccess) cudaGraphicsUnregisterResource(buffers_[0]);
        cuda::check(second, "share a buffer of OpenGL");
    }
    ~SharedBuffers() {
        for (cudaGraphicsResource_t const buffer : buffers_) cudaGraphicsUnregisterResource(buffer);
    }
    SharedBuffers(const SharedBuffers&) = delete;
    SharedBuffers& operator=(const SharedBuffers&) = delete;

    /// Calls write(vertices) while the buffers are mapped: earlier OpenGL commands finish before work that
    /// `write` starts on the executor, and later ones run after it.
    template <class Write>
    void lend(cuda::CudaExecutor& exec, const Write& write) {
        Mapped mapped(buffers_, exec.stream());
        write(DrawnVertices{map_vertices(buffers_[0]), map_vertices(buffers_[1])});
        mapped.give_back();
    }

  private:
    using Pair = std::array<cudaGraphicsResource_t, 2>;  // positions, normals
    static constexpr int kCount = 2;

    // Unmaps the buffers also after an exception.
    class Mapped {
      public:
        Mapped(Pair& buffers, cudaStream_t stream) : buffers_(buffers), stream_(stream) {
            cuda::check(cudaGraphicsMapResources(kCount, buffers_.data(), stream_), "map buffers of OpenGL");
        }
        ~Mapped() {
            if (is_mapped_) cudaGraphicsUnmapResources(kCount, buffers_.data(), stream_);
        }
        Mapped(const Mapped&) = delete;
        Mapped& operator=(const Mapped&) = delete;

        void give_back() {
            is_mapped_ = false;
            cuda::check(cudaGraphicsUnmapResources(kCount, buffers_.data(), stream_),
                        "unmap buffers of OpenGL");
        }

      private:
        Pair& buffers_;
        cudaStream_t stream_;
        bool is_mapped_ = true;
    };

    static std::span<Vec3> map_vertices(cudaGraphicsResource_t buffer) {
        void* begin = nullptr;
        std::size_t bytes = 0;
        cuda::check(cudaGraphicsResourceGetMappedPointer(&begin, &bytes, buffer),
                    "access a buffer of OpenGL");
        return {static_cast<Vec3*>(begin), bytes / sizeof(Vec3)};
    }

    Pair buffers_{};
};

}  // namespace coppice::bench
