#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/field/convolution_field.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/march/march.h"
#include "coppice/tetra/polyhedron/polyhedron.h"
#include "zoo.h"

namespace coppice {

/// Any field, sampled point by point as in a kernel.
template <class F>
struct PointField {
    const F* field;
    FieldSample sample(std::uint32_t region, Vec3 p) const {
        FieldSample out{};
        field->sample(region, std::span(&p, 1), std::span(&out, 1));
        return out;
    }
};

/// A tree in tetrahedra, with a field that has the same regions.
struct TetraScene {
    TetraScene(const Skeleton& tree, int levels, float edge, FieldOptions options = {}, float inner = 0.8f)
        : skeleton(tree),
          axes(segment_axes(skeleton)),
          lattice(axes,
                  {.cell = 2.8f * edge * static_cast<float>(1 << levels), .inside = inner, .outside = 1.25f}),
          field(skeleton, options) {
        set_regions();
    }
    void set_regions() { field.set_regions(region_boxes(lattice.mesh())); }
    InsideAxes inside() const { return {axes, lattice.passing()}; }
    float radius_near(Vec3 p) const {
        double least = HUGE_VAL;
        float radius = 0;
        for (const Segment& s : axes) {
            const Vec3d a(s.a), d = Vec3d(s.b) - a;
            const double t = closest_parameter(Vec3d(p), a, d), away = distance(a + d * t, Vec3d(p));
            if (away >= least) continue;
            least = away;
            radius = s.radius_a + static_cast<float>(t) * (s.radius_b - s.radius_a);
        }
        return radius;
    }

    Skeleton skeleton;
    std::vector<Segment> axes;
    Lattice lattice;
    ConvolutionField field;
};

inline std::vector<std::pair<std::string, Skeleton>> small_trees() {
    std::vector<std::pair<std::string, Skeleton>> out;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() < 120) out.emplace_back(name, skeleton);
    }
    out.emplace_back("random_tree", random_tree(60, 3));
    out.emplace_back("random_hard", random_tree(60, 4, true));
    return out;
}

}  // namespace coppice
