#include "coppice/skeleton/pipe_model.h"

#include <cmath>
#include <cstdint>

namespace coppice {

std::vector<double> pipe_radii(std::span<const NodeId> parents, double tip_radius, double exponent,
                               double leaf) {
    const double tip = std::pow(tip_radius, exponent);
    std::vector<double> area(parents.size(), 0.0);
    for (std::size_t i = parents.size(); i-- > 0;) {
        const NodeId parent = parents[i];
        if (area[i] == 0) {
            area[i] = tip;
        } else if (parent) {
            area[i] += leaf * tip;
        }
        if (parent) area[parent.index()] += area[i];
    }
    for (double& a : area) a = std::pow(a, 1 / exponent);
    return area;
}

}  // namespace coppice
