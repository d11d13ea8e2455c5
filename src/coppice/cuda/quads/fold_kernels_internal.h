#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/base/kernel/partition_point.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/cuda/exec/sets_kernel_internal.h"
#include "coppice/subdivision/kernel/face_kernel.h"
#include "coppice/subdivision/kernel/patch_index.h"

// Kernels that find bad quads, and the clusters of FoldClusters around them.

namespace coppice::cuda {

/// Finds the bad quads of runs of kRun quads, with one group of threads for each run.
struct FindBad {
    static constexpr std::uint32_t kRun = 256;

    PatchStars stars;
    FaceLimits limits;
    std::span<const Vec3> positions, anchors;
    std::span<std::uint32_t> found;  ///< the bad quads of run r from index r kRun on, as indices in their run
    std::span<std::uint32_t> count;  ///< per run, plus an unused last element

    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t run, const Group& group) const {
        const std::uint32_t first = run * kRun;
        const std::uint32_t size = kernel::smaller(kRun, stars.quad_count() - first);
        const auto is_bad = [&](std::uint32_t k) {
            return is_bad_face(stars.quad(first + k), positions, anchors, limits);
        };
        const std::uint32_t bad = group.select(size, is_bad, &found[first]);
        group.each(1, [&](std::uint32_t) { count[run] = bad; });
    }
};

/// Concatenates the bad quads, ascending, as far as there is room, after their count, with one group for each
/// run.
struct GatherBad {
    std::span<const std::uint32_t> found;
    std::span<const std::uint32_t> first;  ///< per run, plus the end
    std::span<std::uint32_t> out;          ///< the count, followed by the bad quads

    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t run, const Group& group) const {
        group.each(first[run + 1] - first[run], [&](std::uint32_t k) {
            const std::size_t place = std::size_t{1} + first[run] + k;
            if (place < out.size()) out[place] = run * FindBad::kRun + found[run * FindBad::kRun + k];
        });
        if (run == 0) group.each(1, [&](std::uint32_t) { out[0] = first[first.size() - 1]; });
    }
};

/// Faces, their corners and rings around them during collection: unique, in any order.
struct Surroundings {
    PatchStars stars;
    std::span<std::uint32_t> seen_vertices, seen_faces;  ///< a bit for each of the surface
    std::span<std::uint32_t> vertices, faces;            ///< as far as there is room
    std::span<std::uint32_t> vertex_count, face_count;   ///< one number each, includes elements without room

    COPPICE_HOST_DEVICE void add_vertex(std::uint32_t v) const {
        if (is_new(seen_vertices, v)) append(vertices, vertex_count, v);
    }
    /// Returns false if the face is already present.
    COPPICE_HOST_DEVICE bool add_face(std::uint32_t face) const {
        if (!is_new(seen_faces, face)) return false;
        append(faces, face_count, face);
        return true;
    }
    COPPICE_HOST_DEVICE void add_corners(std::uint32_t face) const {
        if (!add_face(face)) return;
        for (const std::uint32_t v : stars.quad(face)) add_vertex(v);
    }

  private:
    COPPICE_HOST_DEVICE static bool is_new(std::span<std::uint32_t> seen, std::uint32_t i) {
        const std::uint32_t bit = 1u << (i % 32);
        return (set_bits(seen[i / 32], bit) & bit) == 0;
    }
    COPPICE_HOST_DEVICE static void append(std::span<std::uint32_t> list, std::span<std::uint32_t> count,
                                           std::uint32_t i) {
        const std::uint32_t place = add_to(count[0], 1u);
        if (place < list.size()) list[place] = i;
    }
};

/// Adds the initial faces.
struct CollectFaces {
    Surroundings around;
    std::span<const std::uint32_t> faces;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const { around.add_corners(faces[k]); }
};

/// Stores the number of vertices before a ring is added.
struct NoteRing {
    Surroundings around;
    std::span<std::uint32_t> end;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t) const {
        end[0] = kernel::smaller(around.vertex_count[0], static_cast<std::uint32_t>(around.vertices.size()));
    }
};

