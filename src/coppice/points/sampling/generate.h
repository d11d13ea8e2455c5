#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/points/point_region.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/density.h"
#include "coppice/points/sampling/lane.h"

namespace coppice {

/// How points lie among each other.
enum class PointPattern {
    poisson_disk,  ///< none nearer than a distance, otherwise random (Lane's method)
    clustered,     ///< the same, and points draw others near (Lane's method)
    uniform,       ///< each independent of all others
    jittered,      ///< one at random in each cube of a lattice
    blue_noise     ///< the most even: those of more random points that are left by sample elimination
                   ///< [Yuksel2015]; levels densities
};

template <>
struct EnumNames<PointPattern> {
    static constexpr std::array<std::string_view, 5> names{"poisson_disk", "clustered", "uniform", "jittered",
                                                           "blue_noise"};
};

/// How many points there are, and how they lie.
struct GenerateOptions {
    PointPattern pattern = PointPattern::poisson_disk;  ///< how they lie to each other
    PointDensity density = PointDensity::uniform;       ///< where they are dense
    float width = 0.1f;  ///< of a shell at the boundary, in units of the field's value; > 0
    float power = 1;     ///< exponent of the value in proportional and inverse densities
    int count = 1000;  ///< points; jittered: about; 0 = as many as keep `distance` (poisson_disk, clustered)
    float distance = 0;       ///< [m] least distance of poisson_disk and clustered; 0 = by `spacing`
    float spacing = 0.75f;    ///< least distance over the one at which `count` points leave no room for
                              ///< another, with the density of the place; clusters take a third of it, the
                              ///< same everywhere
    float cluster_reach = 0;  ///< [m] how far a point draws others; 0 = 4 distances
    float cluster_gain = 4;  ///< density just outside the distance, over what it was; < 1 pushes away instead
    int resolution = 0;      ///< voxels along the longest side of the box; 0 = automatic
    int seed = 0;            ///< another seed, another set
    int max_memory = 4096;   ///< [MiB] what would take more is refused before it starts
};

template <class Self, class Visitor>
requires SameOptions<Self, GenerateOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"pattern", "how points lie among each other"}, o.pattern);
    visit(Field{"density", "how dense points lie, by the value of the field"}, o.density);
    visit(Field{"width", "width of a shell at the boundary, in units of the field's value", Unit::none, 1e-6,
                1e6},
          o.width);
    visit(Field{"power", "exponent of the value in proportional and inverse densities", Unit::none, 0, 16},
          o.power);
    visit(Field{"count", "number of points; 0 = as many as keep the distance", Unit::none, 0, 1e8}, o.count);
    visit(Field{"distance", "least distance between points; 0 = by spacing", Unit::metre, 0, 1e9},
          o.distance);
    visit(Field{"spacing", "least distance over the one at which the points leave no room for another",
                Unit::none, 0, 1},
          o.spacing);
    visit(Field{"cluster_reach", "how far a point of a cluster draws others; 0 = 4 distances", Unit::metre, 0,
                1e9},
          o.cluster_reach);
    visit(Field{"cluster_gain", "factor by which a point raises the density near it", Unit::none, 0, 1e4},
          o.cluster_gain);
    visit(Field{"resolution", "voxels along the longest side of the box; 0 = automatic", Unit::none, 0, 2048},
          o.resolution);
    visit(Field{"seed", "another seed gives another set", Unit::none, 0, 2147483647}, o.seed);
    visit(Field{"max_memory", "MiB that may be used", Unit::none, 1, 1e6}, o.max_memory);
}

/// New points, and why there are no more.
struct GenerateResult {
    PointSet points;                            ///< origin zero
    PointStop stop = PointStop::count_reached;  ///< why it ended
    float distance = 0;                         ///< [m] that is kept; 0 for patterns that keep none
    std::uint64_t tries = 0;                    ///< points drawn, also those that were refused
};

/// Fills a solid, or a shell at its boundary, with points of any pattern and density. `box` should hold the
/// field's support; nothing outside it is filled. The density of every point is above 0 exactly there, not
/// only in its voxel. Poisson disks without a `distance` of the caller's follow the density within some per
/// cent in shells of the field's value: their distance goes with the cube root of the room that points have,
/// and of no shell more are placed than its share. With a `distance`, and in clusters, places that are dense
/// fill up, as in [Lane2002]. Deterministic for any number of threads; the field must be thread safe. Cost:
/// linear in the evaluations of the field, about two for each uniform point and 16 for one of blue noise; see
/// `sample_lane` for the others.
///
/// Throws InvalidInput, one sentence: options out of range, a box without volume, a density of 0 all over the
/// box, too much memory. Throws Cancelled.
GenerateResult generate(const FieldRef& field, const Box3& box, const GenerateOptions& options = {},
                        const Context& ctx = {});

/// The same with a density of the caller's; `density`, `width` and `power` of the options are passed over.
GenerateResult generate(const PointRegion& region, const GenerateOptions& options = {},
                        const Context& ctx = {});

}  // namespace coppice
