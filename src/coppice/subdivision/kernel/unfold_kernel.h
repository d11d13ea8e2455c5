#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/subdivision/kernel/flat_ends.h"
#include "coppice/subdivision/kernel/gradient_kernel.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {

/// Which pass of unfolding a cluster of bad faces is in, and what it does: see untangle.
class UnfoldSchedule {
  public:
    /// `passes` and `projected` as in UntangleOptions; so many faces are bad at first, of a cluster of so
    /// many vertices.
    COPPICE_HOST_DEVICE UnfoldSchedule(int passes, int projected, std::uint32_t bad, std::uint32_t vertices)
        : passes_(static_cast<std::uint32_t>(passes)),
          projected_(static_cast<std::uint32_t>(projected)),
          bad_(bad),
          least_bad_(bad),
          most_moves_(kMostMoves * vertices) {}

    /// Passes begun so far.
    COPPICE_HOST_DEVICE std::uint32_t pass() const { return pass_; }

    /// Begins another pass, unless the cluster has come to its end.
    COPPICE_HOST_DEVICE bool begin_pass() {
        const std::uint32_t last = (best_pass_ > projected_ ? best_pass_ : projected_) + kPatience;
        if (bad_ == 0 || pass_ >= passes_ || pass_ >= last || moves_ >= most_moves_) return false;
        ++pass_;
        return true;
    }
    /// Rings of faces around the bad ones that move too. Free passes begin with the bad faces alone and reach
    /// farther where that does not help.
    COPPICE_HOST_DEVICE int rings() const {
        if (pass_ <= projected_) return kRings;
        const int rings = static_cast<int>(pass_ - projected_ - 1) / kPassesPerRing;
        return rings < kRings ? rings : kRings;
    }
    /// Steps along the gradient after smoothing, at most.
    COPPICE_HOST_DEVICE int steps() const { return pass_ <= projected_ ? kSteps : 0; }

    /// Notes how many vertices moved and how many faces are bad now; returns whether so few never were.
    COPPICE_HOST_DEVICE bool end_pass(std::uint32_t moved, std::uint32_t bad) {
        moves_ += moved;
        bad_ = bad;
        if (bad >= least_bad_) return false;
        least_bad_ = bad;
        best_pass_ = pass_;
        return true;
    }

  private:
    static constexpr int kRings = 2;                // at most
    static constexpr int kPassesPerRing = 3;        // before free passes take another ring
    static constexpr int kSteps = 3;                // while passes project
    static constexpr std::uint32_t kPatience = 10;  // passes without gain
    // Of each vertex of a cluster, on average: a tangle is not worth more.
    static constexpr std::uint64_t kMostMoves = 25;

    std::uint32_t passes_, projected_, bad_, least_bad_;
    std::uint32_t pass_ = 0, best_pass_ = 0;
    std::uint64_t moves_ = 0, most_moves_;
};

/// Part of the way from a vertex to the mean of its neighbours. `quads` gives the vertices of a refined quad.
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

/// A vertex on its way back to the surface; on a flat end it keeps to the plane.
class Mover {
  public:
    Mover() = default;  ///< nowhere
    /// From where smoothing put a vertex. `ends` are those of the cage, `clips` their planes.
    COPPICE_HOST_DEVICE Mover(Vec3 smoothed, Vec3 anchor, const FlatEnds::Place& place,
                              std::span<const ClipPlane> clips)
        : plane_(place.end == FlatEnds::kNone ? nullptr : &clips[place.end]),
          point_(on_plane(smoothed)),
          reach_(distance(smoothed, anchor)),
          is_inside_end_(plane_ != nullptr && !place.on_rim) {}

    COPPICE_HOST_DEVICE Vec3 point() const { return point_; }  ///< where it has come to

    /// One step by what the field says there; false when the vertex has arrived.
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
