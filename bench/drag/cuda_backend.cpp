#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "coppice/base/column.h"
#include "drag/device_drag.h"
#include "drag/drag_feed.h"
#include "drag/surface_backend.h"

namespace coppice::bench {
namespace {

// Dragging on a GPU: writes directly into the buffers if the same GPU draws and OpenGL shares them, otherwise
// copies through the host.
class CardFrames {
  public:
    CardFrames(const DragScene& scene, const VertexBuffers& buffers, const Context& ctx)
        : buffers_(buffers),
          feed_(scene.build, scene.drag, scene.part, ctx),
          device_(std::max(0, find_drawing_device()), ctx) {
        if (scene.build.field.contact == 0)
            throw DeviceError("the lists of a field without contact are computed on the CPU");
        is_direct_ = attach();
        if (!is_direct_) {
            positions_.resize(scene.part.written);
            normals_.resize(scene.part.shaded);
        }
        device_.begin(feed_.job(), feed_.moves(scene.drag.rest()));
    }

    std::string name() const { return device_.name() + (is_direct_ ? "" : ", copied through the host"); }
    const std::string& note() const { return note_; }  // the reason for copying through the host
    void make(const DragPose& pose) { device_.make(feed_.moves(pose)); }
    void deliver() {
        if (is_direct_) return;
        device_.download(positions_, normals_);
        write_vertices(buffers_, positions_, normals_);
    }

  private:
    bool attach() {
        try {
            device_.attach({buffers_.positions, buffers_.normals});
            return true;
        } catch (const DeviceError& error) {
            note_ = fmt::format("frames are copied through the host: {}", error.what());
            return false;
        }
    }

    VertexBuffers buffers_;
    DragFeed feed_;
    DeviceDrag device_;
    bool is_direct_ = false;
    std::string note_;
    Buffer<Vec3> positions_, normals_;  // copies in the host
};

// Computes surfaces on a GPU, and on the CPU after an error of the GPU.
class CudaBackend : public SurfaceBackend {
  public:
    explicit CudaBackend(Device wanted) : wanted_(wanted) {}

    std::string name() const override { return name_; }
    std::string note() const override { return note_; }

    void begin(const DragScene& scene, const VertexBuffers& buffers, const Context& ctx) override {
        scene_.emplace(scene);
        buffers_ = buffers;
        if (wanted_ == Device::cuda) require_device();
        if (!is_wanted()) return begin_on_cpu(ctx);
        on_card(ctx, [&] {
            card_.emplace(scene, buffers, ctx);
            name_ = card_->name();
            note_ = card_->note();
        });
    }
    void make(const DragPose& pose, const Context& ctx) override {
        if (card_) on_card(ctx, [&] { card_->make(pose); });
        if (!card_) cpu_->make(pose, ctx);
    }
    void deliver() override { card_ ? card_->deliver() : cpu_->deliver(); }
    void end() noexcept override {
        card_.reset();
        if (cpu_) cpu_->end();
        scene_.reset();
    }

  private:
    // The automatic choice is the GPU that draws.
    bool is_wanted() const {
        if (wanted_ != Device::automatic) return wanted_ == Device::cuda;
        const int device = find_drawing_device();
        return device >= 0 && find_device(device).device.has_value();
    }
    void begin_on_cpu(const Context& ctx) {
        cpu_ = cpu_backend();
        name_ = cpu_->name();
        cpu_->begin(*scene_, buffers_, ctx);
    }
    template <class Work>
    void on_card(const Context& ctx, const Work& work) {
        try {
            work();
        } catch (const DeviceError& error) {
            note_ = fmt::format("{}; the CPU computed the surfaces", error.what());
            card_.reset();
            begin_on_cpu(ctx);
        }
    }

    Device wanted_;
    std::string name_, note_;
    std::optional<DragScene> scene_;
    VertexBuffers buffers_;
    std::optional<CardFrames> card_;
    std::unique_ptr<SurfaceBackend> cpu_;
};

}  // namespace

std::unique_ptr<SurfaceBackend> surface_backend(Device wanted) {
    return std::make_unique<CudaBackend>(wanted);
}

}  // namespace coppice::bench
