#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/render/material.h"
#include "coppice/render/trace/embree_internal.h"
#include "coppice/render/trace/textured_internal.h"

namespace coppice {

/// A position on a face of a traced mesh.
struct FacePlace {
    std::uint32_t face = 0;  ///< of `quads()`
    float u = 0, v = 0;      ///< corners 0..3 are at (0,0), (1,0), (1,1), (0,1)
};

/// Weights of three corners at a hit, which sum to 1. Bilinear faces are two triangles with the diagonal from
/// corner 1 to corner 3.
struct CornerWeights {
    std::array<std::size_t, 3> corner;
    std::array<std::uint32_t, 3> vertex;
    std::array<float, 3> weight;
};

/// A mesh for rays with its normals and texture coordinates. Embree refers to it, so it must not be moved
/// once a geometry is created.
class TracedMesh {
  public:
    /// Takes the faces of the mesh with the given positions of the vertices.
    void set_faces(const PolygonMesh& mesh, std::vector<Vec3> positions);
    /// Takes the texture coordinates. Face f has material face_materials[f]; without any, the first one. The
    /// materials must outlive this object.
    void set_texture(const PolygonMesh& mesh, std::span<const std::uint32_t> face_materials,
                     std::span<const RenderMaterial> materials);
    /// Computes the mean of the normals of the adjacent faces for each vertex, weighted by area.
    void smooth_normals();
    /// Creates an Embree geometry of faces with these vertices. Cut-outs are applied if they are `quads()`.
    EmbreeGeometry make_geometry(RTCDevice device, std::span<const Quad> faces, const Context& ctx) const;

    bool empty() const { return quads_.empty(); }
    bool has_normals() const { return !normals_.empty(); }
    const std::vector<Vec3>& positions() const { return positions_; }
    const std::vector<Quad>& quads() const { return quads_; }  ///< triangles repeat their last corner
    /// Returns the range of `quads()` that face f of the given mesh became: larger faces are fans.
    std::span<const Quad> quads_of(std::uint32_t f) const {
        return {quads_.data() + first_quad_[f], quads_.data() + first_quad_[f + 1]};
    }
    bool has_edge(std::uint32_t face, int k) const { return (edges_[face] >> k & 1) != 0; }

    template <class T>
    T blend(const FacePlace& place, std::span<const T> of) const {
        const auto [corner, vertex, weight] = weights_at(place);
        return of[vertex[0]] * weight[0] + of[vertex[1]] * weight[1] + of[vertex[2]] * weight[2];
    }
    Vec3 normal(const FacePlace& place) const { return blend(place, std::span<const Vec3>(normals_)); }
    /// Returns the weighted mean of the projections of `position` onto the tangent planes of the corners, for
    /// planes above the face [Hanika2021]. `side` is -1 if the mesh is seen from inside.
    Vec3 lifted(const FacePlace& place, Vec3 position, float side) const;
    /// Returns the texture coordinates and the material; nullopt without texture.
    std::optional<TexturePlaces> texture_places(const FacePlace& place) const;
    /// Returns whether the material is cut out at the place.
    bool is_hole(const FacePlace& place) const;

  private:
    CornerWeights weights_at(const FacePlace& place) const;
    TexturePlace texture_place(const FacePlace& place, const std::array<TexturePoint, 4>& corners) const;
    std::uint32_t material(std::uint32_t face) const {
        return quad_materials_.empty() ? 0 : quad_materials_[face];
    }

    std::vector<Vec3> positions_;
    std::vector<Vec3> normals_;  ///< per vertex; empty for flat faces
    std::vector<Quad> quads_;
    std::vector<std::uint32_t> first_quad_;
    std::vector<std::uint8_t> edges_;  ///< bit k: whether corner k to k + 1 is an edge of the face
    std::vector<std::array<TexturePoint, 4>>
        texture_;  ///< of the corners of `quads_`; empty without material
    std::vector<std::array<TextureBlend, 4>>
        texture_blends_;                         ///< of the corners of `quads_`; empty without a second set
    std::vector<std::uint32_t> quad_materials_;  ///< of `quads_`; empty if all have the first material
    std::span<const RenderMaterial> materials_;
};

}  // namespace coppice
