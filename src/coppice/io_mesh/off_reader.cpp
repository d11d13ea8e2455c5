#include <fmt/format.h>

#include <algorithm>

#include "coppice/io/text.h"
#include "coppice/io_mesh/read_internal.h"

namespace coppice {
namespace io_internal {
namespace {

class OffParser {
  public:
    OffParser(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), mesh_(source) {}

    PolygonMesh parse_mesh() {
        const std::size_t faces = parse_vertices();
        // The shortest face is "3 0 0 0" and a line end.
        mesh_.reserve_faces(std::min(faces, lines_.remaining() / 8 + 1));
        for (std::size_t i = 0; i < faces; ++i) parse_face(i, faces);
        return mesh_.take();
    }

    std::vector<Vec3d> parse_points() {
        if (parse_vertices() > 0)
            throw InvalidInput(fmt::format("{}: it has faces, so it is a mesh, not points", mesh_.source()));
        return mesh_.take_vertices();
    }

  private:
    /// Returns the number of faces.
    std::size_t parse_vertices() {
        parse_head();
        const std::size_t vertices = count(0, "vertices");
        const std::size_t faces = count(1, "faces");
        // The shortest vertex is "0 0 0" and a line end.
        mesh_.reserve_vertices(std::min(vertices, lines_.remaining() / 6 + 1));
        for (std::size_t i = 0; i < vertices; ++i) parse_vertex(i, vertices);
        return faces;
    }

    /// Stores the line with the counts in `words_`. The keyword may be missing or on the line of the counts.
    /// Data that it announces (colours, normals, texture) follow the coordinates and are skipped.
    void parse_head() {
        if (!next_line()) fail("it contains no OFF data");
        std::string_view keyword = words_[0];
        if (!keyword.ends_with("OFF")) return;
        keyword.remove_suffix(3);
        if (keyword.find_first_of("4n") != keyword.npos) unsupported("OFF in other than three dimensions");
        words_.erase(words_.begin());
        if (!words_.empty() && words_[0] == "BINARY") unsupported("binary OFF");
        if (words_.empty() && !next_line()) fail("the numbers of vertices and faces are missing");
    }

    std::size_t count(std::size_t place, std::string_view subject) const {
        const auto number = place < words_.size() ? parse_integer(words_[place]) : std::nullopt;
        if (!number || *number < 0 || *number > 0xfffffffe)
            fail(fmt::format("expected the number of {}", subject));
        return static_cast<std::size_t>(*number);
    }

    void parse_vertex(std::size_t i, std::size_t count) {
        if (!next_line())
            fail(fmt::format("the file ends after {} of {} vertices; it is truncated", i, count));
        if (words_.size() < 3) fail("a vertex needs three coordinates");
        if (!mesh_.add_vertex({number(0), number(1), number(2)}))
            fail("a coordinate is not finite or beyond 1e30");
    }

    void parse_face(std::size_t i, std::size_t count) {
        if (!next_line()) fail(fmt::format("the file ends after {} of {} faces; it is truncated", i, count));
        const auto size = parse_integer(words_[0]);
        if (!size || *size < 3) fail("a face must begin with its number of corners, at least 3");
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
    [[noreturn]] void unsupported(std::string_view subject) const {
        throw Unsupported(
            fmt::format("{}: {} is not read; save it as text OFF, PLY or OBJ", mesh_.source(), subject));
    }

    LineReader lines_;
    MeshBuilder mesh_;
    std::vector<std::string_view> words_;
    std::vector<std::uint32_t> corners_;
};

}  // namespace

PolygonMesh parse_off(std::string_view text, const std::string& source, const Context& ctx) {
    return OffParser(text, source, ctx).parse_mesh();
}

}  // namespace io_internal

std::vector<Vec3d> parse_off_points(std::string_view text, const std::string& source, const Context& ctx) {
    return io_internal::OffParser(text, source, ctx).parse_points();
}

}  // namespace coppice
