#include "coppice/cuda/drag/device_drag.cu"
