#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/nearest_triangle_internal.h"
#include "coppice/mesh/face_view.h"
#include "coppice/mesh/shape.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::measure_internal {

/// Spatial index of the faces of a mesh: a hierarchy of the boxes of runs of consecutive faces. It is built
/// much faster than a SurfaceTree if consecutive faces are adjacent, as in subdivided quads, but queries are
/// slower; otherwise each face has its own box.
class FaceRuns {
  public:
    /// The mesh must be valid and outlive the index. O(n).
    FaceRuns(const FaceView& mesh, const Context& ctx);

    /// Adds the triangles that may be the nearest one to `nearest`. O(log n) near the surface.
    void find_nearest(Vec3d p, NearestTriangle& nearest) const {
        const auto bound = [&](std::uint32_t l, std::uint32_t i) {
            return distance_squared(boxes_.level(l)[i], p);
        };
        boxes_.search(bound, nearest.limit_squared(), [&](std::uint32_t run) {
            const IndexRange faces = get_faces(run);
            for (std::size_t f = faces.begin; f < faces.end; ++f) {
                if (distance_squared(box(f), p) > nearest.limit_squared()) continue;
                visit_triangles(f, [&](Vec3d a, Vec3d b, Vec3d c) { nearest.add(a, b, c); });
            }
        });
    }

    /// Faces between two parallel planes.
    struct Run {
        IndexRange faces;
        Vec3d normal;      ///< of the planes, outward for most of the faces; 0 if the faces have no common
                           ///< direction
        double low, high;  ///< [m] positions of the planes along the normal
        double longest;    ///< [m] maximum diagonal of the faces' boxes
    };
    /// Calls visit(run) for runs of faces, including all with boxes that meet `box`, until it returns false;
    /// returns false then.
    template <class Visit>
    bool visit_runs(const Box3& box, const Visit& visit) const {
        bool goes_on = true;
        boxes_.visit_overlapping(box, [&](std::uint32_t i) {
            const Slab& s = slab_[i];
            goes_on = visit(Run{get_faces(i), Vec3d(s.normal), s.low, s.high, s.longest});
            return goes_on;
        });
        return goes_on;
    }

    /// Calls visit(a, b, c) with the corners of each triangle of a face.
    template <class Visit>
    void visit_triangles(std::size_t face, const Visit& visit) const {
        for_each_triangle(corners(face), mesh_.positions(),
                          [&](const Triangle& t) { visit(at(t[0]), at(t[1]), at(t[2])); });
    }

    /// Returns the corner vertices of a face, in order.
    std::span<const std::uint32_t> corners(std::size_t face) const {
        return mesh_.face(static_cast<std::uint32_t>(face));
    }
    Box3 box(std::size_t face) const { return compute_box(corners(face), mesh_.positions()); }  ///< of a face
    Vec3d at(std::uint32_t vertex) const { return Vec3d(mesh_.positions()[vertex]); }           ///< [m]

  private:
    struct Slab {
        Vec3 normal;
        float low, high, longest;
    };
    struct Runs;
    FaceRuns(const FaceView& mesh, Runs&& runs, const Context& ctx);

    IndexRange get_faces(std::uint32_t run) const {
        const std::size_t first = std::size_t{run_length_} * run;
        return {first, std::min<std::size_t>(first + run_length_, mesh_.size())};
    }

    FaceView mesh_;
    std::uint32_t run_length_;
    std::vector<Slab> slab_;  // per run
    BoxTree boxes_;
};

}  // namespace coppice::measure_internal
