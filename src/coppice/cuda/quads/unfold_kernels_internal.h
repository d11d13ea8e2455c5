#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/cuda/quads/fold_stages_internal.h"
#include "coppice/cuda/quads/quad_kernels_internal.h"
#include "coppice/subdivision/kernel/unfold_kernel.h"

namespace coppice::cuda {

/// Working memory for clusters: one entry for each of their vertices or faces.
struct ClusterRoom {
    std::span<std::uint32_t>
        ring;  ///< by vertex: the ring with which it became part of this pass, or kNoIndex
    std::span<std::uint32_t> active;     ///< by vertex: indices of those that move in this pass
    std::span<Vec3> moved, first, best;  ///< by vertex
    std::span<std::uint32_t> now_bad;    ///< by face: indices of bad faces
    std::span<std::uint32_t> min_bad;    ///< indices of bad faces when they were fewest
};

/// Results of all clusters.
struct UnfoldOutcome {
    std::span<std::uint32_t> bad_count;  ///< one number, initially 0
    std::span<std::uint32_t> bad;        ///< quads that are still bad, in any order
    std::span<std::uint32_t> passes;     ///< by report, initially 0: maximum over clusters
    std::span<std::uint32_t> moved;      ///< by report, initially 0: vertices with a changed position
};

/// Unfolds one cluster by the passes of untangle(), with one group of threads for each; groups beyond the
/// number of clusters do no work.
template <class Field>
struct UnfoldCluster {
    static constexpr bool kIsWide = true;  // some clusters are large

    SurfaceView surface;
    DeviceClusters clusters;
    ClusterRoom room;
    UnfoldOutcome outcome;
    std::span<const std::uint32_t> part;  ///< see QuadJob
    Field field;
    FaceLimits limits;
    int passes, projected_passes;

    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t cluster, const Group& group) const {
        if (cluster >= clusters.count[0]) return;
        const At at(clusters, room, cluster);
        const auto count = static_cast<std::uint32_t>(at.vertices.size());
        const std::span<Vec3> positions = surface.points.positions;
        std::uint32_t bad = begin(at, group), least = bad;
        UnfoldSchedule schedule(passes, projected_passes, bad, count);
        while (schedule.begin_pass()) {
            const std::uint32_t moving = find_active(at, bad, schedule.rings(), group);
            move(at, moving, schedule.steps(), group);
            bad = find_bad(at, group);
            if (!schedule.end_pass(moving, bad)) continue;
            least = bad;
            group.each(bad, [&](std::uint32_t k) { at.room.min_bad[k] = at.room.now_bad[k]; });
            group.each(count, [&](std::uint32_t k) { at.room.best[k] = positions[at.vertices[k]]; });
        }
        group.each(count, [&](std::uint32_t k) { positions[at.vertices[k]] = at.room.best[k]; });
        const std::uint32_t moved = group.select(
            count, [&](std::uint32_t k) { return at.room.best[k] != at.room.first[k]; },
            at.room.active.data());
        group.each(least, [&](std::uint32_t k) {
            outcome.bad[add_to(outcome.bad_count[0], 1u)] = at.faces[at.room.min_bad[k]];
        });
        group.each(1, [&](std::uint32_t) {
            const std::uint32_t p = part.empty() ? 0 : part[at.faces[0] >> (2 * surface.levels)];
            raise_to(outcome.passes[p], schedule.pass());
            add_to(outcome.moved[p], moved);
        });
    }

  private:
    /// One cluster: its vertices and faces, both ascending, and its working memory.
    struct At {
        std::span<const std::uint32_t> vertices, faces;
        std::span<const Quad> corners;
        ClusterRoom room;
        std::uint32_t first_vertex;

        COPPICE_HOST_DEVICE At(const DeviceClusters& all, const ClusterRoom& r, std::uint32_t cluster)
            : first_vertex(all.first_vertex[cluster]) {
            const std::uint32_t v = first_vertex, f = all.first_face[cluster];
            const std::uint32_t vertex_count = all.first_vertex[cluster + 1] - v,
                                face_count = all.first_face[cluster + 1] - f;
            vertices = all.vertices.subspan(v, vertex_count);
            faces = all.faces.subspan(f, face_count);
            corners = all.corners.subspan(f, face_count);
            room = {r.ring.subspan(v, vertex_count),  r.active.subspan(v, vertex_count),
                    r.moved.subspan(v, vertex_count), r.first.subspan(v, vertex_count),
                    r.best.subspan(v, vertex_count),  r.now_bad.subspan(f, face_count),
                    r.min_bad.subspan(f, face_count)};
        }
        COPPICE_HOST_DEVICE std::uint32_t face_count() const {
            return static_cast<std::uint32_t>(faces.size());
        }
        /// Returns the ring of a face's corner.
        COPPICE_HOST_DEVICE std::uint32_t get_ring(std::uint32_t corner) const {
            return corner == kNoIndex ? kNoIndex : room.ring[corner - first_vertex];
        }
        /// Adds the corners of a face that are in no ring to a ring.
        COPPICE_HOST_DEVICE void take_corners(const Quad& face, std::uint32_t into) const {
            for (const std::uint32_t c : face) {
                if (c == kNoIndex) continue;
                std::uint32_t& ring = room.ring[c - first_vertex];
                if (ring == kNoIndex) ring = into;
            }
        }
    };

