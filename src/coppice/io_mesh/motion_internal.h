#pragma once

#include <memory>

#include "coppice/io_mesh/motion_writer.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice {

class MotionWriter::Format {
  public:
    virtual ~Format() = default;
    virtual void add(std::span<const Vec3> positions, const Context& ctx) = 0;
    virtual void finish(const Context& ctx) = 0;  ///< commits the file
};

namespace io_internal {

std::unique_ptr<MotionWriter::Format> glb_motion(const MeshView& rest, std::size_t frames, double rate);
std::unique_ptr<MotionWriter::Format> usda_motion(const MeshView& rest, std::size_t frames, double rate);

}  // namespace io_internal
}  // namespace coppice
