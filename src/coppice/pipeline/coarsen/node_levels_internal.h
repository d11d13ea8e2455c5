#pragma once

#include <cstdint>
#include <vector>

#include "coppice/pipeline/coarsen/refined_grid_internal.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"

namespace coppice::pipeline_internal {

/// [m] Returns the maximum radius of an axis. Balls at roots with several branches do not count.
float thickest_radius(const Skeleton& tubes);

/// Returns the number of subdivisions of a polygon with this number of sides for its sides to have, in the
/// middle, the given distance [m] from a circle; rounded to the nearest integer, at least 0.
int level_for_chord(float radius, std::uint32_t sides, float chord_error);

/// [m] Returns the resulting distance of its sides from the circle.
float chord_error_at(float radius, std::uint32_t sides, int level);

/// Returns per node of the tubes the number of subdivisions of the cage for chords with the given distance
/// [m] from their circles; 0 = the distance around the thickest axis at all levels. The number of sides of
/// polygons is then proportional to the square root of the radius. Where several tubes meet, the thickest one
/// determines the number. O(nodes).
std::vector<std::uint8_t> node_levels_by_radius(const TubeRows& tube_rows, float chord_error);

/// The same, but more where sections are not circular, as at branch nodes: until no refined vertex is farther
/// from a chord than three times its distance in a circle. Tubes that were partly remeshed stay unchanged.
/// O(quads).
std::vector<std::uint8_t> node_levels(const RefinedGrid& grid, float chord_error);

/// Returns the distance of the middle of a side of a regular polygon from its circle of radius 1.
double sagitta(double sides);

/// One ring of vertices around a tube.
struct TubeRing {
    std::uint32_t row = 0;  ///< the refined row that it begins
    int level = 0;          ///< number of subdivisions of the cage that produces its number of vertices
};

/// Returns the rings that a tube keeps of 2^levels + 1, if it begins with a ring at level `begin` and ends
/// with one at level `end`: at least 2^rows rows of quads, and exactly that number if both levels are equal.
/// Next to the finer end levels change by one from ring to ring, within the length of one row, and there is a
/// refined ring between two rings of different levels. `rows` is at least the smaller of both levels and at
/// most max_rows().
std::vector<TubeRing> rings_between(int begin, int end, int rows, int levels);

/// Returns the maximum number of rows in rings_between(), as the binary logarithm.
int max_rows(int begin, int end, int levels);

}  // namespace coppice::pipeline_internal
