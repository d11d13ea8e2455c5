#include "coppice/io_mesh/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "coppice/base/local_origin.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/io/text.h"
#include "coppice/io_mesh/read_internal.h"
#include "coppice/system/file.h"
#include "coppice/system/file_progress.h"

namespace coppice {
namespace io_internal {
namespace {

constexpr double kLargestCoordinate = 1e30;
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

bool less(const Vec3d& a, const Vec3d& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

}  // namespace

bool MeshBuilder::add_vertex(Vec3d p) {
    const auto fits = [](double c) { return std::abs(c) <= kLargestCoordinate; };
    if (!fits(p.x) || !fits(p.y) || !fits(p.z)) return false;
    vertices_.push_back(p);
    return true;
}

void MeshBuilder::begin_group(const std::string& name) {
    const auto index_of = [&](const std::string& n) {
        const auto [it, is_new] =
            group_of_name_.try_emplace(n, static_cast<std::uint32_t>(mesh_.group_names.size()));
        if (is_new) mesh_.group_names.push_back(n);
        return it->second;
    };
    if (mesh_.group_names.empty() && name.empty()) return;
    if (mesh_.group_names.empty() && face_count() > 0) mesh_.group.assign(face_count(), index_of(""));
    group_ = index_of(name);
}

void MeshBuilder::add_numbered_vertex(Vec3d p) {
    if (!add_vertex(p)) {
        throw InvalidInput(
            fmt::format("{}: vertex {} is not finite or beyond 1e30", source_, vertex_count()));
    }
}

void MeshBuilder::add_numbered_face(std::span<const double> corners) {
    if (corners.size() < 3) {
        throw InvalidInput(
            fmt::format("{}: face {} has {} corners; a face needs 3", source_, face_count(), corners.size()));
    }
    corners_.clear();
    for (const double v : corners) {
        if (!(v >= 0 && v < static_cast<double>(vertex_count())) || v != std::trunc(v)) {
            throw InvalidInput(fmt::format("{}: face {} refers to vertex {}, but the vertices are 0 to {}",
                                           source_, face_count(), v,
                                           static_cast<double>(vertex_count()) - 1));
        }
        corners_.push_back(static_cast<std::uint32_t>(v));
    }
    mesh_.add_face(corners_);
}

namespace {

struct KeyedVertex {
    std::uint32_t key = 0, vertex = 0;
};

/// Returns a key that is equal for equal positions, including zeros of both signs, and rarely for others.
std::uint32_t make_key(Vec3d p) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
        key = (key ^ std::bit_cast<std::uint64_t>(p[axis] + 0.0)) * 0x9e3779b97f4a7c15ull;
        key ^= key >> 32;
    }
    return static_cast<std::uint32_t>(key);
}

}  // namespace

/// Sorts by keys, and by positions among equal keys: in a hash table, a malicious file could make all
/// positions collide.
void MeshBuilder::weld(const Context& ctx) {
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    const auto count = static_cast<std::uint32_t>(vertices_.size());
    Buffer<KeyedVertex> order(count);
    parallel_for_ranges(ctx, count, kGrain, [&](IndexRange range) {
        for (std::size_t v = range.begin; v < range.end; ++v)
            order[v] = {make_key(vertices_[v]), static_cast<std::uint32_t>(v)};
    });
    radix_sort(ctx, order, 32, [](const KeyedVertex& v) { return v.key; });
    std::vector<std::uint32_t> to(count);
    FileProgress stop({.stop = ctx.stop}, 0);
    for (std::uint32_t begin = 0, end = 0; begin < count; begin = end) {
        stop.at(begin);
        while (end < count && order[end].key == order[begin].key) ++end;
        std::sort(order.begin() + begin, order.begin() + end, [&](KeyedVertex a, KeyedVertex b) {
            const Vec3d &p = vertices_[a.vertex], &q = vertices_[b.vertex];
            return less(p, q) || (p == q && a.vertex < b.vertex);
        });
        for (std::uint32_t i = begin; i < end; ++i) {
            const std::uint32_t v = order[i].vertex;
            const bool repeats = i > begin && vertices_[v] == vertices_[order[i - 1].vertex];
            to[v] = repeats ? to[order[i - 1].vertex] : v;
        }
    }
    fill_attributes();
    std::uint32_t kept = 0;
    for (std::uint32_t v = 0; v < count; ++v) {  // to[v] <= v, so the entry of its target is final already
        if (to[v] == v) {
            vertices_[kept] = vertices_[v];
            for (VertexAttribute& a : attributes_) a.values[kept] = a.values[v];
            to[v] = kept++;
        } else {
            to[v] = to[to[v]];
        }
    }
    vertices_.resize(kept);
    for (VertexAttribute& a : attributes_) a.values.resize(kept);
    for (std::uint32_t& v : mesh_.corners) v = to[v];
}

std::optional<TexturePoint> MeshBuilder::texture_point(double u, double v) {
    if (!(std::abs(u) <= kLargestCoordinate && std::abs(v) <= kLargestCoordinate)) return std::nullopt;
    return TexturePoint{static_cast<float>(u), static_cast<float>(v)};
}

TexturePoint MeshBuilder::numbered_texture_point(std::size_t vertex, double u, double v) const {
    if (const auto point = texture_point(u, v)) return *point;
    throw InvalidInput(fmt::format("{}: the texture coordinates of vertex {} are not finite or beyond 1e30",
                                   source_, vertex));
}

void MeshBuilder::set_texture(Buffer<TexturePoint> of_corners) {
    COPPICE_ASSERT(of_corners.size() == mesh_.corners.size());
    mesh_.texture = std::move(of_corners);
}

TextureBlend MeshBuilder::numbered_blend(std::size_t vertex, double u, double v, double weight) const {
    if (!std::isfinite(weight)) {
        throw InvalidInput(fmt::format(
            "{}: the weight of the second texture coordinates of vertex {} is not finite", source_, vertex));
    }
    return {numbered_texture_point(vertex, u, v), static_cast<float>(std::clamp(weight, 0.0, 1.0))};
}

void MeshBuilder::set_vertex_texture(Buffer<TexturePoint> of_vertices, Buffer<TextureBlend> blends,
                                     const Context& ctx) {
    set_texture(spread_to_corners(std::move(of_vertices)));
    if (!blends.empty()) mesh_.texture_blends = spread_to_corners(std::move(blends));
    weld(ctx);
}

void MeshBuilder::set_attribute(std::size_t attribute, std::size_t vertex, double value) {
    Buffer<float>& values = attributes_[attribute].values;
    values.resize(vertex, kNoValue);  // of vertices without a value
    values.push_back(std::abs(value) <= kLargestCoordinate ? static_cast<float>(value) : kNoValue);
}

void MeshBuilder::fill_attributes() {
    std::erase_if(attributes_, [](const VertexAttribute& a) { return a.values.empty(); });
    for (VertexAttribute& a : attributes_) a.values.resize(vertices_.size(), kNoValue);
}

MeshFile MeshBuilder::take_file() {
    fill_attributes();
    MeshFile out{take(), {}};
    out.attributes = std::move(attributes_);
    return out;
}

PolygonMesh MeshBuilder::take() {
    if (face_count() == 0) {
        throw InvalidInput(fmt::format("{}: it contains no faces, so it is not a surface", source_));
    }
    mesh_.origin = local_origin(vertices_);
    mesh_.positions.reserve(vertices_.size());
    for (const Vec3d& p : vertices_) mesh_.positions.push_back(Vec3(p - mesh_.origin));
    return std::move(mesh_);
}

namespace {

/// Refuses file types that are often passed by mistake with a message that names the type.
void refuse_other_kinds(std::string_view bytes, const std::string& source) {
    const auto refuse = [&](std::string_view kind, std::string_view remedy) {
        throw Unsupported(fmt::format("{}: {} is not read; {}", source, kind, remedy));
    };
    if (bytes.starts_with("Kaydara FBX")) refuse("FBX", "export the mesh as GLB, PLY or OBJ");
    if (bytes.starts_with("PK\x03\x04"))
        refuse("a ZIP container (3MF, USDZ)", "export the mesh as GLB, PLY or OBJ");
    if (bytes.starts_with("\x1f\x8b")) refuse("a gzip file", "unpack it first");
    if (bytes.starts_with("LASF")) refuse("a LAS point cloud", "a mesh is required");
    if (bytes.starts_with("PXR-USDC")) refuse("binary USD", "export the mesh as GLB, PLY or OBJ");
    const std::string_view start = trimmed(bytes.substr(0, bytes.find('\n')));
    if (start.starts_with('{'))
        refuse("JSON (such as .gltf)", "export the mesh as .glb, which contains its buffers");
    if (start.starts_with('<')) refuse("XML", "export the mesh as GLB, PLY or OBJ");
}

}  // namespace
}  // namespace io_internal

