#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

// Constants of glTF 2.0, sections 3.6 and 5.11.
inline constexpr int kFloat = 5126;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kArrayBuffer = 34962;
inline constexpr int kElementArrayBuffer = 34963;

template <class T>
BasicVec3<T> y_up(BasicVec3<T> v) {
    return {v.x, v.z, -v.y};
}

inline nlohmann::json to_json_array(Vec3d v) { return nlohmann::json::array({v.x, v.y, v.z}); }

/// Lays out consecutive buffer views of the single buffer, with their accessors.
class GlbLayout {
  public:
    /// Adds a view of this many bytes, and its accessor; returns the index of the accessor. `target` 0: none.
    std::size_t add(std::uint64_t bytes, int target, int component, std::uint64_t count, const char* type);
    /// The same for vectors.
    std::size_t add_vectors(std::uint64_t count);
    /// The same for positions or displacements, with their bounds.
    std::size_t add_vectors(std::span<const Vec3> bounded);
    /// Adds a view without an accessor, padded to a multiple of four bytes; returns its index.
    std::size_t add_bytes(std::uint64_t bytes);

    nlohmann::json& operator[](std::size_t accessor) { return accessors_[accessor]; }
    std::uint64_t bytes() const { return bytes_; }
    nlohmann::json& views() { return views_; }
    nlohmann::json& accessors() { return accessors_; }

  private:
    nlohmann::json views_ = nlohmann::json::array(), accessors_ = nlohmann::json::array();
    std::uint64_t bytes_ = 0;
};

/// Returns the description of a file with one mesh and the plain brown material of surfaces without images.
/// `primitives`: attributes, indices, materials and others of the primitives of the mesh. To be called when
/// all views are laid out.
nlohmann::json describe_tree(const MeshView& mesh, nlohmann::json primitives, GlbLayout& layout);

/// Writes everything that precedes the bytes of the buffer. Throws Unsupported if the file would be too
/// large.
void write_glb_head(AtomicFile& file, std::string json, std::uint64_t buffer_bytes);

/// The vertices of a GLB file.
struct GlbVertices {
    const MeshView& given;
    std::optional<SplitMesh>& split;       ///< of meshes with texture coordinates
    const std::vector<Vec3>& normals;      ///< one for every vertex of the file
    const std::vector<Tangent>& tangents;  ///< the same; empty without a normal map
    std::size_t count() const { return normals.size(); }
};

/// Contents of a GLB file in addition to those of a surface: its motion, or copies of prototypes.
class GlbMotionPart {
  public:
    virtual ~GlbMotionPart() = default;
    /// Lays out all views, and adds morph targets to the common part of the primitives.
    virtual void lay_out(const GlbVertices& vertices, nlohmann::json& primitive, GlbLayout& layout) = 0;
    /// Adds the animation to the description of the file.
    virtual void describe(nlohmann::json& file) const = 0;
    /// Writes the bytes of the views. May move the vertices of the split mesh.
    virtual void write(AtomicFile& file, const GlbVertices& vertices, const Context& ctx) = 0;
};

/// Writes a surface, with its motion unless `motion` is null.
void write_glb(AtomicFile& file, const MeshView& mesh, GlbMotionPart* motion, const Context& ctx);

/// Creates the mesh with one vertex for every place of the texture, divided for tangents if requested; none
/// without a texture.
void split_mesh(const MeshView& given, bool for_tangents, std::optional<SplitMesh>& out, const Context& ctx);

void write_vectors(AtomicFile& file, std::span<const Vec3> vectors, ProgressRange part, const Context& ctx);
/// Writes all faces as triangles.
void write_triangles(AtomicFile& file, const MeshView& mesh, ProgressRange part, const Context& ctx);
/// Writes some of the faces as triangles.
void write_triangles(AtomicFile& file, const MeshView& mesh, std::span<const std::uint32_t> faces,
                     ProgressRange part, const Context& ctx);

}  // namespace coppice::io_internal
