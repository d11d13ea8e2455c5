// A crown as a solid, points in it, and a tree that grows into them.

#include <cstdio>
#include <vector>

#include "coppice/growth/grow.h"
#include "coppice/growth/radii.h"
#include "coppice/growth/tidy.h"
#include "coppice/implicit/solid/solid.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/points/sampling/generate.h"

int main() {
    using coppice::Vec3;

    // Two balls, scaled and blended, minus a third one.
    const std::vector<coppice::Solid> balls{coppice::sphere(Vec3{0, 0, 4}, {.radius = 1.6f}),
                                            coppice::sphere(Vec3{1.4f, 0, 5.5f}, {.radius = 1.2f})};
    const coppice::Solid bite = coppice::sphere(Vec3{-1.5f, 0, 5}, {.radius = 1});
    const coppice::Solid crown = coppice::subtract(coppice::blend(balls), {&bite, 1});
    const coppice::SolidField field(crown);

    const coppice::GenerateResult points =
        coppice::generate(coppice::FieldRef(field), crown.bounds(), {.count = 1500});

    const coppice::Root root{.position = Vec3{0, 0, 0}, .direction = Vec3{0, 0, 1}};
    const coppice::GrowResult grown =
        coppice::grow({.attractors = points.points.positions, .roots = {&root, 1}},
                      {.influence_radius = 2, .kill_radius = 0.3f, .step = 0.15f});

    // Growth provides no radii: a pipe model computes them. The clean-up smooths the axes.
    const coppice::Skeleton thick = coppice::with_pipe_radii(grown.skeleton, {.tip_radius = 0.008f});
    const coppice::Skeleton tree = coppice::tidy(thick).skeleton;
    const coppice::MeshResult result = coppice::mesh_skeleton(tree);

    std::printf("%zu points, stopped: %s\n", points.points.size(), coppice::name_of(points.stop).data());
    std::printf("%u nodes grown, stopped: %s\n", grown.skeleton.size(), coppice::name_of(grown.stop).data());
    std::printf("trunk: radius %.3f m\n", tree.radius(coppice::NodeId(0)));
    std::printf("%u nodes, %zu quads\n", tree.size(), result.quads().mesh.quads.size());
}
