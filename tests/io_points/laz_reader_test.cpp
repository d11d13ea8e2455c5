#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/io_points/reader.h"
#include "coppice/system/file.h"
#include "io_points/laz/made_points.h"
#include "paths.h"

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

/// Reads a file written by LASzip, see laz/make_laz.cpp.
struct LazFile {
    const char* name;
    int format;
    std::uint32_t channels = 1;

    std::string bytes() const {
        return read_file(source_dir() / "tests/io_points/laz" / (std::string(name) + ".laz"));
    }
};

constexpr LazFile kFiles[] = {{"format0", 0},
                              {"format1", 1},
                              {"format2", 2},
                              {"format3", 3},
                              {"format4", 4},
                              {"format5", 5},
                              {"format6", 6},
                              {"format7", 7},
                              {"format8", 8},
                              {"format9", 9},
                              {"format10", 10},
                              {"format3_version1", 3},
                              {"format5_version1", 5},
                              {"format1_whole", 1},
                              {"format3_whole_version1", 3},
                              {"format1_varying", 1},
                              {"format7_varying", 7},
                              {"format8_channels", 8, 4},
                              {"format8_channels_version4", 8, 4}};
constexpr std::size_t kKept = made::kCount - made::kCount / 50;  // every 50th is withheld

std::string laz_file(const char* name) { return LazFile{name, 0}.bytes(); }

bool has_color(int format) {
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}

void expect_made_points(const PointCloud& found, const LazFile& file) {
    const PointSet& set = found.points;
    ASSERT_EQ(set.size(), kKept);
    EXPECT_NE(set.origin.y, 0);  // so that millimetres are lost only in steps of 20 km
    ASSERT_EQ(found.colors.size(), has_color(file.format) ? kKept : 0);
    ASSERT_EQ(found.classes.size(), kKept);
    ASSERT_EQ(found.intensities.size(), kKept);
    ASSERT_EQ(found.return_numbers.size(), kKept);
    ASSERT_EQ(found.return_counts.size(), kKept);
    std::size_t k = 0;
    for (std::uint32_t i = 0; i < made::kCount; ++i) {
        const made::Point p = made::point(file.format, i, file.channels);
        if (p.withheld) continue;
        const Vec3d wanted(made::kOffset[0] + p.x * 0.001, made::kOffset[1] + p.y * 0.001,
                           made::kOffset[2] + p.z * 0.001);
        ASSERT_EQ(set.positions[k], Vec3(wanted - set.origin)) << i;
        ASSERT_EQ(found.classes[k], p.classification) << i;
        ASSERT_EQ(found.intensities[k], p.intensity) << i;
        ASSERT_EQ(found.return_numbers[k], p.return_number) << i;
        ASSERT_EQ(found.return_counts[k], p.return_count) << i;
        const auto byte = [](std::uint16_t c) { return static_cast<std::uint8_t>(c >> 8); };
        if (!found.colors.empty()) {
            ASSERT_EQ(found.colors[k], (Rgb{byte(p.red), byte(p.green), byte(p.blue)})) << i;
        }
        ++k;
    }
}

/// Returns the offset of the payload of the first variable length record, which is LASzip's.
std::size_t packing_at(const std::string& bytes) { return get<std::uint16_t>(bytes, 94) + 54u; }

TEST(LazReader, ReadsAllFormatsAndVersions) {
    for (const LazFile& file : kFiles) {
        SCOPED_TRACE(file.name);
        expect_made_points(parse_point_cloud(file.bytes(), "p.laz"), file);
        EXPECT_TRUE(parse_points(file.bytes(), "p.laz") == parse_point_cloud(file.bytes(), "p.laz").points);
    }
}

TEST(LazReader, ReadsAScan) {
    const auto scan = source_dir().parent_path() / "shared/data/cloud/treels_pine.laz";
    if (!std::filesystem::exists(scan)) GTEST_SKIP() << "no shared data";
    EXPECT_EQ(read_points(scan).size(), 73851u);  // as its header specifies
}

