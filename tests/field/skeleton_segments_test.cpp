#include "coppice/field/skeleton_segments.h"

#include <gtest/gtest.h>

#include <cstring>

#include "coppice/field/convolution_field.h"
#include "zoo.h"

namespace coppice {
namespace {

bool same_bits(const kernel::SegmentConstants<float>& a, const kernel::SegmentConstants<float>& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

// A node and its descendants.
std::vector<std::uint32_t> subtree(const Skeleton& s, NodeId top) {
    std::vector<std::uint8_t> is_in(s.size());
    std::vector<std::uint32_t> out;
    for (const NodeId n : nodes(s)) {
        const NodeId p = s.parent(n);
        if (n != top && (!p || is_in[p.index()] == 0)) continue;
        is_in[n.index()] = 1;
        out.push_back(n.index());
    }
    return out;
}

TEST(SkeletonSegments, OfMovedNodesMatchANewField) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const FieldOptions options{.kernel = Kernel::scalis};
        SkeletonSegments segments(skeleton, SegmentBuilder(options));
        const NodeId top(skeleton.size() / 3);
        const std::vector<std::uint32_t> branch = subtree(skeleton, top);
        std::vector<Vec3> positions(skeleton.positions().begin(), skeleton.positions().end());
        // There and back: segments without length follow their parent.
        for (const Vec3 way : {Vec3{0.3f, -0.2f, 0.1f}, Vec3{}}) {
            for (const std::uint32_t n : branch) {
                const Vec3 p = skeleton.positions()[n];
                positions[n] = p + Vec3{way.x * p.z, way.y * p.x, way.z * p.y};
            }
            segments.follow(branch, positions);
            const Skeleton there({skeleton.parents().begin(), skeleton.parents().end()}, positions,
                                 {skeleton.radii().begin(), skeleton.radii().end()});
            const ConvolutionField field(there, options);
            for (const NodeId n : nodes(skeleton))
                EXPECT_TRUE(same_bits(segments.build(n, positions), field.segments()[n.index()]))
                    << n.index();
        }
    }
}

}  // namespace
}  // namespace coppice
