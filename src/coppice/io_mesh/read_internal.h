#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/error.h"
#include "coppice/base/vec.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"

namespace coppice::io_internal {

/// Collects the faces and double-precision positions of a reader.
class MeshBuilder {
  public:
    explicit MeshBuilder(std::string source, std::span<const std::string> attributes = {})
        : source_(std::move(source)) {
        for (const std::string& name : attributes) attributes_.push_back({name, {}});
    }

    const std::string& source() const { return source_; }
    std::size_t vertex_count() const { return vertices_.size(); }
    std::size_t face_count() const { return mesh_.face_count(); }
    void reserve_vertices(std::size_t count) { vertices_.reserve(count); }
    void reserve_faces(std::size_t count) { mesh_.first.reserve(count + 1); }

    /// Returns false if a coordinate is not finite or exceeds 1e30, near the limit of float.
    [[nodiscard]] bool add_vertex(Vec3d p);
    void add_face(std::span<const std::uint32_t> corners) {
        mesh_.add_face(corners);
        if (!mesh_.group_names.empty()) mesh_.group.push_back(group_);
    }
    /// Assigns the following faces to the group of this name; faces before the first call belong to a group
    /// without a name.
    void begin_group(const std::string& name);
    /// Like `add_vertex` and `add_face`, but errors name element numbers instead of lines.
    void add_numbered_vertex(Vec3d p);
    void add_numbered_face(std::span<const double> corners);

    /// Merges vertices with equal positions into the first of them.
    void weld(const Context& ctx);

    /// Rounds texture coordinates to float. Returns nullopt if one is not finite or exceeds 1e30.
    static std::optional<TexturePoint> texture_point(double u, double v);
    /// Like `texture_point`, but errors name the number of the vertex.
    TexturePoint numbered_texture_point(std::size_t vertex, double u, double v) const;
    /// Takes one texture coordinate per corner of the faces.
    void set_texture(Buffer<TexturePoint> of_corners);
    /// Like `numbered_texture_point`, for a second set and its weight, which is limited to [0, 1].
    TextureBlend numbered_blend(std::size_t vertex, double u, double v, double weight) const;
    /// Takes the texture coordinates of the vertices, (0, 0) for those beyond the end, and a second set,
    /// which may be empty and has weight 0 beyond the end; then welds the vertices, which files repeat along
    /// seams.
    void set_vertex_texture(Buffer<TexturePoint> of_vertices, Buffer<TextureBlend> blends,
                            const Context& ctx);

    /// The requested attributes of vertices.
    std::span<const VertexAttribute> attributes() const { return attributes_; }
    /// Sets the value of an attribute of a vertex; to be called in the order of the vertices.
    void set_attribute(std::size_t attribute, std::size_t vertex, double value);

    /// Chooses the origin, rounds the positions to float and returns the mesh. Throws `InvalidInput` if there
    /// is no face.
    PolygonMesh take();
    /// The same with the attributes that have values.
    MeshFile take_file();
    std::vector<Vec3d> take_vertices() { return std::move(vertices_); }

  private:
    /// Removes attributes without values, and gives the others one for every vertex.
    void fill_attributes();
    /// Returns the values of the corners; default ones for vertices beyond the end.
    template <class T>
    Buffer<T> spread_to_corners(Buffer<T> of_vertices) const {
        of_vertices.resize(vertices_.size(), T{});
        Buffer<T> out;
        out.reserve(mesh_.corners.size());
        for (const std::uint32_t v : mesh_.corners) out.push_back(of_vertices[v]);
        return out;
    }

    std::string source_;
    std::vector<Vec3d> vertices_;
    std::vector<VertexAttribute> attributes_;  ///< without values beyond the last vertex that has some
    std::vector<std::uint32_t> corners_;
    PolygonMesh mesh_;
    std::uint32_t group_ = 0;
    std::map<std::string, std::uint32_t> group_of_name_;
};

PolygonMesh parse_obj(std::string_view text, const std::string& source, const Context& ctx);
MeshFile parse_ply(std::string_view bytes, const std::string& source, std::span<const std::string> attributes,
                   const Context& ctx);
PolygonMesh parse_off(std::string_view text, const std::string& source, const Context& ctx);
PolygonMesh parse_stl(std::string_view bytes, const std::string& source, const Context& ctx);
MeshFile parse_glb(std::string_view bytes, const std::string& source, std::span<const std::string> attributes,
                   const Context& ctx);

}  // namespace coppice::io_internal
