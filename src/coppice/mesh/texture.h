#pragma once

namespace coppice {

/// Texture coordinates of a corner of a face; the texture repeats. u is around the tube, v along it. Two
/// corners at one vertex may have different coordinates: a texture seam.
struct TexturePoint {
    float u = 0;  ///< [turns] around; [0, 1]
    float v = 0;  ///< along; has the scale of u for a square texture
    friend bool operator==(TexturePoint, TexturePoint) = default;  ///< compares both coordinates
};

}  // namespace coppice
