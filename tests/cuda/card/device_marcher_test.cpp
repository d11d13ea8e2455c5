#include "coppice/cuda/tetra/device_marcher.h"

#include "../march_support.h"
#include "../on_executor.h"
#include "../tetra_scene.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::cuda {
namespace {

constexpr MarchOptions kOnce{.levels = 1};

/// A tree in tetrahedra, cut off at its root.
struct CutScene {
    explicit CutScene(const Skeleton& tree)
        : tetra(tree, 1, 0.6f), ends(cut_at_root(tree, tetra.lattice.mesh().region_count())) {}
    CutConvolution field() const { return {tetra.field, ends}; }
    MarchResult march_on(DeviceMarcher& card) const {
        return card.march(tetra.lattice.mesh(), field(), tetra.inside(), kOnce);
    }

    TetraScene tetra;
    EndCuts ends;
};

class DeviceMarcherOnCard : public OnCard {};

TEST_F(DeviceMarcherOnCard, MakesTheSurfaceOfTheCpuAgainAndAgain) {
    const CutScene scene(random_tree(60, 4, true));
    DeviceMarcher card;
    const CutConvolution field = scene.field();
    const MarchResult expected =
        march(scene.tetra.lattice.mesh(), FieldRef(field), scene.tetra.inside(), kOnce);
    for (int round = 0; round < 3; ++round) expect_alike(scene.tetra, scene.march_on(card), expected, 7);
    card.measure();
    card.repeat();
    EXPECT_FALSE(card.take_times().empty());
    const PrintedMarch printed = card.march_as_printed(scene.tetra.lattice.mesh(), 1, field, true);
    EXPECT_EQ(printed.triangles, printed.mesh.triangles.size());
    EXPECT_TRUE(topology(polygons(printed.mesh)).sound());
    card.repeat();
}

TEST_F(DeviceMarcherOnCard, MakesTheSameBitsInPieces) {
    const CutScene scene(random_tree(250, 5));
    DeviceMarcher card;
    const MarchResult at_once = scene.march_on(card);
    DeviceMarcher small({}, card.bytes_used() / 10 * 7);
    expect_same(scene.march_on(small), at_once);
    EXPECT_THROW(small.repeat(), DeviceError);
    DeviceMarcher tiny({}, std::size_t{1} << 16);
    EXPECT_THROW(scene.march_on(tiny), DeviceFull);
}

}  // namespace
}  // namespace coppice::cuda
