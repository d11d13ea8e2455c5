// Structure of a LAZ file: the record about the compression, and the chunk table.

#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/io_points/laz/chunk_internal.h"
#include "coppice/io_points/laz/integers_internal.h"

namespace coppice::io_internal {
namespace {

constexpr std::size_t kLaszipVlr = 34, kItem = 6;  // [bytes]
constexpr std::string_view kLaszipUser = "laszip encoded";
constexpr std::size_t kPlace = 8;        // [bytes] of the offset of the chunk table
constexpr std::size_t kTableHeader = 8;  // [bytes]
// Maximum number of extra bytes: their models need kilobytes each in every thread.
constexpr std::uint16_t kMaxOwnBytes = 4096;

enum Compressor : std::uint16_t { kPointwise = 1, kChunked = 2, kLayered = 3 };

[[noreturn]] void damaged(const std::string& source, const std::string& subject) {
    las_trouble(source, fmt::format("its compressed points are damaged: {}", subject));
}

/// Returns the items into which the records of a format are divided.
std::vector<LazPacking::Item> list_items(const LasHeader& h) {
    std::vector<LazPacking::Item> items;
    const auto any_of = [&](std::initializer_list<int> formats) {
        return std::find(formats.begin(), formats.end(), int{h.format}) != formats.end();
    };
    const auto add = [&](LazItem type, std::uint16_t size) { items.push_back({type, size, 0}); };
    if (h.recent()) {
        add(LazItem::point14, 30);
        if (h.format == 7) add(LazItem::rgb14, 6);
        if (any_of({8, 10})) add(LazItem::rgb_nir14, 8);
        if (any_of({9, 10})) add(LazItem::wave_packet14, 29);
    } else {
        add(LazItem::point10, 20);
        if (any_of({1, 3, 4, 5})) add(LazItem::gps_time11, 8);
        if (any_of({2, 3, 5})) add(LazItem::rgb12, 6);
        if (any_of({4, 5})) add(LazItem::wave_packet13, 29);
    }
    int rest = h.record;
    for (const LazPacking::Item& item : items) rest -= item.size;
    if (rest > 0) add(h.recent() ? LazItem::byte14 : LazItem::byte, static_cast<std::uint16_t>(rest));
    return items;
}

std::string_view find_laszip_vlr(std::string_view bytes, const LasHeader& h, const std::string& source) {
    for (const LasRecord& record : las_records(bytes, h))
        if (record.user == kLaszipUser) return record.data;
    damaged(source, "the record about their compression is missing");
}

/// Returns whether the version of an item is supported for its format. Version 2 of the recent formats was
/// used by a prototype.
bool is_known_version(const LazPacking::Item& item, bool recent) {
    if (recent) return item.version >= (item.type == LazItem::wave_packet14 ? 3 : 2) && item.version <= 4;
    return item.version == 1 || (item.version == 2 && item.type != LazItem::wave_packet13);
}

/// Returns the offset of the table [bytes from the first record]; 0 if the writer did not store it, or if the
/// file is truncated and that is allowed.
std::size_t find_table(std::string_view data, const LasHeader& h, const LasReading& reading) {
    auto place = number_at<std::int64_t>(data, 0);
    const auto start = static_cast<std::int64_t>(h.data);
    if (place == start) return 0;
    if (place == -1) place = number_at<std::int64_t>(data, data.size() - kPlace);  // written to a pipe
    if (data.size() < kPlace + kTableHeader || place < start + static_cast<std::int64_t>(kPlace) ||
        place > start + static_cast<std::int64_t>(data.size() - kTableHeader)) {
        if (reading.allow_truncated) return 0;
        las_cut_off(reading.source, "the table of its compressed points is missing");
    }
    return static_cast<std::size_t>(place - start);
}

/// Returns at most `most` chunks of `packing.chunk` points, without bytes.
std::vector<LazChunk> equal_chunks(const LasHeader& h, const LazPacking& packing, std::uint64_t most) {
    const std::uint64_t each = packing.chunked ? packing.chunk : h.count;
    std::vector<LazChunk> chunks;
    chunks.reserve(std::min((h.count - 1) / each + 1, most));
    for (std::uint64_t first = 0; first < h.count && chunks.size() < most; first += each)
        chunks.push_back({{}, first, std::min(each, h.count - first)});
    return chunks;
}

/// Reads the table at `table`; the chunks fill the bytes from `kPlace` up to it.
std::vector<LazChunk> read_table(std::string_view data, std::size_t table, const LasHeader& h,
                                 const LazPacking& packing, const std::string& source) {
    const auto count = number_at<std::uint32_t>(data, table + 4);
    // Every chunk begins with an uncompressed record; some writers add an empty chunk at the end.
    if (number_at<std::uint32_t>(data, table) != 0 || count > (table - kPlace) / h.record + 1)
        damaged(source, "their chunk table is unreadable");
    ArithmeticDecoder in(data.substr(table + kTableHeader));
    IntegerDecoder numbers(32, 2);
    const bool varying = packing.chunk == kVaryingChunks;
    std::uint32_t points = 0, size = 0;
    std::uint64_t first = 0, at = kPlace;
    std::vector<LazChunk> chunks;
    for (std::uint32_t i = 0; i < count && first < h.count; ++i) {
        points = varying ? numbers.read(in, points, 0) : packing.chunk;
        size = numbers.read(in, size, 1);
        if (in.damaged() || size > table - at) damaged(source, "their chunk table is unreadable");
        const std::uint64_t taken = std::min<std::uint64_t>(points, h.count - first);
        if (taken > 0 && size < h.record) damaged(source, "one of their chunks is too short");
        if (taken > 0) chunks.push_back({data.substr(at, size), first, taken});
        first += taken;
        at += size;
    }
    if (first < h.count) damaged(source, "some of their chunks are missing");
    return chunks;
}

}  // namespace

LazPacking read_laz_packing(std::string_view bytes, const LasHeader& h, const std::string& source) {
    if (h.data < kOldLasHeader || h.data > bytes.size()) damaged(source, "the file is cut off");
    const std::string_view vlr = find_laszip_vlr(bytes, h, source);
    LazPacking p{.items = list_items(h),
                 .record = h.record,
                 .color = h.color(),
                 .extra = h.extra(),
                 .layered = h.recent()};
    if (vlr.size() < kLaszipVlr + kItem * p.items.size() ||
        number_at<std::uint16_t>(vlr, kLaszipVlr - 2) != p.items.size())
        damaged(source, "their fields differ from those of their format");
    const auto compressor = number_at<std::uint16_t>(vlr, 0);
    p.chunk = number_at<std::uint32_t>(vlr, 12);
    p.chunked = compressor != kPointwise;
    bool known = number_at<std::uint16_t>(vlr, 2) == 0;  // the only coder
    for (std::size_t i = 0; i < p.items.size(); ++i) {
        const std::size_t at = kLaszipVlr + kItem * i;
        if (number_at<std::uint16_t>(vlr, at) != static_cast<std::uint16_t>(p.items[i].type) ||
            number_at<std::uint16_t>(vlr, at + 2) != p.items[i].size)
            damaged(source, "their fields differ from those of their format");
        p.items[i].version = number_at<std::uint16_t>(vlr, at + 4);
        known = known && is_known_version(p.items[i], h.recent());
        if (p.items[i].type == LazItem::byte && p.items[i].size > kMaxOwnBytes) {
            throw Unsupported(fmt::format(
                "{}: its points have {} extra bytes, but at most {} can be unpacked; convert it to LAS",
                source, p.items[i].size, kMaxOwnBytes));
        }
    }
    known =
        known && (p.layered ? compressor == kLayered : compressor == kPointwise || compressor == kChunked);
    if (!known || (p.chunked && p.chunk == 0)) damaged(source, "their kind of compression is unknown");
    return p;
}

std::vector<LazChunk> find_laz_chunks(std::string_view bytes, const LasHeader& h, const LazPacking& packing,
                                      const LasReading& reading) {
    std::string_view data = bytes.substr(h.data);
    std::size_t table = 0;
    if (packing.chunked) {
        if (data.size() < kPlace) damaged(reading.source, "the file is cut off");
        table = find_table(data, h, reading);
        if (table > 0) return read_table(data, table, h, packing, reading.source);
        if (packing.chunk == kVaryingChunks)
            damaged(reading.source, "the table of their chunks, which differ in size, is missing");
        data.remove_prefix(kPlace);
    }
    // Every chunk begins with an uncompressed record.
    std::vector<LazChunk> chunks = equal_chunks(h, packing, data.size() / h.record);
    const bool complete = !chunks.empty() && chunks.back().first + chunks.back().count == h.count;
    if (chunks.empty() || (!complete && !reading.allow_truncated))
        damaged(reading.source, "some of their chunks are missing");
    chunks[0].bytes = data;
    return chunks;
}

}  // namespace coppice::io_internal
