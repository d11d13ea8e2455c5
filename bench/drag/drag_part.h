#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/subdivision/catmull_clark.h"
#include "drag/branch_drag.h"

namespace coppice::bench {

/// The part of a surface that a drag can change, for angles up to a maximum, and an order of vertices in
/// which it comes first: a frame then writes only the beginning of every buffer.
///
/// The tubes that can change are those of the branch, those at its fork, and all tubes that it can touch on
/// its way. The part also contains all tubes adjacent to these, so that the refinement of the part alone is
/// bit-identical to a refinement of the whole.
struct DragPart {
    /// The part as a cage: quads in the order of the build's, with its own vertices. @{
    std::vector<std::uint32_t> cage_vertex;  ///< per vertex, ascending: that of the build's cage
    std::vector<std::uint32_t> cage_quad;    ///< per quad, ascending: that of the build's cage
    std::vector<std::uint32_t> region;       ///< per quad: its region, as in the build
    std::vector<std::uint32_t> clip;         ///< flat ends of the part, ascending: those of the build
    std::vector<std::uint32_t> clip_quad;    ///< per flat end: its first quad in the part
    PatchRefinement patches;                 ///< of these quads, by the build's levels
    /// @}

    /// Vertices and quads of the whole surface in drawing order. @{
    std::vector<std::uint32_t> vertex;   ///< per drawn vertex: that of the build's refined quads
    Buffer<Quad> quads;                  ///< the refined quads by drawn vertices
    std::uint32_t written = 0;           ///< drawn vertices below this have another position in each frame;
    std::uint32_t shaded = 0;            ///< the following ones below this have another normal
    std::vector<std::uint32_t> from;     ///< per written vertex: that of the part's refined quads
    CompressedRows<std::uint32_t> fans;  ///< per shaded vertex: the adjacent quads, ascending
    /// @}
};

/// Returns the cage of a part with its attributes, by its own vertices and quads. Regions are those of the
/// build.
ControlMesh make_control(const QuadBuild& build, const DragPart& part);
/// Returns the flat ends of a part among those of its build's cage, by the part's quads.
std::vector<ClipPlane> select_clip_planes(const DragPart& part, std::span<const ClipPlane> clips);

/// Finds the part that a drag can change up to an angle [rad] in both directions. Returns the whole if the
/// projection relaxes, which propagates from quad to quad. O(n log n).
DragPart drag_part(const QuadBuild& build, const BranchDrag& drag, double max_angle, const Context& ctx = {});

/// Returns the part that contains the whole surface.
DragPart whole_part(const QuadBuild& build, const Context& ctx = {});

}  // namespace coppice::bench
