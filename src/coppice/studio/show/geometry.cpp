#include "coppice/studio/show/geometry_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/mesh/texture_table.h"
#include "coppice/skeleton/architecture.h"

namespace coppice {
namespace {

constexpr std::size_t kAlignment = 4;
constexpr std::size_t kCornersOfQuad = 4, kCornersOfTriangle = 3;
constexpr float kFullByte = 127;
constexpr double kCurveSteps = 16;  // straight segments for each segment of a curve

void pad(std::string& text, char with) {
    while (text.size() % kAlignment != 0) text += with;
}

void append_number(std::string& out, std::uint32_t n) {
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>((n >> shift) & 0xff);
}

std::span<const float> floats(std::span<const Vec3> v) {
    return {reinterpret_cast<const float*>(v.data()), 3 * v.size()};
}
std::span<const float> floats(std::span<const TexturePoint> p) {
    return {reinterpret_cast<const float*>(p.data()), 2 * p.size()};
}

/// Adds the normal of a face, weighted by its area, to its corners.
void add_face_normal(std::span<const Vec3> p, std::span<const std::uint32_t> corners,
                     std::vector<Vec3>& out) {
    const Vec3 a = p[corners[0]], b = p[corners[1]], c = p[corners[2]];
    const Vec3 normal =
        corners.size() == kCornersOfQuad ? cross(c - a, p[corners[3]] - b) : cross(b - a, c - a);
    for (const std::uint32_t corner : corners) out[corner] = out[corner] + normal;
}

void append_normal(std::vector<std::int8_t>& out, Vec3 n) {
    const float size = length(n);
    const float scale = size > 0 ? kFullByte / size : 0;
    for (const float x : {n.x, n.y, n.z}) out.push_back(static_cast<std::int8_t>(std::lround(x * scale)));
    out.push_back(0);
}

std::vector<std::int8_t> packed(std::span<const Vec3> normals) {
    std::vector<std::int8_t> out;
    out.reserve(4 * normals.size());
    for (const Vec3 n : normals) append_normal(out, n);
    return out;
}

std::span<const std::uint32_t> numbers(std::span<const Quad> quads) {
    return {reinterpret_cast<const std::uint32_t*>(quads.data()), kCornersOfQuad * quads.size()};
}
std::span<const std::uint32_t> numbers(std::span<const Triangle> triangles) {
    return {reinterpret_cast<const std::uint32_t*>(triangles.data()), kCornersOfTriangle * triangles.size()};
}

std::vector<Vec3> compute_normals(std::span<const Vec3> positions, std::span<const Quad> quads,
                                  std::span<const Triangle> triangles) {
    std::vector<Vec3> out(positions.size());
    for (const Quad& q : quads) add_face_normal(positions, q, out);
    for (const Triangle& t : triangles) add_face_normal(positions, t, out);
    return out;
}

/// A surface is smooth at its texture seams: all places of a vertex have the same normal.
void merge_normals(std::vector<Vec3>& normals, const TextureTable& table) {
    std::vector<Vec3> sums(*std::ranges::max_element(table.vertex) + 1);
    for (std::size_t i = 0; i < normals.size(); ++i)
        sums[table.vertex[i]] = sums[table.vertex[i]] + normals[i];
    normals = divide_at_seams(std::span<const Vec3>(sums), table);
}

/// `texture` is the table by which the vertices were divided at texture seams; null without texture.
void add_surface(GeometryWriter& writer, std::span<const Vec3> positions, std::span<const Quad> quads,
                 std::span<const Triangle> triangles, const TextureTable* texture = nullptr) {
    std::vector<Vec3> normals = compute_normals(positions, quads, triangles);
    if (texture != nullptr) merge_normals(normals, *texture);
    writer.add("position", floats(positions), 3);
    writer.add("normal", packed(normals), 4);
    if (texture != nullptr) writer.add("uv", floats(texture->places), 2);
    if (!quads.empty()) writer.add("quads", numbers(quads), kCornersOfQuad);
    if (!triangles.empty()) writer.add("triangles", numbers(triangles), kCornersOfTriangle);
}

void add_values(GeometryWriter& writer, const std::vector<float>& values) {
    float low = 0, high = 0;
    bool first = true;
    for (const float v : values) {
        if (!std::isfinite(v)) continue;
        low = first ? v : std::min(low, v);
        high = first ? v : std::max(high, v);
        first = false;
    }
    writer.header()["low"] = low;
    writer.header()["high"] = high;
    writer.add("value", values, 1);
}

/// Returns the values of the nodes; throws if the skeleton has none.
std::vector<float> node_values(const SceneObject& object, StudioColor color) {
    const Skeleton& tree = std::get<Skeleton>(object.value);
    if (color == StudioColor::radius) return {tree.radii().begin(), tree.radii().end()};
    if (color == StudioColor::order) {
        const std::vector<std::uint32_t> orders = axis_orders(tree);
        return {orders.begin(), orders.end()};
    }
    if (color == StudioColor::deviation)
        throw InvalidInput("axes have no deviation; show the surface instead");
    const auto found = std::ranges::find(object.attributes, "evidence", &NodeAttribute::name);
    if (found == object.attributes.end())
        throw InvalidInput("this tree has no evidence values; extract writes them to JSON and PLY");
    return found->values;
}

/// Returns for each vertex the value of the segment that is closest relative to its radius.
std::vector<float> vertex_values(const LiveSurface& surface, const SceneObject& object, StudioColor color,
                                 const Context& ctx) {
    const CapsuleTree capsules(std::get<Skeleton>(object.value), surface.origin(), ctx);
    const bool deviation = color == StudioColor::deviation;
    const std::vector<float> values = deviation ? std::vector<float>() : node_values(object, color);
    std::vector<float> out(surface.positions().size());
    for_each_nearest(
        capsules, ctx, out.size(), [&](std::size_t i) { return Vec3d(surface.positions()[i]); },
        [&](std::size_t i, const CapsuleTree::Nearest& nearest) {
            if (nearest.capsule == kNoIndex) return;
            out[i] = deviation ? static_cast<float>(nearest.rho - 1)
                               : values[capsules.node(nearest.capsule).index()];
        });
    return out;
}

std::string encode(const Solid& solid, const GeometryHead& head, int cells, const Context& ctx) {
    const SolidField field(solid);
    const Vec3 size = field.surface_bounds().size();
    PolygonizeOptions options;
    options.cell = std::max({size.x, size.y, size.z}) / static_cast<float>(cells);
    const TriMesh mesh = polygonize(field, options, ctx);
    GeometryWriter writer("surface", head, mesh.origin);
    add_surface(writer, mesh.positions, {}, mesh.triangles);
    return writer.finish();
}

std::string encode(const Curve& curve, const GeometryHead& head) {
    std::vector<Vec3> points;
    for (const CurveArc& arc : curve.arcs()) {
        for (int k = 0; k < static_cast<int>(kCurveSteps); ++k)
            points.emplace_back(arc.position(k / kCurveSteps));
    }
    if (!curve.closed()) points.emplace_back(curve.arcs().back().position(1));
    GeometryWriter writer("curve", head, {});
    writer.header()["closed"] = curve.closed();
    writer.add("position", floats(points), 3);
    return writer.finish();
}

std::string encode(const Profile& profile, const GeometryHead& head) {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> first;
    for (const std::vector<Vec2d>& contour : profile.contours()) {
        first.push_back(static_cast<std::uint32_t>(points.size()));
        for (const Vec2d p : contour)
            points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), 0.0f);
    }
    GeometryWriter writer("curve", head, {});
    writer.header()["closed"] = profile.closed();
    writer.add("position", floats(points), 3);
    writer.add("first", first, 1);
    return writer.finish();
}

