#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/io_points/las_internal.h"
#include "coppice/io_points/laz/chunk_internal.h"

namespace coppice::io_internal {
namespace {

constexpr std::uint64_t kMaxPointsPerByte = 64;

[[noreturn]] void damaged_chunk(const std::string& source, std::size_t chunk, std::size_t chunks) {
    las_trouble(source, fmt::format("its compressed points are damaged: chunk {} of {} cannot be unpacked",
                                    chunk + 1, chunks));
}

std::optional<std::size_t> unpack(const LazChunk& chunk, const LazPacking& packing, LasRecordRange& out,
                                  const Context& ctx) {
    return packing.layered ? unpack_layers(chunk, packing, out, ctx)
                           : unpack_records(chunk, packing, out, ctx);
}

/// Decompresses chunks without a table sequentially: each begins at the end of the previous one. A file that
/// may be truncated ends before the first incomplete chunk.
void unpack_in_turn(std::vector<LazChunk>& chunks, const LazPacking& packing,
                    std::vector<LasRecordRange>& parts, const LasReading& reading, const Context& ctx) {
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        check_in(ctx, i, chunks.size());
        const auto taken = unpack(chunks[i], packing, parts[i], ctx);
        if (!taken) {
            if (!reading.allow_truncated || i == 0) damaged_chunk(reading.source, i, chunks.size());
            parts.resize(i);
            return;
        }
        if (i + 1 < chunks.size()) chunks[i + 1].bytes = chunks[i].bytes.substr(*taken);
    }
}

}  // namespace

std::vector<LasRecordRange> read_laz(std::string_view bytes, const LasHeader& h, const LasReading& reading,
                                     LasColumns& columns, const Context& ctx) {
    const std::string& source = reading.source;
    const LazPacking packing = read_laz_packing(bytes, h, source);
    if (h.count / kMaxPointsPerByte > bytes.size()) {
        las_trouble(
            source,
            "its compressed points are damaged: the header specifies more of them than the file can contain");
    }
    if (h.count == 0) return {};
    std::vector<LazChunk> chunks = find_laz_chunks(bytes, h, packing, reading);
    columns.resize(chunks.back().first + chunks.back().count, reading.wanted, h);
    std::vector<LasRecordRange> parts;
    parts.reserve(chunks.size());
    for (const LazChunk& chunk : chunks) parts.emplace_back(columns, chunk.first, chunk.first + chunk.count);
    if (chunks.size() > 1 && chunks[1].bytes.empty()) {
        unpack_in_turn(chunks, packing, parts, reading, ctx);
        return parts;
    }
    std::vector<std::uint8_t> sound(chunks.size(), 0);
    parallel_with_progress(ctx, chunks.size(), 1, [&](IndexRange range) {
        for (std::size_t i = range.begin; i < range.end; ++i)
            sound[i] = unpack(chunks[i], packing, parts[i], ctx) ? 1 : 0;
    });
    const auto first_bad = std::ranges::find(sound, 0);
    if (first_bad != sound.end())
        damaged_chunk(source, static_cast<std::size_t>(first_bad - sound.begin()), chunks.size());
    return parts;
}

}  // namespace coppice::io_internal
