#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/kernel/kernel_math.h"
#include "coppice/base/vec.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/subdivision/kernel/cage_view.h"

// Catmull-Clark subdivision and the evolution as published in [Zhu2015], with explicit vertices, edges and
// faces on every level. Each thread gathers the values that the paper adds to accumulators, so that sums do
// not depend on the order of threads.
//
// All elements are numbered in closed form. With V vertices, E edges and F quads of a closed mesh: vertex v
// stays v, V + e is on edge e, V + E + f in quad f; quad 4 f + k is at corner k; edges 2 e and 2 e + 1 start
// at the lower and the higher end of edge e, 2 E + 4 f + k connects the midpoint of side k with that of quad
// f. Edges point forward from their lower vertex, as in HalfEdges, but are numbered in another order.

namespace coppice::bench {

/// Explicit quads with their edges and fans: a writable CageView.
struct ExplicitQuads {
    std::span<Vec3> positions;  ///< [m]
    /// See CageView.
    /// @{
    std::span<Quad> quads;
    std::span<std::uint32_t> side;
    std::span<std::array<std::uint32_t, 2>> edge_half;
    std::span<std::uint32_t> fan_first, fan_half;
    /// @}
};

/// One Catmull-Clark step of a closed mesh.
struct QuadStep {
    CageView coarse;
    std::span<const Vec3> positions;  ///< [m] of `coarse`
    ExplicitQuads fine;

    COPPICE_HOST_DEVICE std::uint32_t edge_point(std::uint32_t e) const { return coarse.vertex_count() + e; }
    COPPICE_HOST_DEVICE std::uint32_t face_point(std::uint32_t f) const {
        return coarse.vertex_count() + coarse.edge_count() + f;
    }
    /// Start of the fans of the points on edges and of those in faces: four half-edges each.
    /// @{
    COPPICE_HOST_DEVICE std::uint32_t edge_fan(std::uint32_t e) const {
        return 4 * (coarse.face_count() + e);
    }
    COPPICE_HOST_DEVICE std::uint32_t face_fan(std::uint32_t f) const {
        return 4 * (coarse.face_count() + coarse.edge_count() + f);
    }
    /// @}
};

/// Computes the mean of a face's corners, and its four subfaces; one thread per face.
struct FacePoints {
    QuadStep step;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t f) const {
        const CageView& mesh = step.coarse;
        const ExplicitQuads& fine = step.fine;
        const Quad& quad = mesh.quads[f];
        const auto side = mesh.side.subspan(4 * f, 4);
        const std::uint32_t middle = step.face_point(f), inner = 2 * mesh.edge_count() + 4 * f;
        Vec3 sum;
        for (const std::uint32_t v : quad) sum += step.positions[v];
        fine.positions[middle] = sum * 0.25f;
        fine.fan_first[middle + 1] = step.face_fan(f + 1);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t part = 4 * f + k, next = 4 * f + ((k + 1) & 3), last = (k + 3) & 3;
            const std::uint32_t after = side[k], before = side[last];
            fine.quads[part] = {quad[k], step.edge_point(after >> 1), middle, step.edge_point(before >> 1)};
            // The half of an edge at the start of a side has the number of the side, 2 e or 2 e + 1.
            fine.side[4 * part] = 2 * after;
            fine.side[4 * part + 1] = 2 * (inner + k);
            fine.side[4 * part + 2] = 2 * (inner + last) + 1;
            fine.side[4 * part + 3] = 2 * (before ^ 1) + 1;
            fine.edge_half[inner + k] = {4 * part + 1, 4 * next + 2};
            fine.fan_half[step.face_fan(f) + k] = 4 * part + 2;
        }
    }
};

