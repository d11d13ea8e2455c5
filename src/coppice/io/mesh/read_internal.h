#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/error.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/mesh.h"

namespace coppice::io_internal {

/// See local_origin(); for positions far from zero a point near their centre. At least one position.
Vec3d choose_origin(std::span<const Vec3d> positions);
Vec3d choose_origin(Vec3d corner, Vec3d opposite);  ///< of the positions' box

/// Faces and double precision positions as a reader collects them.
class MeshBuilder {
  public:
    explicit MeshBuilder(std::string source) : source_(std::move(source)) {}

    const std::string& source() const { return source_; }
    std::size_t vertex_count() const { return vertices_.size(); }
    std::size_t face_count() const { return mesh_.face_count(); }
    void reserve_vertices(std::size_t count) { vertices_.reserve(count); }
    void reserve_faces(std::size_t count) { mesh_.first.reserve(count + 1); }

    /// False when a coordinate is not finite or beyond 1e30, where floats end.
    [[nodiscard]] bool add_vertex(Vec3d p);
    void add_face(std::span<const std::uint32_t> corners) {
        mesh_.add_face(corners);
        if (!mesh_.group_names.empty()) mesh_.group.push_back(group_);
    }
    /// Faces from here on belong to the group of this name; those before the first call to one without.
    void begin_group(const std::string& name);
    /// As `add_vertex` and `add_face`, with numbers in the message instead of lines.
    void add_numbered_vertex(Vec3d p);
    void add_numbered_face(std::span<const double> corners);

    /// Equal positions become one vertex, named by the first of them.
    void weld(const Context& ctx);

    /// Chooses the origin and rounds. Throws `InvalidInput` when there is no face.
    PolygonMesh take();
    std::vector<Vec3d> take_vertices() { return std::move(vertices_); }

  private:
    std::string source_;
    std::vector<Vec3d> vertices_;
    std::vector<std::uint32_t> corners_;
    PolygonMesh mesh_;
    std::uint32_t group_ = 0;
    std::map<std::string, std::uint32_t> group_of_name_;
};

PolygonMesh parse_obj(std::string_view text, const std::string& source, const Context& ctx);
PolygonMesh parse_ply(std::string_view bytes, const std::string& source, const Context& ctx);
PolygonMesh parse_off(std::string_view text, const std::string& source, const Context& ctx);
/// The vertices of a file without faces; `InvalidInput` for others.
std::vector<Vec3d> parse_off_points(std::string_view text, const std::string& source, const Context& ctx);
PolygonMesh parse_stl(std::string_view bytes, const std::string& source, const Context& ctx);
PolygonMesh parse_glb(std::string_view bytes, const std::string& source, const Context& ctx);

}  // namespace coppice::io_internal
