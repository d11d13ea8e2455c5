#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/field/candidate_lists.h"
#include "coppice/field/list_kernel.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Completes regions of boxes that contain all of their points: adds a margin and their seeds.
inline void complete(std::vector<FieldRegion>& regions, std::span<const NodeId> seeds,
                     const Skeleton& skeleton) {
    for (std::size_t r = 0; r < regions.size(); ++r) {
        regions[r].seed = seeds[r];
        regions[r].box = region_box(regions[r].box, skeleton.radius(seeds[r]));
    }
}

/// Positions of the vertices of a cage and of their anchors.
struct CagePlaces {
    std::span<const Vec3> positions, anchors;
};

/// Extends the region of one quad to contain the quad and its anchors.
inline void extend_region(std::vector<FieldRegion>& regions, const ControlMesh& control, std::uint32_t quad,
                          const CagePlaces& places) {
    Box3& box = regions[control.region[quad]].box;
    for (const std::uint32_t v : control.cage.quads[quad]) {
        box.extend(places.positions[v]);
        box.extend(places.anchors[v]);
    }
}

/// Returns the regions of a field in which the surface around some quads of a cage is searched, for any
/// positions of the cage: boxes around quads and anchors. Regions without any of the quads have empty boxes.
inline std::vector<FieldRegion> field_regions(const ControlMesh& control,
                                              std::span<const std::uint32_t> quads, const CagePlaces& places,
                                              const Skeleton& skeleton) {
    std::vector<FieldRegion> regions(control.region_node.size());
    for (const std::uint32_t f : quads) extend_region(regions, control, f, places);
    complete(regions, control.region_node, skeleton);
    return regions;
}

/// The same for all quads of a cage at its current positions.
inline std::vector<FieldRegion> field_regions(const ControlMesh& control, const Skeleton& skeleton) {
    std::vector<FieldRegion> regions(control.region_node.size());
    for (std::uint32_t f = 0; f < control.region.size(); ++f)
        extend_region(regions, control, f, {control.cage.positions, control.anchors});
    complete(regions, control.region_node, skeleton);
    return regions;
}

}  // namespace coppice::pipeline_internal
