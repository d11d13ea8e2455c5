#include "coppice/cuda/quads/device_printed_quads.cu"
#include "coppice/cuda/quads/device_quads.cu"
