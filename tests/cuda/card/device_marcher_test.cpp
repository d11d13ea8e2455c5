#include "coppice/cuda/tetra/device_marcher.h"

#include "../march_support.h"
#include "../on_executor.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::cuda {
namespace {

MarchResult march_on(DeviceMarcher& card, const CutScene& scene) {
    return card.march(scene.mesh(), scene.field, scene.axes, scene.options);
}

class DeviceMarcherOnCard : public OnCard {};

TEST_F(DeviceMarcherOnCard, RepeatedSurfacesMatchTheCpu) {
    const CutScene scene(random_tree(60, 4, true), 1, 0.6f);
    DeviceMarcher card;
    const MarchResult expected = march(scene.mesh(), FieldRef(scene.field), scene.axes, scene.options);
    for (int round = 0; round < 3; ++round) expect_alike(scene.tetra, march_on(card, scene), expected, 7);
    card.measure();
    card.repeat();
    EXPECT_FALSE(card.take_times().empty());
}

TEST_F(DeviceMarcherOnCard, PiecesAreBitIdenticalToTheWhole) {
    const CutScene scene(random_tree(250, 5), 1, 0.6f);
    DeviceMarcher card;
    const MarchResult at_once = march_on(card, scene);
    DeviceMarcher small({}, card.bytes_used() / 10 * 7);
    expect_same(march_on(small, scene), at_once);
    EXPECT_THROW(small.repeat(), DeviceError);
    DeviceMarcher tiny({}, std::size_t{1} << 16);
    EXPECT_THROW(march_on(tiny, scene), DeviceFull);
}

}  // namespace
}  // namespace coppice::cuda
