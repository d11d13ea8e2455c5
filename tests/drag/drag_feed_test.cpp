#include "drag/drag_feed.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/skeleton/random_tree.h"
#include "cuda/strict_executor.h"
#include "drag/drag_stages.h"
#include "drag/dragged_surface.h"
#include "drag_scenes.h"
#include "zoo.h"

namespace coppice::bench {
namespace {

using cuda::QuadStages;
using cuda::StrictExecutor;
using test::Dragged;
using test::kMax;

constexpr std::array<double, 5> kSwing{0, 0.11, kMax, -kMax, 0};

/// The frames of a drag by the kernels of a GPU, on the CPU. From the third one on they are recorded
/// launches.
class ByKernels {
  public:
    ByKernels(const QuadBuild& build, const BranchDrag& drag, const DragPart& part,
              const std::optional<cuda::ListRoom>& room = {})
        : feed_(build, drag, part) {
        const DragJob job = feed_.job();
        drawn_ = {exec_.array<Vec3>(job.drawn.size()), exec_.array<Vec3>(job.shaded())};
        exec_.write(job.drawn, drawn_.positions);
        stages_.emplace(exec_, job, room);
        kernel_ = job.contacts.field.kernel();
    }

    /// Computes a frame; returns the number of attempts.
    int make(const DragPose& pose) {
        int begun = 0;
        do {
            ++begun;
            stages_->begin(feed_.moves(pose), drawn_,
                           [&](QuadStages<StrictExecutor>& quads, const cuda::FieldArrays& field) {
                               cuda::with_formula(kernel_, [&](const auto& formula) {
                                   quads.project(cuda::FieldView(formula, field));
                               });
                           });
        } while (!stages_->has_room());
        download(drawn_.positions, positions_);
        download(drawn_.normals, normals_);
        return begun;
    }
    std::span<const Vec3> positions() const { return positions_; }
    std::span<const Vec3> normals() const { return normals_; }

  private:
    void download(std::span<const Vec3> from, Buffer<Vec3>& to) {
        to.resize(from.size());
        exec_.download(from, std::span(to));
    }

