#include "../on_executor.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

// Tests of whole surfaces created from skeletons.

namespace coppice::cuda {
namespace {

class SurfacesOnCard : public OnCard {
  protected:
    static MeshResult made(const Skeleton& skeleton, MeshOptions options, Device device) {
        options.device = device;
        return mesh_skeleton(skeleton, options);
    }
    static std::string card() { return require_device().name; }
    static void expect_alike(const MeshResult& on_card, const MeshResult& cpu) {
        const TopologyReport a = topology(to_polygons(on_card)), b = topology(to_polygons(cpu));
        EXPECT_TRUE(a.watertight());
        EXPECT_EQ(a.components, b.components);
        EXPECT_EQ(a.euler, b.euler);
    }
};

TEST_F(SurfacesOnCard, QuadsMatchTheCpu) {
    MeshOptions options;
    options.remesh_rounds = 0;
    options.untangle.passes = 0;
    std::size_t apart = 0, all = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const MeshResult a = made(skeleton, options, Device::cpu), b = made(skeleton, options, Device::cuda);
        const QuadSurface &cpu = a.quads(), &on_card = b.quads();
        EXPECT_EQ(on_card.device.name, card());
        EXPECT_EQ(on_card.device.note, "");
        ASSERT_EQ(on_card.mesh.quads, cpu.mesh.quads);
        EXPECT_EQ(on_card.projected.vertices, cpu.projected.vertices);
        Box3 box;
        for (const Vec3 p : cpu.mesh.positions) box.extend(p);
        for (std::size_t v = 0; v < cpu.mesh.positions.size(); ++v)
            apart += !(distance(on_card.mesh.positions[v], cpu.mesh.positions[v]) <= 1e-5f * box.diagonal());
        all += cpu.mesh.positions.size();
    }
    EXPECT_LT(apart, all / 500);
}

TEST_F(SurfacesOnCard, AreClosedWithAllStages) {
    for (const bool hard : {false, true}) {
        for (const TipShape tips : {TipShape::round, TipShape::flat}) {
            MeshOptions options;
            options.control.tips = tips;
            const Skeleton tree = random_tree(size_for(1000, 500), 11, hard);
            const MeshResult cpu = made(tree, options, Device::cpu);
            const MeshResult on_card = made(tree, options, Device::cuda);
            EXPECT_EQ(on_card.quads().device.name, card());
            expect_alike(on_card, cpu);
            EXPECT_LE(on_card.quads().untangled.bad_after, cpu.quads().untangled.bad_after * 1.1 + 5);
        }
    }
}

TEST_F(SurfacesOnCard, TetrahedraMatchTheCpu) {
    for (const TetraBase base : {TetraBase::octree, TetraBase::polyhedron}) {
        MeshOptions options;
        options.method = MeshMethod::tetrahedra;
        options.tetra.base = base;
        const Skeleton tree = random_tree(300, 12);
        const MeshResult cpu = made(tree, options, Device::cpu);
        const MeshResult on_card = made(tree, options, Device::cuda);
        EXPECT_EQ(on_card.tetrahedra().device.name, card());
        expect_alike(on_card, cpu);
        const auto found = static_cast<double>(on_card.tetrahedra().mesh.triangles.size());
        EXPECT_NEAR(found / static_cast<double>(cpu.tetrahedra().mesh.triangles.size()), 1, 1e-3);
    }
}

TEST_F(SurfacesOnCard, SmallSurfacesAreComputedByTheCpu) {
    EXPECT_EQ(made(random_tree(30, 13), {}, Device::automatic).quads().device.name, "CPU");
}

}  // namespace
}  // namespace coppice::cuda
