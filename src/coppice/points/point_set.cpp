#include "coppice/points/point_set.h"

namespace coppice {

Box3 bounds(const PointSet& points) {
    Box3 box;
    for (const Vec3 p : points.positions) box.extend(p);
    return box;
}

PointSet merged(const PointSet& a, const PointSet& b) {
    if (a.empty()) return b;
    PointSet out = a;
    out.positions.reserve(a.size() + b.size());
    const bool same_origin = a.origin == b.origin;  // avoids rounding
    for (std::size_t i = 0; i < b.size(); ++i) {
        out.positions.push_back(same_origin ? b.positions[i] : Vec3(b.world(i) - a.origin));
    }
    return out;
}

}  // namespace coppice
