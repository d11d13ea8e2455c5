#include "coppice/scene/surface_leaves.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/box.h"
#include "coppice/render/colors.h"

namespace coppice {
namespace {

/// Divides the colours of the copies of leaves by their maximum in each channel, and returns it.
Vec3 take_maximum_color(const TreeFoliage& tree, std::vector<Rgb>& colors) {
    constexpr float kMin = 1e-4f;
    const auto is_leaf = [&](std::size_t copy) {
        return tree.prototypes[tree.foliage.instances.prototypes[copy]].material == kLeafMaterial;
    };
    Box3 range{{kMin, kMin, kMin}, {kMin, kMin, kMin}};
    for (std::size_t i = 0; i < colors.size(); ++i) {
        if (is_leaf(i)) range.extend(to_linear(colors[i]));
    }
    for (std::size_t i = 0; i < colors.size(); ++i) {
        if (!is_leaf(i)) continue;
        const Vec3 c = to_linear(colors[i]);
        colors[i] = to_srgb(Vec3{c.x / range.high.x, c.y / range.high.y, c.z / range.high.z});
    }
    return range.high;
}

Rgb to_rgb(Vec3d color) {
    Rgb out{};
    for (std::size_t k = 0; k < 3; ++k)
        out[k] =
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[static_cast<int>(k)], 0.0, 1.0)));
    return out;
}

}  // namespace

SurfaceLeaves make_surface_leaves(const Skeleton& skeleton, const LeafSpecies& species,
                                  const BranchletOptions& branchlets, int models, const Context& ctx) {
    SurfaceLeaves out{.tree = make_foliage(skeleton, species.shape, species.rules, branchlets, models, ctx)};
    MaterialFiles leaf{.name = "leaf", .double_sided = true};
    leaf.base_color = take_maximum_color(out.tree, out.tree.foliage.instances.colors);
    out.materials.push_back(std::move(leaf));
    if (out.tree.branchlets > 0) {
        MaterialFiles twig{.name = "branchlet"};
        twig.base_color = to_linear(to_rgb(branchlets.color.value_or(kTwigColor)));
        out.materials.push_back(std::move(twig));
    }
    return out;
}

std::vector<RenderMaterial> make_render_materials(const SurfaceLeaves& leaves) {
    constexpr float kTransmission = 0.45f;  // of a leaf relative to its reflection [Jacquemoud1990]
    std::vector<RenderMaterial> out;
    for (std::size_t i = 0; i < leaves.materials.size(); ++i) {
        RenderMaterial material{.base_color = leaves.materials[i].base_color};
        if (i == kLeafMaterial) material.transmission = kTransmission;
        out.push_back(std::move(material));
    }
    return out;
}

std::uint64_t compute_memory(const SurfaceLeaves& leaves) {
    constexpr std::uint64_t kBytesOfCopy = 40;
    std::uint64_t bytes = kBytesOfCopy * leaves.tree.foliage.instances.size();
    for (const Prototype& p : leaves.tree.prototypes)
        bytes += p.mesh.positions.size() * sizeof(Vec3) + p.mesh.triangles.size() * sizeof(Triangle) +
                 p.texture.size() * sizeof(TexturePoint);
    return bytes;
}

}  // namespace coppice
