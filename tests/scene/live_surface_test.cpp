// Surfaces that follow edits: after each of a few dozen edits of every kind, the surface is bit-identical to
// one created from scratch, and the changes reported by an update are sufficient to update a copy.

#include "coppice/pipeline/live_surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/edit/cut.h"
#include "coppice/edit/deform.h"
#include "coppice/edit/join.h"
#include "coppice/edit/rigid.h"
#include "coppice/edit/thickness.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "errors.h"

namespace coppice {
namespace {

// A copy of a surface, as on a GPU.
struct Copy {
    std::vector<Vec3> positions;
    std::vector<Quad> quads;

    void fetch(const LiveSurface& from, const SurfaceChange& change) {
        positions.resize(from.positions().size());
        quads.resize(from.quads().size());
        for (const NumberRange& r : change.vertices)
            std::copy_n(from.positions().begin() + r.first, r.count, positions.begin() + r.first);
        for (const NumberRange& r : change.quads)
            std::copy_n(from.quads().begin() + r.first, r.count, quads.begin() + r.first);
    }
    bool is_same(const LiveSurface& other) const {
        return std::ranges::equal(positions, other.positions()) && std::ranges::equal(quads, other.quads());
    }
};

bool is_same(const QuadMesh& a, const QuadMesh& b) {
    return a.origin == b.origin && std::ranges::equal(a.positions, b.positions) &&
           std::ranges::equal(a.quads, b.quads);
}

// Returns the faces as the positions of their corners, in order.
std::vector<std::array<Vec3, 4>> get_faces(const QuadMesh& mesh) {
    std::vector<std::array<Vec3, 4>> out;
    for (const Quad& q : mesh.quads) {
        auto& face = out.emplace_back();
        for (std::size_t k = 0; k < q.size(); ++k) face[k] = mesh.positions[q[k]];
    }
    const auto key = [](const std::array<Vec3, 4>& f) {
        std::array<float, 12> k{};
        for (std::size_t i = 0; i < 4; ++i) {
            k[3 * i] = f[i].x;
            k[3 * i + 1] = f[i].y;
            k[3 * i + 2] = f[i].z;
        }
        return k;
    };
    std::ranges::sort(out, {}, key);
    return out;
}

class RandomEdits {
  public:
    explicit RandomEdits(EditableTree& tree, std::uint64_t seed) : tree_(tree), random_(seed, 0) {}

    // Some edits are invalid, such as a graft into itself; another one is tried then.
    EditChange next() {
        for (;;) {
            try {
                return make(below(9));
            } catch (const InvalidInput&) {
            }
        }
    }

  private:
    std::size_t below(std::size_t n) { return random_.bits(drawn_++) % n; }
    double uniform(double low, double high) { return random_.uniform(drawn_++, low, high); }
    StableId node() {
        for (;;) {
            const StableId n(static_cast<std::uint32_t>(below(tree_.slots())));
            if (tree_.contains(n) && !tree_.is_root(n)) return n;
        }
    }
    // Returns a node with few descendants, so that the update affects only a section of the tree.
    StableId twig() {
        StableId best = node();
        for (int i = 0; i < 8; ++i) {
            const StableId n = node();
            if (tree_.subtree(n).size() < tree_.subtree(best).size()) best = n;
        }
        return best;
    }
    EditChange make(std::size_t kind) {
        const StableId n = twig();
        const double r = double{tree_.radius(n)};
        switch (kind) {
            case 0:
                return rotate(tree_, {n}, {.angle = uniform(-0.5, 0.5)});
            case 1:
                return bend(tree_, {n}, uniform(-0.4, 0.4));
            case 2:
                return translate(tree_, {n}, {r, -r, r});
            case 3:
                return split(tree_, {n});
            case 4:
                return append(tree_, n, {3 * r, 2 * r, 2 * r});
            case 5:
                return remove_branches(tree_, {n});
            case 6:
                return graft(tree_, n, node());
            case 7:
                return scale_radii(tree_, {n}, uniform(0.8, 1.2));
            default:
                return tree_.undo_depth() > 0 ? tree_.undo() : split(tree_, {n});
        }
    }