TEST(LazReader, IsBitIdenticalForAnyNumberOfThreads) {
    for (const LazFile& file : kFiles) {
        SCOPED_TRACE(file.name);
        const std::string bytes = file.bytes();
        const PointSet one = parse_points(bytes, "p.laz", {.threads = 1});
        EXPECT_TRUE(one == parse_points(bytes, "p.laz", {.threads = 2}));
        EXPECT_TRUE(one == parse_points(bytes, "p.laz", {.threads = 7}));
    }
}

TEST(LazReader, ReadsAChunkTableReferencedAtTheEnd) {
    for (const char* name : {"format0", "format7_varying"}) {
        std::string bytes = laz_file(name);
        const auto data = get<std::uint32_t>(bytes, 96);
        const auto table = get<std::int64_t>(bytes, data);
        put<std::int64_t>(bytes, data, -1);
        bytes.append(8, '\0');
        put(bytes, bytes.size() - 8, table);
        EXPECT_EQ(parse_points(bytes, "p.laz").size(), kKept);
    }
}

TEST(LazReader, ReadsCopc) {
    // COPC: a record before that of LASzip, chunks of several sizes, and its index after their table.
    constexpr std::uint32_t kCopcVlr = 54 + 160;
    std::string bytes = laz_file("format7_varying");
    const auto data = get<std::uint32_t>(bytes, 96);
    put<std::int64_t>(bytes, data, get<std::int64_t>(bytes, data) + kCopcVlr);
    std::string vlr(kCopcVlr, '\0');
    vlr.replace(2, 4, "copc");
    put<std::uint16_t>(vlr, 18, 1);
    put<std::uint16_t>(vlr, 20, 160);
    bytes.insert(375, vlr);
    put<std::uint32_t>(bytes, 96, data + kCopcVlr);
    put<std::uint32_t>(bytes, 100, 2);
    bytes.append(60 + 5 * 32, '\1');
    expect_made_points(parse_point_cloud(bytes, "p.copc.laz"), {"format7_varying", 7});
}

TEST(LazReader, ReadsEqualChunksWithoutAChunkTable) {
    for (const LazFile& file : {kFiles[3], kFiles[7], kFiles[10], kFiles[11]}) {
        SCOPED_TRACE(file.name);
        std::string bytes = file.bytes();
        const auto data = get<std::uint32_t>(bytes, 96);
        bytes.resize(static_cast<std::size_t>(get<std::int64_t>(bytes, data)));
        put<std::int64_t>(bytes, data, data);
        expect_made_points(parse_point_cloud(bytes, "p.laz"), file);
    }
    std::string bytes = laz_file("format1_varying");
    put<std::int64_t>(bytes, get<std::uint32_t>(bytes, 96), get<std::uint32_t>(bytes, 96));
    EXPECT_NE(error_of(bytes).find("the table of their chunks, which differ in size, is missing"),
              std::string::npos);
}

TEST(LazReader, RejectsFieldsThatDifferFromTheFormat) {
    const std::string bytes = laz_file("format3");
    const std::string wanted =
        "p.laz: its compressed points are damaged: their fields differ from those of their format";
    const std::size_t items = packing_at(bytes) + 34;
    std::string other = bytes;
    put<std::uint16_t>(other, items + 12, 7);  // a second GPS time in place of the colour
    EXPECT_EQ(error_of(other), wanted);
    other = bytes;
    put<std::uint16_t>(other, items - 2, 2);
    EXPECT_EQ(error_of(other), wanted);
    other = bytes;
    put<std::uint16_t>(other, 105, 40);  // the record has six bytes that no item compresses
    EXPECT_EQ(error_of(other), wanted);
    other = bytes;
    put<std::uint16_t>(other, packing_at(bytes), 9);
    EXPECT_NE(error_of(other).find("their kind of compression is unknown"), std::string::npos);
    other = bytes;
    other[packing_at(bytes) - 50] = 'x';
    EXPECT_NE(error_of(other).find("the record about their compression is missing"), std::string::npos);
}

