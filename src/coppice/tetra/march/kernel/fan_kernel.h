#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"

namespace coppice::tetra_kernel {

/// Configuration of the triangles around a vertex on the surface.
enum class Fan : std::uint8_t {
    none,
    single,        ///< one closed cycle of three or more that visits no corner twice
    non_manifold,  ///< any other configuration
    unknown        ///< not determined yet
};

/// The two corners of a triangle that follow a vertex on the surface: fine vertices, or cut fine edges,
/// identified by keys that do not depend on the tetrahedron.
template <class Key>
struct LinkSegment {
    Key from;  ///< the first corner
    Key to;    ///< the second corner
};

/// Returns the configuration of the triangles around one vertex, given in any order. O(square of their
/// number).
template <class Key>
COPPICE_HOST_DEVICE Fan judge_fan(std::span<const LinkSegment<Key>> segments) {
    if (segments.empty()) return Fan::none;
    // Walks from each segment to the first one that starts at its end: the walk visits all segments before it
    // returns only if they form a single closed cycle that visits no corner twice.
    std::size_t at = 0, steps = 0;
    do {
        std::size_t next = 0;
        while (next < segments.size() && segments[next].from != segments[at].to) ++next;
        if (next == segments.size()) return Fan::non_manifold;
        at = next;
        ++steps;
    } while (at != 0 && steps < segments.size());
    return at == 0 && steps == segments.size() && steps >= 3 ? Fan::single : Fan::non_manifold;
}

/// The triangles around a vertex as far as they are listed. If two corners of a fan have the same key, the
/// walk does not visit all segments, because each corner is a start: a result of a single fan is therefore
/// correct.
struct ListedFan {
    /// maximum number of listed triangles; larger fans remain unknown
    static constexpr std::uint32_t kMax = 8;
    using Key = std::uint16_t;                    ///< see make_key
    std::array<LinkSegment<Key>, kMax> segments;  ///< in any order

    /// Returns the key of a fine vertex, or of the edge between two, independent of their order.
    COPPICE_HOST_DEVICE static Key make_key(std::uint32_t a, std::uint32_t b) {
        return static_cast<Key>((std::min(a, b) * 0x9e3779b1u + std::max(a, b) * 0x85ebca77u) >> 16);
    }

    /// Returns the configuration of `size` triangles, of which those beyond kMax were not listed; fans that
    /// may be non-manifold remain unknown.
    COPPICE_HOST_DEVICE Fan judge(std::uint32_t size) const {
        if (size > kMax) return Fan::unknown;
        const Fan fan = judge_fan(std::span<const LinkSegment<Key>>(segments.data(), size));
        return fan == Fan::non_manifold ? Fan::unknown : fan;
    }
};

}  // namespace coppice::tetra_kernel
