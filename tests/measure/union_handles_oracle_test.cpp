// Compares the handles of unions of cones with those of the weighted alpha complex of CGAL, which has the
// homotopy type of the union of its balls.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Fixed_alpha_shape_3.h>
#include <CGAL/Fixed_alpha_shape_cell_base_3.h>
#include <CGAL/Fixed_alpha_shape_vertex_base_3.h>
#include <CGAL/Regular_triangulation_3.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/random.h"
#include "coppice/measure/cone_union.h"
#include "coppice/measure/union_handles.h"
#include "measure/support.h"

namespace coppice {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase =
    CGAL::Fixed_alpha_shape_vertex_base_3<Kernel, CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using CellBase = CGAL::Fixed_alpha_shape_cell_base_3<Kernel, CGAL::Regular_triangulation_cell_base_3<Kernel>>;
using Triangulation =
    CGAL::Regular_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using Complex = CGAL::Fixed_alpha_shape_3<Triangulation>;

/// Returns the complex of balls along the axes of the cones, each a seventh of its radius from the next.
Complex make_complex(const CapsuleTree& capsules) {
    std::vector<Kernel::Weighted_point_3> balls;
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        const RoundCone& cone = capsules.cone(i);
        const double step = 0.15 * std::min(cone.radius_a, cone.radius_b());
        const int count = static_cast<int>(std::ceil(length(cone.axis) / step)) + 1;
        for (int k = 0; k < count; ++k) {
            const double t = count == 1 ? 0.0 : k / (count - 1.0);
            const Vec3d p = cone.point(t);
            balls.emplace_back(Kernel::Point_3(p.x, p.y, p.z), cone.radius(t) * cone.radius(t));
        }
    }
    return Complex(balls.begin(), balls.end(), 0);
}

/// Returns the number of components of the complex, or of its complement.
template <class Item, class Link>
std::int64_t count_components(const std::map<Item, std::uint32_t>& items, const Link& link) {
    DisjointSets sets(items.size());
    auto count = static_cast<std::int64_t>(items.size());
    link([&](Item a, Item b) { count -= sets.join(items.at(a), items.at(b)) ? 1 : 0; });
    return count;
}

/// Returns the handles from the Euler characteristic, the components and the cavities.
std::int64_t count_handles(const Complex& complex) {
    const auto is_in = [&](const auto& simplex) { return complex.classify(simplex) != Complex::EXTERIOR; };
    std::int64_t euler = 0;
    std::map<Complex::Vertex_handle, std::uint32_t> vertices;
    std::map<Complex::Cell_handle, std::uint32_t> outside;
    for (auto v = complex.finite_vertices_begin(); v != complex.finite_vertices_end(); ++v) {
        if (is_in(Complex::Vertex_handle(v))) vertices.emplace(v, vertices.size());
    }
    for (auto e = complex.finite_edges_begin(); e != complex.finite_edges_end(); ++e)
        euler -= is_in(*e) ? 1 : 0;
    for (auto f = complex.finite_facets_begin(); f != complex.finite_facets_end(); ++f)
        euler += is_in(*f) ? 1 : 0;
    for (auto c = complex.all_cells_begin(); c != complex.all_cells_end(); ++c) {
        if (is_in(Complex::Cell_handle(c))) {
            --euler;
        } else {
            outside.emplace(c, outside.size());
        }
    }
    euler += static_cast<std::int64_t>(vertices.size());
    const std::int64_t parts = count_components(vertices, [&](const auto& join) {
        for (auto e = complex.finite_edges_begin(); e != complex.finite_edges_end(); ++e) {
            if (is_in(*e)) join(e->first->vertex(e->second), e->first->vertex(e->third));
        }
    });
    const std::int64_t cavities =
        count_components(outside,
                         [&](const auto& join) {
                             for (auto f = complex.all_facets_begin(); f != complex.all_facets_end(); ++f) {
                                 if (!is_in(*f)) join(f->first, f->first->neighbor(f->second));
                             }
                         }) -
        1;
    return parts + cavities - euler;
}

/// Returns trees of random nodes in a cube, crowded or not.
Skeleton random_forest(std::uint64_t seed) {
    constexpr std::uint32_t kTrees = 4, kNodes = 6;
    const CounterRandom random(7, seed);
    std::uint64_t draw = 0;
    const auto pick = [&](double low, double high) {
        return static_cast<float>(low + (high - low) * random.uniform(draw++));
    };
    const double thick = pick(0.1, 0.8);
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (std::uint32_t k = 0; k < kTrees * kNodes; ++k) {
        const bool is_fork = k % kNodes > 1 && k % 2 == 1;
        parent.push_back(k % kNodes == 0 ? kRoot : NodeId(is_fork ? k - 2 : k - 1));
        const float x = pick(0, 6), y = pick(0, 6), z = pick(0, 6);
        position.emplace_back(x, y, z);
        radius.push_back(pick(0.5 * thick, thick));
    }
    return {parent, position, radius};
}

TEST(CountUnionHandles, EqualsThatOfAlphaComplexes) {
    constexpr std::uint64_t kForests = 12;
    std::uint64_t with_handles = 0;
    for (std::uint64_t seed = 0; seed < kForests; ++seed) {
        const Skeleton s = random_forest(seed);
        const ConeUnion solid(s, {}, EndShape::round, EndShape::round);
        const std::optional<std::int64_t> found = count_union_handles(solid.capsules(), s);
        const std::int64_t expected = count_handles(make_complex(solid.capsules()));
        with_handles += expected > 0 ? 1 : 0;
        EXPECT_EQ(found, expected) << seed;
    }
    EXPECT_GT(with_handles, kForests / 2);
}

}  // namespace
}  // namespace coppice
