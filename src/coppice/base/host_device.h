#pragma once

/// Marks what a CUDA build compiles for both sides.
#ifdef __CUDACC__
#define COPPICE_HOST_DEVICE __host__ __device__
#else
#define COPPICE_HOST_DEVICE
#endif
