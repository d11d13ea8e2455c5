#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {

/// The cage quads first .. first + count.
struct CageRun {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

/// The cage quads of a tube.
struct TubeFaces {
    CageRun side;                ///< around the tube
    std::array<CageRun, 2> cap;  ///< caps at its beginning and its end
    std::array<CageRun, 2>
        fork;  ///< between tubes at the branch nodes of its ends, if they belong to this tube

    /// Returns the quads beyond an end: no tube has both kinds.
    const CageRun& beyond(int end) const { return cap[end].count > 0 ? cap[end] : fork[end]; }
};

/// Returns the cage quads of all tubes. O(cage).
std::vector<TubeFaces> faces_of_tubes(const TubeRows& tube_rows);

/// A surface of refined quads, tube by tube.
struct TubeQuads {
    const QuadMesh& mesh;
    const TubeRows& tube_rows;
    std::vector<TubeFaces> faces;  ///< per tube
    std::vector<Box3> boxes;       ///< per tube: bounding box of its quads; empty without quads
};

/// Returns the quads with boxes that overlap a box of the tree, ascending. O(tubes) if there are few.
std::vector<std::uint32_t> quads_near(const TubeQuads& tubes, const BoxTree& tree, const Context& ctx);

}  // namespace coppice::pipeline_internal
