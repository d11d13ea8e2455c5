#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

/// Method that moves vertices to the surface; see project().
enum class ProjectionMethod { rays, gradient, newton, none };

template <>
struct EnumNames<ProjectionMethod> {
    static constexpr std::array<std::string_view, 4> names = {"rays", "gradient", "newton", "none"};
};

/// Options of the projection of refined vertices onto the field's surface.
struct ProjectOptions {
    ProjectionMethod method = ProjectionMethod::rays;  ///< rays is the safest
    float tolerance = 1e-4f;   ///< accepted error, as a fraction of the distance from anchor to surface
    float max_stretch = 3;     ///< a ray ends at this multiple of the distance from anchor to start; > 1
    int max_evaluations = 12;  ///< evaluations per vertex and pass, along the ray and then along the gradient
    float damping = 0.95f;     ///< of a gradient step [Zhu2015]
    int relax_passes = 0;      ///< each is a tangential step and a new projection
    float relax_weight = 0.3f;  ///< share of the distance to the neighbours' mean; in [0, 1]
};

/// Lists the members for front ends.
void list_fields(ProjectOptions& o, FieldList& list);

/// Counts of a projection.
struct ProjectReport {
    std::uint64_t vertices = 0;         ///< projected in the last pass
    std::uint64_t evaluations = 0;      ///< of the field, in all passes
    std::uint32_t max_evaluations = 0;  ///< of one vertex, along one ray or one path along the gradient
    std::uint64_t not_converged = 0;    ///< left at their best point, in the last pass
    std::uint64_t anchors_outside = 0;  ///< no surface between anchor and start, despite the gradient
    std::uint64_t clipped = 0;          ///< on flat ends, in the last pass

    /// Adds the counts of other vertices.
    ProjectReport& operator+=(const ProjectReport& more);
};

/// The surface onto which refined vertices are moved.
struct ProjectionTarget {
    FieldRef field;                         ///< its level is the surface
    std::span<const std::uint32_t> region;  ///< per cage quad: the region of the field for evaluations there
    std::span<const ClipPlane> clips;       ///< one per flat end, by first quad
};

/// Moves every refined vertex that has a quad onto the surface value = level.
///
/// rays: along the ray from the vertex's anchor through the vertex, to a crossing near the vertex. Vertices
/// on different rays cannot slide together. Newton's method on value^(2/5) as a function of the squared
/// distance from the anchor, where the compact quartic kernel is linear, within a bracket: usually two or
/// three evaluations. gradient: damped steps along the gradient on the same transformed field [Zhu2015,
/// section 4.3; the sign of its eq. 5 is reversed], none longer than half the initial distance to the anchor,
/// and none that leaves less than a quarter of the current one. newton: the published equation, on the plain
/// value and with steps of any length, for comparison. A vertex with a ray that meets no surface, because its
/// anchor is outside or the ray never leaves the solid, follows the gradient from its initial position; it
/// stays there if that fails too. Neither method moves a vertex that coincides with its anchor, nor writes a
/// number that is not finite if positions and anchors are finite.
///
/// Vertices of a flat end are projected orthogonally onto its plane instead. Those on its rim then move along
/// rays within the plane, for every method, so that the edge of the cut is sharp and as wide as the surface
/// there. No other vertices are cut: extend the field beyond the plane, and keep the rest of the cage behind
/// it.
///
/// `positions` and `anchors` have one entry per refined vertex (PatchRefinement::refine of both). The field
/// is evaluated in batches of one region; number the cage quads of a region consecutively to make these
/// large. The result does not depend on the number of threads. Throws InvalidInput if an option is out of
/// range, the sizes do not match, or a clip plane has no normal or no quads of its own.
ProjectReport project(Buffer<Vec3>& positions, std::span<const Vec3> anchors, const PatchRefinement& patches,
                      const ProjectionTarget& target, const ProjectOptions& options = {},
                      const Context& ctx = {});

/// The same for some vertices of any surface, along rays and, where these meet no surface, along the
/// gradient, once: row r of `vertices` contains those for which the field is evaluated in region r, each in
/// one row. All others keep their positions, and there are no flat ends. The options' method, relaxation and
/// passes are ignored.
ProjectReport project(std::span<Vec3> positions, std::span<const Vec3> anchors,
                      const CompressedRows<std::uint32_t>& vertices, FieldRef field,
                      const ProjectOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
