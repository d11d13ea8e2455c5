#pragma once

#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns the volume in m3 that a closed mesh encloses.
inline double compute_volume(const TriMesh& mesh) {
    double out = 0;
    for (const Triangle& t : mesh.triangles)
        out += double{dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]]))} / 6;
    return out;
}

}  // namespace coppice
