#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "acceptance/support.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

// Tetrahedra neither lose nor add branches: one component for each tree, for any edge length, kernel and
// projection onto the surface.

namespace coppice {
namespace {

using namespace test;

struct Parts {
    std::uint64_t count = 0;
    std::uint64_t inside_out = 0;
    std::uint64_t odd = 0;  ///< components with an Euler number that no closed surface has
};

Parts count_parts(const TriMesh& mesh) {
    DisjointSets sets(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        sets.join(t[0], t[1]);
        sets.join(t[0], t[2]);
    }
    std::vector<double> volume(mesh.positions.size());
    std::vector<std::int64_t> euler(mesh.positions.size());  // multiplied by two
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) euler[sets.find(v)] += 2;
    for (const Triangle& t : mesh.triangles) {
        const std::uint32_t part = sets.find(t[0]);
        const Vec3d o(mesh.positions[part]);
        const auto from = [&](std::uint32_t v) { return Vec3d(mesh.positions[v]) - o; };
        volume[part] += dot(from(t[0]), cross(from(t[1]), from(t[2])));
        euler[part] -= 1;
    }
    Parts out;
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
        if (sets.find(v) != v) continue;
        ++out.count;
        out.inside_out += volume[v] <= 0 ? 1 : 0;
        out.odd += euler[v] > 4 || euler[v] % 4 != 0 ? 1 : 0;
    }
    return out;
}

std::size_t tree_count(const Skeleton& skeleton) {
    std::size_t count = 0;
    for (const NodeId n : nodes(skeleton)) count += skeleton.is_root(n) ? 1 : 0;
    return count;
}

/// Returns the number of trees after joining those with branches closer than twice their radii. O(n^2).
std::size_t trees_apart(const Skeleton& skeleton) {
    DisjointSets sets(skeleton.size());
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n)) sets.join(n.index(), skeleton.parent(n).index());
    }
    if (tree_count(skeleton) == 1) return 1;
    const auto end = [&](NodeId n) {
        return Vec3d(skeleton.position(skeleton.is_root(n) ? n : skeleton.parent(n)));
    };
    for (const NodeId n : nodes(skeleton)) {
        for (const NodeId m : nodes(skeleton)) {
            if (m.index() >= n.index() || sets.find(m.index()) == sets.find(n.index())) continue;
            const double apart =
                segment_distance(Vec3d(skeleton.position(n)), end(n), Vec3d(skeleton.position(m)), end(m));
            if (apart < 2 * (skeleton.radius(n) + skeleton.radius(m))) sets.join(n.index(), m.index());
        }
    }
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < skeleton.size(); ++i) count += sets.find(i) == i;
    return count;
}

struct Ways {
    std::vector<float> edges, snaps;
    std::vector<Kernel> kernels;
    TipShape tips = TipShape::round;
};

void expect_a_part_for_each_tree(const std::string& name, const Skeleton& skeleton, const Ways& ways) {
    const std::size_t most = tree_count(skeleton), least = trees_apart(skeleton);
    for (const float edge : ways.edges) {
        for (const float snap : ways.snaps) {
            for (const Kernel kernel : ways.kernels) {
                SCOPED_TRACE(name + ", edge " + std::to_string(edge) + ", snap " + std::to_string(snap) +
                             ", kernel " + std::to_string(static_cast<int>(kernel)));
                MeshOptions options;
                options.method = MeshMethod::tetrahedra;
                options.tetra.edge = edge;
                options.tetra.march.snap = snap;
                options.field.kernel = kernel;
                options.control.tips = ways.tips;
                const Parts parts = count_parts(mesh_skeleton(skeleton, options).tetrahedra().mesh);
                EXPECT_LE(parts.count, most);
                EXPECT_GE(parts.count, least);
                EXPECT_EQ(parts.inside_out, 0u);
                EXPECT_EQ(parts.odd, 0u);
            }
        }
    }
}

constexpr Kernel kQuartic = Kernel::quartic, kCauchy = Kernel::cauchy, kScalis = Kernel::scalis;

TEST(AcceptanceParts, NumberOfComponentsMatchesTheTreesOfTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        expect_a_part_for_each_tree(name, skeleton, {{0.5f, 1}, {0, 0.45f}, {kQuartic}});
        if (skeleton.size() > 300) continue;
        expect_a_part_for_each_tree(name, skeleton, {{0.25f, 1}, {0.5f}, {kCauchy, kScalis}});
        expect_a_part_for_each_tree(name, skeleton, {{1, 2}, {0.3f}, {kQuartic}, TipShape::flat});
    }
}

TEST(AcceptanceParts, NumberOfComponentsMatchesTheTreesOfRandomSkeletons) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const bool hard = seed % 2 == 0;
        expect_a_part_for_each_tree("random " + std::to_string(seed), random_tree(200, seed, hard),
                                    {{0.5f, 1, 4}, {0, 0.45f}, {kQuartic}});
    }
}

TEST(AcceptancePartsFiles, NumberOfComponentsMatchesTheTreesOfFiles) {
    std::vector<fs::path> files = skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no " << kShared;
    for (const fs::path& file : files) {
        const Skeleton skeleton = read_skeleton(file).skeleton;
        const std::string name = file.filename();
        // Fine surfaces take seconds for the large skeletons, which contain the usual branches in great
        // number.
        if (skeleton.size() > 5000) {
            expect_a_part_for_each_tree(name, skeleton, {{1}, {0.45f}, {kQuartic}});
        } else if (skeleton.size() > 700) {
            expect_a_part_for_each_tree(name, skeleton, {{0.5f}, {0.45f}, {kQuartic}});
            expect_a_part_for_each_tree(name, skeleton, {{1}, {0}, {kCauchy}});
        } else {
            expect_a_part_for_each_tree(name, skeleton, {{0.5f, 1}, {0.45f}, {kQuartic, kCauchy, kScalis}});
        }
    }
}

}  // namespace
}  // namespace coppice
