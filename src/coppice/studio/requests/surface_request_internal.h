#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "coppice/studio/session_internal.h"

namespace coppice::studio_internal {

/// Cells along the longest side of a solid that is displayed during a motion.
inline constexpr int kCoarseCells = 24;

/// The surface of a skeleton that a client requests.
struct SurfaceRequest {
    MeshOptions options;
    std::string text;  ///< the options as text, which identifies them
};

/// The options in `surface`: those of mesh, for a surface that follows edits.
SurfaceRequest surface_request(const Request& request);

/// The state of the surface that the client has, from its `have`.
std::optional<std::uint64_t> get_known_version(const Request& request);

/// Returns the current surface of a skeleton. Throws InvalidInput if it would exceed the memory limit.
const LiveSurfaces::Shown& follow(Studio& studio, const std::string& name, const ObjectPtr& object,
                                  const SurfaceRequest& surface, const Context& ctx);

/// Returns the update from state `have` of a client to the current surface; empty if it is current.
std::optional<std::string> encode_since(const LiveSurfaces::Shown& shown, std::optional<std::uint64_t> have,
                                        std::optional<std::uint64_t> seq, StudioColor color,
                                        const Context& ctx);

}  // namespace coppice::studio_internal
