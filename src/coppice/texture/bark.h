#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The patterns of bark.
enum class BarkKind {
    furrowed,     ///< ridges that join and part, with furrows between them: oak, ash
    plated,       ///< thick plates of many thin flakes: pine
    scaly,        ///< small overlapping scales with lifted edges: spruce
    exfoliating,  ///< smooth bark that falls off in flakes, and is the paler the later it did: plane
    lenticels,    ///< smooth bark with bands of lenticels that peels across: birch
    smooth,       ///< smooth bark with scars of lost branches: beech
    fibrous,      ///< ridges that split and merge, of strips of fibres that peel off: cedar
    ringed,       ///< scars of leaves around the stem: palm
    shoot,        ///< green bark of a shoot, with fine striae and scars of leaves
};

template <>
struct EnumNames<BarkKind> {
    static constexpr std::array<std::string_view, 9> names{
        "furrowed", "plated", "scaly", "exfoliating", "lenticels", "smooth", "fibrous", "ringed", "shoot"};
};

/// Parameters of a tileable set of textures of bark; the defaults are those of an oak. u runs around the
/// stem, v along it.
struct BarkOptions {
    BarkKind kind = BarkKind::furrowed;  ///< pattern
    int width = 1024;                    ///< [pixels] of the tile, along u; in [1, 4096]
    int height = 1024;                   ///< [pixels] of the tile, along v; in [1, 4096]
    float tile_width = 0.5f;             ///< [m] extent of the tile along u; in [0.001, 10]
    float tile_height = 0.5f;            ///< [m] extent of the tile along v; in [0.001, 10]
    /// [m] diameter of the stem: the ratio to mature_diameter is the age of the bark; in [0.001, 10].
    float diameter = 0.6f;
    float mature_diameter = 0.6f;  ///< [m] diameter with fully developed bark; in [0.001, 10]
    float spacing =
        0.034f;            ///< [m] mean distance of ridges, plates, strips, rings or lenticels; in [1e-4, 1]
    float stretch = 5;     ///< length along v of a ridge or plate per width; in [0.02, 100]
    float depth = 0.016f;  ///< [m] height of fully developed ridges or plates; in [0, 0.2]
    float irregularity = 1;          ///< factor of all distortions of the pattern; in [0, 3]
    float detail = 1;                ///< factor of the fine roughness of the surface; in [0, 3]
    float patches = 0.3f;            ///< amount of lichen, scars or black patches; in [0, 1]
    float roughness = 0.88f;         ///< mean of the roughness map; in [0.05, 1]
    float occlusion_radius = 0.02f;  ///< [m] distance at which a ridge shades its surroundings; in [1e-4, 1]
    std::optional<Vec3d> color = std::nullopt;  ///< sRGB in [0, 1] of the outer surface; default: of the kind
    std::optional<Vec3d> deep_color = std::nullopt;   ///< the same of furrows and inner layers
    std::optional<Vec3d> patch_color = std::nullopt;  ///< the same of lichen, lenticels and scars
    int seed = 0;                                     ///< seed of all random numbers; in [0, 2^31 - 1]
};

/// Lists the members for front ends.
void list_fields(BarkOptions& o, FieldList& list);

/// A species with its options.
struct BarkSpecies {
    std::string_view name;   ///< "oak"
    std::string_view title;  ///< "pedunculate oak, old stem"
    BarkOptions options;     ///< parameters of a mature stem
};

/// Returns all species in order of their kinds; the first one of each kind is the typical one.
std::span<const BarkSpecies> bark_species();

/// Returns the options of a species, or of the typical species of a kind of this name; nullopt for other
/// names.
std::optional<BarkOptions> find_bark(std::string_view name);

/// Makes texels square, unless both the height in pixels and the extent along the stem are given: the extent
/// follows from the height in pixels, or has the proportions of the species, from which the height in pixels
/// follows.
void make_texels_square(BarkOptions& options, const BarkOptions& species, bool has_height,
                        bool has_tile_height);

/// The maps of a tile of bark, row by row from the top (v = 1) down.
struct BarkMaps {
    using Texel = std::array<std::uint8_t, 3>;  ///< three channels of 8 bits

    int width = 0;                        ///< [pixels]
    int height = 0;                       ///< [pixels]
    float low = 0;                        ///< [m] height of the value 0 of `heights`
    float high = 0;                       ///< [m] height of the value 65535 of `heights`
    float tile_width = 0;                 ///< [m] extent of the tile along u
    float tile_height = 0;                ///< [m] extent of the tile along v
    std::vector<Texel> color;             ///< sRGB base colour, without light and shade
    std::vector<Texel> normal;            ///< linear; tangent space, green up (v), as in glTF
    std::vector<std::uint8_t> roughness;  ///< linear
    std::vector<std::uint8_t> occlusion;  ///< linear; 255 is not occluded
    std::vector<std::uint16_t> heights;   ///< linear from `low` to `high`

    std::size_t size() const { return color.size(); }  ///< number of texels
    /// Returns occlusion, roughness and metalness (0) in red, green and blue, as glTF packs them.
    std::vector<Texel> packed() const;
};

/// Returns the maps of a tile that continues without a seam on all sides. The same options give the same bits
/// for any number of threads. Distances of the pattern are rounded such that a whole number of them fits into
/// the tile; details below two texels fade out. Normals are those of the heights in metres; occlusion is
/// computed by the horizons in 16 directions within `occlusion_radius`, at most 64 texels. The outer surface
/// is equally bright in all thirds of the tile, so that repetitions do not show from afar.
///
/// Cost: 0.25 to 0.5 microseconds of CPU time per texel, of which the occlusion needs a tenth; 18 bytes of
/// memory per texel while it runs, 10 afterwards. Throws InvalidInput if an option is out of range, or the
/// tile has more than 1000 ridges or plates along a side; Cancelled.
///
/// Sources: gradient noise [Perlin1985], cells [Worley1996], horizons [Max1988].
BarkMaps make_bark(const BarkOptions& options, const Context& ctx = {});

}  // namespace coppice
