#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "coppice/io/mesh/write_internal.h"

namespace coppice::io_internal {

// Values of glTF 2.0, sections 3.6 and 5.11.
inline constexpr int kFloat = 5126;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kArrayBuffer = 34962;
inline constexpr int kElementArrayBuffer = 34963;

template <class T>
BasicVec3<T> y_up(BasicVec3<T> v) {
    return {v.x, v.z, -v.y};
}

inline nlohmann::json array_of(Vec3d v) { return nlohmann::json::array({v.x, v.y, v.z}); }

/// A run of bytes of the one buffer; `target` 0: of no kind.
nlohmann::json view(std::uint64_t offset, std::uint64_t length, int target);
/// What a view holds.
nlohmann::json accessor(std::size_t view, int component, std::uint64_t count, const char* type);
/// The plain brown of all trees.
nlohmann::json bark_material();

/// All that stands before the bytes of the buffer. Throws Unsupported when the file would be too large.
void write_glb_head(AtomicFile& file, std::string json, std::uint64_t buffer_bytes);

void write_vectors(AtomicFile& file, std::span<const Vec3> vectors, ProgressPart part, const Context& ctx);
void write_triangles(AtomicFile& file, const MeshView& mesh, ProgressPart part, const Context& ctx);

}  // namespace coppice::io_internal