/// Computes the mean of an edge's ends and of the points in its two faces, and its halves; one thread per
/// edge, after FacePoints.
struct EdgePoints {
    QuadStep step;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t e) const {
        const CageView& mesh = step.coarse;
        const ExplicitQuads& fine = step.fine;
        const auto [forward, backward] = mesh.edge_half[e];
        const Vec3 ends = step.positions[mesh.corner(forward)] + step.positions[mesh.corner(backward)];
        const Vec3 faces =
            fine.positions[step.face_point(forward >> 2)] + fine.positions[step.face_point(backward >> 2)];
        const std::uint32_t middle = step.edge_point(e);
        fine.positions[middle] = (ends + faces) * 0.25f;
        fine.fan_first[middle + 1] = step.edge_fan(e + 1);
        fine.edge_half[2 * e] = {4 * forward, to_end(backward)};
        fine.edge_half[2 * e + 1] = {4 * backward, to_end(forward)};
        // The lower face first, which owns the vertex: see PatchStars.
        write_fan(kernel::smaller(forward, backward), &fine.fan_half[step.edge_fan(e)]);
        write_fan(kernel::larger(forward, backward), &fine.fan_half[step.edge_fan(e) + 2]);
    }

  private:
    /// Half-edges from the midpoint of a half-edge to its end, and into its face.
    /// @{
    COPPICE_HOST_DEVICE static std::uint32_t to_end(std::uint32_t half) {
        return 4 * next_half_edge<4>(half) + 3;
    }
    COPPICE_HOST_DEVICE static std::uint32_t inward(std::uint32_t half) { return 4 * half + 1; }
    /// @}
    COPPICE_HOST_DEVICE static void write_fan(std::uint32_t half, std::uint32_t* fan) {
        fan[0] = kernel::smaller(inward(half), to_end(half));
        fan[1] = kernel::larger(inward(half), to_end(half));
    }
};

/// Moves vertices; one thread per vertex, after FacePoints. As in the paper, `out` is the sum of the points
/// in the faces around a vertex and twice the midpoints of its edges. Vertices without faces stay.
struct VertexPoints {
    QuadStep step;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        const CageView& mesh = step.coarse;
        const std::uint32_t begin = mesh.fan_first[v], end = mesh.fan_first[v + 1];
        const Vec3 p = step.positions[v];
        Vec3 out;
        for (std::uint32_t i = begin; i < end; ++i) {
            const std::uint32_t half = mesh.fan_half[i];
            out += step.fine.positions[step.face_point(half >> 2)] +
                   (p + step.positions[mesh.corner(next_half_edge<4>(half))]);
            step.fine.fan_half[i] = 4 * half;
        }
        step.fine.fan_first[v + 1] = end;
        const auto n = static_cast<float>(end - begin);
        step.fine.positions[v] = end == begin ? p : ((n - 3) * p + out / n) / n;
    }
};

/// Parameters of the movement of vertices onto the field.
struct Evolution {
    float sigma = 0.95f;  ///< fraction of Newton's step
    int steps = 6;        ///< 5 to 7 are sufficient according to the paper
};

/// Iterates v <- v - sigma (F - T) grad F / |grad F|^2, with T = 1; one thread per vertex. Equation 5 has the
/// opposite sign, which is correct for a field that increases outward. The field is sampled in the region of
/// the control face of the vertex; a vertex without gradient stays.
template <class Field>
struct EvolveVertices {
    CageView mesh;
    int levels;                             ///< number of subdivisions
    std::span<const std::uint32_t> region;  ///< per control face
    Field field;
    Evolution how;
    std::span<const Vec3> in;
    std::span<Vec3> out;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        Vec3 p = in[v];
        const auto fan = mesh.fan(v);
        const int steps = fan.empty() ? 0 : how.steps;
        const std::uint32_t r = steps > 0 ? region[fan[0] >> (2 * levels + 2)] : 0;
        for (int step = 0; step < steps; ++step) {
            const FieldSample s = field.sample(r, p);
            const float slope_squared = length_squared(s.gradient);
            const Vec3 next = p - s.gradient * (how.sigma * (s.value - 1) / slope_squared);
            if (!std::isfinite(length_squared(next))) break;
            p = next;
        }
        out[v] = p;
    }
};

}  // namespace coppice::bench
