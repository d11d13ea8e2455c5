#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/box.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns the bounding box of a face.
inline Box3 compute_box(std::span<const std::uint32_t> face, std::span<const Vec3> positions) {
    Box3 box;
    for (const std::uint32_t v : face) box.extend(positions[v]);
    return box;
}

/// View of the faces of a mesh of any type, which must outlive the view. Cheap to copy.
class FaceView {
  public:
    /// Creates a view of quads.
    FaceView(const QuadMesh& mesh)  // NOLINT(google-explicit-constructor): it is the mesh, as a view
        : quads_(mesh.quads.data()),
          positions_(mesh.positions),
          size_(static_cast<std::uint32_t>(mesh.quads.size())) {}
    /// Creates a view of polygons.
    FaceView(const PolygonMesh& mesh)  // NOLINT(google-explicit-constructor): it is the mesh, as a view
        : corners_(mesh.corners.data()),
          first_(mesh.first.data()),
          positions_(mesh.positions),
          size_(mesh.face_count()) {}

    std::uint32_t size() const { return size_; }                    ///< number of faces
    std::span<const Vec3> positions() const { return positions_; }  ///< [m] vertex positions
    /// Returns the corner vertices of face f, in order.
    std::span<const std::uint32_t> face(std::uint32_t f) const {
        if (quads_ != nullptr) return quads_[f];
        return {corners_ + first_[f], first_[f + 1] - first_[f]};
    }
    /// Returns the bounding box of face f.
    Box3 box(std::uint32_t f) const { return compute_box(face(f), positions_); }
    /// Returns a view of the first `count` faces.
    FaceView first(std::uint32_t count) const {
        FaceView view = *this;
        view.size_ = count;
        return view;
    }

  private:
    const Quad* quads_ = nullptr;             // for a mesh of quads
    const std::uint32_t* corners_ = nullptr;  // for other meshes
    const std::uint32_t* first_ = nullptr;    // per face, in corners_
    std::span<const Vec3> positions_;
    std::uint32_t size_;
};

/// Returns a mesh of the given faces in this order and of the vertices that they use, in the order of the
/// mesh. O(given faces), plus a bit per vertex of the mesh.
PolygonMesh some_faces(const FaceView& mesh, std::span<const std::uint32_t> faces);

}  // namespace coppice
