#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "coppice/cuda/tetra/extract_stages_internal.h"
#include "printed_march_kernels.h"

// Marching tetrahedra as published in [Zhu2013], on an executor, for any field that kernels can sample.

namespace coppice::bench {

/// Tetrahedra and the triangles of a field in them. The arrays are on the executor.
struct PrintedSurface {
    ExplicitTetra mesh;                              ///< of the last level
    std::span<const std::array<Vec3, 3>> triangles;  ///< corners of each, as drawn in the paper
    std::span<const Vec3> positions;   ///< of the same triangles, welded; empty if not requested
    std::span<const Triangle> welded;  ///< counter-clockwise seen from outside
};

template <class Exec>
ExplicitTetra make_explicit(Exec& exec, std::uint64_t vertices, std::uint64_t edges, std::uint64_t faces,
                            std::uint64_t tetra) {
    // A scan uses 31 bits.
    constexpr std::uint64_t kMax = std::numeric_limits<std::int32_t>::max() - 1;
    if (edges > kMax || faces > kMax || tetra > kMax)
        throw DeviceError("there are too many tetrahedra for a device");
    return {exec.template array<Vec3>(vertices), exec.template array<std::uint32_t>(vertices),
            exec.template array<ExplicitTetra::Edge>(edges), exec.template array<ExplicitTetra::Face>(faces),
            exec.template array<ExplicitTetra::Cell>(tetra)};
}

/// Divides every tetrahedron into eight: V' = V + E, E' = 2 E + 3 F + T, F' = 4 F + 8 T, T' = 8 T. Faces are
/// not written on the last level.
template <class Exec>
ExplicitTetra subdivide(Exec& exec, const ExplicitTetra& coarse, bool last = false) {
    const std::uint64_t v = coarse.positions.size(), e = coarse.edges.size(), f = coarse.faces.size(),
                        t = coarse.tetra.size();
    const ExplicitTetra fine = make_explicit(exec, v + e, 2 * e + 3 * f + t, last ? 0 : 4 * f + 8 * t, 8 * t);
    exec.each("vertices", v, KeepVertices{coarse, fine});
    exec.each("CalcEdgePoints", e, CalcEdgePoints{coarse, fine});
    exec.each("SubdivideFaces", f, SubdivideFaces{coarse, fine});
    exec.each("SubdivideTetrahedra", t * SubdivideTetrahedra::kParts, SubdivideTetrahedra{coarse, fine});
    return fine;
}

/// Uploads the coarse mesh with its edges and faces. Throws the exceptions of TetraRefinement.
template <class Exec>
ExplicitTetra upload_explicit(Exec& exec, const TetraMesh& mesh, const Context& ctx = {}) {
    const cuda::DeviceRefinement from = cuda::refine(exec, mesh, 0, ctx);
    const ExplicitTetra out =
        make_explicit(exec, mesh.positions.size(), from.of[1].size(), from.of[2].size(), mesh.tetra.size());
    exec.each("coarse", mesh.positions.size(), WriteVertices{from.view.positions, out});
    exec.each("coarse", mesh.tetra.size(), WriteCoarse{from, out});
    return out;
}

/// Extracts the surface value = `level` of a field in tetrahedra that are divided into eight `levels` times.
template <class Exec, class Field>
PrintedSurface march_as_printed(Exec& exec, const ExplicitTetra& coarse, int levels, const Field& field,
                                float level, bool weld) {
    PrintedSurface out{coarse, {}, {}, {}};
    ExplicitTetra& mesh = out.mesh;
    for (int l = 1; l <= levels; ++l) mesh = subdivide(exec, mesh, l == levels);
    const std::size_t tetra = mesh.tetra.size(), edges = mesh.edges.size();
    const auto value = exec.template array<float>(mesh.positions.size());
    exec.each("CalcFields", mesh.positions.size(), CalcFields<Field>{mesh, field, value});
    const IsoSurface surface{mesh, value, level,
                             exec.upload(std::span<const tetra_kernel::Cut>(tetra_kernel::kCuts))};
    const auto index = exec.template array<std::uint8_t>(tetra);
    const auto first = exec.template array<std::uint32_t>(tetra + 1);
    exec.each("CalcTetrahedralIndice", tetra, CalcTetrahedralIndice{surface, index, first});
    const std::uint32_t triangles = cuda::place_counts(exec, first);
    const auto soup = exec.template array<std::array<Vec3, 3>>(triangles);
    exec.each("ExtractIsoTriangles", tetra, ExtractIsoTriangles{surface, index, first, soup});
    out.triangles = soup;
    if (!weld) return out;
    const auto vertex = exec.template array<std::uint32_t>(edges + 1);
    exec.each("mark cut edges", edges, MarkCutEdges{surface, vertex});
    const auto positions = exec.template array<Vec3>(cuda::place_counts(exec, vertex));
    exec.each("weld vertices", edges, WeldVertices{surface, vertex, positions});
    const auto welded = exec.template array<Triangle>(triangles);
    exec.each("weld triangles", tetra, WeldTriangles{surface, index, first, vertex, welded});
    out.positions = positions;
    out.welded = welded;
    return out;
}

}  // namespace coppice::bench
