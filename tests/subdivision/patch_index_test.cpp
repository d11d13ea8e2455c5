#include "coppice/subdivision/kernel/patch_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "coppice/base/id.h"
#include "coppice/subdivision/catmull_clark.h"
#include "subdivision/cages.h"

namespace coppice {
namespace {

using Corners = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

TEST(PatchStars, MatchTheQuads) {
    for (const auto& [name, cage] : cage_zoo()) {
        for (int levels = 0; levels <= 3; ++levels) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const PatchRefinement patches(cage.quads, cage.vertex_count(), levels);
            const Buffer<Quad> quads = patches.quads();
            std::vector<Corners> expected(patches.vertex_count());
            for (std::uint32_t q = 0; q < quads.size(); ++q) {
                for (std::uint32_t k = 0; k < 4; ++k) expected[quads[q][k]].emplace_back(q, k);
            }
            const PatchStars stars(patches.cage(), levels);
            for (std::uint32_t v = 0; v < patches.vertex_count(); ++v) {
                Corners found;
                std::set<std::uint32_t> after, before;
                stars.for_each_corner(v, [&](QuadCorner c) {
                    found.emplace_back(c.quad, c.corner);
                    after.insert(quads[c.quad][(c.corner + 1) & 3]);
                    before.insert(quads[c.quad][(c.corner + 3) & 3]);
                });
                std::sort(found.begin(), found.end());
                ASSERT_EQ(found, expected[v]);
                ASSERT_EQ(stars.on_boundary(v), after != before);
            }
        }
    }
}

TEST(PatchStars, TheOwnerIsTheQuadThatListsTheVertex) {
    for (const auto& [name, cage] : cage_zoo()) {
        for (int levels = 0; levels <= PatchRefinement::kMaxLevels; levels += 2) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const PatchRefinement patches(cage.quads, cage.vertex_count(), levels);
            const PatchStars stars(patches.cage(), levels);
            std::vector<std::uint32_t> owned(patches.max_owned());
            for (std::uint32_t f = 0; f < cage.quads.size(); ++f) {
                const std::uint32_t count = patches.owned_vertices(f, owned);
                for (std::uint32_t k = 0; k < count; ++k) ASSERT_EQ(stars.owner(owned[k]), f);
            }
        }
    }
}

TEST(PatchStars, UnusedVertexHasNoCorners) {
    Cage cage = grid_cage(1, 1, false);
    cage.points.push_back({});
    const PatchRefinement patches(cage.quads, cage.vertex_count(), 1);
    const PatchStars stars(patches.cage(), 1);
    EXPECT_EQ(stars.owner(cage.vertex_count() - 1), kNoIndex);
    stars.for_each_corner(cage.vertex_count() - 1, [](QuadCorner) { FAIL(); });
}

}  // namespace
}  // namespace coppice