TEST(LazReader, RejectsTooManyExtraBytes) {
    std::string bytes = laz_file("format2");
    put<std::uint16_t>(bytes, 105, 26 + 5000);
    put<std::uint16_t>(bytes, packing_at(bytes) + 34 + 12 + 2, 5000);
    EXPECT_EQ(error_of(bytes),
              "p.laz: its points have 5000 extra bytes, but at most 4096 can be unpacked; convert it to LAS");
}

TEST(LazReader, RejectsCountsBeyondTheFile) {
    std::string bytes = laz_file("format0");
    put<std::uint32_t>(bytes, 107, 0xffffffffu);
    EXPECT_EQ(error_of(bytes),
              "p.laz: its compressed points are damaged: the header specifies more of them than the file can "
              "contain");
    put<std::uint32_t>(bytes, 107, made::kCount + 1000);
    EXPECT_NE(error_of(bytes).find("some of their chunks are missing"), std::string::npos);
    bytes = laz_file("format6");
    put<std::uint64_t>(bytes, 247, std::uint64_t{1} << 60);
    EXPECT_NE(error_of(bytes).find("more of them than the file can contain"), std::string::npos);
    put<std::uint64_t>(bytes, 247, made::kCount + 50);
    EXPECT_EQ(error_of(bytes), "p.laz: its compressed points are damaged: chunk 4 of 4 cannot be unpacked");
}

TEST(LazReader, RejectsInvalidChunkTables) {
    std::string bytes = laz_file("format0");
    const auto data = get<std::uint32_t>(bytes, 96);
    put<std::uint32_t>(bytes, static_cast<std::size_t>(get<std::int64_t>(bytes, data)) + 4, 0xffffffffu);
    EXPECT_NE(error_of(bytes).find("their chunk table is unreadable"), std::string::npos);
    put<std::int64_t>(bytes, data, std::int64_t{1} << 62);
    EXPECT_NE(error_of(bytes).find("the file is cut off"), std::string::npos);
    put<std::int64_t>(bytes, data, std::int64_t{data} + 1);
    EXPECT_NE(error_of(bytes).find("the file is cut off"), std::string::npos);
}

TEST(LazReader, RejectsLayersBeyondTheFile) {
    const std::string bytes = laz_file("format6");
    const std::size_t chunk = get<std::uint32_t>(bytes, 96) + 8u;
    EXPECT_EQ(get<std::uint32_t>(bytes, chunk + 30), made::kChunk);  // points in the first chunk
    std::string other = bytes;
    put<std::uint32_t>(other, chunk + 34, 0xf0000000u);
    EXPECT_EQ(error_of(other), "p.laz: its compressed points are damaged: chunk 1 of 4 cannot be unpacked");
}

/// Adds a record that names the first extra bytes of the points `label`, a number of that type.
std::string with_label(std::string bytes, std::uint8_t type) {
    std::string record(54 + 192, '\0');
    record.replace(2, 9, "LASF_Spec");
    put<std::uint16_t>(record, 18, 4);
    put<std::uint16_t>(record, 20, 192);
    put(record, 54 + 2, type);
    record.replace(54 + 4, 5, "label");
    const auto data = get<std::uint32_t>(bytes, 96);
    const auto size = static_cast<std::uint32_t>(record.size());
    put(bytes, data, get<std::int64_t>(bytes, data) + size);
    bytes.insert(data, record);
    put(bytes, 96, data + size);
    put(bytes, 100, get<std::uint32_t>(bytes, 100) + 1);
    return bytes;
}

