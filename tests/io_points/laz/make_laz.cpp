// Writes the .laz files of this folder with LASzip 3.5.0, from the points of `made_points.h`. Not part of the
// build: compile it with LASzip's sources arithmetic*, integercompressor, lasreaditem*, laswriteitem*,
// laswritepoint, laszip and mydefs, and its folders src and include/laszip as include folders.

#include <cstring>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <vector>

#include "bytestreamout_ostream.hpp"
#include "laswritepoint.hpp"
#include "laszip.hpp"
#include "laszip_api.h"
#include "made_points.h"

namespace {

struct Kind {
    const char* name;
    int format;
    std::uint16_t own_bytes = 0;
    std::uint16_t version = 0;     // 0: default of LASzip
    std::uint16_t compressor = 0;  // 0: that of the format
    std::uint32_t channels = 1;
    bool varying = false;
};

constexpr Kind kKinds[] = {
    {"format0", 0},
    {"format1", 1},
    {"format2", 2, 3},
    {"format3", 3},
    {"format4", 4},
    {"format5", 5, 1},
    {"format6", 6},
    {"format7", 7, 2},
    {"format8", 8},
    {"format9", 9},
    {"format10", 10, 4},
    {"format3_version1", 3, 2, 1},
    {"format5_version1", 5, 0, 1},
    {"format1_whole", 1, 0, 2, LASZIP_COMPRESSOR_POINTWISE},
    {"format3_whole_version1", 3, 0, 1, LASZIP_COMPRESSOR_POINTWISE},
    {"format1_varying", 1, 0, 0, 0, 1, true},
    {"format7_varying", 7, 0, 0, 0, 1, true},
    {"format8_channels", 8, 0, 0, 0, 4},
    {"format8_channels_version4", 8, 0, 4, 0, 4},
};

constexpr int kSize[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

std::string head(const Kind& kind, LASzip& zip) {
    const std::size_t size = kind.format >= 6 ? 375 : kind.format >= 4 ? 235 : 227;
    unsigned char* vlr = nullptr;
    int vlr_size = 0;
    zip.pack(vlr, vlr_size);
    std::string bytes(size + 54 + static_cast<std::size_t>(vlr_size), '\0');
    bytes.replace(0, 4, "LASF");
    put<std::uint8_t>(bytes, 24, 1);
    put<std::uint8_t>(bytes, 25, kind.format >= 6 ? 4 : kind.format >= 4 ? 3 : 2);
    put(bytes, 94, static_cast<std::uint16_t>(size));
    put(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
    put<std::uint32_t>(bytes, 100, 1);
    put(bytes, 104, static_cast<std::uint8_t>(kind.format | 0x80));
    put(bytes, 105, static_cast<std::uint16_t>(kSize[kind.format] + kind.own_bytes));
    put<std::uint32_t>(bytes, 107, kind.format >= 6 ? 0 : made::kCount);
    if (kind.format >= 6) put<std::uint64_t>(bytes, 247, made::kCount);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(bytes, 131 + 8 * axis, 0.001);
        put(bytes, 155 + 8 * axis, made::kOffset[axis]);
    }
    bytes.replace(size + 2, 14, "laszip encoded");
    put<std::uint16_t>(bytes, size + 18, 22204);
    put(bytes, size + 20, static_cast<std::uint16_t>(vlr_size));
    std::memcpy(bytes.data() + size + 54, vlr, static_cast<std::size_t>(vlr_size));
    return bytes;
}

void fill(laszip_point& p, const Kind& kind, std::uint32_t i) {
    const made::Point m = made::point(kind.format, i, kind.channels);
    p.X = m.x;
    p.Y = m.y;
    p.Z = m.z;
    p.intensity = m.intensity;
    p.gps_time = m.time;
    p.scan_direction_flag = i % 9 == 0;
    p.edge_of_flight_line = i % 31 == 0;
    p.user_data = static_cast<std::uint8_t>(i / 8);
    p.point_source_ID = static_cast<std::uint16_t>(i / 20);
    if (kind.format >= 6) {
        p.extended_point_type = 1;
        p.extended_scanner_channel = m.channel;
        p.extended_classification_flags = m.withheld ? 4 : 0;
        p.extended_classification = m.classification;
        p.extended_return_number = m.return_number;
        p.extended_number_of_returns = m.return_count;
        p.extended_scan_angle = static_cast<std::int16_t>(i % 300);
    } else {
        p.return_number = m.return_number & 7;
        p.number_of_returns = m.return_count & 7;
        p.classification = m.classification & 31;
        p.withheld_flag = m.withheld;
        p.scan_angle_rank = static_cast<std::int8_t>(i % 40);
    }
    const std::uint16_t rgb[4] = {m.red, m.green, m.blue, static_cast<std::uint16_t>(i)};
    std::memcpy(p.rgb, rgb, sizeof rgb);
    p.wave_packet[0] = static_cast<std::uint8_t>(i % 3);
    const std::uint64_t offset = i % 11 == 5 ? std::uint64_t{i} << 35 : 100 * i + i % 5;
    std::memcpy(p.wave_packet + 1, &offset, 8);
    const std::uint32_t rest[5] = {100, made::scatter(i, 11), made::scatter(i, 12), i, made::scatter(i, 13)};
    std::memcpy(p.wave_packet + 9, rest, sizeof rest);
    for (std::uint16_t k = 0; k < kind.own_bytes; ++k)
        p.extra_bytes[k] = static_cast<std::uint8_t>(made::scatter(i / 3, 20u + k));
}

void write(const Kind& kind) {
    LASzip zip;
    const std::uint16_t compressor = kind.compressor    ? kind.compressor
                                     : kind.format >= 6 ? LASZIP_COMPRESSOR_LAYERED_CHUNKED
                                                        : LASZIP_COMPRESSOR_POINTWISE_CHUNKED;
    zip.setup(static_cast<U8>(kind.format), static_cast<U16>(kSize[kind.format] + kind.own_bytes),
              compressor);
    if (kind.version == 4) {
        for (int i = 0; i < zip.num_items; ++i) zip.items[i].version = 4;
    } else if (kind.version > 0) {
        zip.request_version(kind.version);
    }
    if (compressor != LASZIP_COMPRESSOR_POINTWISE) zip.set_chunk_size(kind.varying ? U32_MAX : made::kChunk);
    std::ostringstream stream;
    stream << head(kind, zip);
    ByteStreamOutOstreamLE out(stream);
    LASwritePoint writer;
    writer.setup(zip.num_items, zip.items, &zip);
    writer.init(&out);

    laszip_point p{};
    std::vector<std::uint8_t> own(kind.own_bytes + 1u);
    p.extra_bytes = own.data();
    std::vector<U8*> parts;
    for (int i = 0; i < zip.num_items; ++i) {
        switch (zip.items[i].type) {
            case LASitem::POINT10:
            case LASitem::POINT14:
                parts.push_back(reinterpret_cast<U8*>(&p.X));
                break;
            case LASitem::GPSTIME11:
                parts.push_back(reinterpret_cast<U8*>(&p.gps_time));
                break;
            case LASitem::RGB12:
            case LASitem::RGB14:
            case LASitem::RGBNIR14:
                parts.push_back(reinterpret_cast<U8*>(p.rgb));
                break;
            case LASitem::WAVEPACKET13:
            case LASitem::WAVEPACKET14:
                parts.push_back(p.wave_packet);
                break;
            default:
                parts.push_back(own.data());
        }
    }
    std::uint32_t chunk = 0, in_chunk = 0;
    for (std::uint32_t i = 0; i < made::kCount; ++i) {
        fill(p, kind, i);
        writer.write(parts.data());
        if (kind.varying && ++in_chunk == made::kVarying[chunk]) {
            writer.chunk();
            ++chunk;
            in_chunk = 0;
        }
    }
    writer.done();
    std::ofstream(std::string(kind.name) + ".laz", std::ios::binary) << stream.str();
}

}  // namespace

int main() {
    for (const Kind& kind : kKinds) write(kind);
}
