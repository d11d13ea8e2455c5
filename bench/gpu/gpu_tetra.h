#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"
#include "gpu_case.h"

namespace coppice::bench {

/// What is measured of tetrahedra.
struct TetraCase {
    std::string name;
    Skeleton skeleton;
    bool in_polyhedron;  ///< the polyhedron of [Zhu2013], else a lattice
    float edge;          ///< [radii] of the triangles, about; see TetraOptions
    int levels;          ///< times that tetrahedra are cut into eight
    double papers = -1;  ///< [s] printed for 1:8, field and marching
    std::vector<Goal> goals;
};

/// As [Zhu2013] prints it: from coarse tetrahedra on the card to triangles there, and the same kernels on the
/// CPU.
GpuResult measure_printed_tetra(const TetraCase& what, const GpuRun& run);

/// As the product does it: from coarse tetrahedra and regions of the field on the host to the welded surface
/// there, copies included, and on the CPU.
GpuResult measure_tetra(const TetraCase& what, const GpuRun& run);

}  // namespace coppice::bench
