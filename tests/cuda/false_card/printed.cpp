#include "device_printed_march.cu"
#include "device_printed_quads.cu"
