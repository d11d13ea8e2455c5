#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "coppice/cuda/quads/quad_kernels.h"
#include "coppice/subdivision/kernel/unfold_kernel.h"

namespace coppice::cuda {

/// Finds the bad quads of one run of kRun each: a group of threads for each run.
struct FindBad {
    static constexpr std::uint32_t kRun = 1024;

    PatchStars stars;
    FaceLimits limits;
    std::span<const Vec3> positions, anchors;
    std::span<std::uint32_t> found;  ///< the bad ones of run r from r kRun on, as places in their run
    std::span<std::uint32_t> count;  ///< per run, and one more, which is left alone

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

/// Brings them together, ascending, as far as there is room, behind their count: a group for each run.
struct GatherBad {
    std::span<const std::uint32_t> found;
    std::span<const std::uint32_t> first;  ///< per run, and one more
    std::span<std::uint32_t> out;          ///< the count, and then the bad quads

    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t run, const Group& group) const {
        group.each(first[run + 1] - first[run], [&](std::uint32_t k) {
            const std::size_t place = std::size_t{1} + first[run] + k;
            if (place < out.size()) out[place] = run * FindBad::kRun + found[run * FindBad::kRun + k];
        });
        if (run == 0) group.each(1, [&](std::uint32_t) { out[0] = first[first.size() - 1]; });
    }
};

/// Rows of numbers: see CompressedRows.
struct RowsView {
    std::span<const std::uint32_t> first, items;
    COPPICE_HOST_DEVICE std::span<const std::uint32_t> operator[](std::uint32_t row) const {
        return {items.data() + first[row], first[row + 1] - first[row]};
    }
};

/// Bad quads in clusters (see FoldClusters), and room to work on them: one entry per item of the rows.
struct ClusterView {
    RowsView vertices, faces, bad;
    std::span<std::uint32_t> ring;         ///< by vertex: the ring that brought it into this pass, or none
    std::span<std::uint32_t> active;       ///< by vertex: places of those that move in this pass
    std::span<Vec3> moved, first, best;    ///< by vertex
    std::span<std::uint32_t> now_bad;      ///< by face: places of the bad ones
    std::span<std::uint32_t> least_bad;    ///< the same when they were fewest
    std::span<std::uint32_t> least_count;  ///< per cluster
    std::span<std::uint32_t> passes;       ///< per cluster
    std::span<std::uint32_t> moved_count;  ///< per cluster: vertices that lie elsewhere in the end
};

/// Unfolds one cluster by the passes of untangle(): a group of threads for each.
template <class Field>
struct UnfoldCluster {
    SurfaceView surface;
    ClusterView clusters;
    Field field;
    FaceLimits limits;
    int passes, projected_passes;

    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t cluster, const Group& group) const {
        const auto vertices = clusters.vertices[cluster];
        const auto faces = clusters.faces[cluster];
        const auto count = static_cast<std::uint32_t>(vertices.size());
        const std::span<Vec3> positions = surface.points.positions;
        const At at{vertices, faces, clusters.vertices.first[cluster], clusters.faces.first[cluster]};
        std::uint32_t bad = begin(cluster, at, group);
        UnfoldSchedule schedule(passes, projected_passes, bad, count);
        while (schedule.begin_pass()) {
            const std::uint32_t moving = find_active(at, bad, schedule.rings(), group);
            move(at, moving, schedule.steps(), group);
            bad = find_bad(at, group);
            if (!schedule.end_pass(moving, bad)) continue;
            group.each(bad, [&](std::uint32_t k) {
                clusters.least_bad[at.first_face + k] = clusters.now_bad[at.first_face + k];
            });
            group.each(count, [&](std::uint32_t k) { best(at, k) = positions[vertices[k]]; });
            group.each(1, [&](std::uint32_t) { clusters.least_count[cluster] = bad; });
        }
        group.each(count, [&](std::uint32_t k) { positions[vertices[k]] = best(at, k); });
        const std::uint32_t moved = group.select(
            count, [&](std::uint32_t k) { return best(at, k) != clusters.first[at.first_vertex + k]; },
            &clusters.active[at.first_vertex]);
        group.each(1, [&](std::uint32_t) {
            clusters.passes[cluster] = schedule.pass();
            clusters.moved_count[cluster] = moved;
        });
    }

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    /// The vertices and faces of a cluster, both ascending, and where those of all clusters begin.
    struct At {
        std::span<const std::uint32_t> vertices, faces;
        std::uint32_t first_vertex, first_face;

