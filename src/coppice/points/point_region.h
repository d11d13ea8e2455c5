#pragma once

#include <span>

#include "coppice/base/box.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/points/sampling/density.h"

namespace coppice {

/// Where points may lie, and how densely: a density as a function of a field's value, 0 outside a box. The
/// field is only referred to.
struct PointRegion {
    FieldRef field;        ///< whose values the density is of
    Box3 box;              ///< [m] finite, with a volume; should hold all places where the density is above 0
    DensityCurve density;  ///< by the value

    /// Whether p lies in the box, its border included.
    bool contains(Vec3 p) const {
        return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y &&
               p.z >= box.low.z && p.z <= box.high.z;
    }
    /// The density at one point; costs a batch of the field.
    double density_at(Vec3 p) const {
        if (!contains(p)) return 0;
        FieldSample sample{};
        field.sample(0, std::span(&p, 1), std::span(&sample, 1));
        return density.at(sample.value);
    }
};

}  // namespace coppice
