#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/points/point_region.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/dart_throwing.h"
#include "coppice/points/sampling/density.h"

namespace coppice {

/// Distribution of points relative to each other.
enum class PointPattern {
    poisson_disk,  ///< random with a minimum distance (Lane's method)
    clustered,     ///< the same, with attraction between points (Lane's method)
    uniform,       ///< independent
    jittered,      ///< one random point in each cube of a lattice
    blue_noise     ///< most even: random points reduced by sample elimination [Yuksel2015]; flattens density
                   ///< variations
};

template <>
struct EnumNames<PointPattern> {
    static constexpr std::array<std::string_view, 5> names{"poisson_disk", "clustered", "uniform", "jittered",
                                                           "blue_noise"};
};

/// Options of `generate`.
struct GenerateOptions {
    PointPattern pattern = PointPattern::poisson_disk;  ///< distribution relative to each other
    PointDensity density = PointDensity::uniform;       ///< density as a function of the field
    float width = 0.1f;  ///< width of a shell at the boundary, in units of the value of the field; > 0
    float power = 1;     ///< exponent of the value in proportional and inverse densities
    int count = 1000;    ///< number of points; jittered: approximate; 0 = as many as keep `distance`
                         ///< (poisson_disk, clustered)
    float distance = 0;  ///< [m] minimum distance of poisson_disk and clustered; 0 = computed from `spacing`
    float spacing = 0.75f;    ///< minimum distance relative to that at which `count` points fill the region,
                              ///< varying with the density; clusters use a third of it, constant everywhere
    float cluster_reach = 0;  ///< [m] distance up to which a point attracts others; 0 = 4 distances
    float cluster_gain = 4;   ///< factor of the density just beyond the distance; < 1 repels instead
    int resolution = 0;       ///< number of voxels along the longest side of the box; 0 = automatic
    int seed = 0;             ///< random seed
    int max_memory = 4096;    ///< [MiB] maximum memory; larger requests are refused in advance
};

/// Lists the members for front ends.
void list_fields(GenerateOptions& o, FieldList& list);

/// Generated points and the reason for the end.
struct GenerateResult {
    PointSet points;                            ///< origin zero
    PointStop stop = PointStop::count_reached;  ///< reason for the end
    float distance = 0;       ///< [m] minimum distance of the points; 0 for patterns without one
    std::uint64_t tries = 0;  ///< number of points drawn, including rejected ones
};

/// Fills a solid, or a shell at its boundary, with points of any pattern and density. `box` should contain
/// the support of the field; no points are placed outside it. The density of every point itself is above 0,
/// not only that of its voxel. Poisson disks without a specified `distance` follow the density within some
/// per cent in shells of the value of the field: their distance is proportional to the cube root of the
/// volume per point, and each shell gets at most its share of the points. With a `distance`, and in clusters,
/// dense regions fill up, as in [Lane2002]. The result does not depend on the number of threads; the field
/// must be thread-safe. Cost: linear in the evaluations of the field, about two for each uniform point and 16
/// for one of blue noise; see `sample_dart_throwing` for the others.
///
/// Throws InvalidInput for options out of range, a box without volume, a density of 0 in the whole box, or
/// too much memory. Throws Cancelled.
GenerateResult generate(const FieldRef& field, const Box3& box, const GenerateOptions& options = {},
                        const Context& ctx = {});

/// Fills a region with a custom density; ignores `density`, `width` and `power` of the options.
GenerateResult generate(const PointRegion& region, const GenerateOptions& options = {},
                        const Context& ctx = {});

}  // namespace coppice