    /// Returns the initial number of bad faces.
    template <class Group>
    COPPICE_HOST_DEVICE std::uint32_t begin(const At& at, const Group& group) const {
        group.each(static_cast<std::uint32_t>(at.vertices.size()), [&](std::uint32_t k) {
            at.room.best[k] = at.room.first[k] = surface.points.positions[at.vertices[k]];
        });
        const auto is_bad = [&](std::uint32_t k) { return is_bad_now(at.faces[k]); };
        const std::uint32_t bad = group.select(at.face_count(), is_bad, at.room.now_bad.data());
        group.each(bad, [&](std::uint32_t k) { at.room.min_bad[k] = at.room.now_bad[k]; });
        return bad;
    }

    /// Marks the corners of the bad faces and of `rings` rings around them, and lists them.
    template <class Group>
    COPPICE_HOST_DEVICE std::uint32_t find_active(const At& at, std::uint32_t bad, int rings,
                                                  const Group& group) const {
        const auto count = static_cast<std::uint32_t>(at.vertices.size());
        group.each(count, [&](std::uint32_t k) { at.room.ring[k] = kNoIndex; });
        group.each(bad, [&](std::uint32_t k) { at.take_corners(at.corners[at.room.now_bad[k]], 0); });
        for (int r = 1; r <= rings; ++r) {
            const auto limit = static_cast<std::uint32_t>(r);
            // Several threads write the same value, which is not below the limit, so the order has no effect.
            group.each(at.face_count(), [&](std::uint32_t k) {
                const Quad face = at.corners[k];
                std::uint32_t least = kNoIndex;
                for (const std::uint32_t c : face) least = kernel::smaller(least, at.get_ring(c));
                if (least < limit) at.take_corners(face, limit);
            });
        }
        return group.select(
            count, [&](std::uint32_t k) { return at.room.ring[k] != kNoIndex; }, at.room.active.data());
    }

    template <class Group>
    COPPICE_HOST_DEVICE void move(const At& at, std::uint32_t count, int steps, const Group& group) const {
        group.each(count, [&](std::uint32_t k) {
            const std::uint32_t place = at.room.active[k];
            at.room.moved[place] = moved(at.vertices[place], steps);
        });
        group.each(count, [&](std::uint32_t k) {
            const std::uint32_t place = at.room.active[k];
            const Vec3 p = at.room.moved[place];
            if (is_finite(p)) surface.points.positions[at.vertices[place]] = p;
        });
    }
    COPPICE_HOST_DEVICE Vec3 moved(std::uint32_t vertex, int steps) const {
        const PatchStars& stars = surface.stars;
        const FlatEnds::Place end = FlatEnds(surface.clips).of_vertex(stars, surface.levels, vertex);
        const Vec3 start = smoothed(vertex, surface.points.positions, stars,
                                    [&](std::uint32_t quad) { return stars.quad(quad); });
        Mover mover(start, surface.points.anchors[vertex], end, surface.clips);
        const std::uint32_t region = surface.region[stars.owner(vertex)];
        for (int step = 0; step < steps; ++step) {
            if (!mover.advance(read_sample(field.sample(region, mover.point()), 1.0f))) break;
        }
        return mover.point();
    }

    COPPICE_HOST_DEVICE bool is_bad_now(std::uint32_t face) const {
        return is_bad_face(surface.stars.quad(face), surface.points.positions, surface.points.anchors,
                           limits);
    }
    /// Lists the bad faces among those with moved vertices; returns their number.
    template <class Group>
    COPPICE_HOST_DEVICE std::uint32_t find_bad(const At& at, const Group& group) const {
        const auto is_bad = [&](std::uint32_t k) {
            bool has_moved = false;
            for (const std::uint32_t c : at.corners[k]) has_moved = has_moved || at.get_ring(c) != kNoIndex;
            return has_moved && is_bad_now(at.faces[k]);
        };
        return group.select(at.face_count(), is_bad, at.room.now_bad.data());
    }
};

}  // namespace coppice::cuda
