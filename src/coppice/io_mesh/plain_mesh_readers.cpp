// PLY and STL.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "coppice/io/ply_header.h"
#include "coppice/io/text.h"
#include "coppice/io_mesh/read_internal.h"

namespace coppice::io_internal {
namespace {

class PlyMeshParser {
  public:
    PlyMeshParser(std::string_view bytes, const std::string& source, std::span<const std::string> attributes,
                  const Context& ctx)
        : header_(parse_ply_header(bytes, source)),
          rows_(bytes, header_, source, ctx),
          ctx_(ctx),
          mesh_(source, attributes) {}

    MeshFile parse() {
        for (const PlyElement& element : header_.elements) {
            rows_.begin_element(element);
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else if (element.name == "tristrips" && element.count > 0) {
                throw Unsupported(fmt::format("{}: triangle strips are not read; save the mesh with faces",
                                              mesh_.source()));
            } else {
                rows_.skip_element();
            }
        }
        if (!texture_.empty() && mesh_.face_count() > 0)
            mesh_.set_vertex_texture(std::move(texture_), std::move(blends_), ctx_);
        return mesh_.take_file();
    }

  private:
    void read_vertices(const PlyElement& element) {
        const auto x = element.find({"x"});
        const auto y = element.find({"y"});
        const auto z = element.find({"z"});
        if (!x || !y || !z) {
            throw InvalidInput(fmt::format("{}: the vertices lack a property x, y or z", mesh_.source()));
        }
        const auto s = element.find({"s", "u", "texture_u"});
        const auto t = element.find({"t", "v", "texture_v"});
        const auto s1 = element.find({"s1"});
        const auto t1 = element.find({"t1"});
        const auto blend = element.find({"blend"});
        const bool has_blends = s && t && s1 && t1 && blend;
        std::vector<std::optional<std::size_t>> attributes;
        for (const VertexAttribute& a : mesh_.attributes()) {
            const auto found = element.find({std::string_view(a.name)});
            attributes.push_back(found && element.properties[*found].is_list() ? std::nullopt : found);
        }
        mesh_.reserve_vertices(element.count);
        if (has_blends) blends_.resize(mesh_.vertex_count(), TextureBlend{});
        if (s && t) texture_.resize(mesh_.vertex_count(), TexturePoint{});  // of other elements
        for (std::uint64_t i = 0; i < element.count; ++i) {
            rows_.read(row_);
            mesh_.add_numbered_vertex({scalar(element, *x), scalar(element, *y), scalar(element, *z)});
            for (std::size_t k = 0; k < attributes.size(); ++k) {
                if (attributes[k])
                    mesh_.set_attribute(k, mesh_.vertex_count() - 1, row_.scalar(*attributes[k]));
            }
            if (!s || !t) continue;
            texture_.push_back(mesh_.numbered_texture_point(mesh_.vertex_count() - 1, scalar(element, *s),
                                                            scalar(element, *t)));
            if (!has_blends) continue;
            blends_.push_back(mesh_.numbered_blend(mesh_.vertex_count() - 1, scalar(element, *s1),
                                                   scalar(element, *t1), scalar(element, *blend)));
        }
    }

    void read_faces(const PlyElement& element) {
        const auto corners = element.find({"vertex_indices", "vertex_index"});
        if (!corners || !element.properties[*corners].is_list()) {
            throw InvalidInput(fmt::format("{}: the faces lack a list vertex_indices", mesh_.source()));
        }
        if (mesh_.vertex_count() == 0 && element.count > 0) {
            throw InvalidInput(fmt::format("{}: the faces are not preceded by vertices", mesh_.source()));
        }
        mesh_.reserve_faces(element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            rows_.read(row_);
            mesh_.add_numbered_face(row_.list(*corners));
        }
    }

    double scalar(const PlyElement& element, std::size_t property) const {
        if (element.properties[property].is_list()) {
            throw InvalidInput(fmt::format("{}: the coordinates of the vertices are lists", mesh_.source()));
        }
        return row_.scalar(property);
    }

