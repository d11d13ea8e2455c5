#include "coppice/scene/object.h"

#include <fmt/format.h>

#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

constexpr std::uint64_t kBytesOfNode = 60;

std::string box_text(const Box3& box, Vec3d origin = {}) {
    if (box.empty()) return "empty";
    const Vec3d low = Vec3d(box.low) + origin, high = Vec3d(box.high) + origin;
    return fmt::format("{:.6g},{:.6g},{:.6g} to {:.6g},{:.6g},{:.6g}", low.x, low.y, low.z, high.x, high.y,
                       high.z);
}

std::string described(const Solid& solid) {
    return fmt::format("solid      {}\nparts      {}\ndepth      {}\nsurface    {}\nsupport    {}\n",
                       solid.kind(), solid.part_count(), solid.depth(), box_text(solid.surface_bounds()),
                       box_text(solid.bounds()));
}

std::string described(const Curve& path) {
    return fmt::format("path       {}\npieces     {}\nlength_m   {:.6g}\nbox        {}\n",
                       path.closed() ? "closed" : "open", path.span_count(), path.length(),
                       box_text(path.bounds()));
}

std::string described(const Profile& profile) {
    return fmt::format("profile    {}\ncontours   {}\nbox        {:.6g},{:.6g} to {:.6g},{:.6g}\n",
                       profile.closed() ? "closed" : "open", profile.contours().size(), profile.low().x,
                       profile.low().y, profile.high().x, profile.high().y);
}

std::string described(const PointSet& points) {
    return fmt::format("points     {}\nbox        {}\n", points.size(),
                       box_text(bounds(points), points.origin));
}

std::string described(const Skeleton& skeleton) {
    const SkeletonMeasures m = measure(skeleton);
    return fmt::format(
        "skeleton   {} nodes\ntrees      {}\ntips       {}\nlength_m   {:.6g}\nradius_m   {:.6g} to "
        "{:.6g}\nbox "
        "       {}\n",
        m.nodes, m.trees, m.tips, m.length, m.min_radius, m.max_radius,
        box_text(m.bounds, skeleton.origin()));
}

std::string described(const Surface& surface) {
    Box3 box;
    Vec3d origin;
    std::size_t vertices = 0;
    std::visit(
        [&](const auto& mesh) {
            for (const Vec3 p : mesh.positions) box.extend(p);
            origin = mesh.origin;
            vertices = mesh.positions.size();
        },
        surface.mesh);
    std::vector<std::string> materials;
    for (const SurfaceMaterial& material : surface.materials) {
        if (!material.empty()) materials.push_back(material.files.name);
    }
    std::string text =
        fmt::format("mesh       {} faces\nvertices   {}\nbox        {}\n{}", face_count(surface), vertices,
                    box_text(box, origin),
                    materials.empty() ? "" : fmt::format("material   {}\n", fmt::join(materials, ", ")));
    if (surface.leaves) {
        const FoliageReport& report = surface.leaves->tree.foliage.report;
        text += fmt::format("leaves     {}\nleaf_m2    {:.6g}\nleaf_index {:.6g}\n", report.leaves,
                            report.leaf_area, report.leaf_area_index);
        if (report.flowers > 0) text += fmt::format("flowers    {}\n", report.flowers);
        if (report.fruit > 0) text += fmt::format("fruit      {}\n", report.fruit);
    }
    return text;
}

std::string described(const SurfaceMaterial& material) {
    if (!material.bark)
        return fmt::format("material   {}\nimage      {}\n", material.files.name,
                           material.files.color.string());
    const BarkMaps& maps = *material.bark;
    return fmt::format(
        "material   {}\npixels     {} x {}\ntile_m     {:.6g} x {:.6g}\nheights_m  {:.6g} to {:.6g}\n",
        material.files.name, maps.width, maps.height, maps.tile_width, maps.tile_height, maps.low, maps.high);
}

}  // namespace

std::string with_article(ObjectKind kind) {
    const std::string name(name_of(kind));
    return kind == ObjectKind::points ? name : "a " + name;
}

PolygonMesh make_polygons(const Surface& surface) {
    if (const auto* quads = std::get_if<QuadMesh>(&surface.mesh)) return to_polygons(*quads);
    if (const auto* triangles = std::get_if<TriMesh>(&surface.mesh)) return to_polygons(*triangles);
    return std::get<PolygonMesh>(surface.mesh);
}

TriMesh to_triangles(const Surface& surface) {
    if (const auto* triangles = std::get_if<TriMesh>(&surface.mesh)) return *triangles;
    if (const auto* quads = std::get_if<QuadMesh>(&surface.mesh)) return triangulate(*quads);
    return triangulate(std::get<PolygonMesh>(surface.mesh));
}

std::uint64_t face_count(const Surface& surface) {
    if (const auto* quads = std::get_if<QuadMesh>(&surface.mesh)) return quads->quads.size();
    if (const auto* triangles = std::get_if<TriMesh>(&surface.mesh)) return triangles->triangles.size();
    return std::get<PolygonMesh>(surface.mesh).face_count();
}

std::uint64_t compute_memory(const PointSet& points) { return points.size() * sizeof(Vec3); }

std::uint64_t compute_memory(const Skeleton& skeleton, std::span<const NodeAttribute> attributes) {
    return skeleton.size() * (kBytesOfNode + sizeof(float) * attributes.size());
}

std::uint64_t compute_memory(const Surface& surface) {
    const std::uint64_t vertices =
        std::visit([](const auto& mesh) { return mesh.positions.size(); }, surface.mesh);
    const auto* polygons = std::get_if<PolygonMesh>(&surface.mesh);
    const std::uint64_t corners =
        surface.texture.size() + (polygons == nullptr ? 0 : polygons->texture.size());
    const std::uint64_t blends =
        surface.texture_blends.size() + (polygons == nullptr ? 0 : polygons->texture_blends.size());
    return vertices * sizeof(Vec3) + face_count(surface) * 5 * sizeof(std::uint32_t) +
           corners * sizeof(TexturePoint) + blends * sizeof(TextureBlend) +
           surface.slots.size() * sizeof(std::uint32_t) +
           (surface.leaves ? compute_memory(*surface.leaves) : 0);
}

std::string describe_object(const SceneObject& object) {
    return std::visit([](const auto& value) { return described(value); }, object.value);
}

}  // namespace coppice
