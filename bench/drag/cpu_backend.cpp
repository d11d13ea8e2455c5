#include <optional>

#include "drag/dragged_surface.h"
#include "drag/surface_backend.h"

namespace coppice::bench {
namespace {

class CpuBackend : public SurfaceBackend {
  public:
    std::string name() const override { return "CPU"; }

    void begin(const DragScene& scene, const VertexBuffers& buffers, const Context& ctx) override {
        surface_.emplace(scene.build, scene.part, ctx);
        written_ = scene.part.written;
        shaded_ = scene.part.shaded;
        buffers_ = buffers;
    }

    void make(const DragPose& pose, const Context& ctx) override { surface_->make(pose, ctx); }

    void deliver() override {
        write_vertices(buffers_, surface_->positions().first(written_), surface_->normals().first(shaded_));
    }

    void end() noexcept override { surface_.reset(); }

  private:
    std::optional<DraggedSurface> surface_;
    std::uint32_t written_ = 0, shaded_ = 0;
    VertexBuffers buffers_;
};

}  // namespace

std::unique_ptr<SurfaceBackend> cpu_backend() { return std::make_unique<CpuBackend>(); }

}  // namespace coppice::bench