/// Adds the faces around the vertices of the last ring, and their corners. Their number is not known at the
/// launch: they are distributed over `threads` threads.
struct AddRing {
    Surroundings around;
    std::span<const std::uint32_t> begin, end;  ///< see NoteRing
    std::uint32_t threads;
    bool with_corners;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t thread) const {
        for (std::uint32_t k = begin[0] + thread; k < end[0]; k += threads) {
            around.stars.for_each_corner(around.vertices[k], [&](QuadCorner c) {
                with_corners ? around.add_corners(c.quad) : static_cast<void>(around.add_face(c.quad));
            });
        }
    }
};

/// Replaces vertices on boundaries, which may not move, by kNoIndex.
struct DropBoundary {
    PatchStars stars;
    std::span<std::uint32_t> vertices;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        if (stars.on_boundary(vertices[k])) vertices[k] = kNoIndex;
    }
};

/// Finds the indices of the corners of faces in the ascending list of vertices, and joins the corners of each
/// face into one set.
struct JoinCorners {
    PatchStars stars;
    std::span<const std::uint32_t> vertices, faces;
    std::span<Quad> corners;  ///< kNoIndex for corners that may not move
    DeviceSets sets;          ///< of vertices
    COPPICE_HOST_DEVICE void operator()(std::uint32_t f) const {
        Quad places = stars.quad(faces[f]);
        std::uint32_t first = kNoIndex;
        for (std::uint32_t& place : places) {
            const std::uint32_t v = place;
            place = kernel::partition_point(vertices, [&](std::uint32_t other) { return other < v; });
            if (place == vertices.size() || vertices[place] != v) {
                place = kNoIndex;
            } else if (first == kNoIndex) {
                first = place;
            } else {
                sets.join(first, place);
            }
        }
        corners[f] = places;
    }
};

/// Marks the representative vertices of clusters.
struct MarkClusters {
    std::span<const std::uint32_t> vertices;
    DeviceSets sets;
    std::span<std::uint32_t> mark;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        mark[k] = vertices[k] != kNoIndex && sets.find(k) == k ? 1 : 0;
    }
};

/// Compute sorting keys of entries: the number of their cluster, or kNoIndex without a cluster.
/// @{
struct KeyVertices {
    std::span<const std::uint32_t> vertices;
    DeviceSets sets;
    std::span<const std::uint32_t> number;
    std::span<std::uint32_t> key, entry;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        key[k] = vertices[k] == kNoIndex ? kNoIndex : number[sets.find(k)];
        entry[k] = k;
    }
};
struct KeyFaces {
    std::span<const Quad> corners;
    DeviceSets sets;
    std::span<const std::uint32_t> number;
    std::span<std::uint32_t> key, entry;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t f) const {
        std::uint32_t first = kNoIndex;
        for (const std::uint32_t c : corners[f]) first = kernel::smaller(first, c);
        key[f] = first == kNoIndex ? kNoIndex : number[sets.find(first)];
        entry[f] = f;
    }
};
/// @}

/// Computes the start of the entries of each cluster, and the end, for entries sorted by key.
struct BoundRows {
    std::span<const std::uint32_t> key;
    std::span<std::uint32_t> first;
    std::span<std::uint32_t> count;  ///< one number: number of clusters; initially 0
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        const std::uint32_t row = key[k];
        if (row == kNoIndex) return;
        if (k == 0 || key[k - 1] != row) first[row] = k;
        if (k + 1 < key.size() && key[k + 1] != kNoIndex) return;
        first[row + 1] = k + 1;
        count[0] = row + 1;
    }
};

/// Copies the vertices in sorted order, and stores the new index of each.
struct TakeVertices {
    std::span<const std::uint32_t> vertices, entry;
    std::span<std::uint32_t> out, place;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        out[k] = vertices[entry[k]];
        place[entry[k]] = k;
    }
};
/// Copies the faces in sorted order, with the new indices of their corners.
struct TakeFaces {
    std::span<const std::uint32_t> faces, entry;
    std::span<const Quad> corners;
    std::span<const std::uint32_t> place;
    std::span<std::uint32_t> out;
    std::span<Quad> corners_out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        out[k] = faces[entry[k]];
        Quad to = corners[entry[k]];
        for (std::uint32_t& c : to) c = c == kNoIndex ? kNoIndex : place[c];
        corners_out[k] = to;
    }
};

}  // namespace coppice::cuda
