#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/knots/slices_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {

/// Cage quads first .. first + count.
struct CageRun {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

/// The cage quads of a tube.
struct TubeFaces {
    CageRun side;                ///< around it
    std::array<CageRun, 2> cap;  ///< that close its beginning and its end
    std::array<CageRun, 2>
        fork;  ///< at branch nodes where it begins and ends, as far as they count as its own

    /// At an end: no tube has both.
    const CageRun& beyond(int end) const { return cap[end].count > 0 ? cap[end] : fork[end]; }
};

/// The cage quads of all tubes. O(cage).
std::vector<TubeFaces> faces_of_tubes(const Slices& slices);

/// A surface of refined quads, tube by tube.
struct TubeQuads {
    const QuadMesh& mesh;
    const Slices& slices;
    std::vector<TubeFaces> faces;  ///< per tube
    std::vector<Box3> boxes;       ///< per tube: where its quads lie; empty without any
};

/// The quads whose boxes meet any of those of the tree; ascending. O(tubes) where few do.
std::vector<std::uint32_t> quads_near(const TubeQuads& tubes, const BoxTree& tree, const Context& ctx);

}  // namespace coppice::pipeline_internal
