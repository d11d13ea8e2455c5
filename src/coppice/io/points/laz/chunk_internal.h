#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io/points/las_internal.h"

namespace coppice::io_internal {

/// The parts that a record is divided into for packing, by their numbers in [Isenburg2013].
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

/// How the points of a file were packed.
struct LazPacking {
    struct Item {
        LazItem type = LazItem::byte;
        std::uint16_t size = 0;  ///< [bytes]
        std::uint16_t version = 0;
    };
    std::vector<Item> items;
    std::uint16_t record = 0;  ///< [bytes]
    std::size_t color = 0;     ///< [bytes] where in a record it begins; 0 = it has none
    std::size_t extra = 0;     ///< [bytes] where what the format has not begins
    bool layered = false;      ///< each property by itself, as formats 6 to 10 are
    bool chunked = true;       ///< else all points are one chunk
    std::uint32_t chunk = 0;   ///< points in each; `kVaryingChunks`: the table says how many
};

inline constexpr std::uint32_t kVaryingChunks = 0xffffffff;

/// The record that tells the packing, held against the format of the points. Throws `InvalidInput` where it
/// is missing or tells of something else.
LazPacking read_laz_packing(std::string_view bytes, const LasHeader& h, const std::string& source);

/// A chunk and the points in it; it is packed by itself.
struct LazChunk {
    std::string_view bytes;
    std::uint64_t first = 0, count = 0;
};

/// By the table of chunks. Where there is none, as a writer was broken off before it wrote it, only the first
/// chunk has `bytes`, up to the end of the file: where the others begin is found by unpacking. Throws
/// `InvalidInput` where the table cannot be true, or is missing from a file that may not be truncated.
std::vector<LazChunk> find_laz_chunks(std::string_view bytes, const LasHeader& h, const LazPacking& packing,
                                      const LasReading& reading);

/// Unpacks the points of a chunk, of formats 0 to 5, one record after the other. Gives the bytes that they
/// took, or nothing when they are damaged. Throws `Cancelled`.
std::optional<std::size_t> unpack_records(const LazChunk& chunk, const LazPacking& packing, LasPart& out,
                                          const Context& ctx);

/// The same for formats 6 to 10, one property after the other; those that are not needed are passed over.
std::optional<std::size_t> unpack_layers(const LazChunk& chunk, const LazPacking& packing, LasPart& out,
                                         const Context& ctx);

}  // namespace coppice::io_internal
