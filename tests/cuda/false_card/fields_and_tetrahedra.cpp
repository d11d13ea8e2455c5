#include "coppice/cuda/field/device_field.cu"
#include "coppice/cuda/tetra/tetra.cu"
