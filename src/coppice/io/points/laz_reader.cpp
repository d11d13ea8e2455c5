#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/file_progress.h"
#include "coppice/io/points/las_header_internal.h"

#ifdef COPPICE_HAVE_LASZIP
#include <laszip/laszip_api.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory>
#include <sstream>
#include <utility>
#endif

namespace coppice::io_internal {

#ifdef COPPICE_HAVE_LASZIP

namespace {

constexpr std::size_t kVlrHeader = 54, kUserId = 2, kUserIdSize = 16, kPayloadSize = 20;  // [bytes]
constexpr std::size_t kLaszipVlr = 34, kItem = 6;                                         // [bytes]
constexpr std::string_view kLaszipUser = "laszip encoded";
constexpr std::size_t kPlace = 8;  // [bytes] of what says where the table of chunks is
constexpr std::uint32_t kVaryingChunks = 0xffffffff;
constexpr std::uint64_t kMostPointsPerByte = 64;

enum Compressor : std::uint16_t { kPointwise = 1, kChunked = 2, kLayered = 3 };
enum ItemType : std::uint16_t {
    kByte = 0,
    kPoint10 = 6,
    kGpsTime11 = 7,
    kRgb12 = 8,
    kWavePacket13 = 9,
    kPoint14 = 10,
    kRgb14 = 11,
    kRgbNir14 = 12,
    kWavePacket14 = 13,
    kByte14 = 14
};

struct Item {
    std::uint16_t type = 0, size = 0, version = 0;
};

/// How the records of a format are divided for compression.
std::vector<Item> items_of(const LasHeader& h) {
    std::vector<Item> items;
    const auto any_of = [&](std::initializer_list<int> formats) {
        return std::find(formats.begin(), formats.end(), int{h.format}) != formats.end();
    };
    const auto add = [&](std::uint16_t type, std::uint16_t size) { items.push_back({type, size, 0}); };
    if (h.recent()) {
        add(kPoint14, 30);
        if (h.format == 7) add(kRgb14, 6);
        if (any_of({8, 10})) add(kRgbNir14, 8);
        if (any_of({9, 10})) add(kWavePacket14, 29);
    } else {
        add(kPoint10, 20);
        if (any_of({1, 3, 4, 5})) add(kGpsTime11, 8);
        if (any_of({2, 3, 5})) add(kRgb12, 6);
        if (any_of({4, 5})) add(kWavePacket13, 29);
    }
    int rest = h.record;
    for (const Item& item : items) rest -= item.size;
    if (rest > 0) add(h.recent() ? kByte14 : kByte, static_cast<std::uint16_t>(rest));
    return items;
}

[[noreturn]] void damaged(const std::string& source, const std::string& what) {
    las_trouble(source, fmt::format("its compressed points are damaged: {}", what));
}

/// The record that says how points were compressed; refused when it is not for points of this format.
std::string_view find_laszip_vlr(std::string_view bytes, const LasHeader& h, const std::string& source) {
    std::uint64_t at = number_at<std::uint16_t>(bytes, 94);
    for (auto left = number_at<std::uint32_t>(bytes, 100); left > 0; --left) {
        if (at + kVlrHeader > std::min<std::uint64_t>(h.data, bytes.size())) break;
        const std::size_t size = number_at<std::uint16_t>(bytes, at + kPayloadSize);
        if (at + kVlrHeader + size > bytes.size()) break;
        if (bytes.substr(at + kUserId, kUserIdSize).starts_with(kLaszipUser))
            return bytes.substr(at + kVlrHeader, size);
        at += kVlrHeader + size;
    }
    damaged(source, "the record that says how they were compressed is missing");
}

struct Packing {
    std::uint16_t compressor = 0;
    std::uint32_t chunk = 0;  ///< points in each
    std::vector<Item> items;
    bool chunked() const { return compressor != kPointwise; }
};

/// Of items that were compressed, in the format's kind.
bool is_known_version(const Item& item, bool recent) {
    return recent ? item.version == 3 || item.version == 4
                  : item.version == 1 || (item.version == 2 && item.type != kWavePacket13);
}

/// LASzip trusts this record: one that names other items than the format has makes it write where it should
/// not.
Packing check_packing(std::string_view vlr, const LasHeader& h, const std::string& source) {
    Packing p{.items = items_of(h)};
    if (vlr.size() < kLaszipVlr + kItem * p.items.size() ||
        number_at<std::uint16_t>(vlr, kLaszipVlr - 2) != p.items.size())
        damaged(source, "they have other fields than their format has");
    p.compressor = number_at<std::uint16_t>(vlr, 0);
    p.chunk = number_at<std::uint32_t>(vlr, 12);
    bool known = number_at<std::uint16_t>(vlr, 2) == 0;  // the only coder
    for (std::size_t i = 0; i < p.items.size(); ++i) {
        const std::size_t at = kLaszipVlr + kItem * i;
        if (number_at<std::uint16_t>(vlr, at) != p.items[i].type ||
            number_at<std::uint16_t>(vlr, at + 2) != p.items[i].size)
            damaged(source, "they have other fields than their format has");
        p.items[i].version = number_at<std::uint16_t>(vlr, at + 4);
        known = known && is_known_version(p.items[i], h.recent());
    }
    known = known &&
            (h.recent() ? p.compressor == kLayered : p.compressor == kPointwise || p.compressor == kChunked);
    if (!known || (p.chunked() && p.chunk == 0)) damaged(source, "their kind of compression is unknown");
    if (!h.recent() && p.chunked() && p.chunk == kVaryingChunks) {
        throw Unsupported(
            fmt::format("{}: its compressed points are in chunks of different sizes, which can be read of "
                        "point formats 6 "
                        "to 10 only; convert it to LAS",
                        source));
    }
    return p;
}

struct ChunkTable {
    std::size_t at = 0;  ///< [bytes] from the first record
    std::uint32_t chunks = 0;
};

/// LASzip makes room for as many chunks as the table names.
ChunkTable find_chunk_table(std::string_view data, const LasHeader& h, const std::string& source) {
    constexpr std::size_t kTableHeader = 8;  // [bytes]
    if (data.size() < kPlace + kTableHeader) damaged(source, "the file is cut off");
    auto place = number_at<std::int64_t>(data, 0);
    if (place == -1) place = number_at<std::int64_t>(data, data.size() - kPlace);  // written to a pipe
    const auto start = static_cast<std::int64_t>(h.data);
    if (place < start + static_cast<std::int64_t>(kPlace) ||
        place > start + static_cast<std::int64_t>(data.size() - kTableHeader))
        damaged(source, "the file is cut off");
    const auto at = static_cast<std::size_t>(place - start);
    const auto chunks = number_at<std::uint32_t>(data, at + 4);
    // Every chunk begins with a point as it is.
    if (number_at<std::uint32_t>(data, at) != 0 || chunks > data.size() / h.record)
        damaged(source, "the table of their chunks is not to be read");
    return {at, chunks};
}

std::size_t layer_count(const std::vector<Item>& items) {
    std::size_t count = 0;
    for (const Item& item : items) {
        switch (item.type) {
            case kPoint14:
                count += 9;
                break;
            case kRgbNir14:
                count += 2;
                break;
            case kByte14:
                count += item.size;
                break;
            default:
                ++count;
        }
    }
    return count;
}

/// Chunks of layers say how long each layer is, and LASzip takes their word for it: they must fill the place
/// up to the table, be as many as it says, and hold all points.
void check_layers(std::string_view data, const ChunkTable& table, const Packing& packing, const LasHeader& h,
                  const std::string& source) {
    const std::size_t layers = layer_count(packing.items);
    const std::size_t fixed = std::size_t{h.record} + 4 + 4 * layers;
    std::uint64_t points = 0, chunks = 0;
    std::size_t at = kPlace;
    for (; at < table.at; ++chunks) {
        if (table.at - at < fixed) damaged(source, "a chunk of them is cut off");
        points += number_at<std::uint32_t>(data, at + h.record);
        std::uint64_t size = fixed;
        for (std::size_t k = 0; k < layers; ++k)
            size += number_at<std::uint32_t>(data, at + h.record + 4 + 4 * k);
        if (size > table.at - at) damaged(source, "a chunk of them is longer than the file");
        at += static_cast<std::size_t>(size);
    }
    if (chunks != table.chunks || points < h.count) damaged(source, "chunks of them are missing");
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
        bytes[at + i] = static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
}

void put_packing(std::string& bytes, std::size_t at, const Packing& packing) {
    put(bytes, at, packing.compressor);
    put<std::uint8_t>(bytes, at + 4, 2);  // the version of LASzip
    put<std::uint8_t>(bytes, at + 5, 2);
    put(bytes, at + 12, packing.chunk);
    for (const std::size_t evlrs : {16u, 24u}) put<std::int64_t>(bytes, at + evlrs, -1);
    put(bytes, at + kLaszipVlr - 2, static_cast<std::uint16_t>(packing.items.size()));
    at += kLaszipVlr;
    for (const Item& item : packing.items) {
        put(bytes, at, item.type);
        put(bytes, at + 2, item.size);
        put(bytes, at + 4, item.version);
        at += kItem;
    }
}

/// The same points behind a header of our own, with nothing in it but what LASzip needs: it is not at ease
/// with damaged ones.
std::string plain_laz(std::string_view bytes, const LasHeader& h, const std::string& source) {
    if (h.data < kOldLasHeader || h.data > bytes.size()) damaged(source, "the file is cut off");
    const std::string_view data = bytes.substr(h.data);
    const Packing packing = check_packing(find_laszip_vlr(bytes, h, source), h, source);
    const std::size_t header = h.recent() ? kNewLasHeader : kOldLasHeader;
    const std::size_t vlr_size = kLaszipVlr + kItem * packing.items.size();
    const std::size_t payload = header + kVlrHeader, first = payload + vlr_size;
    std::string out(first, '\0');
    out.replace(0, 4, "LASF");
    put<std::uint8_t>(out, 24, 1);
    put<std::uint8_t>(out, 25, h.recent() ? 4 : 2);
    put(out, 94, static_cast<std::uint16_t>(header));
    put(out, 96, static_cast<std::uint32_t>(first));
    put<std::uint32_t>(out, 100, 1);
    put(out, 104, static_cast<std::uint8_t>(h.format | 0x80));
    put(out, 105, h.record);
    put(out, 107, static_cast<std::uint32_t>(h.recent() ? 0 : h.count));
    for (const std::size_t scale : {131u, 139u, 147u}) put(out, scale, std::bit_cast<std::uint64_t>(1.0));
    if (h.recent()) put(out, 247, h.count);
    out.replace(header + kUserId, kLaszipUser.size(), kLaszipUser);
    put<std::uint16_t>(out, header + 18, 22204);
    put(out, header + kPayloadSize, static_cast<std::uint16_t>(vlr_size));
    put_packing(out, payload, packing);
    out += data;
    if (packing.chunked()) {
        const ChunkTable table = find_chunk_table(data, h, source);
        if (h.recent()) {
            check_layers(data, table, packing, h, source);
        } else if (std::uint64_t{table.chunks} * packing.chunk < h.count) {
            damaged(source, "chunks of them are missing");
        }
        put(out, first, static_cast<std::int64_t>(first + table.at));
    }
    return out;
}

/// LASzip, reading from memory.
class Unzipper {
  public:
    Unzipper(std::string bytes, const std::string& source)
        : stream_(std::move(bytes)), source_(source), handle_(create(source)) {
        // The other layers of point formats 6 to 10 are passed over.
        check(laszip_decompress_selective(handle_.get(), laszip_DECOMPRESS_SELECTIVE_CHANNEL_RETURNS_XY |
                                                             laszip_DECOMPRESS_SELECTIVE_Z |
                                                             laszip_DECOMPRESS_SELECTIVE_FLAGS));
        laszip_BOOL compressed = 0;
        check(laszip_open_reader_stream(handle_.get(), stream_, &compressed));
        check(laszip_get_point_pointer(handle_.get(), &point_));
    }

