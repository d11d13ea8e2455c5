#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io_points/las_internal.h"

namespace coppice::io_internal {

/// Items of a record that are compressed separately, by their numbers in [Isenburg2013].
enum class LazItem : std::uint16_t {
    byte = 0,
    point10 = 6,
    gps_time11 = 7,
    rgb12 = 8,
    wave_packet13 = 9,
    point14 = 10,
    rgb14 = 11,
    rgb_nir14 = 12,
    wave_packet14 = 13,
    byte14 = 14
};

/// Compression parameters of a file.
struct LazPacking {
    struct Item {
        LazItem type = LazItem::byte;
        std::uint16_t size = 0;  ///< [bytes]
        std::uint16_t version = 0;
    };
    std::vector<Item> items;
    std::uint16_t record = 0;  ///< [bytes]
    std::size_t color = 0;     ///< [bytes] offset in a record; 0 if there is no colour
    std::size_t extra = 0;     ///< [bytes] offset of the extra bytes in a record
    bool layered = false;      ///< each property is compressed separately, as in formats 6 to 10
    bool chunked = true;       ///< otherwise all points are one chunk
    std::uint32_t chunk = 0;   ///< points in each chunk; with `kVaryingChunks` the table specifies them
};

inline constexpr std::uint32_t kVaryingChunks = 0xffffffff;

/// Reads the record about the compression and compares it with the point format. Throws `InvalidInput` if it
/// is missing or does not match.
LazPacking read_laz_packing(std::string_view bytes, const LasHeader& h, const std::string& source);

/// A chunk and the range of its points; chunks are compressed independently.
struct LazChunk {
    std::string_view bytes;
    std::uint64_t first = 0, count = 0;
};

/// Returns the chunks by the chunk table. If it is missing because the writer was interrupted, only the first
/// chunk has `bytes`, up to the end of the file: decompression finds the begin of the others. Throws
/// `InvalidInput` if the table is inconsistent, or is missing and the file may not be truncated.
std::vector<LazChunk> find_laz_chunks(std::string_view bytes, const LasHeader& h, const LazPacking& packing,
                                      const LasReading& reading);

/// Decompresses the points of a chunk of formats 0 to 5, record by record. Returns the number of bytes read,
/// or nullopt if they are damaged. Throws `Cancelled`.
std::optional<std::size_t> unpack_records(const LazChunk& chunk, const LazPacking& packing,
                                          LasRecordRange& out, const Context& ctx);

/// Decompresses the points of a chunk of formats 6 to 10, property by property; properties that are not
/// needed are skipped.
std::optional<std::size_t> unpack_layers(const LazChunk& chunk, const LazPacking& packing,
                                         LasRecordRange& out, const Context& ctx);

}  // namespace coppice::io_internal
