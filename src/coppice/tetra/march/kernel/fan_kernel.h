#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"

namespace coppice::tetra_kernel {

/// The triangles around a vertex on the surface.
enum class Fan : std::uint8_t {
    none,
    single,        ///< one closed way around it, of three or more, that comes to no corner twice
    non_manifold,  ///< anything else
    unknown        ///< to be looked at
};

/// Two corners of a triangle that follow a vertex on the surface: fine vertices, or fine edges that are cut,
/// named in some way that is the same from all sides.
template <class Key>
struct LinkSegment {
    Key from;  ///< the corner that comes first
    Key to;    ///< the other one
};

/// What the triangles around one vertex make, in whatever order they come. O(square of their number).
template <class Key>
COPPICE_HOST_DEVICE Fan judge_fan(std::span<const LinkSegment<Key>> segments) {
    if (segments.empty()) return Fan::none;
    // From each segment to the first that goes on from its end: only from a single closed way without a
    // corner that it comes to twice does this see all segments before it is back.
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

/// The triangles around a vertex as far as they are listed. Where two corners of a fan have the same key the
/// walk does not see all of it, as each corner is a start: so what looks like a single fan is one.
struct ListedFan {
    static constexpr std::uint32_t kMost = 8;      ///< others are left unknown
    using Key = std::uint16_t;                     ///< see key_of
    std::array<LinkSegment<Key>, kMost> segments;  ///< in any order

    /// The name of a fine vertex, or of the edge between two; the same in whichever order.
    COPPICE_HOST_DEVICE static Key key_of(std::uint32_t a, std::uint32_t b) {
        return static_cast<Key>((std::min(a, b) * 0x9e3779b1u + std::max(a, b) * 0x85ebca77u) >> 16);
    }

    /// What `size` triangles make, of which those beyond the most were not listed; those that may be
    /// non-manifold are left unknown.
    COPPICE_HOST_DEVICE Fan judge(std::uint32_t size) const {
        if (size > kMost) return Fan::unknown;
        const Fan fan = judge_fan(std::span<const LinkSegment<Key>>(segments.data(), size));
        return fan == Fan::non_manifold ? Fan::unknown : fan;
    }
};

}  // namespace coppice::tetra_kernel
