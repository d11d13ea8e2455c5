#include <algorithm>

#include "../march_support.h"
#include "../on_executor.h"
#include "../quads_case.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/skeleton/random_tree.h"
#include "device_printed_march.h"
#include "device_printed_quads.h"
#include "printed_quad_stages.h"

namespace coppice::bench {
namespace {

class DevicePrintedOnCard : public cuda::OnCard {};

TEST_F(DevicePrintedOnCard, MarchesToWatertightSurfaces) {
    const CutScene scene(random_tree(60, 4, true), 1, 0.6f);
    DevicePrintedMarch card;
    for (int round = 0; round < 2; ++round) {
        const TriMesh made = card.make(scene.mesh(), 1, scene.field);
        EXPECT_GT(made.triangles.size(), 100u);
        EXPECT_TRUE(topology(polygons(made)).watertight());
        card.repeat();
    }
    card.measure();
    card.repeat();
    EXPECT_FALSE(card.take_times().empty());
}

TEST_F(DevicePrintedOnCard, MakesTheQuadsOfTheCpu) {
    const cuda::QuadCase c(random_tree(60, 4), 2, {}, {.tips = TipShape::round, .base = BaseShape::round});
    cuda::HostExecutor exec;
    const cuda::FieldArrays arrays = cuda::upload_field(exec, c.field);
    PrintedQuadStages stages(exec, c.job());
    stages.refine();
    cuda::with_formula(c.field.kernel(),
                       [&](const auto& formula) { stages.evolve(cuda::FieldView(formula, arrays)); });
    DevicePrintedQuads card;
    for (int round = 0; round < 2; ++round) {
        const QuadMesh made = card.make(c.job(), c.field);
        EXPECT_TRUE(std::ranges::equal(made.quads, stages.mesh().quads));
        ASSERT_EQ(made.positions.size(), stages.positions().size());
        std::size_t near = 0;
        for (std::size_t v = 0; v < made.positions.size(); ++v)
            near += distance(made.positions[v], stages.positions()[v]) < 1e-3f;
        EXPECT_GT(near, made.positions.size() * 99 / 100);
        card.repeat();
    }
    card.measure();
    card.repeat();
    EXPECT_FALSE(card.take_times().empty());
}

}  // namespace
}  // namespace coppice::bench
