// PLY, OFF and STL.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "coppice/io/mesh/read_internal.h"
#include "coppice/io/ply_header.h"
#include "coppice/io/text_internal.h"

namespace coppice::io_internal {
namespace {

class PlyMeshParser {
  public:
    PlyMeshParser(std::string_view bytes, const std::string& source)
        : header_(parse_ply_header(bytes, source)), rows_(bytes, header_, source), mesh_(source) {}

    PolygonMesh parse() {
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
        return mesh_.take();
    }

  private:
    void read_vertices(const PlyElement& element) {
        const auto x = element.find({"x"});
        const auto y = element.find({"y"});
        const auto z = element.find({"z"});
        if (!x || !y || !z) {
            throw InvalidInput(fmt::format("{}: the vertices lack a property x, y or z", mesh_.source()));
        }
        mesh_.reserve_vertices(element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            rows_.read(row_);
            mesh_.add_numbered_vertex({scalar(element, *x), scalar(element, *y), scalar(element, *z)});
        }
    }

    void read_faces(const PlyElement& element) {
        const auto corners = element.find({"vertex_indices", "vertex_index"});
        if (!corners || !element.properties[*corners].is_list()) {
            throw InvalidInput(fmt::format("{}: the faces lack a list vertex_indices", mesh_.source()));
        }
        if (mesh_.vertex_count() == 0 && element.count > 0) {
            throw InvalidInput(fmt::format("{}: no vertices stand before the faces", mesh_.source()));
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
    MeshBuilder mesh_;
};

class OffParser {
  public:
    OffParser(std::string_view text, const std::string& source) : lines_(text), mesh_(source) {}

    PolygonMesh parse() {
        parse_head();
        const std::size_t vertices = count(0, "vertices");
        const std::size_t faces = count(1, "faces");
        // The shortest vertex is "0 0 0" and a line end, the shortest face "3 0 0 0".
        mesh_.reserve_vertices(std::min(vertices, lines_.remaining() / 6 + 1));
        mesh_.reserve_faces(std::min(faces, lines_.remaining() / 8 + 1));
        for (std::size_t i = 0; i < vertices; ++i) parse_vertex(i, vertices);
        for (std::size_t i = 0; i < faces; ++i) parse_face(i, faces);
        return mesh_.take();
    }

  private:
    /// Leaves the line with the counts in `words_`. The keyword may be missing, or share the line of the
    /// counts. What it announces (colours, normals, texture) follows the coordinates and is passed over.
    void parse_head() {
        if (!next_line()) fail("it holds no OFF data");
        std::string_view keyword = words_[0];
        if (!keyword.ends_with("OFF")) return;
        keyword.remove_suffix(3);
        if (keyword.find_first_of("4n") != keyword.npos) unsupported("OFF in other than three dimensions");
        words_.erase(words_.begin());
        if (!words_.empty() && words_[0] == "BINARY") unsupported("binary OFF");
        if (words_.empty() && !next_line()) fail("the numbers of vertices and faces are missing");
    }

    std::size_t count(std::size_t place, std::string_view what) const {
        const auto number = place < words_.size() ? parse_integer(words_[place]) : std::nullopt;
        if (!number || *number < 0 || *number > 0xfffffffe)
            fail(fmt::format("expected the number of {}", what));
        return static_cast<std::size_t>(*number);
    }

    void parse_vertex(std::size_t i, std::size_t count) {
        if (!next_line()) fail(fmt::format("the file ends after {} of {} vertices; it is cut", i, count));
        if (words_.size() < 3) fail("a vertex needs three coordinates");
        if (!mesh_.add_vertex({number(0), number(1), number(2)}))
            fail("a coordinate is not finite or beyond 1e30");
    }

    void parse_face(std::size_t i, std::size_t count) {
        if (!next_line()) fail(fmt::format("the file ends after {} of {} faces; it is cut", i, count));
        const auto size = parse_integer(words_[0]);
        if (!size || *size < 3) fail("a face starts with the number of its corners, at least 3");
        if (static_cast<std::uint64_t>(*size) >= words_.size())
            fail(fmt::format("the face has fewer than {} corners", *size));
        corners_.clear();
        for (std::size_t k = 1; k <= static_cast<std::size_t>(*size); ++k) {
            const auto v = parse_integer(words_[k]);
            if (!v || *v < 0 || static_cast<std::uint64_t>(*v) >= mesh_.vertex_count()) {
                fail(fmt::format("face {} refers to vertex {}, but the vertices are 0 to {}", i,
                                 in_quotes(words_[k]), static_cast<std::int64_t>(mesh_.vertex_count()) - 1));
            }
            corners_.push_back(static_cast<std::uint32_t>(*v));
        }
        mesh_.add_face(corners_);
    }

    double number(std::size_t place) const {
        const auto value = parse_number(words_[place]);
        if (!value) fail(fmt::format("{} is not a number", in_quotes(words_[place])));
        return *value;
    }

    bool next_line() {
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            split_at_blanks(line.substr(0, line.find('#')), words_);
            if (!words_.empty()) return true;
        }
        return false;
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(mesh_.source(), lines_.number(), text); }
    [[noreturn]] void unsupported(std::string_view what) const {
        throw Unsupported(
            fmt::format("{}: {} is not read; save it as text OFF, PLY or OBJ", mesh_.source(), what));
    }

    LineReader lines_;
    MeshBuilder mesh_;
    std::vector<std::string_view> words_;
    std::vector<std::uint32_t> corners_;
};

constexpr std::size_t kStlHead = 84;
constexpr std::size_t kStlFacet = 50;

void add_triangle(MeshBuilder& mesh) {
    const auto end = static_cast<std::uint32_t>(mesh.vertex_count());
    mesh.add_face(std::array{end - 3, end - 2, end - 1});
}

PolygonMesh parse_binary_stl(std::string_view bytes, const std::string& source) {
    std::uint32_t count = 0;
    if (bytes.size() >= kStlHead) std::memcpy(&count, bytes.data() + 80, sizeof count);
    if (bytes.size() < kStlHead || (bytes.size() - kStlHead) / kStlFacet < count) {
        throw InvalidInput(fmt::format(
            "{}: the head claims {} triangles, for which the file is too short; it is cut", source, count));
    }
    MeshBuilder mesh(source);
    mesh.reserve_vertices(std::size_t{3} * count);
    mesh.reserve_faces(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::array<Vec3, 3> corner;
        std::memcpy(&corner, bytes.data() + kStlHead + kStlFacet * i + sizeof(Vec3), sizeof corner);
        for (const Vec3 p : corner) mesh.add_numbered_vertex(Vec3d(p));
        add_triangle(mesh);
    }
    mesh.weld();
    return mesh.take();
}

PolygonMesh parse_ascii_stl(std::string_view text, const std::string& source) {
    MeshBuilder mesh(source);
    LineReader lines(text);
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
    if (!ended || corners != 0) fail("the file ends before 'endsolid'; it is cut");
    mesh.weld();
    return mesh.take();
}

/// Many binary files start with "solid" too, but none of them goes on with "facet".
bool is_ascii_stl(std::string_view bytes) {
    const std::string_view start = trimmed(bytes.substr(0, 1024));
    return start.starts_with("solid") &&
           (start.find("facet") != start.npos || start.find("endsolid") != start.npos);
}

}  // namespace

PolygonMesh parse_ply(std::string_view bytes, const std::string& source) {
    return PlyMeshParser(bytes, source).parse();
}

PolygonMesh parse_off(std::string_view text, const std::string& source) {
    return OffParser(text, source).parse();
}

PolygonMesh parse_stl(std::string_view bytes, const std::string& source) {
    return is_ascii_stl(bytes) ? parse_ascii_stl(bytes, source) : parse_binary_stl(bytes, source);
}

}  // namespace coppice::io_internal
