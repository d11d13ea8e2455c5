#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

/// Writes [item, item, ...] with regular line breaks, which the USD parser allows and editors need.
template <class Put>
void write_list(AtomicFile& file, std::size_t count, ProgressRange part, const Context& ctx, const Put& put) {
    file.write("[");
    write_items(file, count, part, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(16);
        chunk.put(i == 0 ? "" : i % 8 == 0 ? ",\n            " : ", ");
        put(i, chunk);
    });
    file.write("]");
}

/// Writes name = [item, item, ...]
template <class Put>
void write_array(AtomicFile& file, std::string_view name, std::size_t count, ProgressRange part,
                 const Context& ctx, const Put& put) {
    file.write(fmt::format("        {} = ", name));
    write_list(file, count, part, ctx, put);
}

void put_tuple(Chunk& chunk, Vec3 v);

/// Writes everything that precedes the attributes of the mesh; `more` are additional lines of the layer
/// metadata.
void write_head(AtomicFile& file, const MeshView& mesh, std::string_view more = {});

void put_tuple(Chunk& chunk, TexturePoint p);
void put_weight(Chunk& chunk, TextureBlend blend);

/// Writes the texture coordinates, if there are any.
void write_texture(AtomicFile& file, const MeshView& mesh, const Context& ctx);

/// Writes everything that follows the attributes of the mesh, with its materials and copies.
void write_tail(AtomicFile& file, const MeshView& mesh, Subdivision subdivision, const Context& ctx);

/// Returns the minimum and the maximum corner of the bounding box.
std::string extent_text(std::span<const Vec3> positions);

}  // namespace coppice::io_internal
