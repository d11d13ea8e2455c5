#include "coppice/scene/surface_leaves.h"

#include <array>
#include <string>
#include <string_view>

#include "coppice/base/box.h"
#include "coppice/base/srgb.h"
#include "coppice/render/colors.h"

namespace coppice {
namespace {

/// Divides the colours of the copies with a material by their maximum in each channel, and returns it.
Vec3 take_maximum_color(const TreeFoliage& tree, std::uint32_t material, std::vector<Rgb>& colors) {
    constexpr float kMin = 1e-4f;
    const auto has_material = [&](std::size_t copy) {
        return tree.prototypes[tree.foliage.instances.prototypes[copy]].material == material;
    };
    Box3 range{{kMin, kMin, kMin}, {kMin, kMin, kMin}};
    for (std::size_t i = 0; i < colors.size(); ++i) {
        if (has_material(i)) range.extend(to_linear(colors[i]));
    }
    for (std::size_t i = 0; i < colors.size(); ++i) {
        if (!has_material(i)) continue;
        const Vec3 c = to_linear(colors[i]);
        colors[i] = to_srgb(Vec3{c.x / range.high.x, c.y / range.high.y, c.z / range.high.z});
    }
    return range.high;
}

/// A material of the parts of trees.
struct PartMaterial {
    std::string_view name;
    float transmission = 0;  ///< relative to the reflection
};

/// By the indices kLeafMaterial to kFruitMaterial; leaves as measured [Jacquemoud1990].
constexpr std::array<PartMaterial, 4> kPartMaterials{
    {{"leaf", 0.45f}, {"branchlet", 0}, {"flower", 0.5f}, {"fruit", 0}}};

/// Returns which of these materials the prototypes have.
std::array<bool, kPartMaterials.size()> find_used(const std::vector<Prototype>& prototypes) {
    std::array<bool, kPartMaterials.size()> out{};
    for (const Prototype& p : prototypes) out[p.material] = true;
    return out;
}

}  // namespace

SurfaceLeaves make_surface_leaves(const Skeleton& skeleton, const LeafSpecies& species,
                                  const BranchletOptions& branchlets, const OrganOptions& organs, int models,
                                  const Context& ctx) {
    SurfaceLeaves out{.tree = make_foliage(skeleton, species.shape, species.rules, branchlets, models,
                                           {find_organs(species.name), organs}, ctx)};
    TreeFoliage& tree = out.tree;
    const auto used = find_used(tree.prototypes);
    std::array<std::uint32_t, kPartMaterials.size()> index{};
    for (std::uint32_t m = 0; m < kPartMaterials.size(); ++m) {
        if (!used[m]) continue;
        index[m] = static_cast<std::uint32_t>(out.materials.size());
        MaterialFiles files{.name = std::string(kPartMaterials[m].name), .double_sided = m != kTwigMaterial};
        files.base_color = m == kTwigMaterial ? to_linear(to_bytes(branchlets.color.value_or(kTwigColor)))
                                              : take_maximum_color(tree, m, tree.foliage.instances.colors);
        out.materials.push_back(std::move(files));
        out.transmissions.push_back(kPartMaterials[m].transmission);
    }
    for (Prototype& p : tree.prototypes) p.material = index[p.material];
    return out;
}

std::vector<RenderMaterial> make_render_materials(const SurfaceLeaves& leaves) {
    std::vector<RenderMaterial> out;
    for (std::size_t i = 0; i < leaves.materials.size(); ++i) {
        RenderMaterial material{.base_color = leaves.materials[i].base_color};
        material.transmission = leaves.transmissions[i];
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
