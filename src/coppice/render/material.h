#pragma once

#include <optional>

#include "coppice/base/vec.h"
#include "coppice/render/image.h"

namespace coppice {

/// Images of the surface of a mesh with texture coordinates, which repeat: u is to the right in them, v up.
/// Any may be empty; their sizes may differ.
struct RenderMaterial {
    Image color;   ///< reflected colour, in sRGB; empty: that of meshes without material
    Image normal;  ///< normals in the frame of the texture: red along u, green along v, blue outward, (n + 1)
                   ///< / 2
    Image roughness;  ///< red channel: 0 reflects as a mirror, 1 is matt; empty: without reflections
    Image occlusion;  ///< red channel: fraction of the light of the sky that arrives; empty: all
    /// Linear colour, multiplied with that of the image; without both, the colour of meshes without material.
    std::optional<Vec3> base_color = {};
    bool cut_out = false;  ///< parts of `color` with an alpha below one half are holes
    /// Light that passes through a thin surface, such as a leaf, relative to the light that it reflects; >=
    /// 0.
    float transmission = 0;
};

}  // namespace coppice
