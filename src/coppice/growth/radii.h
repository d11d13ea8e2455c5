#pragma once

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of the pipe model.
struct RadiiOptions {
    float tip_radius = 0.01f;    ///< [m] of tips; in [1e-6, 1e4]
    float pipe_exponent = 2.5f;  ///< r^e of a node is the sum over its children: 2 preserves the sum of the
                                 ///< cross-sections, greater values make thinner trunks; in [2, 3]
    float leaf_share = 0.02f;  ///< contribution of every segment, as a fraction of a tip, so that unbranched
                               ///< axes taper; 0 = off; in [0, 1]
};

/// Lists the members for front ends.
void list_fields(RadiiOptions& o, FieldList& list);

/// Returns the skeleton with radii of the pipe model [Shinozaki1964]. Throws InvalidInput if an option is out
/// of range. O(n).
Skeleton with_pipe_radii(const Skeleton& skeleton, const RadiiOptions& options = {});

}  // namespace coppice
