#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/face_view.h"

namespace coppice::pipeline_internal {

/// [m] Point in the plane of a chart.
struct PlanePoint {
    float x = 0;  ///< to the right
    float y = 0;  ///< up
};

/// Faces that are mapped together onto a part of an atlas.
using Chart = std::vector<std::uint32_t>;

/// Faces of a surface with the numbers of their corners. The surface must outlive it.
class AtlasFaces {
  public:
    explicit AtlasFaces(const FaceView& mesh) : mesh_(mesh), first_(mesh.size() + 1, 0) {
        for (std::uint32_t f = 0; f < mesh.size(); ++f)
            first_[f + 1] = first_[f] + static_cast<std::uint32_t>(mesh.face(f).size());
    }

    std::uint32_t size() const { return mesh_.size(); }           ///< number of faces
    std::uint32_t corner_count() const { return first_.back(); }  ///< number of corners of all faces
    std::uint32_t vertex_count() const {                          ///< number of vertices
        return static_cast<std::uint32_t>(mesh_.positions().size());
    }
    /// Returns the vertices of a face.
    std::span<const std::uint32_t> vertices(std::uint32_t face) const { return mesh_.face(face); }
    /// Returns the corners of a face.
    IndexRange corners(std::uint32_t face) const { return {first_[face], first_[face + 1]}; }
    /// Returns the position of corner k of a face.
    Vec3 position(std::uint32_t face, std::size_t k) const { return mesh_.positions()[mesh_.face(face)[k]]; }
    /// Returns the elements that belong to the corners of a face, of one element per corner.
    template <class T>
    std::span<T> values(std::span<T> per_corner, std::uint32_t face) const {
        return per_corner.subspan(first_[face], corners(face).size());
    }

  private:
    FaceView mesh_;
    std::vector<std::uint32_t> first_;  // corner of each face
};

/// Divides a chart into sets of faces that share corners with the same points, in the order of their first
/// faces. `points`: per corner of all faces. O(n log n).
template <class Point>
std::vector<Chart> find_connected_parts(const AtlasFaces& faces, const Chart& chart,
                                        std::span<const Point> points) {
    struct Corner {
        std::uint32_t vertex, index;  // of the face in the chart
        Point point;
        auto key() const { return std::tie(vertex, point.x, point.y); }
    };
    std::vector<Corner> corners;
    for (std::uint32_t i = 0; i < chart.size(); ++i) {
        for (std::size_t k = 0; k < faces.vertices(chart[i]).size(); ++k)
            corners.push_back({faces.vertices(chart[i])[k], i, faces.values(points, chart[i])[k]});
    }
    std::ranges::sort(corners, [](const Corner& a, const Corner& b) { return a.key() < b.key(); });
    DisjointSets sets(chart.size());
    for (std::size_t i = 1; i < corners.size(); ++i) {
        if (corners[i].key() == corners[i - 1].key()) sets.join(corners[i].index, corners[i - 1].index);
    }
    std::vector<Chart> parts(chart.size());  // by the first face
    for (std::uint32_t i = 0; i < chart.size(); ++i) parts[sets.find(i)].push_back(chart[i]);
    std::erase_if(parts, [](const Chart& part) { return part.empty(); });
    return parts;
}

/// Returns the normal of a face with the length of twice its area.
Vec3 doubled_area_normal(const AtlasFaces& faces, std::uint32_t face);

}  // namespace coppice::pipeline_internal
