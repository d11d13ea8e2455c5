#include "drag/device_drag.cu"
