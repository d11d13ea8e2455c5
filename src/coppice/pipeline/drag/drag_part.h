#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/drag/branch_drag.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

/// The part of a surface that a drag can change, at angles up to a greatest one, and an order of vertices in
/// which it stands first: a frame then writes the beginning of every buffer and nothing else.
///
/// What can change are the tubes of the branch, those at its fork, and all tubes that it can touch on its
/// way. Around them, the part holds all tubes beside these, so that what is refined of the part alone has the
/// same bits as if the whole had been refined.
struct DragPart {
    /// The part as a cage: quads in the order of the model's, by vertices of its own.
    /// @{
    std::vector<std::uint32_t> cage_vertex;  ///< per vertex, ascending: that of the model's cage
    std::vector<std::uint32_t> cage_quad;    ///< per quad, ascending: that of the model's cage
    std::vector<std::uint32_t> region;       ///< per quad: its region, as in the model
    std::vector<std::uint32_t> clip;         ///< flat ends of the part, ascending: those of the model
    std::vector<std::uint32_t> clip_quad;    ///< per flat end: its first quad in the part
    PatchRefinement patches;                 ///< of these quads, by the model's levels
    /// @}

    /// Vertices and quads of the whole surface as they are drawn.
    /// @{
    std::vector<std::uint32_t> vertex;  ///< per drawn vertex: that of the model's refined quads
    Buffer<Quad> quads;                 ///< the refined quads by drawn vertices
    std::uint32_t written = 0;  ///< drawn vertices below this have another place in each frame; then come
    std::uint32_t shaded = 0;   ///< those below this, which have at least another normal
    std::vector<std::uint32_t> from;     ///< per written vertex: that of the part's refined quads
    CompressedRows<std::uint32_t> fans;  ///< per shaded vertex: the quads about it, ascending
    /// @}
};

/// The cage of a part with all that belongs to it, by its own vertices and quads. Regions are those of the
/// model.
ControlMesh control_of(const QuadModel& model, const DragPart& part);
/// The flat ends of a part among those of all of its model's cage, by the part's quads.
std::vector<ClipPlane> clips_of(const DragPart& part, std::span<const ClipPlane> clips);

/// Finds the part that a drag can change up to an angle [rad] to both sides. The whole where the projection
/// relaxes, which goes from quad to quad. O(n log n).
DragPart drag_part(const QuadModel& model, const BranchDrag& drag, double greatest_angle,
                   const Context& ctx = {});

/// The same as if the drag could change everything.
DragPart whole_part(const QuadModel& model, const Context& ctx = {});

}  // namespace coppice
