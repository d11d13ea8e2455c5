#include "coppice/cuda/field/device_field.h"

#include <cmath>

#include "../on_executor.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::cuda {
namespace {

class DeviceFieldOnCard : public OnCard {};

TEST_F(DeviceFieldOnCard, SamplesMatchTheCpu) {
    const Skeleton tree = random_tree(200, 1);
    Box3 all;
    for (const Vec3 p : tree.positions()) all.extend(p);
    for (const Kernel kernel : {Kernel::quartic, Kernel::cauchy, Kernel::scalis, Kernel::balls}) {
        for (const int blend : {1, 4}) {
            SCOPED_TRACE(static_cast<int>(kernel) * 10 + blend);
            ConvolutionField field(tree, {.kernel = kernel, .blend = blend});
            field.set_regions(std::span<const Box3>(&all, 1));
            std::vector<Vec3> points;
            for (const NodeId n : nodes(tree)) {
                // Not exactly at a node, where gradients are discontinuous and rounding determines the side.
                for (int k = 1; k <= 20; ++k) {
                    const auto a = static_cast<float>(k);
                    points.push_back(tree.position(n) +
                                     tree.radius(n) * 0.1f * a * Vec3{std::sin(a), std::cos(a), 0.3f});
                }
            }
            std::vector<FieldSample> expected(points.size()), found(points.size());
            field.sample(0, points, expected);
            sample_on_device(field, points, found);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const float slope = length(expected[i].gradient);
                EXPECT_NEAR(found[i].value, expected[i].value, 1e-4f * (1 + expected[i].value)) << i;
                EXPECT_LE(distance(found[i].gradient, expected[i].gradient), 1e-3f * (1 + slope)) << i;
            }
            EXPECT_EQ(time_field(field, points, 3).size(), 3u);
        }
    }
}

}  // namespace
}  // namespace coppice::cuda
