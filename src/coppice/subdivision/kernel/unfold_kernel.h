#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/subdivision/kernel/flat_ends.h"
#include "coppice/subdivision/kernel/gradient_kernel.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {

/// The current pass of unfolding a cluster of bad faces, and its parameters: see untangle.
class UnfoldSchedule {
  public:
    /// `passes` and `projected` as in UntangleOptions; `bad`: initial number of bad faces, of a cluster of
    /// `vertices` vertices.
    COPPICE_HOST_DEVICE UnfoldSchedule(int passes, int projected, std::uint32_t bad, std::uint32_t vertices)
        : passes_(static_cast<std::uint32_t>(passes)),
          projected_(static_cast<std::uint32_t>(projected)),
          bad_(bad),
          min_bad_(bad),
          max_moves_(kMaxMoves * vertices) {}

    /// Number of passes begun so far.
    COPPICE_HOST_DEVICE std::uint32_t pass() const { return pass_; }

    /// Begins another pass, unless the cluster is finished.
    COPPICE_HOST_DEVICE bool begin_pass() {
        const std::uint32_t last = (best_pass_ > projected_ ? best_pass_ : projected_) + kMaxStalledPasses;
        if (bad_ == 0 || pass_ >= passes_ || pass_ >= last || moves_ >= max_moves_) return false;
        ++pass_;
        return true;
    }
    /// Returns the number of rings of faces around the bad ones that move too. Free passes begin with the bad
    /// faces alone and extend farther if that does not help.
    COPPICE_HOST_DEVICE int rings() const {
        if (pass_ <= projected_) return kRings;
        const int rings = static_cast<int>(pass_ - projected_ - 1) / kPassesPerRing;
        return rings < kRings ? rings : kRings;
    }
    /// Returns the maximum number of steps along the gradient after smoothing.
    COPPICE_HOST_DEVICE int steps() const { return pass_ <= projected_ ? kSteps : 0; }

    /// Records the number of moved vertices and the current number of bad faces; returns whether this is a
    /// new minimum.
    COPPICE_HOST_DEVICE bool end_pass(std::uint32_t moved, std::uint32_t bad) {
        moves_ += moved;
        bad_ = bad;
        if (bad >= min_bad_) return false;
        min_bad_ = bad;
        best_pass_ = pass_;
        return true;
    }

  private:
    static constexpr int kRings = 2;                        // maximum
    static constexpr int kPassesPerRing = 3;                // before free passes use another ring
    static constexpr int kSteps = 3;                        // while passes project
    static constexpr std::uint32_t kMaxStalledPasses = 10;  // passes without improvement
    // Maximum of the mean number of moves per vertex of a cluster.
    static constexpr std::uint64_t kMaxMoves = 25;

    std::uint32_t passes_, projected_, bad_, min_bad_;
    std::uint32_t pass_ = 0, best_pass_ = 0;
    std::uint64_t moves_ = 0, max_moves_;
};

/// Returns a vertex moved by a share of the distance to the mean of its neighbours. `quads` returns the
/// vertices of a refined quad.
template <class Quads>
COPPICE_HOST_DEVICE Vec3 smoothed(std::uint32_t vertex, std::span<const Vec3> positions,
                                  const PatchStars& stars, const Quads& quads) {
    constexpr float kWeight = 0.6f;
    const Vec3 p = positions[vertex];
    Vec3 way;
    float count = 0;
    stars.for_each_corner(vertex, [&](QuadCorner c) {
        way += positions[quads(c.quad)[(c.corner + 1) & 3]] - p;
        count += 1;
    });
    return p + way * (kWeight / count);
}

/// A vertex on its way back to the surface; on a flat end it stays in the plane.
class Mover {
  public:
    Mover() = default;  ///< undefined position
    /// Begins at the smoothed position of a vertex. `ends` are those of the cage, `clips` their planes.
    COPPICE_HOST_DEVICE Mover(Vec3 smoothed, Vec3 anchor, const FlatEnds::Place& place,
                              std::span<const ClipPlane> clips)
        : plane_(place.end == kNoIndex ? nullptr : &clips[place.end]),
          point_(on_plane(smoothed)),
          reach_(distance(smoothed, anchor)),
          is_inside_end_(plane_ != nullptr && !place.on_rim) {}

    COPPICE_HOST_DEVICE Vec3 point() const { return point_; }  ///< current position

    /// Moves by one step from the reading at the current position; returns false if the vertex has converged.
    COPPICE_HOST_DEVICE bool advance(Reading here) {
        constexpr float kDamping = 0.95f;
        constexpr float kLongestStep = 0.3f;  // in distances to the anchor
        constexpr float kTolerance = 1e-4f;   // of the distance to the anchor
        if (is_inside_end_) return false;
        if (plane_ != nullptr) {
            const Vec3 n = plane_->normal;
            here.gradient -= n * (dot(n, here.gradient) / length_squared(n));
        }
        const float slope_squared = length_squared(here.gradient);
        if (!(slope_squared > 0)) return false;
        Vec3 step = newton_step(here, slope_squared, kDamping);
        const float size = length(step);
        if (!std::isfinite(size)) return false;
        if (size > kLongestStep * reach_) step *= kLongestStep * reach_ / size;
        point_ = on_plane(point_ + step);
        const float left = (1 - kDamping) * size * reach_ + size * size;
        return left > kTolerance * reach_ * reach_;
    }

  private:
    COPPICE_HOST_DEVICE Vec3 on_plane(Vec3 p) const { return plane_ == nullptr ? p : dropped(p, *plane_); }

    const ClipPlane* plane_ = nullptr;
    Vec3 point_;
    float reach_ = 0;
    bool is_inside_end_ = false;
};

}  // namespace coppice