    DragFeed feed_;
    StrictExecutor exec_;
    DrawnVertices drawn_;
    std::optional<DragStages<StrictExecutor>> stages_;
    KernelConstants kernel_;
    Buffer<Vec3> positions_, normals_;
};

/// Number of vertices that differ from those of the CPU, among those that frames write.
struct Differing {
    std::size_t positions = 0, normals = 0, all = 0;
};

/// [m] Radius of the closest node.
float local_radius(const QuadBuild& build, const DragPose& pose, Vec3 p) {
    float nearest = std::numeric_limits<float>::infinity(), radius = 0;
    for (std::size_t n = 0; n < pose.nodes.size(); ++n) {
        const float away = distance(pose.nodes[n], p);
        if (away >= nearest) continue;
        nearest = away;
        radius = build.skeleton.radius(NodeId(static_cast<std::uint32_t>(n)));
    }
    return radius;
}

Differing differing(const Dragged& d, const DragPose& pose, const DraggedSurface& cpu,
                    const ByKernels& kernels) {
    Differing out{.all = d.part.written};
    for (std::size_t i = 0; i < d.part.written; ++i) {
        const Vec3 p = cpu.positions()[i];
        const float away = distance(p, kernels.positions()[i]);
        if (away == 0) continue;
        // Coordinates have a relative rounding error of 6e-8, several times.
        out.positions += !(away <= 1e-4f * local_radius(d.build, pose, p) + 1e-6f * length(p));
    }
    for (std::size_t i = 0; i < d.part.shaded; ++i)
        out.normals += !(distance(cpu.normals()[i], kernels.normals()[i]) <= 1e-2f);
    return out;
}

/// Compares a swing frame by frame; returns the total number of different vertices.
Differing swing(const Dragged& d, ByKernels& kernels) {
    DraggedSurface cpu(d.build, d.part);
    DragPose pose = d.drag.rest();
    Differing sum;
    for (const double angle : kSwing) {
        SCOPED_TRACE(angle);
        d.drag.turn(angle, pose);
        cpu.make(pose);
        kernels.make(pose);
        const Differing frame = differing(d, pose, cpu, kernels);
        sum.positions += frame.positions;
        sum.normals += frame.normals;
        sum.all += frame.all;
        // Vertices that are not written remain bit-identical.
        EXPECT_TRUE(std::ranges::equal(kernels.positions().subspan(d.part.written),
                                       cpu.positions().subspan(d.part.written)));
    }
    return sum;
}

/// `share` of the vertices may differ: rays in a plane of symmetry, or that touch a wall between branches,
/// end on one side or the other by rounding.
void expect_same(const Dragged& d, double share = 0) {
    ByKernels kernels(d.build, d.drag, d.part);
    const Differing found = swing(d, kernels);
    const auto all = static_cast<double>(found.all);
    EXPECT_GT(found.all, 1000u);
    EXPECT_LE(static_cast<double>(found.positions), share * all);
    // A different vertex also changes the normals of its eight neighbours.
    EXPECT_LE(static_cast<double>(found.normals), 9 * share * all);
}

TEST(DragFeed, FramesByKernelsMatchTheCpu) { expect_same(Dragged(random_tree(400, 3))); }

TEST(DragFeed, MatchesTheCpuForOverlappingBranches) {
    expect_same(Dragged(random_tree(600, 4, true), {}, 150), 1.0 / 300);
}

TEST(DragFeed, MatchesTheCpuForOtherEndsFieldsAndMethods) {
    MeshOptions flat, balls, walked;
    flat.control.tips = TipShape::flat;
    flat.levels = 1;
    balls.method = MeshMethod::bmesh;
    balls.levels = 1;
    walked.project.method = ProjectionMethod::gradient;
    walked.field.kernel = Kernel::cauchy;
    walked.levels = 1;
    for (const MeshOptions& options : {flat, balls, walked})
        expect_same(Dragged(random_tree(200, 3), options), 1.0 / 1000);
}

TEST(DragFeed, MatchesTheCpuIfTheWholeIsRelaxed) {
    MeshOptions relaxed;
    relaxed.project.relax_passes = 1;
    relaxed.levels = 1;
    const Dragged d(random_tree(200, 3), relaxed);
    EXPECT_EQ(d.part.written, d.part.vertex.size());
    expect_same(d, 1.0 / 1000);
}

TEST(DragFeed, FewVerticesDifferOnTheZoo) {
    Differing sum;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const QuadBuild build = build_quads(skeleton);
        if (!branch_of_about(build.skeleton, 5)) continue;
        const Dragged d(skeleton, {}, 5);
        ByKernels kernels(d.build, d.drag, d.part);
        const Differing found = swing(d, kernels);
        sum.positions += found.positions;
        sum.all += found.all;
    }
    EXPECT_LT(sum.positions, sum.all / 200);
}

TEST(DragFeed, RepeatsAFrameWithMoreRoomForLists) {
    const Dragged d(random_tree(200, 3));
    ByKernels kernels(d.build, d.drag, d.part, cuda::ListRoom{1, 1}), roomy(d.build, d.drag, d.part);
    const DragPose pose = d.at(0.2);
    EXPECT_EQ(roomy.make(pose), 1);
    // First the own lists are counted, then those of competing segments.
    EXPECT_EQ(kernels.make(pose), 3);
    EXPECT_EQ(kernels.make(pose), 1);
    EXPECT_TRUE(std::ranges::equal(kernels.positions(), roomy.positions()));
    EXPECT_TRUE(std::ranges::equal(kernels.normals(), roomy.normals()));
}

TEST(DragFeed, NormalsOfFixedVerticesAreThoseAtRest) {
    const Dragged d(random_tree(200, 3));
    ByKernels kernels(d.build, d.drag, d.part);
    const DraggedSurface rest(d.build, d.part);
    kernels.make(d.drag.rest());
    ASSERT_EQ(kernels.normals().size(), d.part.shaded);
    ASSERT_GT(d.part.shaded, d.part.written);
    for (std::size_t i = 0; i < d.part.shaded; ++i)
        EXPECT_LT(distance(kernels.normals()[i], rest.normals()[i]), 1e-2f);
}

}  // namespace
}  // namespace coppice::bench
