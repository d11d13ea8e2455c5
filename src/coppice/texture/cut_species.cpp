#include <array>

#include "coppice/texture/bark_internal.h"
#include "coppice/texture/cut.h"

namespace coppice {
namespace {

using texture_internal::srgb;

CutOptions with_colors(unsigned color, unsigned heart_color, unsigned bark_color) {
    CutOptions out;
    out.color = srgb(color);
    out.heart_color = srgb(heart_color);
    out.bark_color = srgb(bark_color);
    return out;
}

/// Returns the wood of a conifer: dense late wood, no pores, no visible rays.
CutOptions conifer(unsigned color, unsigned heart_color, unsigned bark_color) {
    CutOptions out = with_colors(color, heart_color, bark_color);
    out.ring_width = 0.0028f;
    out.ring_contrast = 0.85f;
    out.late_wood = 0.3f;
    out.pores = 0;
    out.rays = 0.1f;
    out.ray_spacing = 0.003f;
    out.heartwood = 0.6f;
    return out;
}

/// Returns even wood, with fine pores in the whole ring.
CutOptions diffuse(unsigned color, unsigned heart_color, unsigned bark_color) {
    CutOptions out = with_colors(color, heart_color, bark_color);
    out.ring_contrast = 0.35f;
    out.late_wood = 0.15f;
    out.pores = 0.15f;
    out.rays = 0.3f;
    out.ray_spacing = 0.004f;
    return out;
}

std::vector<CutSpecies> make_species() {
    CutOptions ash = with_colors(0xdcc7a2, 0xb99b74, 0x6f6759);
    ash.rays = 0.15f;
    ash.heartwood = 0.35f;
    CutOptions beech = diffuse(0xd9b995, 0xcaa27c, 0x7d776d);
    beech.rays = 0.7f;
    beech.bark_share = 0.03f;
    CutOptions birch = diffuse(0xe3d0ae, 0xdac29a, 0x8d8579);
    birch.bark_share = 0.045f;
    CutOptions cherry = diffuse(0xdcbc94, 0xae754e, 0x5a4238);
    cherry.bark_share = 0.04f;
    CutOptions apple = diffuse(0xd8b791, 0x9c6a4c, 0x6b5d50);
    apple.bark_share = 0.04f;
    CutOptions willow = diffuse(0xe0cfb2, 0xbf9f86, 0x6a6153);
    willow.ring_width = 0.006f;
    willow.bark_share = 0.08f;
    CutOptions pine = conifer(0xe2c898, 0xbf8450, 0x6a4632);
    pine.bark_share = 0.07f;
    CutOptions larch = conifer(0xdfc08f, 0xa9683f, 0x5c3f30);
    larch.heartwood = 0.85f;
    CutOptions spruce = conifer(0xe6d3ab, 0xe0c99e, 0x6e5648);
    spruce.bark_share = 0.04f;
    return {{"oak", "oak: wide rays, rings of pores", CutOptions{}},
            {"ash", "ash: pale, rings of pores", ash},
            {"beech", "beech: even, many rays", beech},
            {"birch", "birch: pale, faint rings", birch},
            {"cherry", "cherry: red heartwood", cherry},
            {"apple", "apple: brown heartwood", apple},
            {"willow", "willow: wide, faint rings", willow},
            {"pine", "Scots pine: dark late wood, red heartwood", pine},
            {"larch", "larch: wide red heartwood", larch},
            {"spruce", "spruce: pale, dark late wood", spruce}};
}

}  // namespace

std::span<const CutSpecies> cut_species() {
    static const std::vector<CutSpecies> all = make_species();
    return all;
}

}  // namespace coppice
