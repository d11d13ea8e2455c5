#pragma once

#include <optional>
#include <string>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/measure/axes.h"
#include "coppice/measure/edge_flow.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/radius.h"
#include "coppice/measure/smoothness.h"
#include "coppice/measure/tree_parts.h"
#include "coppice/measure/volume_report.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What is looked for in a surface.
struct CheckOptions {
    bool intersections = true;           ///< look for faces that cross
    int most_intersections = 1'000'000;  ///< stop looking after so many pairs; >= 0
    int most_places = 5;                 ///< where they cross that are named; >= 0
    EndShape base = EndShape::flat;      ///< how the skeleton's trees end at a root with one child
    EndShape tips = EndShape::round;     ///< how its branches end
};

template <class Self, class Visitor>
requires SameOptions<Self, CheckOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("intersections", "Find pairs of faces that cross each other"), o.intersections);
    visit(Field{"most_intersections", "stop looking after so many crossing pairs", Unit::none, 0, 1e9},
          o.most_intersections);
    visit(Field{"most_places", "name so many of the places where faces cross, the largest first", Unit::none,
                0, 1e6},
          o.most_places);
    visit(Field{"base", "how trees are meant to end at a root with one child, for the volume"}, o.base);
    visit(Field{"tips", "how branches are meant to end, for the volume"}, o.tips);
}

/// All that is known of a surface, on its own and against its skeleton.
struct SurfaceReport {
    TopologyReport topology;                          ///< how faces join
    ShapeReport shape;                                ///< how well shaped they are
    SmoothnessReport smoothness;                      ///< how much they turn
    std::optional<IntersectionReport> intersections;  ///< none when not asked for
    std::optional<CrossingPlaces> crossing_places;    ///< where they are; none when not asked for
    std::optional<RadiusReport> radius;               ///< none without a skeleton
    std::optional<EdgeFlowReport> edge_flow;          ///< none without a skeleton
    std::optional<AxesReport> axes;                   ///< none without a skeleton
    std::optional<TreePartsReport> parts;             ///< none without a skeleton
    std::optional<VolumeReport> volume;               ///< none without a skeleton

    bool watertight() const { return topology.watertight(); }  ///< closed, manifold and oriented
    /// Whether faces are known to cross; false where they were not looked for.
    bool crosses_itself() const {
        return intersections && (intersections->total > 0 || !intersections->complete);
    }
    /// Watertight, and no faces cross. Says nothing of crossings that were not looked for.
    bool sound() const { return watertight() && !crosses_itself(); }
    /// Most segments of the skeleton lie within the surface; true without a skeleton.
    bool covers_skeleton() const { return !axes || 2 * axes->missing <= axes->segments; }
    /// No part is torn off the surface of a tree; true without a skeleton.
    bool is_whole() const { return !parts || parts->whole(); }
    /// Hardly anything of the skeleton is cut off; true without a skeleton.
    bool joins_branches() const { return !axes || axes->is_whole(); }
    /// It reaches as far as nearly all tips of the skeleton; true without a skeleton.
    bool reaches_tips() const { return !axes || axes->reaches_tips(); }
    /// It has the volume of the skeleton's rounded cones, and hardly any of that lies outside; true without a
    /// skeleton.
    bool holds_volume() const { return !volume || (volume->complete() && volume->agrees()); }
    /// All of the above.
    bool passes() const {
        return sound() && covers_skeleton() && is_whole() && joins_branches() && reaches_tips() &&
               holds_volume();
    }
    friend bool operator==(const SurfaceReport&, const SurfaceReport&) = default;  ///< member by member
};

/// Judges a surface. `skeleton` may be null; where its origin differs from the mesh's, both are brought into
/// one frame. Throws InvalidInput for a mesh with numbers that are not finite or faces that cannot be (see
/// `validate`). The same bits for any number of threads.
SurfaceReport check_surface(const PolygonMesh& mesh, const Skeleton* skeleton,
                            const CheckOptions& options = {}, const Context& ctx = {});

/// Calls visit("name_1", value), visit("name_2", value), ...
template <class Value, class Visitor>
void visit_numbered(const char* name, const std::vector<Value>& values, Visitor&& visit) {
    for (std::size_t k = 0; k < values.size(); ++k) visit(name + std::to_string(k + 1), values[k]);
}

/// Calls visit(name, value) for every figure, in the order for print. A value is an integer, a bool, a
/// double, or a group (Statistics, IntersectionReport) with a visit_figures of its own. Names are those of
/// the JSON report. `sound` is left out where it depends on crossings that were not looked for.
template <class Visitor>
void visit_figures(const SurfaceReport& r, Visitor&& visit) {
    const TopologyReport& t = r.topology;
    if (r.intersections || !r.sound()) visit("sound", r.sound());
    visit("watertight", r.watertight());
    visit("vertices", t.vertices);
    visit("faces", t.faces);
    visit("quads_percent", t.quads_percent());
    visit("components", t.components);
    visit("euler", t.euler);
    visit("open_edges", t.open_edges);
    visit("non_manifold_edges", t.non_manifold_edges);
    visit("misoriented_edges", t.misoriented_edges);
    visit("non_manifold_vertices", t.non_manifold_vertices);
    visit("irregular_vertices", t.irregular_vertices);
    visit("irregular_percent", t.irregular_percent());
    visit("scaled_jacobian", r.shape.scaled_jacobian);
    visit("inverted_faces", r.shape.inverted_faces);
    visit("signed_volume", r.shape.signed_volume);
    visit("area", r.shape.area);
    visit("bending", r.smoothness.whole.bending);
    visit("face_angle_degrees", r.smoothness.whole.face_angle);
    if (r.smoothness.forks) {
        visit("fork_bending", r.smoothness.forks->bending);
        visit("fork_face_angle_degrees", r.smoothness.forks->face_angle);
    }
    if (r.smoothness.chains) visit("chain_face_angle_degrees", r.smoothness.chains->face_angle);
    if (r.intersections) visit("intersections", *r.intersections);
    if (r.crossing_places) {
        visit("crossing_places", *r.crossing_places);
        visit_numbered("crossing_place_", r.crossing_places->largest, visit);
    }
    if (r.radius) {
        visit("radius_all", r.radius->all);
        visit("radius_regular", r.radius->regular);
        visit("radius_areas", r.radius->areas);
    }
    if (r.edge_flow) {
        visit("edge_flow", *r.edge_flow);
        visit_numbered("density_", r.edge_flow->classes, visit);
    }
    if (r.axes) {
        visit("axes", *r.axes);
        visit("segments_missing", r.axes->missing);
        visit_numbered("severed_place_", r.axes->longest, visit);
        visit("tips", r.axes->tips);
        visit("tips_short", r.axes->short_tips);
        visit("tip_reach", r.axes->tip_reach);
        visit_numbered("short_tip_", r.axes->shortest, visit);
    }
    if (r.parts) {
        visit("trees", r.parts->trees);
        visit("parts", r.parts->parts);
        visit("parts_loose", r.parts->loose);
        visit_numbered("loose_part_", r.parts->largest, visit);
    }
    if (r.volume) {
        visit("volume", *r.volume);
        visit_numbered("missing_lump_", r.volume->lumps, visit);
    }
}

}  // namespace coppice
