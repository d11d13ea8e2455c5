#include <gtest/gtest.h>

#include <vector>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/cuda/tetra/march_stages_internal.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/polyhedron/polyhedron.h"
#include "on_executor.h"
#include "strict_executor.h"

namespace coppice::cuda {
namespace {

/// A tree in tetrahedra, truncated at its root.
struct CutTree {
    Skeleton skeleton = random_tree(60, 4, true);
    std::vector<Segment> axes = segment_axes(skeleton);
    Lattice lattice{axes, {.cell = 3.5f, .inside = 0.8f, .outside = 1.25f}};
    ConvolutionField field{skeleton, FieldOptions{.root_extension = 1.5f}};
    EndCuts ends;

    CutTree() {
        const std::uint32_t regions = lattice.mesh().region_count();
        field.set_regions(region_boxes(lattice.mesh()));
        ends.cuts.push_back({skeleton.position(NodeId(0)), {0, 0, -1}, skeleton.radius(NodeId(0))});
        ends.of_region = compress_rows<std::uint32_t>(regions, [&](const auto& put) {
            for (std::uint32_t r = 0; r < regions; ++r) put(r, 0u);
        });
    }
};

template <class Exec>
MarchResult marched(const CutTree& tree, int levels) {
    Exec exec;
    const CutConvolution field{tree.field, tree.ends};
    const InsideAxes axes{tree.axes, tree.lattice.passing()};
    const MarchOptions options{.levels = levels};
    const MarchJob job = upload_march(exec, {tree.lattice.mesh(), field, axes, options});
    return downloaded(exec, *march(exec, job));
}

TEST(MarchStages, MatchTheHostExecutorOnTheStrictOne) {
    const CutTree tree;
    for (const int levels : {0, 1, 2}) {
        SCOPED_TRACE(levels);
        const MarchResult host = marched<HostExecutor>(tree, levels);
        const MarchResult strict = marched<StrictExecutor>(tree, levels);
        ASSERT_GT(host.mesh.triangles.size(), 100u);
        EXPECT_EQ(strict.report, host.report);
        EXPECT_EQ(strict.mesh.triangles, host.mesh.triangles);
        EXPECT_EQ(strict.mesh.positions, host.mesh.positions);
    }
}

}  // namespace
}  // namespace coppice::cuda
