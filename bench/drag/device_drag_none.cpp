#include "drag/device_drag.h"

namespace coppice::bench {

int find_drawing_device() { return -1; }

struct DeviceDrag::Impl {
    std::string name;
};

DeviceDrag::DeviceDrag(int device, const Context&) { require_device(device); }
DeviceDrag::~DeviceDrag() = default;

// Without a GPU the constructor throws, so these are never called.
const std::string& DeviceDrag::name() const { return impl_->name; }
void DeviceDrag::attach(const DrawnBuffers&) {}
void DeviceDrag::begin(const DragJob&, const DragMoves&) {}
void DeviceDrag::make(const DragMoves&) {}
void DeviceDrag::download(std::span<Vec3>, std::span<Vec3>) {}

}  // namespace coppice::bench
