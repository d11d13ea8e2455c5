#pragma once

#include "coppice/base/box.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/points/sampling/density.h"

namespace coppice {

/// Region of points and their density: a function of the value of a field, 0 outside a box. The field is
/// stored by reference.
struct PointRegion {
    FieldRef field;        ///< field that determines the density
    Box3 box;              ///< [m] finite, with a volume; should contain all positions with a density above 0
    DensityCurve density;  ///< density as a function of the value

    /// Returns whether p is in the box, including its border.
    bool contains(Vec3 p) const {
        return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y &&
               p.z >= box.low.z && p.z <= box.high.z;
    }
};

}  // namespace coppice
