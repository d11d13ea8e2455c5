#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/foliage/leaf_species.h"
#include "coppice/foliage/tree_foliage.h"
#include "coppice/io_mesh/instanced_parts.h"
#include "coppice/render/material.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The leaves, flowers and fruit of a surface, with their materials.
struct SurfaceLeaves {
    TreeFoliage tree;  ///< prototypes, places and figures
    /// By Prototype::material: those of "leaf", "branchlet", "flower" and "fruit" that prototypes have.
    std::vector<MaterialFiles> materials;
    std::vector<float> transmissions;  ///< light that passes through relative to the reflected, by material

    /// Returns the copies as writers take them; this object must outlive them.
    InstancedParts parts(InstanceStorage storage = InstanceStorage::instanced) const {
        return {tree.prototypes, materials, &tree.foliage.instances, storage};
    }
};

/// Makes the leaves, flowers and fruit of a species for a skeleton; see make_foliage(). The maximum colours
/// of the copies become the colour of their material, so that formats without colours of copies have a
/// similar one.
SurfaceLeaves make_surface_leaves(const Skeleton& skeleton, const LeafSpecies& species,
                                  const BranchletOptions& branchlets, const OrganOptions& organs, int models,
                                  const Context& ctx = {});

/// Returns the materials for render(), by Prototype::material: light passes through leaves and petals.
std::vector<RenderMaterial> make_render_materials(const SurfaceLeaves& leaves);

/// Returns the approximate memory [bytes].
std::uint64_t compute_memory(const SurfaceLeaves& leaves);

}  // namespace coppice
