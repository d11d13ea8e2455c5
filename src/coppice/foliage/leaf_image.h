#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/foliage/leaf_shape.h"

namespace coppice {

/// An image of a leaf, row by row from the top (v = 1) down.
struct LeafImage {
    using Texel = std::array<std::uint8_t, 3>;  ///< three channels of 8 bits

    int width = 0;                    ///< [pixels]
    int height = 0;                   ///< [pixels]
    std::vector<Texel> color;         ///< sRGB; outside of the leaf the colour of its blade
    std::vector<std::uint8_t> alpha;  ///< covered share of the pixel: 255 inside of the leaf

    std::size_t size() const { return color.size(); }  ///< number of pixels
};

/// Draws the upper side of an unbent leaf with its veins, lobes and teeth: midrib, secondary veins and a net
/// of fine veins. `size` is the number of pixels of the longer side. The colour is that of the blade in sRGB
/// from 0 to 1; white is to be multiplied with the colours of instances. The same bits for any number of
/// threads. Throws InvalidInput for a size that is not in [8, 4096] or a shape that is out of range;
/// Cancelled.
LeafImage make_leaf_image(const LeafShape& shape, int size, Vec3d color = {0.29, 0.384, 0.165},
                          const Context& ctx = {});

}  // namespace coppice
