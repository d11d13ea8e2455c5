#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "coppice/io/mesh/write_internal.h"

namespace coppice::io_internal {

/// [item, item, ...] with a line break now and then, which USD's parser allows and editors need.
template <class Put>
void write_list(AtomicFile& file, std::size_t count, ProgressPart part, const Context& ctx, const Put& put) {
    file.write("[");
    write_items(file, count, part, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(16);
        chunk.put(i == 0 ? "" : i % 8 == 0 ? ",\n            " : ", ");
        put(i, chunk);
    });
    file.write("]");
}

/// name = [item, item, ...]
template <class Put>
void write_array(AtomicFile& file, std::string_view name, std::size_t count, ProgressPart part,
                 const Context& ctx, const Put& put) {
    file.write(fmt::format("        {} = ", name));
    write_list(file, count, part, ctx, put);
}

void put_tuple(Chunk& chunk, Vec3 v);

/// What stands before the attributes of the mesh; `more` are further lines about the whole file.
void write_head(AtomicFile& file, const MeshView& mesh, std::string_view more = {});

/// What stands behind the attributes of the mesh, and ends the file.
void write_tail(AtomicFile& file, Subdivision subdivision);

/// The least and the greatest corner of the box about the points.
std::string extent_text(std::span<const Vec3> positions);

}  // namespace coppice::io_internal
