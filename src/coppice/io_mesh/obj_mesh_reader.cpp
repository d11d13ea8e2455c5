#include <fmt/format.h>

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
        if (mesh_.face_count() > 0 && largest_ >= mesh_.vertex_count()) {
            fail_at(mesh_.source(), largest_line_, refers_to(largest_ + 1));
        }
        if (mesh_.face_count() == 0 && mesh_.vertex_count() == 0) {
            throw InvalidInput(
                fmt::format("{}: no mesh was found; OBJ, PLY, OFF, STL and GLB are read", mesh_.source()));
        }
        return mesh_.take();
    }

  private:
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
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word = next_word(line);
            const auto value = parse_number(word);
            if (!value)
                fail(word.empty() ? "a vertex needs three coordinates"
                                  : fmt::format("{} is not a number", in_quotes(word)));
            p[axis] = *value;
        }
        if (!mesh_.add_vertex(p)) fail("a coordinate is not finite or beyond 1e30");
    }

    void parse_face(std::string_view line) {
        corners_.clear();
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
            corners_.push_back(corner(word));
        }
        if (corners_.size() < 3) fail(fmt::format("a face has {} corners; it needs 3", corners_.size()));
        mesh_.add_face(corners_);
    }

    /// Parses "7", "7/1/2", "7//2"; negative numbers count back from the last vertex. Vertices may also
    /// follow the faces.
    std::uint32_t corner(std::string_view word) {
        const auto number = parse_integer(word.substr(0, word.find('/')));
        if (!number) fail(fmt::format("{} is not a corner of a face", in_quotes(word)));
        const auto count = static_cast<std::int64_t>(mesh_.vertex_count());
        const std::int64_t index = *number < 0 ? count + *number : *number - 1;
        if (index < 0 || index > 0xfffffffe) fail(refers_to(*number));
        if (static_cast<std::uint64_t>(index) >= largest_) {
            largest_ = static_cast<std::uint64_t>(index);
            largest_line_ = lines_.number();
        }
        return static_cast<std::uint32_t>(index);
    }

    std::string refers_to(std::int64_t vertex) const {
        return fmt::format("a face refers to vertex {}, but the vertices are 1 to {}", vertex,
                           mesh_.vertex_count());
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(mesh_.source(), lines_.number(), text); }

    LineReader lines_;
    MeshBuilder mesh_;
    std::string joined_;
    std::string object_, group_, material_;
    std::vector<std::uint32_t> corners_;
    std::uint64_t largest_ = 0;
    std::uint32_t largest_line_ = 0;
};

}  // namespace

PolygonMesh parse_obj(std::string_view text, const std::string& source, const Context& ctx) {
    return ObjParser(text, source, ctx).parse();
}

}  // namespace coppice::io_internal
