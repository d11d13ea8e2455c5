#pragma once

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The size of a tree as foresters measure it.
struct SizeOptions {
    float height = 10;  ///< [m] of the highest node above the first root; in [0.01, 1000]
    /// [m] diameter of the thickest stem at 1.3 m, or at a quarter of the height of trees below 5.2 m; 0:
    /// radii are scaled with the height; in [0, 50].
    float dbh = 0;
    float tip_radius = 0.004f;  ///< [m] of the thinnest node if there is a dbh; in [1e-5, 10]
    float taper = 0;  ///< share by which the stem is thicker at the ground than at its tip, in addition;
                      ///< in [0, 5]
    float flare = 0;  ///< share by which roots widen the stem at the ground; in [0, 5]
    float flare_height = 0.4f;  ///< [m] at which a 1/e of that is left; in [1e-3, 100]
};

/// Lists the members for front ends.
void list_fields(SizeOptions& o, FieldList& list);

/// The size of a skeleton.
struct TreeSize {
    double height = 0;  ///< [m] of the highest node above the first root
    double dbh = 0;     ///< [m] diameter of the thickest stem; see SizeOptions
    double width = 0;   ///< [m] mean extent of the nodes in x and y
};

/// Returns the size of a skeleton, 0 without nodes. O(n).
TreeSize measure_size(const Skeleton& skeleton);

/// Returns the skeleton scaled about its first root to a height, with a diameter of the thickest stem. All
/// radii are powers of the given ones, so that the thinnest and the stem have the required radii and the
/// order of thickness is unchanged; the exponent is that of the pipe model for the number of twigs that the
/// tree would have. Taper and flare widen the stems.
///
/// Throws InvalidInput if an option is out of range, the tree has no height, or the diameter is not greater
/// than that of tips. O(n).
Skeleton with_size(const Skeleton& skeleton, const SizeOptions& options = {});

}  // namespace coppice
