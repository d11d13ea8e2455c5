#pragma once

#include "coppice/mesh/mesh.h"

namespace coppice::bench {

struct OpenSubdivTime {
    double topology = 0;  ///< [s] TopologyRefiner: create and refine uniformly
    double points = 0;    ///< [s] PrimvarRefiner: interpolate the positions of every level
    double total() const { return topology + points; }
};

/// Measures the uniform Catmull-Clark refinement of a cage by OpenSubdiv, which uses one thread. The
/// conversion of the cage into its input is not included.
OpenSubdivTime time_opensubdiv(const QuadMesh& cage, int levels);

}  // namespace coppice::bench
