#include "coppice/growth/radii.h"

#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/skeleton/pipe_model.h"

namespace coppice {

Skeleton with_pipe_radii(const Skeleton& skeleton, const RadiiOptions& options) {
    check_fields(options, "radii");
    const std::vector<double> wide =
        pipe_radii(skeleton.parents(), options.tip_radius, options.pipe_exponent, options.leaf_share);
    std::vector<float> radii;
    radii.reserve(wide.size());
    for (const double r : wide) radii.push_back(static_cast<float>(r));
    return Skeleton({skeleton.parents().begin(), skeleton.parents().end()},
                    {skeleton.positions().begin(), skeleton.positions().end()}, std::move(radii),
                    skeleton.origin());
}

}  // namespace coppice
