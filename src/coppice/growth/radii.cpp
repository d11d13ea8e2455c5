#include "coppice/growth/radii.h"

#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
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

void list_fields(RadiiOptions& o, FieldList& list) {
    list.add(common_field("tip_radius", "Radius of tips.", Unit::metre, 1e-6, 1e4), o.tip_radius);
    list.add(Field{"pipe_exponent", "Exponent of the radii that are added at forks.", Unit::none, 2, 3},
             o.pipe_exponent);
    list.add(Field{"leaf_share", "Contribution of every segment to the pipes, as a fraction of a tip.",
                   Unit::none, 0, 1},
             o.leaf_share);
}

}  // namespace coppice
