#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/vec.h"
#include "coppice/texture/bark.h"

namespace coppice {

/// Parameters of a picture of cut wood; the defaults are those of an oak.
struct CutOptions {
    int size = 1024;             ///< [pixels] width and height; in [16, 4096]
    float diameter = 0.4f;       ///< [m] of the cut, bark included, which fills the image; in [0.005, 5]
    float ring_width = 0.0025f;  ///< [m] mean width of an annual ring; in [1e-4, 0.1]
    float ring_contrast = 0.6f;  ///< difference of early and late wood; in [0, 1]
    float late_wood = 0.55f;     ///< share of late wood in a ring; in [0.02, 0.98]
    float pores = 0.8f;          ///< amount of pores in the early wood; in [0, 1]
    float rays = 0.7f;           ///< visibility of rays; in [0, 1]
    float ray_spacing = 0.007f;  ///< [m] mean distance of visible rays; in [1e-4, 1]
    float heartwood = 0.8f;      ///< share of the radius of the wood; in [0, 1]
    float bark_share = 0.06f;    ///< share of bark in the radius; in [0, 0.5]
    float cracks = 0.5f;         ///< amount of cracks by drying; in [0, 1]
    float irregularity = 1;      ///< factor of the deviations of rings from circles; in [0, 3]
    float detail = 1;            ///< factor of the fine roughness of the surface; in [0, 3]
    float roughness = 0.8f;      ///< mean of the roughness map; in [0.05, 1]
    std::optional<Vec3d> color = std::nullopt;        ///< sRGB in [0, 1] of sapwood; default: of an oak
    std::optional<Vec3d> heart_color = std::nullopt;  ///< the same of heartwood
    std::optional<Vec3d> bark_color = std::nullopt;   ///< the same of bark
    int seed = 0;                                     ///< seed of all random numbers; in [0, 2^31 - 1]
};

/// Lists the members for front ends.
void list_fields(CutOptions& o, FieldList& list);

/// A species with its options.
struct CutSpecies {
    std::string_view name;   ///< "oak"
    std::string_view title;  ///< "oak: wide rays, rings of pores"
    CutOptions options;      ///< parameters of a stem
};

/// Returns all species.
std::span<const CutSpecies> cut_species();

/// Returns the options of a species; nullopt for other names.
std::optional<CutOptions> find_cut(std::string_view name);

/// Returns the maps of a picture of cut wood: annual rings around the pith, rays, heartwood, cracks, and a
/// rim of bark. The disc fills the square, as the coordinates of flat ends do (MaterialSlot::cut); its
/// corners continue the bark. Rings of less than two pixels fade out. The same options give the same bits for
/// any number of threads. Cost: 0.2 us per pixel. Throws InvalidInput for options out of range, Cancelled if
/// stopped.
BarkMaps make_cut(const CutOptions& options, const Context& ctx = {});

}  // namespace coppice
