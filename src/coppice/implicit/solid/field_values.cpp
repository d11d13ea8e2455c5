#include "coppice/implicit/solid/field_values.h"

#include "coppice/base/parallel.h"

namespace coppice {

std::vector<float> values_at(const SolidField& field, std::span<const Vec3> places, const Context& ctx) {
    constexpr std::size_t kGrain = 1024;
    std::vector<float> values(places.size());
    parallel_for_ranges(ctx, places.size(), kGrain, [&](IndexRange r) {
        if (ctx.stop.stop_requested()) return;
        field.values(places.subspan(r.begin, r.size()), std::span(values).subspan(r.begin, r.size()));
    });
    ctx.throw_if_cancelled();
    return values;
}

}  // namespace coppice