PolygonMesh parse_mesh(std::string_view bytes, MeshFormat format, const std::string& source,
                       const Context& ctx) {
    return parse_mesh_file(bytes, format, source, {}, ctx).mesh;
}

MeshFile parse_mesh_file(std::string_view bytes, MeshFormat format, const std::string& source,
                         std::span<const std::string> attributes, const Context& ctx) {
    switch (format) {
        case MeshFormat::obj:
            return {io_internal::parse_obj(bytes, source, ctx), {}};
        case MeshFormat::ply:
            return io_internal::parse_ply(bytes, source, attributes, ctx);
        case MeshFormat::off:
            return {io_internal::parse_off(bytes, source, ctx), {}};
        case MeshFormat::stl:
            return {io_internal::parse_stl(bytes, source, ctx), {}};
        case MeshFormat::glb:
            return io_internal::parse_glb(bytes, source, attributes, ctx);
        case MeshFormat::usda:
            break;
    }
    throw Unsupported(fmt::format("{}: USD is written only; export the mesh as GLB, PLY or OBJ", source));
}

PolygonMesh read_mesh(const std::filesystem::path& path, const Context& ctx) {
    return read_mesh_file(path, {}, ctx).mesh;
}

MeshFile read_mesh_file(const std::filesystem::path& path, std::span<const std::string> attributes,
                        const Context& ctx) {
    const std::string bytes = read_file(path, kLargestFile, ctx);
    const std::string source = path.string();
    if (bytes.empty()) throw InvalidInput(fmt::format("{}: the file is empty", source));
    auto format = mesh_format_of_content(bytes);
    if (!format) {
        io_internal::refuse_other_kinds(bytes, source);
        format = mesh_format_of_name(path);
    }
    MeshFile file = parse_mesh_file(bytes, format.value_or(MeshFormat::obj), source, attributes, ctx);
    ctx.throw_if_cancelled();
    ctx.report(1);
    return file;
}

}  // namespace coppice