        /// The place of a vertex in its cluster; kNone of one that may not move.
        COPPICE_HOST_DEVICE std::uint32_t place(std::uint32_t vertex) const {
            const auto found = std::lower_bound(vertices.begin(), vertices.end(), vertex);
            if (found == vertices.end() || *found != vertex) return kNone;
            return static_cast<std::uint32_t>(found - vertices.begin());
        }
    };

    COPPICE_HOST_DEVICE Vec3& best(const At& at, std::uint32_t k) const {
        return clusters.best[at.first_vertex + k];
    }
    COPPICE_HOST_DEVICE std::uint32_t& ring(const At& at, std::uint32_t k) const {
        return clusters.ring[at.first_vertex + k];
    }

    /// Returns how many faces are bad at first.
    template <class Group>
    COPPICE_HOST_DEVICE std::uint32_t begin(std::uint32_t cluster, const At& at, const Group& group) const {
        const auto bad = clusters.bad[cluster];
        const auto count = static_cast<std::uint32_t>(bad.size());
        group.each(count, [&](std::uint32_t k) {
            const auto place = std::lower_bound(at.faces.begin(), at.faces.end(), bad[k]) - at.faces.begin();
            clusters.now_bad[at.first_face + k] = static_cast<std::uint32_t>(place);
            clusters.least_bad[at.first_face + k] = static_cast<std::uint32_t>(place);
        });
        group.each(static_cast<std::uint32_t>(at.vertices.size()), [&](std::uint32_t k) {
            const Vec3 p = surface.points.positions[at.vertices[k]];
            best(at, k) = clusters.first[at.first_vertex + k] = p;
        });
        group.each(1, [&](std::uint32_t) { clusters.least_count[cluster] = count; });
        return count;
    }

    /// Marks the corners of the bad faces and of so many rings around them, and lists them.
    template <class Group>
    COPPICE_HOST_DEVICE std::uint32_t find_active(const At& at, std::uint32_t bad, int rings,
                                                  const Group& group) const {
        const auto count = static_cast<std::uint32_t>(at.vertices.size());
        group.each(count, [&](std::uint32_t k) { ring(at, k) = kNone; });
        group.each(bad, [&](std::uint32_t k) {
            const std::uint32_t face = at.faces[clusters.now_bad[at.first_face + k]];
            for (const std::uint32_t v : surface.stars.quad(face)) {
                const std::uint32_t place = at.place(v);
                if (place != kNone) ring(at, place) = 0;
            }
        });
        for (int r = 1; r <= rings; ++r) {
            const auto limit = static_cast<std::uint32_t>(r);
            group.each(count, [&](std::uint32_t k) {
                if (ring(at, k) == kNone && has_corner_below(at, at.vertices[k], limit)) ring(at, k) = limit;
            });
        }
        return group.select(
            count, [&](std::uint32_t k) { return ring(at, k) != kNone; }, &clusters.active[at.first_vertex]);
    }
    /// Whether a face about a vertex has a corner in a ring below `limit`.
    COPPICE_HOST_DEVICE bool has_corner_below(const At& at, std::uint32_t vertex, std::uint32_t limit) const {
        bool has = false;
        surface.stars.for_each_corner(vertex, [&](QuadCorner c) {
            for (const std::uint32_t v : surface.stars.quad(c.quad)) {
                const std::uint32_t place = at.place(v);
                has = has || (place != kNone && ring(at, place) < limit);
            }
        });
        return has;
    }

    template <class Group>
    COPPICE_HOST_DEVICE void move(const At& at, std::uint32_t count, int steps, const Group& group) const {
        const auto place = [&](std::uint32_t k) { return clusters.active[at.first_vertex + k]; };
        group.each(count, [&](std::uint32_t k) {
            clusters.moved[at.first_vertex + place(k)] = moved(at.vertices[place(k)], steps);
        });
        group.each(count, [&](std::uint32_t k) {
            const Vec3 p = clusters.moved[at.first_vertex + place(k)];
            if (is_finite(p)) surface.points.positions[at.vertices[place(k)]] = p;
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

    /// Lists the bad faces of those that have a vertex that has moved; returns how many.
    template <class Group>
    COPPICE_HOST_DEVICE std::uint32_t find_bad(const At& at, const Group& group) const {
        const auto is_bad = [&](std::uint32_t k) {
            const Quad face = surface.stars.quad(at.faces[k]);
            bool has_moved = false;
            for (const std::uint32_t v : face) {
                const std::uint32_t place = at.place(v);
                has_moved = has_moved || (place != kNone && ring(at, place) != kNone);
            }
            return has_moved && is_bad_face(face, surface.points.positions, surface.points.anchors, limits);
        };
        return group.select(static_cast<std::uint32_t>(at.faces.size()), is_bad,
                            &clusters.now_bad[at.first_face]);
    }
};

}  // namespace coppice::cuda
