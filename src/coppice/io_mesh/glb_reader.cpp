// The JSON is read with nlohmann-json and the buffers are checked here. tinygltf is not used: it opens files
// named by the JSON, decodes images, and still leaves the check of every offset and count to its caller.

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "coppice/io_mesh/glb_names_internal.h"
#include "coppice/io_mesh/read_internal.h"
#include "coppice/system/file_progress.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

constexpr std::size_t kLargestJson = std::size_t{1} << 26;

/// An affine map, stored as columns.
struct Affine {
    std::array<Vec3d, 4> column{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{}};

    Vec3d direction(Vec3d v) const { return v.x * column[0] + v.y * column[1] + v.z * column[2]; }
    Vec3d point(Vec3d p) const { return direction(p) + column[3]; }
    double determinant() const { return dot(cross(column[0], column[1]), column[2]); }
    friend Affine operator*(const Affine& a, const Affine& b) {
        return {{a.direction(b.column[0]), a.direction(b.column[1]), a.direction(b.column[2]),
                 a.point(b.column[3])}};
    }
};

/// Returns the rotation matrix of a quaternion (x, y, z, w) of any length except zero.
Affine rotation(std::array<double, 4> q) {
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(norm > 0)) return {};
    const double w = q[3] / norm;
    const Vec3d u = Vec3d(q[0], q[1], q[2]) / norm;
    Affine r;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d v = r.column[i];
        r.column[i] = (2 * dot(u, v)) * u + (w * w - dot(u, u)) * v + (2 * w) * cross(u, v);
    }
    return r;
}

constexpr std::array<double, 3> kNoShift{0, 0, 0}, kNoScale{1, 1, 1};
constexpr std::array<double, 4> kNoRotation{0, 0, 0, 1};

/// Returns the map that scales, then rotates, then shifts.
Affine compose(const std::array<double, 3>& shift, const std::array<double, 4>& turn,
               const std::array<double, 3>& scale) {
    Affine out = rotation(turn);
    for (std::size_t i = 0; i < 3; ++i) out.column[i] *= scale[i];
    out.column[3] = {shift[0], shift[1], shift[2]};
    return out;
}

