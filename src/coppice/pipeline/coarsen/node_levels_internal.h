#pragma once

#include <cstdint>
#include <vector>

#include "coppice/pipeline/coarsen/refined_grid_internal.h"
#include "coppice/pipeline/knots/slices_internal.h"

namespace coppice::pipeline_internal {

/// [m] The largest radius of an axis. Balls at roots with several branches do not count.
float thickest_radius(const Skeleton& tubes);

/// How often a polygon of so many sides is to be subdivided for its sides to be as far from a circle, in the
/// middle, as given [m]; to the nearest whole number, at least 0.
int level_for_chord(float radius, std::uint32_t sides, float chord_error);

/// [m] How far its sides are then from the circle.
float chord_error_at(float radius, std::uint32_t sides, int level);

/// Returns per node of the tubes how often the cage is to be subdivided there for chords to be as far from
/// their circles as given [m]; 0 = as far as around the thickest axis at all levels. Polygons then have sides
/// by the square root of the radius. Where several tubes meet, the thickest one decides. O(nodes).
std::vector<std::uint8_t> node_levels_by_radius(const Slices& slices, float chord_error);

/// The same, but more where sections are not round, as at branch nodes: until no refined vertex is farther
/// from a chord than three times what it is in a circle. Tubes of which something was remeshed stay as they
/// are. O(quads).
std::vector<std::uint8_t> node_levels(const RefinedGrid& grid, float chord_error);

/// How far the middle of a side of a regular polygon is from its circle of radius 1.
double sagitta(double sides);

/// One ring of vertices around a tube.
struct TubeRing {
    std::uint32_t row = 0;  ///< of the refined row that it begins
    int level = 0;          ///< it has so many vertices as the cage has after so many subdivisions
};

/// The rings that a tube keeps of 2^levels + 1, where it begins with the one at level `begin` and ends with
/// that at level `end`: 2^rows rows of quads or more, where both levels are the same just so many. Next to
/// the finer end levels change by one from ring to ring, within the length of one row, and there is a refined
/// ring between two rings of different levels. `rows` is at least the lesser of both levels and at most
/// max_rows().
std::vector<TubeRing> rings_between(int begin, int end, int rows, int levels);

/// Largest number of rows in rings_between(), as the binary logarithm.
int max_rows(int begin, int end, int levels);

}  // namespace coppice::pipeline_internal
