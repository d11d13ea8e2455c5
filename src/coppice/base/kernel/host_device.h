#pragma once

/// Marks functions that a CUDA build compiles for host and device.
#ifdef __CUDACC__
#define COPPICE_HOST_DEVICE __host__ __device__
#else
#define COPPICE_HOST_DEVICE
#endif

/// For functions that must be inlined into the calling loop.
#define COPPICE_ALWAYS_INLINE inline __attribute__((always_inline))
