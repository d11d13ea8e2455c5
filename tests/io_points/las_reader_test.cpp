#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/io_points/reader.h"

namespace coppice {
namespace {

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}

struct LasKind {
    int minor = 2, format = 3;
    std::uint16_t record = 34;
};

/// Three points at (1, 2, 3), (-1, 0.5, 4) and (1.001, 2, 3), minus the offset in millimetres.
std::string las_file(const LasKind& kind) {
    const std::size_t header = kind.minor == 4 ? 375 : kind.minor == 3 ? 235 : 227;
    std::string bytes(header + 3u * kind.record, '\0');
    std::memcpy(bytes.data(), "LASF", 4);
    put<std::uint8_t>(bytes, 24, 1);
    put(bytes, 25, static_cast<std::uint8_t>(kind.minor));
    put(bytes, 94, static_cast<std::uint16_t>(header));
    put(bytes, 96, static_cast<std::uint32_t>(header));
    put(bytes, 104, static_cast<std::uint8_t>(kind.format));
    put(bytes, 105, kind.record);
    put<std::uint32_t>(bytes, 107, kind.minor == 4 ? 0 : 3);
    if (kind.minor == 4) put<std::uint64_t>(bytes, 247, 3);
    const double offset[3] = {1e6, 2e6, 100};
    const std::int32_t raw[3][3] = {{1000, 2000, 3000}, {-1000, 500, 4000}, {1001, 2000, 3000}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(bytes, 131 + 8 * axis, 0.001);
        put(bytes, 155 + 8 * axis, offset[axis]);
        for (std::size_t i = 0; i < 3; ++i) put(bytes, header + i * kind.record + 4 * axis, raw[i][axis]);
    }
    return bytes;
}

std::string error_of(std::string_view bytes) {
    try {
        parse_points(bytes, "p.las");
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

constexpr LasKind kKinds[] = {{0, 0, 20}, {1, 1, 28}, {2, 3, 34}, {2, 2, 40}, {3, 4, 57},
                              {3, 5, 63}, {4, 6, 30}, {4, 7, 36}, {4, 8, 38}, {4, 10, 67}};

TEST(LasReader, ReadsAllVersionsAndFormats) {
    for (const LasKind& kind : kKinds) {
        SCOPED_TRACE(kind.format);
        const PointSet set = parse_points(las_file(kind), "p.las");
        ASSERT_EQ(set.size(), 3u);
        EXPECT_LT(distance(set.world(0), {1e6 + 1, 2e6 + 2, 103}), 1e-6);
        EXPECT_LT(distance(set.world(1), {1e6 - 1, 2e6 + 0.5, 104}), 1e-6);
        // A millimetre from the first, which floats at 2e6 would lose.
        EXPECT_NEAR(set.world(2).x - set.world(0).x, 0.001, 1e-6);
    }
}

TEST(LasReader, PreservesTheDigitsOfDistantCoordinates) {
    // Swiss coordinates in multiples of 0.1 mm, over 40 m: the origin is within 64 m, and half a step of
    // floats below 64 is 1.9e-6.
    std::string bytes = las_file({2, 3, 34});
    const double offset[3] = {2.86e6, 1.18e6, 1500};
    const std::int32_t raw[3][3] = {{1, 2, 3}, {400003, 200007, 123456}, {123457, 200001, 9}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(bytes, 131 + 8 * axis, 1e-4);
        put(bytes, 155 + 8 * axis, offset[axis]);
        for (std::size_t i = 0; i < 3; ++i) put(bytes, 227 + i * 34 + 4 * axis, raw[i][axis]);
    }
    const PointSet set = parse_points(bytes, "p.las");
    ASSERT_EQ(set.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            // The sum in double precision adds half a step at 2.86e6, 2.3e-10, three times.
            EXPECT_NEAR(set.world(i)[axis], raw[i][a] * 1e-4 + offset[a], 2e-6) << i << ' ' << axis;
        }
    }
}

TEST(LasReader, ReadsPointAttributes) {
    std::string bytes = las_file({2, 3, 34});
    put<std::uint16_t>(bytes, 227 + 12, 700);
    bytes[227 + 14] = 2 | 3 << 3;              // the second of three returns
    bytes[227 + 15] = 0x25;                    // class 5, a key point
    put<std::uint16_t>(bytes, 227 + 28, 255);  // writers that support 8 bits only leave the upper ones zero
    put<std::uint16_t>(bytes, 227 + 34 + 32, 7);
    const PointCloud found = parse_point_cloud(bytes, "p.las");
    EXPECT_EQ(found.intensities, (std::vector<float>{700, 0, 0}));
    EXPECT_EQ(found.return_numbers, (std::vector<std::uint8_t>{2, 0, 0}));
    EXPECT_EQ(found.return_counts, (std::vector<std::uint8_t>{3, 0, 0}));
    EXPECT_EQ(found.classes, (std::vector<std::uint8_t>{5, 0, 0}));
    EXPECT_EQ(found.colors, (std::vector<Rgb>{{255, 0, 0}, {0, 0, 7}, {0, 0, 0}}));
    put<std::uint16_t>(bytes, 227 + 30, 0x1234);
    EXPECT_EQ(parse_point_cloud(bytes, "p.las").colors,
              (std::vector<Rgb>{{0, 0x12, 0}, {0, 0, 0}, {0, 0, 0}}));
    const PointCloud plain = parse_point_cloud(las_file({4, 7, 36}), "p.las");
    EXPECT_TRUE(plain.classes.empty() && plain.intensities.empty() && plain.colors.empty());
    const PointCloud places = parse_point_cloud(bytes, "p.las", kNoColumns);
    EXPECT_TRUE(places.classes.empty() && places.intensities.empty() && places.colors.empty());
    EXPECT_EQ(places.points, found.points);
}

TEST(LasReader, SkipsWithheldPoints) {
    std::string old = las_file({2, 3, 34});
    put<std::uint8_t>(old, 227 + 34 + 15, 0x82);
    EXPECT_EQ(parse_points(old, "p.las").size(), 2u);
    std::string recent = las_file({4, 6, 30});
    put<std::uint8_t>(recent, 375 + 15, 0x04);
    EXPECT_EQ(parse_points(recent, "p.las").size(), 2u);
}

TEST(LasReader, RejectsUnsupportedAndInvalidFiles) {
    std::string bytes = las_file({2, 3, 34});
    put<std::uint8_t>(bytes, 25, 5);
    EXPECT_EQ(error_of(bytes),
              "p.las: it is LAS 1.5, but only 1.0 to 1.4 can be read; convert it to LAS 1.4");
    bytes = las_file({2, 3, 34});
    put<std::uint8_t>(bytes, 104, 11);
    EXPECT_EQ(error_of(bytes), "p.las: its point format 11 is unknown; 0 to 10 can be read");
    bytes = las_file({2, 3, 34});
    put<std::uint16_t>(bytes, 105, 33);
    EXPECT_EQ(error_of(bytes), "p.las: its points have 33 bytes, fewer than format 3 has");
    bytes = las_file({2, 3, 34});
    put(bytes, 131, 0.0);
    EXPECT_EQ(error_of(bytes), "p.las: its LAS header has scales or offsets that are zero or not finite");
    put(bytes, 131, std::nan(""));
    EXPECT_EQ(error_of(bytes), "p.las: its LAS header has scales or offsets that are zero or not finite");
    put(bytes, 131, 1e300);
    EXPECT_EQ(error_of(bytes), "p.las: the coordinates of its points are not finite or beyond 1e30");
    bytes = las_file({2, 3, 34});
    put<std::uint32_t>(bytes, 107, 0);
    EXPECT_EQ(error_of(bytes), "p.las: it contains no points");
}

TEST(LasReader, RejectsCountsBeyondTheFile) {
    std::string bytes = las_file({4, 6, 30});
    put<std::uint64_t>(bytes, 247, std::uint64_t{1} << 62);
    EXPECT_EQ(error_of(bytes),
              "p.las: the file is cut off or damaged: its header specifies 4611686018427387904 points, but "
              "it contains 3");
    EXPECT_THROW(parse_point_file(bytes, "p.las", {}), TruncatedFile);
    bytes = las_file({2, 3, 34});
    put<std::uint32_t>(bytes, 96, 0xffffffffu);
    EXPECT_NE(error_of(bytes).find("but it contains 0"), std::string::npos);
    put<std::uint32_t>(bytes, 96, 4);  // points overlap the header
    EXPECT_NE(error_of(bytes).find("cut off or damaged"), std::string::npos);
}

TEST(LasReader, ReadsTheCompletePointsOfATruncatedFile) {
    // the second lacks its last byte
    const std::string bytes = las_file({2, 3, 34}).substr(0, 227 + 34 + 33);
    const PointFile file = parse_point_file(bytes, "p.las", {}, {.allow_truncated = true});
    ASSERT_EQ(file.point_cloud.points.size(), 1u);
    EXPECT_EQ(file.missing, 2u);
    EXPECT_EQ(file.format, "LAS 1.2, point format 3");
    EXPECT_LT(distance(file.point_cloud.points.world(0), {1e6 + 1, 2e6 + 2, 103}), 1e-6);
    const auto none = [&] { parse_point_file(bytes.substr(0, 228), "p.las", {}, {.allow_truncated = true}); };
    EXPECT_THROW(none(), InvalidInput);
    EXPECT_EQ(parse_point_file(las_file({2, 3, 34}), "p.las", {}, {.allow_truncated = true}).missing, 0u);
}

/// Returns an entry of the record about extra bytes.
std::string dimension(std::string_view name, std::uint8_t type, std::uint8_t options = 0) {
    std::string entry(192, '\0');
    put(entry, 2, type);
    put(entry, 3, options);
    entry.replace(4, name.size(), name);
    return entry;
}

/// Inserts a variable length record before the points of a file without any.
void add_record(std::string& bytes, std::string_view user, std::uint16_t id, std::string_view data) {
    std::string record(54, '\0');
    record.replace(2, user.size(), user);
    put(record, 18, id);
    put(record, 20, static_cast<std::uint16_t>(data.size()));
    record += data;
    std::uint32_t at = 0, count = 0;
    std::memcpy(&at, bytes.data() + 96, 4);
    std::memcpy(&count, bytes.data() + 100, 4);
    bytes.insert(at, record);
    put(bytes, 96, static_cast<std::uint32_t>(at + record.size()));
    put(bytes, 100, count + 1);
}

TEST(LasReader, ReadsExtraDimensions) {
    // 2 raw bytes, then i16 height with scale 0.5 and offset 10, f32 wood, i32 PredInstance with -1 for no
    // tree.
    std::string bytes = las_file({4, 6, 42});
    const std::int16_t height[3] = {2, 4, 8};
    const float wood[3] = {0.25f, std::nanf(""), 0.75f};
    const std::int32_t tree[3] = {7, -1, 70000};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t at = 375 + 42 * i + 30;
        put(bytes, at + 2, height[i]);
        put(bytes, at + 4, wood[i]);
        put(bytes, at + 8, tree[i]);
    }
    std::string scaled = dimension("height", 4, 8 | 16), predicted = dimension("PredInstance", 6, 1);
    put(scaled, 112, 0.5);
    put(scaled, 136, 10.0);
    put<std::int64_t>(predicted, 40, -1);
    add_record(bytes, "LASF_Spec", 4, dimension("", 0, 2) + scaled + dimension("wood", 9) + predicted);
    const PointFile file = parse_point_file(bytes, "p.las", {.ranges = true});
    EXPECT_EQ(file.point_cloud.tree_ids, (std::vector<std::uint32_t>{7, 0, 70000}));
    ASSERT_EQ(file.dimensions.size(), 3u);
    EXPECT_EQ(file.dimensions[0].name, "height");
    EXPECT_EQ(file.dimensions[0].low, 11);
    EXPECT_EQ(file.dimensions[0].high, 14);
    EXPECT_EQ(file.dimensions[1].low, 0.25);
    EXPECT_EQ(file.dimensions[1].high, 0.75);
    EXPECT_EQ(file.dimensions[2].name, "PredInstance");
    EXPECT_EQ(file.dimensions[2].low, 7);
    EXPECT_TRUE(parse_point_file(bytes, "p.las", kNoColumns).point_cloud.tree_ids.empty());
    EXPECT_TRUE(parse_point_file(bytes, "p.las").dimensions.empty());
}

TEST(LasReader, SkipsDimensionsBeyondTheRecord) {
    std::string bytes = las_file({4, 6, 34});
    put<std::uint32_t>(bytes, 375 + 30, 5);
    add_record(bytes, "LASF_Spec", 4, dimension("label", 5) + dimension("treeID", 5));
    const PointFile file = parse_point_file(bytes, "p.las", {.ranges = true});
    EXPECT_EQ(file.point_cloud.tree_ids, (std::vector<std::uint32_t>{5, 0, 0}));
    EXPECT_EQ(file.dimensions.size(), 1u);
}

TEST(LasReader, ReadsTheNameOfTheCoordinateSystem) {
    const auto named = [](std::uint16_t id, std::string_view data) {
        std::string bytes = las_file({4, 6, 30});
        add_record(bytes, "LASF_Projection", id, data);
        return parse_point_file(bytes, "p.las").system.name();
    };
    const std::string zone = "PROJCS[\"ETRS89 / UTM zone 32N\",AUTHORITY[\"EPSG\",\"25832\"]]";
    EXPECT_EQ(named(2112, zone + '\0'), "EPSG:25832");
    EXPECT_EQ(
        named(2112, "PROJCS[\"Local grid\",UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],AXIS[\"X\",EAST]]"),
        "Local grid");
    EXPECT_EQ(named(2112, "COMPD_CS[\"a b\",PROJCS[\"x\"],VERT_CS[\"y\",AUTHORITY[\"EPSG\",\"5783\"]]]"),
              "a b");
    std::string keys(16, '\0');
    put<std::uint16_t>(keys, 8, 3072);
    put<std::uint16_t>(keys, 14, 25832);
    EXPECT_EQ(named(34735, keys), "EPSG:25832");
    EXPECT_EQ(parse_point_file(las_file({4, 6, 30}), "p.las").system.name(), "");
}

TEST(LasReader, RejectsEveryTruncation) {
    for (const LasKind& kind : {kKinds[2], kKinds[6]}) {
        const std::string bytes = las_file(kind);
        for (std::size_t size = 4; size < bytes.size(); ++size) {
            EXPECT_THROW(parse_points(std::string_view(bytes).substr(0, size), "p.las"), InvalidInput)
                << size;
        }
    }
}

TEST(LasReader, DamagedFilesAreReadOrRejected) {
    const CounterRandom random(5, 1);
    for (std::uint64_t turn = 0; turn < 3000; ++turn) {
        std::string bytes = las_file(kKinds[turn % std::size(kKinds)]);
        for (std::uint64_t k = 0; k < 3; ++k) {
            const std::uint64_t draw = random.bits(8 * turn + k);
            bytes[4 + (draw >> 8) % (bytes.size() - 4)] = static_cast<char>(draw);
        }
        try {
            const PointSet set = parse_points(bytes, "p.las");
            for (const Vec3 p : set.positions) ASSERT_TRUE(is_finite(p));
        } catch (const Error&) {  // expected for an invalid file
        }
    }
}

}  // namespace
}  // namespace coppice
