#include "coppice/scene/animation/animation.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"
#include "errors.h"

namespace coppice {
namespace {

// A trunk with one branch of two segments along x.
Skeleton fork() {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
            {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}, {1, 0, 2}, {2, 0, 2}},
            {0.2f, 0.2f, 0.15f, 0.1f, 0.1f}};
}

AnimationOptions options() {
    AnimationOptions out;
    out.run.rate = 10;
    out.mesh.levels = 1;
    return out;
}

/// Records its input.
class Recorder : public FrameSink {
  public:
    struct Seen {
        std::vector<QuadMesh> frames;
        std::vector<Texture> textures;
        int finished = 0;
    };
    explicit Recorder(Seen& seen) : seen_(seen) {}
    void add(const SurfaceFrame& frame, const Context&) override {
        seen_.frames.push_back(frame.mesh);
        const auto& [points, blends] = frame.texture;
        seen_.textures.push_back(
            {.points{points.begin(), points.end()}, .blends{blends.begin(), blends.end()}});
    }
    void finish(const Context&) override { ++seen_.finished; }

  private:
    Seen& seen_;
};

FrameSinks recording(Recorder::Seen& seen) {
    FrameSinks sinks;
    sinks.push_back(std::make_unique<Recorder>(seen));
    return sinks;
}

TEST(Animation, LengthFollowsTheKeysOrTheDuration) {
    AnimationOptions o = options();
    const auto keys = [] { return Keyframes(fork(), "0.5: rotate 3 30", "k"); };
    EXPECT_EQ(Motion(fork(), keys(), o).seconds(), 0.5);
    EXPECT_EQ(Motion(fork(), keys(), o).frames(), 6u);  // including the last moment
    EXPECT_EQ(Motion(fork(), keys(), o).keys(), 2u);    // including the rest pose before it
    o.wind.speed = 8;
    EXPECT_EQ(Motion(fork(), keys(), o).frames(), 5u);  // periodic
    EXPECT_EQ(Motion(fork(), std::nullopt, o).seconds(), 4);
    o.run.duration = 0.2f;
    EXPECT_EQ(Motion(fork(), keys(), o).frames(), 2u);
    EXPECT_EQ(growth_frames(o.run).frames, 2u);
    o.run.duration = 3600;
    EXPECT_NE(test::error_of<InvalidInput>([&] { Motion(fork(), keys(), o); }).find("make 36000 frames"),
              std::string::npos);
    EXPECT_THROW(growth_frames(o.run), InvalidInput);
}

TEST(Animation, RequiresAMovement) {
    AnimationOptions o = options();
    EXPECT_THROW(check_animation(o, false), InvalidInput);
    EXPECT_NO_THROW(check_animation(o, true));
    o.grow = true;
    EXPECT_NO_THROW(check_animation(o, false));
    EXPECT_THROW(check_animation(o, true), InvalidInput);
    o.mesh.method = MeshMethod::cylinders;
    EXPECT_THROW(check_animation(o, false), InvalidInput);
    o = options();
    o.wind.speed = 1;
    EXPECT_NO_THROW(check_animation(o, false));
}

TEST(Animation, SinksReceiveEveryFrame) {
    const AnimationOptions o = options();
    const Motion motion(fork(), Keyframes(fork(), "0.3: rotate 3 30", "k"), o);
    SkinnedMesh mesh(fork(), o.mesh);
    const FrameSeries series = make_series(mesh, motion, o);
    EXPECT_EQ(series.count, 4u);
    Recorder::Seen seen;
    const MotionReport report = make_frames(mesh, motion, recording(seen), {});
    ASSERT_EQ(seen.frames.size(), 4u);
    EXPECT_EQ(seen.finished, 1);
    EXPECT_EQ(report.frozen, 0u);
    EXPECT_EQ(seen.frames[0].quads, series.rest->quads);
    EXPECT_NE(seen.frames[3].positions, seen.frames[0].positions);
    EXPECT_EQ(to_text(report, 4, 1000), "4 frames of 1,000 quads");
}

TEST(Animation, FramesHaveTheTextureOfTheSurfaceAtRest) {
    AnimationOptions o = options();
    o.mesh.texture = {.coordinates = TextureCoordinates::bark, .tile = 0.1f, .blend = true};
    o.materials = {{.color = "bark_color.png"}};
    const Motion motion(fork(), Keyframes(fork(), "0.3: rotate 3 30", "k"), o);
    SkinnedMesh mesh(fork(), o.mesh);
    const FrameSeries series = make_series(mesh, motion, o);
    const Texture expected = *mesh_skeleton(fork(), o.mesh).texture;
    EXPECT_TRUE(std::ranges::equal(series.texture.points, expected.points));
    EXPECT_TRUE(std::ranges::equal(series.texture.blends, expected.blends));
    ASSERT_EQ(series.materials.size(), 1u);
    EXPECT_EQ(series.materials[0].color, o.materials[0].color);
    Recorder::Seen seen;
    make_frames(mesh, motion, recording(seen), {});
    for (const Texture& texture : seen.textures) {
        EXPECT_EQ(texture.points, expected.points);
        EXPECT_EQ(texture.blends, expected.blends);
    }
}

TEST(Animation, GrowingTreesHaveATextureInEveryFrame) {
    AnimationOptions o = options();
    o.grow = true;
    o.run.duration = 0.3f;
    o.mesh.texture = {TextureCoordinates::bark, 0.1f};
    Recorder::Seen seen;
    make_frames(fork(), growth_frames(o.run), o, recording(seen), {});
    ASSERT_EQ(seen.textures.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(seen.textures[i].points.size(), 4 * seen.frames[i].quads.size());
}

TEST(Animation, ReportsFrozenFrames) {
    MotionReport report;
    report.frozen = 3;
    EXPECT_EQ(to_text(report, 1200, 37376),
              "1,200 frames of 37,376 quads; 3 with frozen branches that would fold or intersect");
}

TEST(Animation, GrowingTreeEndsWithTheWholeSurface) {
    AnimationOptions o = options();
    o.grow = true;
    o.run.duration = 0.3f;
    const Skeleton tree = fork();
    Recorder::Seen seen;
    EXPECT_EQ(make_frames(tree, growth_frames(o.run), o, recording(seen), {}), 0u);
    ASSERT_EQ(seen.frames.size(), 3u);
    EXPECT_EQ(seen.frames.back().positions, mesh_skeleton(tree, o.mesh).quads().mesh.positions);
}

}  // namespace
}  // namespace coppice
