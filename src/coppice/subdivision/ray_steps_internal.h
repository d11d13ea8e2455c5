#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/implicit/field_ref.h"
#include "coppice/subdivision/project_internal.h"

namespace coppice {

// no_surface: no point inside down to the anchor; no_crossing: no point outside up to the end of the ray.
enum class RayOutcome : std::int32_t { running, converged, no_surface, no_crossing };

// Vertices on their rays, anchor + t direction, with the surface between `inside` and `outside`. One array
// per number, so that a vector instruction moves many of them.
struct RayLanes {
    using Numbers = std::array<float, kFieldBatch>;

    alignas(64) Numbers anchor_x, anchor_y, anchor_z;
    alignas(64) Numbers direction_x, direction_y, direction_z;
    alignas(64) Numbers t;
    alignas(64) Numbers inside;  // initially 0: the anchor is assumed inside until a vertex comes close to it
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
    float max_stretch;  // maximum t
    bool slow;          // bisect the bracket instead of using Newton's method
};

// Moves the first `count` vertices by one step, from the samples of the field at their points: Newton's
// method on value^(2/5) as a function of t^2, limited to the bracket. Sets `outcome` and the new `point`. The
// result for a vertex does not depend on its index.
void advance_rays(RayLanes& rays, std::size_t count, const std::array<FieldSample, kFieldBatch>& samples,
                  const RayRule& rule);

}  // namespace coppice
