#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/pipeline/live/edit_zone_internal.h"
#include "coppice/pipeline/live/patch_store_internal.h"

namespace coppice::pipeline_internal {

/// The nodes of a part that may get another surface if the tubes of some nodes change.
struct AffectedNodes {
    std::vector<std::uint8_t>
        is_wanted;  ///< per node: those near a change, and all that repair patches cover there
    std::vector<StableId> missing;  ///< nodes from which these patches are made and that are not trusted
};
AffectedNodes affected_nodes(const EditZone& zone, std::uint8_t trusted, std::span<const NodeId> changed,
                             const Touched& touched, const PatchStore& store, const Context& ctx);

}  // namespace coppice::pipeline_internal