std::string encode(const PointSet& points, const GeometryHead& head) {
    GeometryWriter writer("points", head, points.origin);
    writer.add("position", floats({points.positions.data(), points.positions.size()}), 3);
    return writer.finish();
}

std::string encode_axes(const SceneObject& object, const GeometryHead& head, StudioColor color) {
    const Skeleton& tree = std::get<Skeleton>(object.value);
    std::vector<std::uint32_t> parents, ids;
    std::vector<std::uint8_t> orders;
    for (const std::uint32_t order : axis_orders(tree))
        orders.push_back(static_cast<std::uint8_t>(std::min<std::uint32_t>(order, 255)));
    for (const NodeId n : nodes(tree)) {
        parents.push_back(tree.parent(n) ? tree.parent(n).index() : 0xffffffff);
        ids.push_back(tree.stable_id(n).index());
    }
    GeometryWriter writer("skeleton", head, tree.origin());
    writer.add("position", floats(tree.positions()), 3);
    writer.add("radius", tree.radii(), 1);
    writer.add("parent", parents, 1);
    writer.add("id", ids, 1);
    writer.add("order", orders, 1);
    if (color != StudioColor::plain) add_values(writer, node_values(object, color));
    return writer.finish();
}

/// Sorts the faces of a surface by slot. `mesh` are its polygons, with texture coordinates. Returns the
/// number of faces of each slot as they are encoded: quads, or triangles of other polygons.
std::vector<std::uint32_t> sort_by_slot(PolygonMesh& mesh, const Surface& surface) {
    const bool has_quads = std::holds_alternative<QuadMesh>(surface.mesh);
    const CompressedRows<std::uint32_t> faces = group_by(surface.slots, surface.materials.size());
    PolygonMesh sorted;
    std::vector<std::uint32_t> counts;
    for (std::size_t slot = 0; slot < faces.size(); ++slot) {
        counts.push_back(0);
        for (const std::uint32_t f : faces[slot]) {
            const auto corners = mesh.face(f);
            const auto places = std::span(mesh.texture).subspan(mesh.first[f], corners.size());
            sorted.add_face(corners);
            sorted.texture.insert(sorted.texture.end(), places.begin(), places.end());
            counts.back() += has_quads ? 1 : static_cast<std::uint32_t>(corners.size()) - 2;
        }
    }
    mesh.corners = std::move(sorted.corners);
    mesh.first = std::move(sorted.first);
    mesh.texture = std::move(sorted.texture);
    return counts;
}