    PlyHeader header_;
    PlyRows rows_;
    PlyRow row_;
    const Context& ctx_;
    MeshBuilder mesh_;
    Buffer<TexturePoint> texture_;  ///< per vertex
    Buffer<TextureBlend> blends_;   ///< per vertex
};

constexpr std::size_t kStlHead = 84;
constexpr std::size_t kStlFacet = 50;

void add_triangle(MeshBuilder& mesh) {
    const auto end = static_cast<std::uint32_t>(mesh.vertex_count());
    mesh.add_face(std::array{end - 3, end - 2, end - 1});
}

PolygonMesh parse_binary_stl(std::string_view bytes, const std::string& source, const Context& ctx) {
    std::uint32_t count = 0;
    if (bytes.size() >= kStlHead) std::memcpy(&count, bytes.data() + 80, sizeof count);
    if (bytes.size() < kStlHead || (bytes.size() - kStlHead) / kStlFacet < count) {
        throw InvalidInput(fmt::format(
            "{}: the header specifies {} triangles, but the file is too short for them; it is truncated",
            source, count));
    }
    MeshBuilder mesh(source);
    mesh.reserve_vertices(std::size_t{3} * count);
    mesh.reserve_faces(count);
    FileProgress progress(ctx, count);
    for (std::size_t i = 0; i < count; ++i) {
        progress.at(i);
        std::array<Vec3, 3> corner;
        std::memcpy(&corner, bytes.data() + kStlHead + kStlFacet * i + sizeof(Vec3), sizeof corner);
        for (const Vec3 p : corner) mesh.add_numbered_vertex(Vec3d(p));
        add_triangle(mesh);
    }
    mesh.weld(ctx);
    return mesh.take();
}

PolygonMesh parse_ascii_stl(std::string_view text, const std::string& source, const Context& ctx) {
    MeshBuilder mesh(source);
    LineReader lines(text, ctx);
    std::vector<std::string_view> words;
    int corners = 0;
    bool ended = true;
    const auto fail = [&](const std::string& message) { fail_at(source, lines.number(), message); };
    while (lines.next()) {
        split_at_blanks(lines.line(), words);
        if (words.empty()) continue;
        if (words[0] == "vertex") {
            Vec3d p;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto value = k + 1 < words.size() ? parse_number(words[k + 1]) : std::nullopt;
                if (!value) fail("a vertex needs three coordinates");
                p[static_cast<int>(k)] = *value;
            }
            if (!mesh.add_vertex(p)) fail("a coordinate is not finite or beyond 1e30");
            ++corners;
        } else if (words[0] == "endloop") {
            if (corners != 3) fail(fmt::format("a triangle has {} corners", corners));
            add_triangle(mesh);
            corners = 0;
        } else if (words[0] == "solid" || words[0] == "endsolid") {
            ended = words[0] == "endsolid";
        }
    }
    if (!ended || corners != 0) fail("the file ends before 'endsolid'; it is truncated");
    mesh.weld(ctx);
    return mesh.take();
}

/// Returns whether the file is text. Many binary files start with "solid" too, but "facet" does not follow.
bool is_ascii_stl(std::string_view bytes) {
    const std::string_view start = trimmed(bytes.substr(0, 1024));
    return start.starts_with("solid") &&
           (start.find("facet") != start.npos || start.find("endsolid") != start.npos);
}

}  // namespace

MeshFile parse_ply(std::string_view bytes, const std::string& source, std::span<const std::string> attributes,
                   const Context& ctx) {
    return PlyMeshParser(bytes, source, attributes, ctx).parse();
}

PolygonMesh parse_stl(std::string_view bytes, const std::string& source, const Context& ctx) {
    return is_ascii_stl(bytes) ? parse_ascii_stl(bytes, source, ctx) : parse_binary_stl(bytes, source, ctx);
}

}  // namespace coppice::io_internal
