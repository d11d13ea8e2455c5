#include "coppice/view/edit_demo.h"

#include <cmath>

#include "errors.h"
#include "view_scenes.h"

namespace coppice {
namespace {

using test::small_picture;
using test::small_tree;

class EditDemoTest : public test::ViewTest {};

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

TEST_F(EditDemoTest, DraggedBranchIsVisibleAndReturnsBitIdentically) {
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

TEST_F(EditDemoTest, ReportsItsCountsAndTimes) {
    const QuadBuild build = build_quads(small_tree());
    const auto backend = cpu_backend();
    const EditDemoResult result = edit_demo(build, {.frames = 6, .segments = 30}, small_picture(), *backend);
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
EditDemoResult small_demo(SurfaceBackend& backend) {
    return edit_demo(build_quads(small_tree()), {.frames = 4, .segments = 30}, small_picture(), backend);
}

TEST_F(EditDemoTest, WithoutACardThrowsOrUsesTheCpu) {
    const DeviceSearch search = find_device();
    if (search.device) GTEST_SKIP() << "there is a card: " << search.device->name;
    const auto requested = surface_backend(Device::cuda), left = surface_backend(Device::automatic);
    EXPECT_THROW(small_demo(*requested), DeviceError);
    const EditDemoResult by_itself = small_demo(*left);
    EXPECT_EQ(by_itself.backend, "CPU");
    EXPECT_EQ(by_itself.note, "");
    EXPECT_EQ(by_itself.pictures, small_demo(*cpu_backend()).pictures);
}

TEST_F(EditDemoTest, ACardMatchesTheCpu) {
    const DeviceSearch search = find_device();
    if (!search.device) GTEST_SKIP() << "there is no card: " << search.missing;
    const auto card = surface_backend(Device::cuda), cpu = surface_backend(Device::cpu);
    const EditDemoResult here = small_demo(*card), there = small_demo(*cpu);
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

TEST_F(EditDemoTest, OneFrameIsTheTreeAtRest) {
    const QuadBuild build = build_quads(small_tree());
    const auto backend = cpu_backend();
    const auto first = [&](int frames) {
        return edit_demo(build, {.frames = frames, .segments = 30}, small_picture(), *backend)
            .pictures.front();
    };
    EXPECT_EQ(first(1), first(2));
}

TEST_F(EditDemoTest, RejectsATreeWithoutABranch) {
    const QuadBuild ball = build_quads(Skeleton({NodeId{}}, {Vec3{}}, {1.0f}));
    const auto backend = cpu_backend();
    EXPECT_EQ(test::error_of([&] { edit_demo(ball, {}, small_picture(), *backend); }),
              "view: a tree without segments has no branch to drag");
    EXPECT_EQ(test::error_of([&] { edit_demo(ball, {.frames = 0}, small_picture(), *backend); }),
              "view: frames must be between 1 and 1000000, but is 0");
}

TEST_F(EditDemoTest, StopsWhenCancelled) {
    const QuadBuild build = build_quads(small_tree());
    const auto backend = cpu_backend();
    std::stop_source stop;
    int reports = 0;
    const Context ctx{.stop = stop.get_token(), .progress = [&](float) {
                          if (++reports == 2) stop.request_stop();
                      }};
    EXPECT_THROW(edit_demo(build, {.frames = 50}, small_picture(), *backend, ctx), Cancelled);
    EXPECT_EQ(reports, 2);
}

TEST_F(EditDemoTest, DrawsASurfaceOnce) {
    const QuadBuild build = build_quads(small_tree());
    const ViewResult result =
        view_surface(to_polygons(QuadMesh{build.refined, build.refinement.quads()}), small_picture());
    EXPECT_EQ(result.picture.width, 320);
    EXPECT_EQ(result.picture.height, 240);
    EXPECT_NE(result.picture.at(160, 120), result.picture.at(0, 0));
}

}  // namespace
}  // namespace coppice
