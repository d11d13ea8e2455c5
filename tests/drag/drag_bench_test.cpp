#include "drag/drag_bench.h"

#include <cmath>

#include "drag/branch_drag.h"
#include "drag/drag_part.h"
#include "drag/dragged_surface.h"
#include "errors.h"
#include "view/view_scenes.h"

namespace coppice::bench {
namespace {

using test::small_picture;
using test::small_tree;

class DragBench : public test::ViewTest {};

/// Draws frames of a branch at any angle.
class Frames {
  public:
    Frames()
        : build_(build_quads(small_tree())),
          drag_(build_, branch_of_about(build_.skeleton, 30), {1, 0, 0}),
          part_(drag_part(build_, drag_, kMax)),
          surface_(build_, part_),
          triangles_(triangulate(
              QuadMesh{{surface_.positions().begin(), surface_.positions().end()}, part_.quads, {}})),
          view_({surface_.positions(), surface_.normals(), triangles_.triangles},
                test::camera_for(surface_.positions(), small_picture()), small_picture()),
          backend_(cpu_backend()),
          pose_(drag_.rest()) {
        backend_->begin({build_, drag_, part_}, view_.buffers(), {});
    }

    Image rest() {
        view_.draw();
        return view_.picture();
    }
    Image at(double angle) {
        drag_.turn(angle, pose_);
        backend_->make(pose_, {});
        backend_->deliver();
        return rest();
    }

    static constexpr double kMax = 0.35;

  private:
    QuadBuild build_;
    BranchDrag drag_;
    DragPart part_;
    DraggedSurface surface_;
    TriMesh triangles_;
    SurfaceView view_;
    std::unique_ptr<SurfaceBackend> backend_;
    DragPose pose_;
};

TEST_F(DragBench, DraggedBranchIsVisibleAndReturnsBitIdentically) {
    Frames frames;
    const Image rest = frames.rest();
    EXPECT_EQ(frames.at(0), rest);
    const Image dragged = frames.at(Frames::kMax);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < rest.pixels.size(); ++i)
        changed += rest.pixels[i] != dragged.pixels[i] ? 1 : 0;
    EXPECT_GT(changed, 100u);
    EXPECT_LT(changed, rest.pixels.size() / 2);
    EXPECT_NE(frames.at(-Frames::kMax), dragged);
    EXPECT_EQ(frames.at(0), rest);
}

TEST_F(DragBench, ReportsItsCountsAndTimes) {
    const QuadBuild build = build_quads(small_tree());
    const auto backend = cpu_backend();
    const DragFigures result = measure_drag(build, {.frames = 6, .segments = 30}, small_picture(), *backend);
    EXPECT_FALSE(result.renderer.empty());
    EXPECT_EQ(result.backend, "CPU");
    EXPECT_EQ(result.frames, 6u);
    EXPECT_EQ(result.quads, build.refinement.quad_count());
    EXPECT_EQ(result.vertices, build.refined.size());
    EXPECT_GT(result.written, 0u);
    EXPECT_LT(result.written, result.vertices);
    EXPECT_GT(result.segments, 10u);
    EXPECT_LT(result.segments, 90u);
    EXPECT_EQ(result.seconds.frame.n, 6u);
    EXPECT_GT(result.seconds.surface.p50, 0);
    EXPECT_GE(result.seconds.frame.max, result.seconds.draw.max);
    EXPECT_NEAR(result.frames_per_second, 1 / result.seconds.frame.mean, 1e-6 / result.seconds.frame.mean);
    ASSERT_EQ(result.pictures.size(), 4u);
    EXPECT_NE(result.pictures.front(), result.pictures.back());
}

/// Four frames of the small tree, and the backend that computed them.
DragFigures small_drag(SurfaceBackend& backend) {
    return measure_drag(build_quads(small_tree()), {.frames = 4, .segments = 30}, small_picture(), backend);
}

TEST_F(DragBench, WithoutACardThrowsOrUsesTheCpu) {
    const DeviceSearch search = find_device();
    if (search.device) GTEST_SKIP() << "there is a card: " << search.device->name;
    const auto requested = surface_backend(Device::cuda), left = surface_backend(Device::automatic);
    EXPECT_THROW(small_drag(*requested), DeviceError);
    const DragFigures by_itself = small_drag(*left);
    EXPECT_EQ(by_itself.backend, "CPU");
    EXPECT_EQ(by_itself.note, "");
    EXPECT_EQ(by_itself.pictures, small_drag(*cpu_backend()).pictures);
}

TEST_F(DragBench, ACardMatchesTheCpu) {
    const DeviceSearch search = find_device();
    if (!search.device) GTEST_SKIP() << "there is no card: " << search.missing;
    const auto card = surface_backend(Device::cuda), cpu = surface_backend(Device::cpu);
    const DragFigures here = small_drag(*card), there = small_drag(*cpu);
    EXPECT_EQ(here.note.empty(), here.backend.find("through the host") == std::string::npos) << here.note;
    EXPECT_NE(here.backend, "CPU");
    EXPECT_EQ(there.backend, "CPU");
    ASSERT_EQ(here.pictures.size(), there.pictures.size());
    for (std::size_t k = 0; k < here.pictures.size(); ++k) {
        // Positions differ by much less than a pixel: a few pixels along edges may differ.
        std::size_t differing = 0;
        const auto &a = here.pictures[k].pixels, &b = there.pictures[k].pixels;
        for (std::size_t i = 0; i < a.size(); ++i) differing += a[i] != b[i] ? 1 : 0;
        EXPECT_LT(differing, a.size() / 100);
    }
}

TEST_F(DragBench, OneFrameIsTheTreeAtRest) {
    const QuadBuild build = build_quads(small_tree());
    const auto backend = cpu_backend();
    const auto first = [&](int frames) {
        return measure_drag(build, {.frames = frames, .segments = 30}, small_picture(), *backend)
            .pictures.front();
    };
    EXPECT_EQ(first(1), first(2));
}

TEST_F(DragBench, RejectsATreeWithoutABranch) {
    const QuadBuild ball = build_quads(Skeleton({NodeId{}}, {Vec3{}}, {1.0f}));
    const auto backend = cpu_backend();
    EXPECT_EQ(test::error_of([&] { measure_drag(ball, {}, small_picture(), *backend); }),
              "a tree without segments has no branch to drag");
}

TEST_F(DragBench, StopsWhenCancelled) {
    const QuadBuild build = build_quads(small_tree());
    const auto backend = cpu_backend();
    std::stop_source stop;
    int reports = 0;
    const Context ctx{.stop = stop.get_token(), .progress = [&](float) {
                          if (++reports == 2) stop.request_stop();
                      }};
    EXPECT_THROW(measure_drag(build, {.frames = 50}, small_picture(), *backend, ctx), Cancelled);
    EXPECT_EQ(reports, 2);
}

}  // namespace
}  // namespace coppice::bench
