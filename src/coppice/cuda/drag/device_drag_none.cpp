#include "coppice/cuda/drag/device_drag.h"

namespace coppice {

int drawing_device() { return -1; }

struct DeviceDrag::Impl {
    std::string name;
};

DeviceDrag::DeviceDrag(int device, const Context&) { require_device(device); }
DeviceDrag::~DeviceDrag() = default;

// Without a GPU the constructor throws, so these are never called.
const std::string& DeviceDrag::name() const { return impl_->name; }
void DeviceDrag::attach(const DrawnBuffers&) {}
void DeviceDrag::begin(const cuda::DragJob&, const cuda::DragMoves&) {}
void DeviceDrag::make(const cuda::DragMoves&) {}
void DeviceDrag::download(std::span<Vec3>, std::span<Vec3>) {}

}  // namespace coppice
