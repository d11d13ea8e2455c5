#include "sums.h"

#include "coppice/measure/union_volume.h"

namespace coppice::cli {

void add_sums(Json& out, const SkeletonFile& file, const SkeletonMeasures& measures, const FigureName& name,
              const Context& ctx) {
    out.update({{name("volume_frusta", 3), measures.volume_frusta},
                {name("area_frusta", 2), measures.area_frusta},
                {name("volume_segments", 3), measures.volume},
                {name("area_segments", 2), measures.area}});
    // The ends have the default shapes of surfaces.
    const ConeUnion solid(file.skeleton, file.skeleton.origin(), EndShape::flat, EndShape::round, ctx);
    const UnionVolume united = union_volume(solid, {}, {}, ctx);
    out.update({{name("volume_union", 3), united.total}, {name("volume_union_error", 3), united.error}});
    if (!file.declared) return;
    out.update({{"cylinders", file.declared->cylinders},
                {name("cylinder_length", 1), file.declared->length},
                {name("cylinder_area", 2), file.declared->area},
                {name("cylinder_volume", 3), file.declared->volume}});
}

}  // namespace coppice::cli
