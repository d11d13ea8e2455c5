// write_samples FOLDER: writes the GLB files that the Khronos validator and MikkTSpace check.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <variant>

#include "coppice/io_mesh/motion_writer.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/png.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/system/file.h"

namespace {

using namespace coppice;

/// A torus of n x n quads; `flat` flattens it until faces have no area and normals no direction.
QuadMesh torus(std::uint32_t n, float flat) {
    QuadMesh mesh;
    const float step = 6.2831853f / static_cast<float>(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t k = 0; k < n; ++k) {
            const float a = step * static_cast<float>(i);
            const float b = step * static_cast<float>(k);
            const float r = 2 + std::cos(b);
            mesh.positions.push_back(Vec3{r * std::cos(a), r * std::sin(a), std::sin(b)} * flat);
            mesh.quads.push_back(
                {i * n + k, (i + 1) % n * n + k, (i + 1) % n * n + (k + 1) % n, i * n + (k + 1) % n});
        }
    }
    return mesh;
}

/// Writes a small image of one colour.
std::filesystem::path write_image(const std::filesystem::path& path, Image::Pixel color) {
    Image image(4, 4);
    std::ranges::fill(image.pixels, color);
    write_file(path, encode_png(image));
    return path;
}

/// Writes a tree with a material that is bent more in each frame.
void write_moving_bark(const std::filesystem::path& path, const Skeleton& tree,
                       const MaterialFiles& material) {
    MeshOptions options;
    options.texture = {.coordinates = TextureCoordinates::bark, .tile = 0.1f, .blend = true};
    const MeshResult made = mesh_skeleton(tree, options);
    const QuadMesh& rest = made.quads().mesh;
    MotionWriter motion(path, rest, 3, 24, {{made.texture->points, made.texture->blends}, {material}, {}});
    for (const float bend : {0.0f, 0.1f, 0.2f}) {
        Buffer<Vec3> positions = rest.positions;
        for (Vec3& p : positions) p.x += bend * p.z * p.z;
        motion.add(positions);
    }
    motion.finish();
}

/// Writes trees with a material, with overlapping branches that are remeshed.
void write_bark(const std::filesystem::path& folder) {
    MaterialFiles material{.color = write_image(folder / "color.png", {120, 100, 80, 255}),
                           .normal = write_image(folder / "normal.png", {128, 128, 255, 255}),
                           .packed = write_image(folder / "orm.png", {255, 200, 0, 255})};
    MaterialFiles twig = material, cut{.name = "cut", .color = material.color};
    twig.name = "twig";
    const Skeleton tree = random_tree(60, 7, true);
    const auto write = [&](const char* name, MeshMethod method, bool blend = false, SlotOptions slots = {}) {
        MeshOptions options;
        options.method = method;
        options.attributes = true;
        options.texture = {.coordinates = TextureCoordinates::bark, .tile = 0.1f, .blend = blend};
        options.slots = slots;
        const MeshResult made = mesh_skeleton(tree, options);
        std::visit(
            [&](const auto& surface) {
                write_mesh(folder / name, surface.mesh,
                           {.texture = made.texture->points,
                            .texture_blends = made.texture->blends,
                            .attributes = made.attributes,
                            .materials = {material, twig, cut},
                            .face_materials = made.slots});
            },
            made.surface);
    };
    write("bark_quads.glb", MeshMethod::quads);
    write("bark_tetrahedra.glb", MeshMethod::tetrahedra);
    write("bark_cylinders.glb", MeshMethod::cylinders);
    write_moving_bark(folder / "bark_motion.glb", tree, material);
    write("bark_blended.glb", MeshMethod::quads, true);
    const SlotOptions slots{.twigs = true, .twig_diameter = 2 * tree.radii()[30], .cuts = true};
    write("bark_slots.glb", MeshMethod::quads, false, slots);
    material.normal.clear();
    write("bark_without_normals.glb", MeshMethod::quads);
    write("bark_slots_mixed_normals.glb", MeshMethod::quads, false, slots);
}

/// Writes a torus with copies of a textured square and of a triangle without texture.
void write_copies(const std::filesystem::path& folder) {
    Prototype square{"leaf", {}, {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}, 0};
    square.mesh.positions = {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}};
    square.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    Prototype triangle{"bud", {}, {}, 1};
    triangle.mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    triangle.mesh.triangles = {{0, 1, 2}};
    const std::vector<Prototype> prototypes{square, triangle};
    const std::vector<MaterialFiles> materials{
        {.name = "leaf",
         .color = write_image(folder / "leaf_color.png", {80, 120, 40, 255}),
         .normal = write_image(folder / "leaf_normal.png", {128, 128, 255, 255}),
         .base_color = {0.9f, 1, 0.8f},
         .cut_out = true,
         .double_sided = true},
        {.name = "bud", .base_color = {0.4f, 0.3f, 0.1f}}};
    Instances copies;
    copies.origin = {100, 200, 300};
    for (std::uint32_t i = 0; i < 100; ++i) {
        const auto a = static_cast<float>(i);
        copies.prototypes.push_back(i % 3 == 0 ? 1 : 0);
        copies.positions.push_back({3 * std::cos(a), 3 * std::sin(a), 0.1f * a});
        copies.rotations.push_back({0.6f * std::sin(a), 0.8f * std::sin(a), 0, std::cos(a)});
        copies.scales.push_back(i % 3 == 0 ? 1 : 0.5f + 0.01f * a);
        copies.colors.push_back({static_cast<std::uint8_t>(2 * i), 200, 255});
    }
    InstancedParts parts{prototypes, materials, &copies};
    write_mesh(folder / "instanced.glb", torus(8, 1), {.parts = parts});
    parts.storage = InstanceStorage::merged;
    write_mesh(folder / "merged_copies.glb", torus(8, 1), {.parts = parts});
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    QuadMesh mesh = torus(100, 1);  // 10,000 quads, which the writer writes in two blocks
    write_mesh(folder / "plain.glb", mesh);
    mesh.origin = {500000.25, -5200000.5, 310};
    write_mesh(folder / "origin.glb", mesh);
    write_mesh(folder / "tiny.glb", torus(8, 1e-6f));
    write_mesh(folder / "degenerate.glb", torus(8, 0));
    write_mesh(folder / "triangles.glb", triangulate(torus(8, 1)));
    const QuadMesh rest = torus(8, 1);
    MotionWriter motion(folder / "motion.glb", rest, 3, 24);
    for (const float flat : {1.0f, 0.5f, 0.0f}) motion.add(torus(8, flat).positions);
    motion.finish();
    write_bark(folder);
    write_copies(folder);
    return 0;
}