/// Encodes a surface with texture coordinates, divided at its texture seams.
std::string encode_textured(const Surface& surface, std::span<const TexturePoint> texture,
                            const GeometryHead& head) {
    PolygonMesh mesh = make_polygons(surface);
    mesh.texture.assign(texture.begin(), texture.end());
    GeometryWriter writer("surface", head, mesh.origin);
    if (!surface.slots.empty()) writer.header()["slots"] = sort_by_slot(mesh, surface);
    TextureTable table = make_texture_table(mesh.corners, {mesh.texture, {}}, mesh.positions.size());
    const std::vector<Vec3> positions = divide_at_seams(std::span<const Vec3>(mesh.positions), table);
    if (std::holds_alternative<QuadMesh>(surface.mesh)) {
        const std::span<const Quad> quads{reinterpret_cast<const Quad*>(table.of_corner.data()),
                                          table.of_corner.size() / kCornersOfQuad};
        add_surface(writer, positions, quads, {}, &table);
    } else {
        mesh.positions.assign(positions.begin(), positions.end());
        mesh.corners = std::move(table.of_corner);
        add_surface(writer, positions, {}, triangulate(mesh).triangles, &table);
    }
    return writer.finish();
}

/// Returns the texture coordinates of a surface with a material; otherwise they are not displayed.
std::span<const TexturePoint> find_texture(const Surface& surface) {
    if (surface.materials.empty()) return {};
    const auto* polygons = std::get_if<PolygonMesh>(&surface.mesh);
    if (surface.texture.empty() && polygons != nullptr) return polygons->texture;
    return surface.texture;
}

std::string encode(const Surface& surface, const GeometryHead& head) {
    if (const auto texture = find_texture(surface); !texture.empty())
        return encode_textured(surface, texture, head);
    if (const auto* quads = std::get_if<QuadMesh>(&surface.mesh)) {
        GeometryWriter writer("surface", head, quads->origin);
        add_surface(writer, quads->positions, quads->quads, {});
        return writer.finish();
    }
    const TriMesh mesh = to_triangles(surface);
    GeometryWriter writer("surface", head, mesh.origin);
    add_surface(writer, mesh.positions, {}, mesh.triangles);
    return writer.finish();
}

