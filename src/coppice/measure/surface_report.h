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
#include "coppice/measure/tree_components.h"
#include "coppice/measure/union_handles.h"
#include "coppice/measure/volume_report.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of check_surface().
struct CheckOptions {
    bool intersections = true;          ///< find faces that intersect
    int max_intersections = 1'000'000;  ///< maximum number of intersecting pairs that are searched; >= 0
    int max_places = 5;                 ///< maximum number of places with intersections that are listed; >= 0
    EndShape base = EndShape::flat;     ///< end shape of the skeleton's trees at a root with one child
    EndShape tips = EndShape::round;    ///< end shape of its branches
};

/// Lists the members for front ends.
void list_fields(CheckOptions& o, FieldList& list);

/// The properties of a surface, alone and compared with its skeleton.
struct SurfaceReport {
    TopologyReport topology;                          ///< connectivity of the faces
    ShapeReport shape;                                ///< quality of their shapes
    SmoothnessReport smoothness;                      ///< angles and curvature
    std::optional<IntersectionReport> intersections;  ///< nullopt if not requested
    std::optional<CrossingPlaces> crossing_places;  ///< places of the intersections; nullopt if not requested
    std::optional<RadiusReport> radius;             ///< nullopt without a skeleton
    std::optional<EdgeFlowReport> edge_flow;        ///< nullopt without a skeleton
    std::optional<AxesReport> axes;                 ///< nullopt without a skeleton
    std::optional<TreeComponentsReport> parts;      ///< nullopt without a skeleton
    /// nullopt without a skeleton, if the surface is not watertight, or if too many branches overlap
    std::optional<HandlesReport> handles;
    std::optional<VolumeReport> volume;  ///< nullopt without a skeleton

    bool watertight() const { return topology.watertight(); }  ///< closed, manifold and oriented
    /// Returns whether faces intersect; false if that was not examined.
    bool crosses_itself() const {
        return intersections && (intersections->total > 0 || !intersections->complete);
    }
    /// Returns whether the surface is watertight and no faces are known to intersect.
    bool sound() const { return watertight() && !crosses_itself(); }
    /// Returns whether most segments of the skeleton are inside the surface; true without a skeleton.
    bool covers_skeleton() const { return !axes || 2 * axes->missing <= axes->segments; }
    /// Returns whether no component is detached from the surface of a tree; true without a skeleton.
    bool is_whole() const { return !parts || parts->whole(); }
    /// Returns whether almost nothing of the skeleton is cut off; true without a skeleton.
    bool joins_branches() const { return !axes || axes->is_whole(); }
    /// Returns whether the surface reaches almost all tips of the skeleton; true without a skeleton.
    bool reaches_tips() const { return !axes || axes->reaches_tips(); }
    /// Returns whether the surface has the volume of the skeleton's rounded cones and contains almost all of
    /// it; true without a skeleton.
    bool holds_volume() const { return !volume || (volume->complete() && volume->agrees()); }
    /// Returns whether all of the above are satisfied.
    bool passes() const {
        return sound() && covers_skeleton() && is_whole() && joins_branches() && reaches_tips() &&
               holds_volume();
    }
    friend bool operator==(const SurfaceReport&, const SurfaceReport&) = default;  ///< member by member
};

/// Evaluates a surface. `skeleton` may be null; if its origin differs from the mesh's, both are transformed
/// to one frame. Throws InvalidInput for a mesh with numbers that are not finite or invalid faces (see
/// `validate`). The result does not depend on the number of threads.
SurfaceReport check_surface(const PolygonMesh& mesh, const Skeleton* skeleton,
                            const CheckOptions& options = {}, const Context& ctx = {});

/// Calls visit("name_1", value), visit("name_2", value), ...
template <class Value, class Visitor>
void visit_numbered(const char* name, const std::vector<Value>& values, Visitor&& visit) {
    for (std::size_t k = 0; k < values.size(); ++k) visit(name + std::to_string(k + 1), values[k]);
}

/// Calls visit(name, value) for every figure, in the order for output. A value is an integer, a bool, a
/// double, or a group (Statistics, IntersectionReport) with its own visit_figures. Names are those of the
/// JSON report. `sound` is omitted if it depends on intersections that were not examined.
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
    if (r.handles) visit("handles", *r.handles);
    if (r.volume) {
        visit("volume", *r.volume);
        visit_numbered("missing_lump_", r.volume->lumps, visit);
    }
}

}  // namespace coppice
