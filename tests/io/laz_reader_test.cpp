#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/io/points/reader.h"

#ifdef COPPICE_HAVE_LASZIP
#include <laszip/laszip_api.h>

#include <sstream>
#endif

namespace coppice {
namespace {

std::string error_of(std::string_view bytes) {
    try {
        parse_points(bytes, "p.laz");
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

#ifndef COPPICE_HAVE_LASZIP

TEST(LazReader, SaysThatLaszipIsMissing) {
    std::string bytes(227 + 20, '\0');
    std::memcpy(bytes.data(), "LASF", 4);
    bytes[24] = 1;
    bytes[104] = static_cast<char>(0x80);
    bytes[105] = 20;
    for (const std::size_t scale : {131u, 139u, 147u}) {
        const double one = 1;
        std::memcpy(bytes.data() + scale, &one, sizeof one);
    }
    EXPECT_EQ(error_of(bytes),
              "p.laz: it is compressed (LAZ), which this build cannot read, as no LASzip library was found; "
              "convert it to LAS");
}

#else

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

template <class T>
T get(const std::string& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

struct LazKind {
    std::uint8_t minor = 2, format = 0;
    std::uint16_t record = 20;  // beyond the format's, bytes of their own
    laszip_U32 chunk = 0;       // points in a chunk; 0 = LASzip's own choice
};

constexpr LazKind kKinds[] = {{2, 0, 20}, {2, 1, 28, 100}, {2, 2, 29}, {3, 3, 34},      {3, 4, 57},
                              {4, 6, 30}, {4, 7, 36, 64},  {4, 8, 41}, {4, 10, 67, 300}};
constexpr std::uint32_t kCount = 1000;
constexpr double kOffset[3] = {1e6, 2e6, 100};

/// Millimetres of a point, jumping about as branches do.
std::int32_t raw(std::uint32_t i, std::uint32_t axis) {
    return static_cast<std::int32_t>(i * (axis + 1)) +
           static_cast<std::int32_t>(CounterRandom(3, 7).bits(3 * i + axis) % 5000);
}

class Zipper {
  public:
    Zipper() { require(laszip_create(&handle_)); }
    ~Zipper() { laszip_destroy(handle_); }
    Zipper(const Zipper&) = delete;
    Zipper& operator=(const Zipper&) = delete;

    /// kCount points of which every hundredth is withheld.
    std::string zip(const LazKind& kind) {
        set_header(kind);
        if (kind.format >= 6) require(laszip_request_native_extension(handle_, 1));
        if (kind.chunk > 0) require(laszip_set_chunk_size(handle_, kind.chunk));
        std::ostringstream stream;
        require(laszip_open_writer_stream(handle_, stream, 1, 0));
        laszip_point_struct* point = nullptr;
        require(laszip_get_point_pointer(handle_, &point));
        for (std::uint32_t i = 0; i < kCount; ++i) {
            point->X = raw(i, 0);
            point->Y = raw(i, 1);
            point->Z = raw(i, 2);
            point->gps_time = i;
            point->extended_point_type = kind.format >= 6;
            point->withheld_flag = i % 100 == 99;
            point->extended_classification_flags = i % 100 == 99 ? 4 : 0;
            require(laszip_write_point(handle_));
        }
        require(laszip_close_writer(handle_));
        return stream.str();
    }

  private:
    void require(laszip_I32 trouble) {
        if (trouble == 0) return;
        laszip_CHAR* text = nullptr;
        laszip_get_error(handle_, &text);
        ADD_FAILURE() << (text ? text : "");
    }
    void set_header(const LazKind& kind) {
        laszip_header_struct* header = nullptr;
        require(laszip_get_header_pointer(handle_, &header));
        header->version_major = 1;
        header->version_minor = kind.minor;
        header->header_size = kind.minor == 4 ? 375 : kind.minor == 3 ? 235 : 227;
        header->offset_to_point_data = header->header_size;
        header->point_data_format = kind.format;
        header->point_data_record_length = kind.record;
        header->number_of_point_records = kind.format >= 6 ? 0 : kCount;
        header->extended_number_of_point_records = kCount;
        header->x_scale_factor = header->y_scale_factor = header->z_scale_factor = 0.001;
        header->x_offset = kOffset[0];
        header->y_offset = kOffset[1];
        header->z_offset = kOffset[2];
    }
    laszip_POINTER handle_ = nullptr;
};

std::string laz_file(const LazKind& kind) { return Zipper().zip(kind); }

/// Where the payload of the first variable record begins, which is LASzip's.
std::size_t packing_at(const std::string& bytes) { return get<std::uint16_t>(bytes, 94) + 54u; }

TEST(LazReader, ReadsAllFormatsButWithheldPoints) {
    for (const LazKind& kind : kKinds) {
        SCOPED_TRACE(int{kind.format});
        const PointSet set = parse_points(laz_file(kind), "p.laz");
        ASSERT_EQ(set.size(), kCount - kCount / 100);
        std::size_t k = 0;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            if (i % 100 == 99) continue;
            const Vec3d wanted(kOffset[0] + raw(i, 0) * 0.001, kOffset[1] + raw(i, 1) * 0.001,
                               kOffset[2] + raw(i, 2) * 0.001);
            ASSERT_LT(distance(set.world(k++), wanted), 1e-5) << i;
        }
    }
}

TEST(LazReader, RefusesFieldsThatTheFormatHasNot) {
    const std::string bytes = laz_file({2, 3, 34});
    const std::string wanted =
        "p.laz: its compressed points are damaged: they have other fields than their format has";
    const std::size_t items = packing_at(bytes) + 34;
    std::string other = bytes;
    put<std::uint16_t>(other, items + 12, 7);  // a second time of the GPS where the colour is
    EXPECT_EQ(error_of(other), wanted);
    other = bytes;
    put<std::uint16_t>(other, items - 2, 2);
    EXPECT_EQ(error_of(other), wanted);
    other = bytes;
    put<std::uint16_t>(other, 105, 40);  // the record has six bytes that nothing packs
    EXPECT_EQ(error_of(other), wanted);
    other = bytes;
    put<std::uint16_t>(other, packing_at(bytes), 9);
    EXPECT_NE(error_of(other).find("their kind of compression is unknown"), std::string::npos);
    other = bytes;
    other[packing_at(bytes) - 50] = 'x';
    EXPECT_NE(error_of(other).find("how they were compressed is missing"), std::string::npos);
}

TEST(LazReader, RefusesCountsBeyondTheFile) {
    std::string bytes = laz_file({2, 0, 20});
    put<std::uint32_t>(bytes, 107, 0xffffffffu);
    EXPECT_EQ(
        error_of(bytes),
        "p.laz: its compressed points are damaged: the header names more of them than the file can hold");
    put<std::uint32_t>(bytes, 107, kCount + 1000);
    EXPECT_NE(error_of(bytes).find("its compressed points are damaged"), std::string::npos);
    EXPECT_EQ(parse_points(laz_file({2, 0, 20, kCount}), "p.laz").size(), kCount - kCount / 100);
    bytes = laz_file({2, 0, 20, 100});
    put<std::uint32_t>(bytes, 107, kCount + 1);
    EXPECT_NE(error_of(bytes).find("chunks of them are missing"), std::string::npos);
    const auto data = get<std::uint32_t>(bytes, 96);
    put<std::uint32_t>(bytes, static_cast<std::size_t>(get<std::int64_t>(bytes, data)) + 4, 0xffffffffu);
    EXPECT_NE(error_of(bytes).find("the table of their chunks is not to be read"), std::string::npos);
    put<std::int64_t>(bytes, data, std::int64_t{1} << 62);
    EXPECT_NE(error_of(bytes).find("the file is cut off"), std::string::npos);
    put<std::int64_t>(bytes, data, std::int64_t{data});
    EXPECT_NE(error_of(bytes).find("the file is cut off"), std::string::npos);
}

TEST(LazReader, RefusesLayersBeyondTheFile) {
    const std::string bytes = laz_file({4, 6, 30, 300});
    const std::size_t chunk = get<std::uint32_t>(bytes, 96) + 8u;
    EXPECT_EQ(get<std::uint32_t>(bytes, chunk + 30), 300u);  // points in the first chunk
    std::string other = bytes;
    put<std::uint32_t>(other, chunk + 34, 0xf0000000u);
    EXPECT_EQ(error_of(other),
              "p.laz: its compressed points are damaged: a chunk of them is longer than the file");
    other = bytes;
    put<std::uint64_t>(other, 247, kCount + 1);
    EXPECT_EQ(error_of(other), "p.laz: its compressed points are damaged: chunks of them are missing");
}

TEST(LazReader, RefusesVaryingChunksOfOldFormats) {
    std::string bytes = laz_file({2, 0, 20});
    put<std::uint32_t>(bytes, packing_at(bytes) + 12, 0xffffffffu);
    EXPECT_NE(error_of(bytes).find("in chunks of different sizes"), std::string::npos);
}

TEST(LazReader, ReadsTheTableFromTheEndAsPipesLeaveIt) {
    std::string bytes = laz_file({2, 0, 20, 100});
    const auto data = get<std::uint32_t>(bytes, 96);
    const auto table = get<std::int64_t>(bytes, data);
    put<std::int64_t>(bytes, data, -1);
    bytes.append(8, '\0');
    put(bytes, bytes.size() - 8, table);
    EXPECT_EQ(parse_points(bytes, "p.laz").size(), kCount - kCount / 100);
}

TEST(LazReader, RefusesEveryTruncation) {
    for (const LazKind& kind : {kKinds[1], kKinds[6]}) {
        const std::string bytes = laz_file(kind);
        const auto table = static_cast<std::size_t>(get<std::int64_t>(bytes, get<std::uint32_t>(bytes, 96)));
        for (std::size_t size = 4; size < table + 8; size += size < 600 ? 1 : 61) {
            EXPECT_THROW(parse_points(std::string_view(bytes).substr(0, size), "p.laz"), InvalidInput)
                << size;
        }
    }
}

TEST(LazReader, SurvivesDamage) {
    const CounterRandom random(5, 2);
    std::vector<std::string> files;
    for (const LazKind& kind : kKinds) files.push_back(laz_file(kind));
    for (std::uint64_t turn = 0; turn < 2000; ++turn) {
        std::string bytes = files[turn % files.size()];
        // One in two within what describes the points, where damage has the most effect.
        const std::size_t range = turn % 4 < 2 ? bytes.size() : 600;
        for (std::uint64_t k = 0; k < 1 + turn % 3; ++k) {
            const std::uint64_t draw = random.bits(8 * turn + k);
            bytes[4 + (draw >> 8) % (range - 4)] = static_cast<char>(draw);
        }
        try {
            const PointSet set = parse_points(bytes, "p.laz");
            for (const Vec3 p : set.positions) ASSERT_TRUE(is_finite(p));
        } catch (const Error&) {  // the proper answer to a bad file
        }
    }
}

#endif

}  // namespace
}  // namespace coppice
