#include "coppice/cuda/quads/device_quads.cu"
