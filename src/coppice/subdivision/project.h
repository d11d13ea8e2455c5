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

/// How vertices reach the surface; see project().
enum class ProjectionMethod { rays, gradient, newton, none };

template <>
struct EnumNames<ProjectionMethod> {
    static constexpr std::array<std::string_view, 4> names = {"rays", "gradient", "newton", "none"};
};

/// How refined vertices are moved onto the field's surface.
struct ProjectOptions {
    ProjectionMethod method = ProjectionMethod::rays;  ///< rays is the safest
    float tolerance = 1e-4f;  ///< error aimed at, as a fraction of the distance from anchor to surface
    float max_stretch = 3;    ///< a ray ends at this multiple of the distance from anchor to start; > 1
    int max_evaluations =
        12;                 ///< of the field, per vertex and pass, along the ray and then along the gradient
    float damping = 0.95f;  ///< of a gradient step [Zhu2015]
    int relax_passes = 0;   ///< each is a tangential step and a new projection
    float relax_weight = 0.3f;  ///< part of the way to the neighbours' mean; in [0, 1]
};

template <class Self, class Visitor>
requires SameOptions<Self, ProjectOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(
        Field{
            "method",
            "how refined vertices reach the surface: along rays from the skeleton, along the gradient, or by "
            "the plain Newton step of Zhu et al. 2015"},
        o.method);
    visit(Field{"tolerance", "error of the projection as a fraction of the local radius", Unit::radius, 1e-6,
                0.1},
          o.tolerance);
    visit(Field{"max_stretch", "length at which a ray gives up, in multiples of its first length", Unit::none,
                1.01, 100},
          o.max_stretch);
    visit(Field{"max_evaluations", "field evaluations per vertex at most", Unit::none, 1, 100},
          o.max_evaluations);
    visit(Field{"damping", "factor on each step along the gradient", Unit::none, 0.1, 1}, o.damping);
    visit(Field{"relax_passes", "tangential relaxations, each followed by a projection", Unit::none, 0, 100},
          o.relax_passes);
    visit(Field{"relax_weight", "part of the way to the neighbours' mean per relaxation", Unit::none, 0, 1},
          o.relax_weight);
}

/// How projection went, counted.
struct ProjectReport {
    std::uint64_t vertices = 0;         ///< projected in the last pass
    std::uint64_t evaluations = 0;      ///< of the field, in all passes
    std::uint32_t max_evaluations = 0;  ///< of one vertex, along one ray or one way down the gradient
    std::uint64_t not_converged = 0;    ///< left at their best point so far, in the last pass
    std::uint64_t anchors_outside = 0;  ///< no surface between anchor and start, whatever the gradient gave
    std::uint64_t clipped = 0;          ///< on flat ends, in the last pass

    /// Of the field, per vertex.
    double mean_evaluations() const {
        return vertices == 0 ? 0 : static_cast<double>(evaluations) / static_cast<double>(vertices);
    }
    /// Adds what was done to other vertices.
    ProjectReport& operator+=(const ProjectReport& more);
};

/// The surface that refined vertices belong on.
struct ProjectionTarget {
    FieldRef field;                         ///< its level is the surface
    std::span<const std::uint32_t> region;  ///< per cage quad: the region in which the field is asked there
    std::span<const ClipPlane> clips;       ///< one per flat end, by first quad
};

/// Moves every refined vertex that has a quad onto the surface value = level.
///
/// rays: along the ray from the vertex's anchor through the vertex, to a crossing near the vertex. Vertices
/// on different rays cannot slide together. Newton's rule on value^(2/5) as a function of the squared
/// distance from the anchor, where the compact quartic kernel is a straight line, within a bracket: two or
/// three evaluations as a rule. gradient: damped steps along the gradient on the same transformed field
/// [Zhu2015, section 4.3; the sign of its eq. 5 is reversed], none longer than half the first distance to
/// the anchor, and none that leaves less than a quarter of the present one. newton: that equation as it
/// stands, on the plain value and with steps of any length, for comparison. A vertex whose ray meets no
/// surface, because its anchor lies outside or the ray never leaves the solid, follows the gradient from
/// where it was; it stays there when that leads nowhere either. Neither moves a vertex that coincides with
/// its anchor, nor ever writes a number that is not finite when positions and anchors are.
///
/// Vertices of a flat end are dropped onto its plane instead, as they are. Those on its rim then go along
/// rays within the plane, whatever the method, so that the edge of the cut is sharp and as wide as the
/// surface is there. Nothing else is cut: let the field go on beyond the plane, and keep the rest of the cage
/// behind it.
///
/// `positions` and `anchors` have one entry per refined vertex (PatchRefinement::refine of both). The field
/// is asked in batches of one region; number cage quads of a region one after the other to make these large.
/// Deterministic for any number of threads. Throws InvalidInput when an option is out of range, the sizes do
/// not match, or a clip plane has no normal or no quads of its own.
ProjectReport project(Buffer<Vec3>& positions, std::span<const Vec3> anchors, const PatchRefinement& patches,
                      const ProjectionTarget& target, const ProjectOptions& options = {},
                      const Context& ctx = {});

/// The same for some vertices of any surface, along rays and, where these meet nothing, the gradient, once:
/// row r of `vertices` holds those that the field is asked for in region r, each in one row. All others stay,
/// and there are no flat ends. The options' method, relaxation and passes are not looked at.
ProjectReport project(std::span<Vec3> positions, std::span<const Vec3> anchors,
                      const CompressedRows<std::uint32_t>& vertices, FieldRef field,
                      const ProjectOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