template <class Element>
std::vector<Element> in_ranges(std::span<const Element> all, const std::vector<NumberRange>& ranges) {
    std::vector<Element> out;
    for (const NumberRange& r : ranges) {
        const auto part = all.subspan(r.first, r.count);
        out.insert(out.end(), part.begin(), part.end());
    }
    return out;
}

/// Computes the normals of the vertices in the ranges from all adjacent quads.
std::vector<std::int8_t> normals_in(const LiveSurface& surface, const std::vector<NumberRange>& ranges) {
    const std::span<const Vec3> positions = surface.positions();
    std::vector<std::uint8_t> wanted(positions.size());
    for (const NumberRange& r : ranges) std::fill_n(wanted.begin() + r.first, r.count, std::uint8_t{1});
    std::vector<Vec3> normals(positions.size());
    for (const Quad& q : surface.quads()) {
        if ((wanted[q[0]] | wanted[q[1]] | wanted[q[2]] | wanted[q[3]]) != 0)
            add_face_normal(positions, q, normals);
    }
    return packed(in_ranges<Vec3>(normals, ranges));
}

Json make_json(const std::vector<NumberRange>& ranges) {
    Json out = Json::array();
    for (const NumberRange& r : ranges) out.push_back({r.first, r.count});
    return out;
}

std::optional<std::pair<Vec3d, Vec3d>> corners(const Box3& box, Vec3d origin = {}) {
    if (box.empty()) return std::nullopt;
    return std::pair(origin + Vec3d(box.low), origin + Vec3d(box.high));
}

}  // namespace

struct GeometryWriter::Body {
    Json header;
    Json arrays = Json::array();
    std::string bytes;
};

GeometryWriter::GeometryWriter(std::string_view kind, const GeometryHead& head, Vec3d origin)
    : body_(std::make_unique<Body>()) {
    body_->header["kind"] = kind;
    body_->header["object"] = {{"kind", name_of(head.kind)}, {"name", head.name}};
    body_->header["version"] = head.version;
    body_->header["origin"] = {origin.x, origin.y, origin.z};
    if (head.seq) body_->header["seq"] = *head.seq;
}

GeometryWriter::~GeometryWriter() = default;

Json& GeometryWriter::header() { return body_->header; }

