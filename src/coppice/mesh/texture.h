#pragma once

namespace coppice {

/// Where a corner of a face lies on a texture that repeats: u goes around, v along. Two corners at one vertex
/// may lie at different places, which makes a seam.
struct TexturePoint {
    float u = 0;  ///< [turns] around; [0, 1]
    float v = 0;  ///< along; as much as u where the texture is as high as it is wide
    friend bool operator==(TexturePoint, TexturePoint) = default;  ///< both coordinates
};

}  // namespace coppice