TEST(LazReader, ReadsExtraBytes) {
    struct Case {
        const char* name;
        std::uint8_t type;
    };
    constexpr std::uint8_t kByte = 1, kTwoBytes = 3;
    for (const Case& c : {Case{"format2", kTwoBytes}, Case{"format5", kByte}, Case{"format7", kTwoBytes},
                          Case{"format10", kTwoBytes}, Case{"format3_version1", kTwoBytes}}) {
        SCOPED_TRACE(c.name);
        const PointCloud found = parse_point_cloud(with_label(laz_file(c.name), c.type), "p.laz");
        ASSERT_EQ(found.tree_ids.size(), kKept);
        std::size_t k = 0;
        for (std::uint32_t i = 0; i < made::kCount; ++i) {
            if (i % 50 == 49) continue;  // withheld
            const auto byte = [&](std::uint32_t n) { return made::scatter(i / 3, 20 + n) & 255u; };
            ASSERT_EQ(found.tree_ids[k++], c.type == kByte ? byte(0) : byte(0) | byte(1) << 8) << i;
        }
    }
}

TEST(LazReader, ReadsTheCompleteChunksOfATruncatedFile) {
    for (const char* name : {"format1", "format7"}) {
        SCOPED_TRACE(name);
        const std::string bytes = laz_file(name);
        const auto table = static_cast<std::size_t>(get<std::int64_t>(bytes, get<std::uint32_t>(bytes, 96)));
        const PointCloud all = parse_point_cloud(bytes, "p.laz");
        const auto cut = [&](std::size_t size) {
            return parse_point_file(std::string_view(bytes).substr(0, size), "p.laz", {},
                                    {.allow_truncated = true});
        };
        EXPECT_EQ(cut(table + 4).missing, 0u);  // only the table is missing
        const PointFile found = cut(table - 40);
        EXPECT_EQ(found.missing, made::kCount - 3 * made::kChunk);
        ASSERT_EQ(found.point_cloud.points.size(), 3 * made::kChunk - 3);  // 3 of 192 are withheld
        for (std::size_t i = 0; i < found.point_cloud.points.size(); ++i)
            ASSERT_LT(distance(found.point_cloud.points.world(i), all.points.world(i)), 1e-3) << i;
        EXPECT_THROW(cut(table / 4), InvalidInput);
    }
    const std::string varying = laz_file("format7_varying");
    EXPECT_THROW(parse_point_file(std::string_view(varying).substr(0, varying.size() - 30), "p.laz", {},
                                  {.allow_truncated = true}),
                 InvalidInput);
}

TEST(LazReader, RejectsEveryTruncation) {
    for (const char* name : {"format1", "format7", "format1_whole"}) {
        SCOPED_TRACE(name);
        const std::string bytes = laz_file(name);
        const auto place = get<std::int64_t>(bytes, get<std::uint32_t>(bytes, 96));
        const bool whole = std::string_view(name).ends_with("whole");
        // The decoder only looks ahead at the last bytes of the table and of points that fill the whole file.
        const std::size_t end = whole ? bytes.size() - 6 : static_cast<std::size_t>(place) + 8;
        for (std::size_t size = 4; size < end; size += size < 600 ? 1 : 61) {
            EXPECT_THROW(parse_points(std::string_view(bytes).substr(0, size), "p.laz"), InvalidInput)
                << size;
        }
    }
}

TEST(LazReader, DamagedFilesAreReadOrRejected) {
    const CounterRandom random(5, 2);
    std::vector<std::string> files;
    for (const LazFile& file : kFiles) files.push_back(file.bytes());
    for (std::uint64_t turn = 0; turn < 2000; ++turn) {
        std::string bytes = files[turn % files.size()];
        // Half of the changes are in the description of the points, where damage has the largest effect.
        const std::size_t range = turn % 4 < 2 ? bytes.size() : 600;
        for (std::uint64_t k = 0; k < 1 + turn % 3; ++k) {
            const std::uint64_t draw = random.bits(8 * turn + k);
            bytes[4 + (draw >> 8) % (range - 4)] = static_cast<char>(draw);
        }
        try {
            const PointSet set = parse_point_cloud(bytes, "p.laz").points;
            for (const Vec3 p : set.positions) ASSERT_TRUE(is_finite(p));
        } catch (const Error&) {  // expected for an invalid file
        }
    }
}

}  // namespace
}  // namespace coppice
