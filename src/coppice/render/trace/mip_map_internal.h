#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/mesh/texture.h"
#include "coppice/render/image.h"

namespace coppice {

/// How the bytes of an image are decoded: sRGB to linear light, or as fractions of 255.
enum class TexelEncoding : std::uint8_t { srgb, linear };

/// An image with levels of half the size down to one texel, which repeats. Each level is the mean of the
/// areas that its texels cover, in decoded values; sizes need not be powers of two. Refers to the image.
class MipMap {
  public:
    /// Builds the levels in parallel. The result does not depend on the number of threads. O(pixels); levels
    /// take four bytes per pixel of the image.
    MipMap(const Image& image, TexelEncoding encoding, const Context& ctx);

    /// Returns the value at a place of the texture, v up; interpolates between texels and between levels.
    Vec3 sample(float u, float v, float level) const;
    /// Returns the level for a change of texture coordinates between two adjacent samples, (du_dx, dv_dx) to
    /// the right and (du_dy, dv_dy) down.
    float level(float du_dx, float dv_dx, float du_dy, float dv_dy) const;

    /// [pixels] Sizes of a level; level 0 is the image.
    int width(std::size_t level) const { return level == 0 ? image_.width : levels_[level - 1].width; }
    int height(std::size_t level) const { return level == 0 ? image_.height : levels_[level - 1].height; }
    std::size_t level_count() const { return levels_.size() + 1; }
    /// Returns a decoded texel; row 0 is at the top.
    Vec3 texel(std::size_t level, int x, int y) const;

  private:
    struct Level {
        int width = 0, height = 0;
        std::vector<Vec3> texels;
    };

    Level halved(std::size_t level, const Context& ctx) const;
    Vec3 bilinear(std::size_t level, float u, float v) const;

    const Image& image_;
    std::vector<float> decoded_;  ///< of each byte
    std::vector<Level> levels_;   ///< from half the size down
};

/// Returns whether the alpha of a repeating image, interpolated between its pixels, is below one half; v is
/// up. The image must not be empty, the coordinates finite.
bool is_cut_out(const Image& image, TexturePoint at);

}  // namespace coppice