void GeometryWriter::add_bytes(std::string_view name, std::string_view type, std::span<const std::byte> bytes,
                               std::size_t size, std::size_t count) {
    pad(body_->bytes, '\0');
    body_->arrays.push_back({{"name", name},
                             {"type", type},
                             {"size", size},
                             {"count", count / size},
                             {"offset", body_->bytes.size()}});
    body_->bytes.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void GeometryWriter::add(std::string_view name, std::span<const float> numbers, std::size_t size) {
    add_bytes(name, "f32", std::as_bytes(numbers), size, numbers.size());
}
void GeometryWriter::add(std::string_view name, std::span<const std::uint32_t> numbers, std::size_t size) {
    add_bytes(name, "u32", std::as_bytes(numbers), size, numbers.size());
}
void GeometryWriter::add(std::string_view name, std::span<const std::uint8_t> numbers, std::size_t size) {
    add_bytes(name, "u8", std::as_bytes(numbers), size, numbers.size());
}
void GeometryWriter::add(std::string_view name, std::span<const std::int8_t> numbers, std::size_t size) {
    add_bytes(name, "i8", std::as_bytes(numbers), size, numbers.size());
}

std::string GeometryWriter::finish() {
    body_->header["arrays"] = std::move(body_->arrays);
    std::string text = body_->header.dump();
    pad(text, ' ');
    std::string out = "CPB1";
    out.reserve(2 * kAlignment + text.size() + body_->bytes.size() + kAlignment);
    append_number(out, static_cast<std::uint32_t>(text.size()));
    out += text;
    out += body_->bytes;
    pad(out, '\0');
    return out;
}

std::string encode_object(const SceneObject& object, const GeometryHead& head, int cells, StudioColor color,
                          const Context& ctx) {
    if (object.kind() == ObjectKind::skeleton) return encode_axes(object, head, color);
    if (object.kind() == ObjectKind::material) throw InvalidInput("a material has no shape");
    if (color != StudioColor::plain)
        throw InvalidInput(
            fmt::format("only skeletons and their surfaces can be coloured by {}", name_of(color)));
    if (const auto* solid = std::get_if<Solid>(&object.value)) return encode(*solid, head, cells, ctx);
    if (const auto* curve = std::get_if<Curve>(&object.value)) return encode(*curve, head);
    if (const auto* profile = std::get_if<Profile>(&object.value)) return encode(*profile, head);
    if (const auto* points = std::get_if<PointSet>(&object.value)) return encode(*points, head);
    return encode(std::get<Surface>(object.value), head);
}

std::string encode_live_surface(const LiveSurface& surface, const SceneObject& tree, const GeometryHead& head,
                                StudioColor color, const Context& ctx) {
    GeometryWriter writer("surface", head, surface.origin());
    add_surface(writer, surface.positions(), surface.quads(), {});
    if (color != StudioColor::plain) add_values(writer, vertex_values(surface, tree, color, ctx));
    return writer.finish();
}

std::string encode_patch(const LiveSurface& surface, const SurfaceChange& change, const GeometryHead& head,
                         std::uint64_t base) {
    GeometryWriter writer("patch", head, surface.origin());
    writer.header()["base"] = base;
    writer.header()["ranges"] = {{"vertices", make_json(change.vertices)},
                                 {"quads", make_json(change.quads)}};
    writer.header()["vertices"] = surface.positions().size();
    writer.header()["quads"] = surface.quads().size();
    const std::vector<Vec3> positions = in_ranges(surface.positions(), change.vertices);
    const std::vector<Quad> quads = in_ranges(surface.quads(), change.quads);
    writer.add("position", floats(positions), 3);
    writer.add("normal", normals_in(surface, change.vertices), 4);
    writer.add("quads", numbers(quads), kCornersOfQuad);
    return writer.finish();
}

std::optional<std::pair<Vec3d, Vec3d>> compute_bounds(const SceneObject& object) {
    if (const auto* solid = std::get_if<Solid>(&object.value)) return corners(solid->surface_bounds());
    if (const auto* curve = std::get_if<Curve>(&object.value)) return corners(curve->bounds());
    if (const auto* points = std::get_if<PointSet>(&object.value))
        return corners(bounds(*points), points->origin);
    if (const auto* tree = std::get_if<Skeleton>(&object.value))
        return corners(tree->bounds(), tree->origin());
    if (const auto* profile = std::get_if<Profile>(&object.value)) {
        return std::pair(Vec3d(profile->low().x, profile->low().y, 0),
                         Vec3d(profile->high().x, profile->high().y, 0));
    }
    if (object.kind() == ObjectKind::material) return std::nullopt;
    return std::visit(
        [](const auto& mesh) {
            Box3 box;
            for (const Vec3 p : mesh.positions) box.extend(p);
            return corners(box, mesh.origin);
        },
        std::get<Surface>(object.value).mesh);
}

ObjectCount count_elements(const SceneObject& object) {
    if (const auto* points = std::get_if<PointSet>(&object.value)) return {points->size(), "points"};
    if (const auto* tree = std::get_if<Skeleton>(&object.value)) return {tree->size(), "nodes"};
    if (const auto* surface = std::get_if<Surface>(&object.value)) return {face_count(*surface), "faces"};
    if (const auto* solid = std::get_if<Solid>(&object.value)) return {solid->part_count(), "parts"};
    if (const auto* profile = std::get_if<Profile>(&object.value))
        return {profile->contours().size(), "contours"};
    if (object.kind() == ObjectKind::material) return {0, ""};
    return {std::get<Curve>(object.value).span_count(), "pieces"};
}

}  // namespace coppice
