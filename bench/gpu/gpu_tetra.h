#pragma once

#include <vector>

#include "coppice/skeleton/skeleton.h"
#include "gpu_case.h"

namespace coppice::bench {

/// A benchmark case of tetrahedra.
struct TetraCase {
    std::string name;
    Skeleton skeleton;
    bool in_polyhedron;  ///< whether to use the polyhedron of [Zhu2013] instead of a lattice
    float edge;          ///< [radii] approximate edge of the triangles; see TetraOptions
    int levels;          ///< number of subdivisions of tetrahedra
    double papers = -1;  ///< [s] published time for 1:8, field and marching
    std::vector<Goal> goals;
};

/// Measures the method as published in [Zhu2013]: from coarse tetrahedra on the GPU to triangles there, and
/// the same kernels on the CPU.
GpuResult measure_printed_tetra(const TetraCase& what, const GpuRun& run);

/// Measures the method of the library: from coarse tetrahedra and regions of the field on the host to the
/// welded surface on the host, including copies, and on the CPU.
GpuResult measure_tetra(const TetraCase& what, const GpuRun& run);

}  // namespace coppice::bench
