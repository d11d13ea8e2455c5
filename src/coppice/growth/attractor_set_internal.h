#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {

/// The sum of the unit vectors from a node to the attractors to which it is nearest. In integers, so that
/// contributions can be added and removed exactly, in any order.
struct Pull {
    std::int64_t x = 0, y = 0, z = 0;
    std::uint32_t count = 0;      ///< number of attractors
    std::uint16_t changed = 0;    ///< whether it lost attractors, or is new, since the node last grew
    std::uint16_t attracted = 0;  ///< whether the node was ever the nearest one to an attractor
};

/// The attractors, each with the nearest node within the influence radius, updated when nodes are added. A
/// hierarchy of boxes stores the distance of the nodes to all attractors in a box, so that a new node only
/// visits attractors to which it may be nearest. A place is the index of an attractor in the order of the
/// hierarchy. The result does not depend on the number of threads.
class AttractorSet {
  public:
    struct Target {
        std::uint32_t place = kNoIndex;
        float distance_squared = 0;
    };

    /// Positions must be finite, radii greater than 0.
    AttractorSet(std::span<const Vec3> attractors, float influence, float kill, const Context& ctx);

    std::uint32_t size() const { return static_cast<std::uint32_t>(number_.size()); }
    std::uint32_t spent() const { return spent_; }
    Vec3 position(std::uint32_t place) const {
        const Points& p = points_[place / kWidth];
        return {p.x[place % kWidth], p.y[place % kWidth], p.z[place % kWidth]};
    }

    /// Adds the nodes from `first` on: attractors are reassigned to nodes that are nearer, and are spent
    /// within the kill radius. Of equally near nodes the one with the smallest index is selected.
    void add_nodes(std::span<const Vec3> nodes, std::uint32_t first, std::span<Pull> pulls,
                   const Context& ctx);

    /// Returns the nearest of the attractors that belong to a node; kNoIndex if there are no attractors.
    Target find_nearest(std::uint32_t node, Vec3 at) const;

    /// Returns the nearest attractor that is not spent.
    Target nearest(Vec3 at) const;

    /// Removes an attractor from its node; other nodes may still get it.
    void drop(std::uint32_t place, std::span<Pull> pulls);

    /// Returns the indices of the attractors that are not spent, sorted.
    std::vector<std::uint32_t> remaining() const;

  private:
    static constexpr std::uint32_t kWidth = BoxTree::kWidth;
    using Floats = std::array<float, kWidth>;
    /// Squared distance in the high bits, node in the low bits: the smaller key is the nearer node.
    using Key = std::uint64_t;
    static constexpr Key kSpent = 0;
    static Key make_key(float distance_squared, std::uint32_t node) {
        // The bits of non-negative numbers have the order of the numbers.
        return Key{std::bit_cast<std::uint32_t>(distance_squared)} << 32 | node;
    }
    static std::uint32_t get_node(Key key) { return static_cast<std::uint32_t>(key); }
    static float compute_distance_squared(Key key) {
        return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
    }

    /// The attractors of one box of the level above; unused places are marked as spent.
    struct Points {
        Floats x, y, z;
        std::array<Key, kWidth> key;

        Floats distances_squared(Vec3 p) const {
            Floats d;
            for (std::uint32_t i = 0; i < kWidth; ++i) {
                const float dx = x[i] - p.x, dy = y[i] - p.y, dz = z[i] - p.z;
                d[i] = dx * dx + dy * dy + dz * dz;
            }
            return d;
        }
    };
    struct Boxes {
        Floats low_x, low_y, low_z, high_x, high_y, high_z;
        Floats reach;  ///< maximum squared distance of a key below; -1 if all are spent

        /// Returns lower bounds of the squared distances to the contents of the boxes, including rounding.
        Floats min_distances_squared(Vec3 p) const {
            // Twice the distance outside the range of an axis, exact, without branches that prevent
            // vectorization.
            const auto beyond = [](float low, float x, float high) {
                const float under = low - x, over = x - high;
                return (under + std::abs(under)) + (over + std::abs(over));
            };
            Floats d;
            for (std::uint32_t i = 0; i < kWidth; ++i) {
                const float x = beyond(low_x[i], p.x, high_x[i]);
                const float y = beyond(low_y[i], p.y, high_y[i]);
                const float z = beyond(low_z[i], p.z, high_z[i]);
                d[i] = 0.2499997f * (x * x + y * y + z * z);
            }
            return d;
        }
    };

    /// The contribution of an attractor to the pull of its node.
    struct Link {
        std::uint32_t node;
        std::int32_t x, y, z;
    };
    struct NewNode {
        Vec3 position;
        std::uint32_t node;
        std::uint32_t first;  ///< the first node of the same batch
    };
    using Places = std::vector<std::uint32_t>;

    Key& key(std::uint32_t place) { return points_[place / kWidth].key[place % kWidth]; }
    Key key(std::uint32_t place) const { return points_[place / kWidth].key[place % kWidth]; }
    void copy_boxes(const BoxTree& tree, float reach);
    float offer_below(std::uint32_t level, std::uint32_t group, const NewNode& n, Places& changed);
    float offer_to_points(std::uint32_t group, const NewNode& n, Places& changed);
    void nearest_below(std::uint32_t level, std::uint32_t group, std::uint32_t node, Vec3 at,
                       Target& best) const;
    bool reassign(std::uint32_t place, std::span<const Vec3> nodes, std::span<Pull> pulls);

    Buffer<std::uint32_t> number_;      // index of the attractor at a place
    Buffer<Points> points_;             // by group of places
    std::vector<Buffer<Boxes>> boxes_;  // by level and group; the last level is a single group
    Buffer<Link> link_;                 // by place
    float kill_squared_;
    std::uint32_t spent_ = 0;
};

}  // namespace coppice
