#pragma once

/// Marks what a CUDA build compiles for both sides.
#ifdef __CUDACC__
#define COPPICE_HOST_DEVICE __host__ __device__
#else
#define COPPICE_HOST_DEVICE
#endif

/// For what has to be part of the loop that it is called from.
#define COPPICE_ALWAYS_INLINE inline __attribute__((always_inline))