    EditableTree& tree_;
    CounterRandom random_;
    std::uint64_t drawn_ = 0;
};

// Makes edits and compares the surface after each; returns the number of incremental updates.
int follow(const Skeleton& first, int edits, std::uint64_t seed) {
    EditableTree tree(first);
    LiveSurface surface(first, {});
    Copy copy;
    copy.fetch(surface, {true,
                         {{0, static_cast<std::uint32_t>(surface.positions().size())}},
                         {{0, static_cast<std::uint32_t>(surface.quads().size())}},
                         0});
    RandomEdits random(tree, seed);
    int parts = 0;
    for (int i = 0; i < edits; ++i) {
        const EditChange change = random.next();
        const Skeleton now = tree.skeleton();
        const SurfaceChange wrote = surface.update(now, change.nodes());
        parts += wrote.is_whole ? 0 : 1;
        copy.fetch(surface, wrote);
        EXPECT_TRUE(copy.is_same(surface)) << "edit " << i;
        const bool same = is_same(surface.mesh(), LiveSurface(now, {}).mesh());
        EXPECT_TRUE(same) << "edit " << i;
        if (!same) break;
    }
    return parts;
}

TEST(LiveSurface, IsBitIdenticalToANewSurface) { EXPECT_GT(follow(random_tree(600, 3), 25, 1), 10); }

TEST(LiveSurface, IsBitIdenticalForOverlappingBranches) { follow(random_tree(150, 5, true), 6, 2); }

TEST(LiveSurface, MatchesTheFacesOfTheMesh) {
    const Skeleton tree = random_tree(300, 4);
    const QuadMesh whole = mesh_skeleton(tree).quads().mesh;
    const QuadMesh live = LiveSurface(tree, {}).mesh();
    EXPECT_EQ(live.positions.size(), whole.positions.size());
    EXPECT_EQ(get_faces(live), get_faces(whole));
}

TEST(LiveSurface, UpdateWritesFewVertices) {
    EditableTree tree(random_tree(2'000, 6));
    LiveSurface surface(tree.skeleton(), {});
    StableId tip = tree.first_root();
    while (!tree.is_tip(tip)) tip = tree.first_child(tip);
    const EditChange change = rotate(tree, {tip}, {.angle = 0.2});
    const SurfaceChange wrote = surface.update(tree.skeleton(), change.nodes());
    EXPECT_FALSE(wrote.is_whole);
    EXPECT_LT(wrote.meshed, 600u);
    std::size_t vertices = 0;
    for (const NumberRange& r : wrote.vertices) vertices += r.count;
    EXPECT_GT(vertices, 0u);
    EXPECT_LT(vertices, surface.positions().size() / 20);
}

TEST(LiveSurface, EmptyUpdateWritesNothing) {
    const Skeleton tree = random_tree(300, 7);
    LiveSurface surface(tree, {});
    const SurfaceChange wrote = surface.update(tree, {});
    EXPECT_FALSE(wrote.is_whole);
    EXPECT_TRUE(wrote.vertices.empty());
    EXPECT_TRUE(wrote.quads.empty());
}

TEST(LiveSurface, IsBitIdenticalForAnyNumberOfThreads) {
    std::vector<QuadMesh> made;
    for (const unsigned threads : {1u, 3u}) {
        EditableTree tree(random_tree(500, 8));
        LiveSurface surface(tree.skeleton(), {}, {.threads = threads});
        RandomEdits random(tree, 3);
        for (int i = 0; i < 8; ++i) {
            const EditChange change = random.next();
            surface.update(tree.skeleton(), change.nodes(), {.threads = threads});
        }
        made.push_back(surface.mesh());
    }
    EXPECT_TRUE(is_same(made[0], made[1]));
}

TEST(LiveSurface, RejectsOptionsThatDependOnTheWholeTree) {
    const auto error = [](const auto& change) {
        MeshOptions options;
        change(options);
        return test::error_of<InvalidInput>([&] { LiveSurface(random_tree(10, 1), options); });
    };
    EXPECT_EQ(error([](MeshOptions& o) { o.method = MeshMethod::tetrahedra; }),
              "mesh: method must be quads or bmesh for a surface that follows edits");
    EXPECT_EQ(error([](MeshOptions& o) { o.field.weights = Weights::global; }),
              "mesh: weights must be local for a surface that follows edits");
    EXPECT_EQ(error([](MeshOptions& o) { o.fit = Fit::volume; }),
              "mesh: fit must not be volume for a surface that follows edits");
}

}  // namespace
}  // namespace coppice
