#include <fmt/format.h>

#include "coppice/base/id.h"
#include "coppice/io/text.h"
#include "coppice/io_mesh/read_internal.h"

namespace coppice::io_internal {
namespace {

/// Removes the next word from a line and returns it; empty at the end.
std::string_view next_word(std::string_view& line) {
    std::size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin])) ++begin;
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) ++end;
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

class ObjParser {
  public:
    ObjParser(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), mesh_(source) {}

    PolygonMesh parse() {
        while (lines_.next()) {
            std::string_view line = lines_.line();
            if (line.ends_with('\\')) line = joined();
            parse_line(line);
        }
        if (mesh_.face_count() > 0 && max_vertex_.index >= mesh_.vertex_count()) {
            fail_at(mesh_.source(), max_vertex_.line, refers_to(max_vertex_.index + 1));
        }
        if (mesh_.face_count() == 0 && mesh_.vertex_count() == 0) {
            throw InvalidInput(
                fmt::format("{}: no mesh was found; OBJ, PLY, OFF, STL and GLB are read", mesh_.source()));
        }
        set_texture();
        return mesh_.take();
    }

  private:
    /// An index in the file, and its line.
    struct Reference {
        std::uint64_t index = 0;
        std::uint32_t line = 0;

        void extend(std::uint64_t to, std::uint32_t at) {
            if (to >= index) *this = {to, at};
        }
    };

    /// Without any texture coordinates in the file, the references of its faces to them are ignored.
    void set_texture() {
        if (texture_.empty() || texture_of_corner_.empty()) return;
        if (max_texture_.index >= texture_.size()) {
            fail_at(mesh_.source(), max_texture_.line, refers_to_texture(max_texture_.index + 1));
        }
        Buffer<TexturePoint> of_corners;
        of_corners.reserve(texture_of_corner_.size());
        for (const std::uint32_t t : texture_of_corner_)
            of_corners.push_back(t == kNoIndex ? TexturePoint{} : texture_[t]);
        of_corners.resize(corner_count_, TexturePoint{});
        mesh_.set_texture(std::move(of_corners));
    }

    /// Joins a line that ends in a backslash with the next one.
    std::string_view joined() {
        joined_.assign(lines_.line());
        while (joined_.ends_with('\\')) {
            joined_.back() = ' ';
            if (!lines_.next()) break;
            joined_ += lines_.line();
        }
        return joined_;
    }

    void parse_line(std::string_view line) {
        const std::string_view word = next_word(line);
        if (word == "v") {
            parse_vertex(line);
        } else if (word == "vt") {
            parse_texture_point(line);
        } else if (word == "f") {
            parse_face(line);
        } else if (word == "o" || word == "g" || word == "usemtl") {
            begin_group(word == "o" ? object_ : word == "g" ? group_ : material_, line);
        }
    }

    /// Composes the name of a group from the object, group and material, as far as the file specifies them.
    void begin_group(std::string& part, std::string_view name) {
        while (!name.empty() && is_blank(name.front())) name.remove_prefix(1);
        while (!name.empty() && is_blank(name.back())) name.remove_suffix(1);
        part = name;
        std::string whole;
        for (const std::string* p : {&object_, &group_, &material_}) {
            if (p->empty()) continue;
            if (!whole.empty()) whole += '/';
            whole += *p;
        }
        mesh_.begin_group(whole);
    }

    void parse_vertex(std::string_view line) {
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = number(next_word(line), "a vertex needs three coordinates");
        if (!mesh_.add_vertex(p)) fail("a coordinate is not finite or beyond 1e30");
    }

    /// The second coordinate is optional.
    void parse_texture_point(std::string_view line) {
        const double u = number(next_word(line), "texture coordinates need at least one number");
        const std::string_view word = next_word(line);
        const auto point = MeshBuilder::texture_point(u, word.empty() ? 0.0 : number(word, ""));
        if (!point) fail("a texture coordinate is not finite or beyond 1e30");
        texture_.push_back(*point);
    }

    double number(std::string_view word, std::string_view missing) const {
        const auto value = parse_number(word);
        if (!value)
            fail(word.empty() ? std::string(missing) : fmt::format("{} is not a number", in_quotes(word)));
        return *value;
    }

    void parse_face(std::string_view line) {
        corners_.clear();
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
            corners_.push_back(corner(word));
            add_texture_of_corner(word);
        }
        if (corners_.size() < 3) fail(fmt::format("a face has {} corners; it needs 3", corners_.size()));
        mesh_.add_face(corners_);
        corner_count_ += corners_.size();
    }

    /// Parses "7", "7/1/2", "7//2"; negative numbers count back from the last vertex. Vertices may also
    /// follow the faces.
    std::uint32_t corner(std::string_view word) {
        const auto number = parse_integer(word.substr(0, word.find('/')));
        if (!number) fail(fmt::format("{} is not a corner of a face", in_quotes(word)));
        const auto count = static_cast<std::int64_t>(mesh_.vertex_count());
        const std::int64_t index = *number < 0 ? count + *number : *number - 1;
        if (index < 0 || index > 0xfffffffe) fail(refers_to(*number));
        max_vertex_.extend(static_cast<std::uint64_t>(index), lines_.number());
        return static_cast<std::uint32_t>(index);
    }

    /// Parses the second number of "7/1/2", if the corner has one.
    void add_texture_of_corner(std::string_view word) {
        const std::size_t slash = word.find('/');
        if (slash == word.npos) return;
        const std::string_view part = word.substr(slash + 1, word.find('/', slash + 1) - slash - 1);
        if (part.empty()) return;
        const auto number = parse_integer(part);
        if (!number) fail(fmt::format("{} is not a corner of a face", in_quotes(word)));
        const auto count = static_cast<std::int64_t>(texture_.size());
        const std::int64_t index = *number < 0 ? count + *number : *number - 1;
        if (index < 0 || index > 0xfffffffe) fail(refers_to_texture(*number));
        max_texture_.extend(static_cast<std::uint64_t>(index), lines_.number());
        texture_of_corner_.resize(corner_count_ + corners_.size(), kNoIndex);
        texture_of_corner_.back() = static_cast<std::uint32_t>(index);
    }

    std::string refers_to(std::int64_t vertex) const {
        return fmt::format("a face refers to vertex {}, but the vertices are 1 to {}", vertex,
                           mesh_.vertex_count());
    }

    template <class Index>
    std::string refers_to_texture(Index number) const {
        return fmt::format("a face refers to texture coordinates {}, but those are 1 to {}", number,
                           texture_.size());
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(mesh_.source(), lines_.number(), text); }

    LineReader lines_;
    MeshBuilder mesh_;
    std::string joined_;
    std::string object_, group_, material_;
    std::vector<std::uint32_t> corners_;
    Buffer<TexturePoint> texture_;
    std::vector<std::uint32_t> texture_of_corner_;  ///< up to the last corner that has one; kNoIndex: none
    std::size_t corner_count_ = 0;                  ///< of all faces
    Reference max_vertex_, max_texture_;
};

}  // namespace

PolygonMesh parse_obj(std::string_view text, const std::string& source, const Context& ctx) {
    return ObjParser(text, source, ctx).parse();
}

}  // namespace coppice::io_internal
