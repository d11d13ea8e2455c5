#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/cage/cage.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"
#include "zoo.h"

namespace coppice::cuda {

inline std::vector<NodeId> all_nodes(const Skeleton& skeleton) {
    std::vector<NodeId> out;
    for (const NodeId n : nodes(skeleton)) out.push_back(n);
    return out;
}

/// A skeleton with all input of a surface.
struct QuadCase {
    Skeleton skeleton;
    ControlMesh control;
    ConvolutionField field;
    PatchRefinement patches;

    QuadCase(Skeleton of, int levels, const FieldOptions& options = {}, const ControlOptions& cage = {})
        : skeleton(std::move(of)),
          control(build_control_mesh(skeleton, all_nodes(skeleton), cage, {})),
          field(skeleton, options),
          patches(control.cage.quads, static_cast<std::uint32_t>(control.cage.positions.size()), levels) {
        std::vector<FieldRegion> regions(control.region_node.size());
        for (std::size_t f = 0; f < control.region.size(); ++f) {
            for (const std::uint32_t v : control.cage.quads[f]) {
                regions[control.region[f]].box.extend(control.cage.positions[v]);
                regions[control.region[f]].box.extend(control.anchors[v]);
            }
        }
        for (std::size_t r = 0; r < regions.size(); ++r) regions[r].seed = control.region_node[r];
        const std::vector<NodeId> tube = all_nodes(skeleton);
        field.set_regions(regions, {skeleton, tube});
    }
    QuadCase(const QuadCase&) = delete;

    QuadJob job(const ProjectOptions& project = {}, const UntangleOptions& untangle = {}) const {
        return {patches.cage(),  patches.levels(), control.cage.positions,
                control.anchors, control.region,   control.clip,
                project,         untangle};
    }
};

/// The result.
struct Surface {
    Buffer<Vec3> positions, anchors;
    ProjectReport projected;
    UntangleReport untangled;
};

inline Surface on_cpu(const QuadCase& c, const ProjectOptions& project, const UntangleOptions& untangle) {
    Surface out{c.patches.refine(c.control.cage.positions), c.patches.refine(c.control.anchors), {}, {}};
    const ProjectionTarget target{FieldRef(c.field), c.control.region, c.control.clip};
    out.projected = coppice::project(out.positions, out.anchors, c.patches, target, project);
    const Buffer<Quad> quads = c.patches.quads();
    if (project.method != ProjectionMethod::none && c.patches.levels() > 0)
        out.untangled = coppice::untangle({out.positions, out.anchors, quads}, c.patches, target, untangle);
    return out;
}

/// Returns the number of vertices that differ by more than 1e-4 of their distance from the anchor plus the
/// rounding of coordinates of that size.
inline std::size_t differing(const Surface& a, const Surface& b) {
    std::size_t count = 0;
    for (std::size_t v = 0; v < a.positions.size(); ++v) {
        const Vec3 p = a.positions[v];
        const float rounding = 4e-7f * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
        count += !(distance(p, b.positions[v]) <= 1e-4f * distance(p, a.anchors[v]) + rounding);
    }
    return count;
}

inline bool near(std::uint64_t x, std::uint64_t y, double share) {
    const auto a = static_cast<double>(x), b = static_cast<double>(y);
    return std::abs(a - b) <= 4 + share * std::max(a, b);
}

/// A ray within a plane of symmetry may go to either side because of rounding: this is accepted for `share`
/// of the vertices. Counts in reports may differ by `of_counts`.
inline void expect_same(const Surface& a, const Surface& b, double share, double of_counts = 0.02) {
    ASSERT_EQ(a.positions.size(), b.positions.size());
    EXPECT_LE(static_cast<double>(differing(a, b)), 3 + share * static_cast<double>(a.positions.size()));
    EXPECT_EQ(a.projected.vertices, b.projected.vertices);
    EXPECT_EQ(a.projected.clipped, b.projected.clipped);
    EXPECT_TRUE(near(a.projected.evaluations, b.projected.evaluations, of_counts))
        << a.projected.evaluations << " " << b.projected.evaluations;
    EXPECT_TRUE(near(a.projected.not_converged, b.projected.not_converged, of_counts))
        << a.projected.not_converged << " " << b.projected.not_converged;
}

inline constexpr UntangleOptions kNoUnfolding{.passes = 0};

}  // namespace coppice::cuda
