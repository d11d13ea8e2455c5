#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

// Constants of glTF 2.0, sections 3.6 and 5.11.
inline constexpr int kFloat = 5126;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kArrayBuffer = 34962;
inline constexpr int kElementArrayBuffer = 34963;

template <class T>
BasicVec3<T> y_up(BasicVec3<T> v) {
    return {v.x, v.z, -v.y};
}

inline nlohmann::json array_of(Vec3d v) { return nlohmann::json::array({v.x, v.y, v.z}); }

/// Returns a view of a byte range of the single buffer; `target` 0: no target.
nlohmann::json view(std::uint64_t offset, std::uint64_t length, int target);
/// Returns an accessor that describes the contents of a view.
nlohmann::json accessor(std::size_t view, int component, std::uint64_t count, const char* type);
/// Returns the plain brown material of all trees.
nlohmann::json bark_material();

/// Writes everything that precedes the bytes of the buffer. Throws Unsupported if the file would be too
/// large.
void write_glb_head(AtomicFile& file, std::string json, std::uint64_t buffer_bytes);

void write_vectors(AtomicFile& file, std::span<const Vec3> vectors, ProgressPart part, const Context& ctx);
void write_triangles(AtomicFile& file, const MeshView& mesh, ProgressPart part, const Context& ctx);

}  // namespace coppice::io_internal
