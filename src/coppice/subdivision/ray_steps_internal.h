#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/implicit/field_ref.h"
#include "coppice/subdivision/project_internal.h"

namespace coppice {

// no_surface: nothing inside down to the anchor; no_crossing: nothing outside up to the end of the ray.
enum class RayOutcome : std::int32_t { running, converged, no_surface, no_crossing };

// Vertices on their rays, anchor + t direction, the surface between `inside` and `outside`. One array per
// number, so that a vector instruction moves many of them.
struct RayLanes {
    using Numbers = std::array<float, kFieldBatch>;

    alignas(64) Numbers anchor_x, anchor_y, anchor_z;
    alignas(64) Numbers direction_x, direction_y, direction_z;
    alignas(64) Numbers t;
    alignas(64) Numbers inside;   // 0 at first: the anchor is taken on trust until a vertex gets near it
    alignas(64) Numbers outside;  // infinite until a point outside is known
    alignas(64) Numbers best_t;
    alignas(64) Numbers best_error;
    alignas(64) std::array<RayOutcome, kFieldBatch> outcome;
    std::array<Vec3, kFieldBatch> point;

    void copy(std::size_t from, std::size_t to) {
        for (Numbers* n : {&anchor_x, &anchor_y, &anchor_z, &direction_x, &direction_y, &direction_z, &t,
                           &inside, &outside, &best_t, &best_error}) {
            (*n)[to] = (*n)[from];
        }
        point[to] = point[from];
    }
};

struct RayRule {
    float per_level;    // 1 / level of the field
    float tolerance;    // of t, as a fraction
    float max_stretch;  // greatest t
    bool slow;          // halve the bracket instead of trusting Newton's rule
};

// One step of the first `count` vertices, by what the field says at their points: Newton's rule on
// value^(2/5) as a function of t^2, kept within the bracket. Sets `outcome` and the new `point`. A vertex's
// bits do not depend on its place.
void advance_rays(RayLanes& rays, std::size_t count, const std::array<FieldSample, kFieldBatch>& samples,
                  const RayRule& rule);

}  // namespace coppice