std::uint32_t read_u32(std::string_view bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

template <class T>
double read_as(const char* from, bool normalized) {
    T value{};
    std::memcpy(&value, from, sizeof value);
    const auto number = static_cast<double>(value);
    if constexpr (std::is_integral_v<T>) {
        if (normalized) return std::max(number / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
    }
    return number;
}

/// A checked accessor: all elements are within the file.
struct Elements {
    const char* data = nullptr;
    std::size_t count = 0;
    std::size_t stride = 0;
    std::uint64_t type = 0;
    bool normalized = false;

    double number(std::size_t element, std::size_t component) const {
        const char* at = data + element * stride + component * component_size(type);
        switch (type) {
            case 5120:
                return read_as<std::int8_t>(at, normalized);
            case 5121:
                return read_as<std::uint8_t>(at, normalized);
            case 5122:
                return read_as<std::int16_t>(at, normalized);
            case 5123:
                return read_as<std::uint16_t>(at, normalized);
            case 5125:
                return read_as<std::uint32_t>(at, normalized);
            default:
                return read_as<float>(at, normalized);
        }
    }
    /// Returns the size of a component in bytes; 0 for an unknown type.
    static std::size_t component_size(std::uint64_t type) {
        switch (type) {
            case 5120:
            case 5121:
                return 1;
            case 5122:
            case 5123:
                return 2;
            case 5125:
            case 5126:
                return 4;
            default:
                return 0;
        }
    }
};

class GlbParser {
  public:
    GlbParser(std::string_view bytes, const std::string& source, std::span<const std::string> attributes,
              const Context& ctx)
        : mesh_(source, attributes),
          stop_{.threads = ctx.threads, .stop = ctx.stop},
          allowed_((std::size_t{1} << 25) + 8 * bytes.size()) {
        split(bytes);
        refuse_compression();
    }

    MeshFile parse() {
        visited_.assign(array(document_, "nodes").size(), false);
        std::vector<std::pair<std::uint64_t, Affine>> stack;
        push(stack, roots(), {});
        while (!stack.empty()) {
            const auto [index, above] = stack.back();
            stack.pop_back();
            const json& node = item("nodes", index);
            if (visited_[index]) fail(fmt::format("node {} has two parents or is its own ancestor", index));
            visited_[index] = true;
            const Affine transform = above * local(node);
            if (const auto mesh = find_index(node, "mesh")) add_copies(node, *mesh, transform);
            push(stack, indices(node, "children"), transform);
        }
        if (!texture_.empty() && mesh_.face_count() > 0)
            mesh_.set_vertex_texture(std::move(texture_), std::move(blends_), stop_);
        return mesh_.take_file();
    }

  private:
    /// Splits the file into a 12-byte header and chunks of length, type and data: the first is JSON, the
    /// optional second is the buffer.
    void split(std::string_view bytes) {
        if (bytes.size() < 20 || !bytes.starts_with("glTF")) fail("it is not a GLB file, or it is truncated");
        if (read_u32(bytes, 4) != 2)
            refuse(fmt::format("glTF {} is not read; export glTF 2.0", read_u32(bytes, 4)));
        if (read_u32(bytes, 8) > bytes.size())
            fail("the file is shorter than its header specifies; it is truncated");
        const std::size_t length = read_u32(bytes, 12);
        if (bytes.substr(16, 4) != "JSON" || length > bytes.size() - 20)
            fail("the JSON chunk is missing or truncated");
        if (length > kLargestJson) refuse("its JSON chunk is larger than 64 MiB");
        const std::string_view text = bytes.substr(20, length);
        document_ = json::parse(text.begin(), text.end(), nullptr, false);
        if (!document_.is_object()) fail("its JSON chunk is damaged");
        const std::string_view rest = bytes.substr(20 + length);
        if (rest.size() < 8 || rest.substr(4, 4) != std::string_view("BIN\0", 4)) return;
        if (read_u32(rest, 0) > rest.size() - 8) fail("the buffer is truncated");
        buffer_ = rest.substr(8, read_u32(rest, 0));
    }

    void refuse_compression() const {
        for (const json& name : array(document_, "extensionsRequired")) {
            if (name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression") {
                refuse(name.get<std::string>() + " is not read; export the mesh without compression");
            }
        }
    }

    // --- access to untrusted JSON ---

    static const json* find(const json& object, const char* key) {
        if (!object.is_object()) return nullptr;
        const auto it = object.find(key);
        return it == object.end() ? nullptr : &*it;
    }
    /// Returns an array; an empty one if it is missing.
    const json& array(const json& object, const char* key) const {
        static const json kEmpty = json::array();
        const json* value = find(object, key);
        if (value != nullptr && !value->is_array()) fail(fmt::format("'{}' is not an array", key));
        return value == nullptr ? kEmpty : *value;
    }
    const json& item(const char* key, std::uint64_t index) const {
        const json& all = array(document_, key);
        if (index >= all.size() || !all[index].is_object())
            fail(fmt::format("'{}' has no entry {}", key, index));
        return all[index];
    }
    std::uint64_t to_index(const json& value, const char* key) const {
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() > 0xffffffffu) {
            fail(fmt::format("'{}' is not an unsigned 32-bit integer", key));
        }
        return value.get<std::uint64_t>();
    }
    std::optional<std::uint64_t> find_index(const json& object, const char* key) const {
        const json* value = find(object, key);
        return value == nullptr ? std::nullopt : std::optional(to_index(*value, key));
    }
    std::vector<std::uint64_t> indices(const json& object, const char* key) const {
        std::vector<std::uint64_t> out;
        for (const json& value : array(object, key)) out.push_back(to_index(value, key));
        return out;
    }
    template <std::size_t N>
    std::optional<std::array<double, N>> numbers(const json& object, const char* key) const {
        const json& values = array(object, key);
        if (values.empty()) return {};
        std::array<double, N> out{};
        if (values.size() != N) fail(fmt::format("'{}' does not have {} numbers", key, N));
        for (std::size_t i = 0; i < N; ++i) {
            if (!values[i].is_number()) fail(fmt::format("'{}' does not have {} numbers", key, N));
            out[i] = values[i].get<double>();
        }
        return out;
    }

    // --- nodes ---

    /// Returns the nodes of the default scene; without scenes, all nodes without a parent.
    std::vector<std::uint64_t> roots() const {
        if (!array(document_, "scenes").empty()) {
            return indices(item("scenes", find_index(document_, "scene").value_or(0)), "nodes");
        }
        const json& nodes = array(document_, "nodes");
        std::vector<bool> is_child(nodes.size(), false);
        for (const json& node : nodes) {
            for (const std::uint64_t child : indices(node, "children")) {
                if (child < is_child.size()) is_child[child] = true;
            }
        }
        std::vector<std::uint64_t> out;
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            if (!is_child[n]) out.push_back(n);
        }
        return out;
    }

    static void push(std::vector<std::pair<std::uint64_t, Affine>>& stack,
                     const std::vector<std::uint64_t>& nodes, const Affine& above) {
        for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) stack.emplace_back(*it, above);
    }

    Affine local(const json& node) const {
        if (const auto m = numbers<16>(node, "matrix")) {
            const auto column = [&](std::size_t c) {
                return Vec3d((*m)[4 * c], (*m)[4 * c + 1], (*m)[4 * c + 2]);
            };
            return {{column(0), column(1), column(2), column(3)}};
        }
        return compose(numbers<3>(node, "translation").value_or(kNoShift),
                       numbers<4>(node, "rotation").value_or(kNoRotation),
                       numbers<3>(node, "scale").value_or(kNoScale));
    }

    /// Adds a mesh, or as many copies of it as EXT_mesh_gpu_instancing specifies.
    void add_copies(const json& node, std::uint64_t mesh, const Affine& transform) {
        const json* extensions = find(node, "extensions");
        const json* instancing =
            extensions == nullptr ? nullptr : find(*extensions, "EXT_mesh_gpu_instancing");
        const json* attributes = instancing == nullptr ? nullptr : find(*instancing, "attributes");
        if (attributes == nullptr) return add_mesh(mesh, transform);
        std::optional<std::size_t> count;
        const auto read = [&](const char* name, const char* type, std::size_t components) {
            const auto accessor = find_index(*attributes, name);
            if (!accessor) return Elements{};
            const Elements out = elements(*accessor, type, components);
            if (count && *count != out.count) fail("the attributes of instances have different lengths");
            count = out.count;
            return out;
        };
        const Elements shifts = read("TRANSLATION", "VEC3", 3), rotations = read("ROTATION", "VEC4", 4),
                       scales = read("SCALE", "VEC3", 3);
        if (!count) return add_mesh(mesh, transform);
        FileProgress progress(stop_, *count);
        for (std::size_t i = 0; i < *count; ++i) {
            progress.at(i);
            take_from_allowed(1);
            add_mesh(mesh,
                     transform * compose(values_at(shifts, i, kNoShift), values_at(rotations, i, kNoRotation),
                                         values_at(scales, i, kNoScale)));
        }
    }

    /// Returns an element, or `fallback` if the accessor is missing.
    template <std::size_t N>
    static std::array<double, N> values_at(const Elements& from, std::size_t i,
                                           std::array<double, N> fallback) {
        for (std::size_t k = 0; from.data != nullptr && k < N; ++k) fallback[k] = from.number(i, k);
        return fallback;
    }

    // --- geometry ---

    void add_mesh(std::uint64_t index, const Affine& transform) {
        // Accessors of vertices already in the mesh: primitives share them.
        using Accessor = std::optional<std::uint64_t>;
        std::map<std::vector<Accessor>, std::uint32_t> placed;
        for (const json& primitive : array(item("meshes", index), "primitives")) {
            const std::uint64_t mode = find_index(primitive, "mode").value_or(4);
            if (mode < 4) continue;  // points and lines
            if (mode > 4)
                refuse(fmt::format("mesh {} has triangle strips or fans; export plain triangles", index));
            const json* attributes = find(primitive, "attributes");
            const auto position = attributes == nullptr ? std::nullopt : find_index(*attributes, "POSITION");
            if (!position) continue;
            const Elements positions = elements(*position, "VEC3", 3);
            const auto texture = find_index(*attributes, "TEXCOORD_0");
            const auto second = find_index(*attributes, "TEXCOORD_1");
            const auto blend = find_index(*attributes, "_BLEND");
            std::vector<Accessor> accessors{position, texture, second, blend};
            for (const VertexAttribute& a : mesh_.attributes())
                accessors.push_back(find_index(*attributes, glb_attribute_name(a.name).c_str()));
            const auto [it, is_new] =
                placed.try_emplace(accessors, static_cast<std::uint32_t>(mesh_.vertex_count()));
            if (is_new) {
                add_positions(positions, transform);
                if (texture) add_texture(*texture, positions.count, index);
                if (texture && second && blend) add_blends(*second, *blend, positions.count, index);
                add_attributes(std::span(accessors).subspan(4), positions.count, index);
            }
            mesh_.begin_group(group_name(item("meshes", index), primitive));
            add_triangles(primitive, index, it->second, positions.count, transform.determinant() < 0);
        }
    }

    /// Returns the names of the mesh and of the material, as far as they exist.
    std::string group_name(const json& mesh, const json& primitive) const {
        std::string whole;
        const auto add = [&](const json& object) {
            const json* name = find(object, "name");
            if (name == nullptr || !name->is_string()) return;
            if (!whole.empty()) whole += '/';
            whole += name->get<std::string>();
        };
        add(mesh);
        if (const auto material = find_index(primitive, "material")) add(item("materials", *material));
        return whole;
    }

    void add_positions(const Elements& positions, const Affine& transform) {
        take_from_allowed(positions.count);
        FileProgress progress(stop_, positions.count);
        for (std::size_t i = 0; i < positions.count; ++i) {
            progress.at(i);
            const Vec3d p =
                transform.point({positions.number(i, 0), positions.number(i, 1), positions.number(i, 2)});
            mesh_.add_numbered_vertex({p.x, -p.z, p.y});
        }
    }

    /// Adds the texture coordinates of the last vertices. In glTF, v points down in the image.
    void add_texture(std::uint64_t accessor, std::size_t vertices, std::uint64_t mesh) {
        const Elements places = texture_elements(accessor, "VEC2", 2, vertices, mesh);
        texture_.resize(mesh_.vertex_count() - vertices, TexturePoint{});  // of other meshes
        for (std::size_t i = 0; i < vertices; ++i) {
            texture_.push_back(
                mesh_.numbered_texture_point(texture_.size(), places.number(i, 0), 1 - places.number(i, 1)));
        }
    }

    /// Adds the second texture coordinates and their weights.
    void add_blends(std::uint64_t second, std::uint64_t weight, std::size_t vertices, std::uint64_t mesh) {
        const Elements places = texture_elements(second, "VEC2", 2, vertices, mesh);
        const Elements weights = texture_elements(weight, "SCALAR", 1, vertices, mesh);
        blends_.resize(mesh_.vertex_count() - vertices, TextureBlend{});  // of other meshes
        for (std::size_t i = 0; i < vertices; ++i) {
            blends_.push_back(mesh_.numbered_blend(blends_.size(), places.number(i, 0),
                                                   1 - places.number(i, 1), weights.number(i, 0)));
        }
    }

    /// Adds the attributes of the last vertices.
    void add_attributes(std::span<const std::optional<std::uint64_t>> accessors, std::size_t vertices,
                        std::uint64_t mesh) {
        const std::size_t first = mesh_.vertex_count() - vertices;
        for (std::size_t a = 0; a < accessors.size(); ++a) {
            if (!accessors[a]) continue;
            const Elements values =
                vertex_elements(*accessors[a], "SCALAR", 1, vertices, "values of an attribute", mesh);
            for (std::size_t i = 0; i < vertices; ++i) mesh_.set_attribute(a, first + i, values.number(i, 0));
        }
    }

    Elements texture_elements(std::uint64_t accessor, const char* type, std::size_t components,
                              std::size_t vertices, std::uint64_t mesh) const {
        return vertex_elements(accessor, type, components, vertices, "texture coordinates", mesh);
    }

    /// Returns the elements of an accessor with one for every vertex; errors name them as `things`.
    Elements vertex_elements(std::uint64_t accessor, const char* type, std::size_t components,
                             std::size_t vertices, const char* things, std::uint64_t mesh) const {
        const Elements out = elements(accessor, type, components);
        if (out.count != vertices) {
            fail(fmt::format("mesh {} has {} {} for {} vertices", mesh, out.count, things, vertices));
        }
        return out;
    }

    /// A mirroring transform inverts the orientation of triangles; reversing them preserves the outside.
    void add_triangles(const json& primitive, std::uint64_t mesh, std::uint32_t base, std::size_t vertices,
                       bool mirrored) {
        const auto accessor = find_index(primitive, "indices");
        const Elements listed = accessor ? elements(*accessor, "SCALAR", 1) : Elements{};
        const std::size_t corners = accessor ? listed.count : vertices;
        if (corners % 3 != 0)
            fail(fmt::format("mesh {} has {} corners, which is not a multiple of 3", mesh, corners));
        take_from_allowed(corners);
        FileProgress progress(stop_, corners);
        for (std::size_t i = 0; i < corners; i += 3) {
            progress.at(i);
            Triangle t{};
            for (std::size_t k = 0; k < 3; ++k) {
                const double v = accessor ? listed.number(i + k, 0) : static_cast<double>(i + k);
                if (!(v >= 0 && v < static_cast<double>(vertices)) || v != std::trunc(v)) {
                    fail(fmt::format("triangle {} of mesh {} refers to vertex {} of {}", i / 3, mesh, v,
                                     vertices));
                }
                t[k] = base + static_cast<std::uint32_t>(v);
            }
            if (mirrored) std::swap(t[1], t[2]);
            mesh_.add_face(t);
        }
    }

    /// Limits the size of the mesh: nodes and primitives may reuse the same data, so that a small file could
    /// produce a mesh of any size.
    void take_from_allowed(std::size_t count) {
        if (count > allowed_) {
            refuse("its nodes repeat the same meshes too often; export fewer instances");
        }
        allowed_ -= count;
    }

    Elements elements(std::uint64_t index, const char* shape, std::size_t components) const {
        const json& accessor = item("accessors", index);
        const json* type = find(accessor, "type");
        if (type == nullptr || *type != shape) fail(fmt::format("accessor {} is not {}", index, shape));
        const auto view_index = find_index(accessor, "bufferView");
        if (!view_index || find(accessor, "sparse") != nullptr) {
            refuse(fmt::format("accessor {} is sparse, which is not read; export plain buffers", index));
        }
        Elements out;
        out.type = find_index(accessor, "componentType").value_or(0);
        out.count = find_index(accessor, "count").value_or(0);
        const json* normalized = find(accessor, "normalized");
        out.normalized = normalized != nullptr && *normalized == true;
        const std::size_t size = components * Elements::component_size(out.type);
        if (size == 0) fail(fmt::format("accessor {} has an unknown component type", index));
        const json& view = item("bufferViews", *view_index);
        const std::string_view bytes = view_bytes(view, *view_index);
        out.stride = find_index(view, "byteStride").value_or(size);
        const std::size_t offset = find_index(accessor, "byteOffset").value_or(0);
        const std::size_t needed = out.count == 0 ? 0 : offset + (out.count - 1) * out.stride + size;
        if (out.stride < size || needed > bytes.size())
            fail(fmt::format("accessor {} extends beyond its buffer", index));
        if (out.count > 0) out.data = bytes.data() + offset;  // an empty one may begin at any offset
        return out;
    }

    std::string_view view_bytes(const json& view, std::uint64_t index) const {
        const std::uint64_t buffer = find_index(view, "buffer").value_or(0);
        if (buffer != 0 || find(item("buffers", 0), "uri") != nullptr) {
            refuse("it stores data in other files; export a single .glb that contains everything");
        }
        const std::size_t offset = find_index(view, "byteOffset").value_or(0);
        const std::size_t length = find_index(view, "byteLength").value_or(0);
        if (offset + length > buffer_.size())
            fail(fmt::format("buffer view {} extends beyond the file", index));
        return buffer_.substr(offset, length);
    }

    [[noreturn]] void fail(const std::string& text) const {
        throw InvalidInput(fmt::format("{}: {}", mesh_.source(), text));
    }

    [[noreturn]] void refuse(const std::string& text) const {
        throw Unsupported(fmt::format("{}: {}", mesh_.source(), text));
    }

    MeshBuilder mesh_;
    Context stop_;  ///< reports no progress: the number of triangles is unknown until the end
    json document_;
    std::string_view buffer_;
    std::vector<bool> visited_;
    Buffer<TexturePoint> texture_;  ///< per vertex, up to the last that has some
    Buffer<TextureBlend> blends_;   ///< per vertex, up to the last that has some
    std::size_t allowed_;           ///< number of vertices and corners that may still be created
};

}  // namespace

MeshFile parse_glb(std::string_view bytes, const std::string& source, std::span<const std::string> attributes,
                   const Context& ctx) {
    return GlbParser(bytes, source, attributes, ctx).parse();
}

}  // namespace coppice::io_internal
