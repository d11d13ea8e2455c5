#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "coppice/studio/session_internal.h"

namespace coppice::studio_internal {

/// Cells along the longest side of a solid that is seen while something moves.
inline constexpr int kCoarseCells = 24;

/// The surface of a skeleton that a client asks for.
struct SurfaceWish {
    MeshOptions options;
    std::string text;  ///< the options as text, which tells wishes apart
};

/// The options of `surface`: those of mesh, for a surface that follows edits.
SurfaceWish surface_wish(const Request& request);

/// The state of the surface that the client has, by its `have`.
std::optional<std::uint64_t> have_of(const Request& request);

/// The surface of a skeleton as it is now. Throws InvalidInput where it would take too much memory.
const LiveSurfaces::Shown& follow(Studio& studio, const std::string& name, const ObjectPtr& object,
                                  const SurfaceWish& wish, const Context& ctx);

/// What a client that has state `have` needs to have the surface as it is now; nothing where it is that.
std::optional<std::string> encode_since(const LiveSurfaces::Shown& shown, std::optional<std::uint64_t> have,
                                        std::optional<std::uint64_t> seq, StudioColor color,
                                        const Context& ctx);

}  // namespace coppice::studio_internal