    const laszip_point_struct& next() {
        check(laszip_read_point(handle_.get()));
        return *point_;
    }

  private:
    struct Close {
        void operator()(laszip_POINTER handle) const {
            laszip_close_reader(handle);
            laszip_destroy(handle);
        }
    };
    static laszip_POINTER create(const std::string& source) {
        laszip_POINTER handle = nullptr;
        if (laszip_create(&handle) != 0) throw IoError(fmt::format("{}: LASzip does not start", source));
        return handle;
    }
    void check(laszip_I32 trouble) {
        if (trouble == 0) return;
        laszip_CHAR* text = nullptr;
        laszip_get_error(handle_.get(), &text);
        damaged(source_, text != nullptr ? text : "unknown reason");
    }

    std::istringstream stream_;
    const std::string& source_;
    std::unique_ptr<void, Close> handle_;
    laszip_point_struct* point_ = nullptr;
};

bool withheld(const laszip_point_struct& p, bool recent) {
    return recent ? (p.extended_classification_flags & 0x4) != 0 : p.withheld_flag != 0;
}

}  // namespace

std::vector<Vec3d> read_laz(std::string_view bytes, const LasHeader& h, const std::string& source,
                            const Context& ctx) {
    if (h.count / kMostPointsPerByte > bytes.size() ||
        (!h.recent() && h.count > std::numeric_limits<std::uint32_t>::max()))
        damaged(source, "the header names more of them than the file can hold");
    std::vector<Vec3d> points;
    if (h.count == 0) return points;
    Unzipper unzipper(plain_laz(bytes, h, source), source);
    FileProgress progress(ctx, h.count);
    for (std::uint64_t i = 0; i < h.count; ++i) {
        progress.at(i);
        const laszip_point_struct& p = unzipper.next();
        if (!withheld(p, h.recent())) add_las_point(points, h, Vec3d(p.X, p.Y, p.Z), source, i);
    }
    return points;
}

#else

std::vector<Vec3d> read_laz(std::string_view, const LasHeader&, const std::string& source, const Context&) {
    throw Unsupported(
        fmt::format("{}: it is compressed (LAZ), which this build cannot read, as no LASzip library was "
                    "found; convert it to LAS",
                    source));
}

#endif

}  // namespace coppice::io_internal
