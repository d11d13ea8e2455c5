#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/io_points/reader.h"
#include "io_points/e57_file.h"

namespace coppice {
namespace {

using e57_file::Field;
using e57_file::Scan;
using e57_file::to_bits;

constexpr const char* kDouble = "type=\"Float\"";
constexpr const char* kSingle = "type=\"Float\" precision=\"single\"";

/// Position of the i-th point of the generated scans, in millimetres.
std::array<int, 3> place(std::size_t i) {
    const auto k = static_cast<int>(i);
    return {k % 50 * 20, k * 7 % 1000, k * 3 - 500};
}

Field real(const char* name, std::size_t count, std::size_t axis, bool single) {
    Field f{name, single ? kSingle : kDouble, single ? 32u : 64u, {}};
    for (std::size_t i = 0; i < count; ++i) {
        const double v = 0.001 * place(i)[axis];
        f.stored.push_back(single ? to_bits(static_cast<float>(v)) : to_bits(v));
    }
    return f;
}

/// In millimetres from `low` on, with the number of bits that `high` needs.
Field scaled(const char* name, std::size_t count, std::size_t axis, int low, std::int64_t high,
             unsigned bits) {
    Field f{name,
            "type=\"ScaledInteger\" minimum=\"" + std::to_string(low) + "\" maximum=\"" +
                std::to_string(high) + "\" scale=\"0.001\"",
            bits,
            {}};
    for (std::size_t i = 0; i < count; ++i)
        f.stored.push_back(static_cast<std::uint64_t>(place(i)[axis] - low));
    return f;
}

Scan make_scan(std::size_t count, bool single = false) {
    return {{real("cartesianX", count, 0, single), real("cartesianY", count, 1, single),
             real("cartesianZ", count, 2, single)},
            ""};
}

std::string error_of(std::string_view bytes) {
    try {
        parse_points(bytes, "p.e57");
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

void expect_made_points(const PointSet& set, std::size_t count) {
    ASSERT_EQ(set.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [x, y, z] = place(i);
        ASSERT_LT(distance(set.world(i), {0.001 * x, 0.001 * y, 0.001 * z}), 1e-6) << i;
    }
}

TEST(E57Reader, ReadsEveryTypeOfCoordinates) {
    constexpr std::size_t kCount = 1000;
    // 19 bits represent 500001, 11 bits 1023 + 1024, and 64 a range without a specified minimum.
    const Scan integers{
        {scaled("cartesianX", kCount, 0, -100, 499901, 19), scaled("cartesianY", kCount, 1, -1, 2046, 11),
         scaled("cartesianZ", kCount, 2, -500, std::int64_t{1} << 62, 63)},
        ""};
    for (const std::size_t piece : {1u, 7u, 100u, 5000u}) {
        SCOPED_TRACE(piece);
        expect_made_points(parse_points(e57_file::make({make_scan(kCount)}, piece), "p.e57"), kCount);
        expect_made_points(parse_points(e57_file::make({make_scan(kCount, true)}, piece), "p.e57"), kCount);
        expect_made_points(parse_points(e57_file::make({integers}, piece), "p.e57"), kCount);
    }
}

TEST(E57Reader, ReadsConstantsAndWholeRanges) {
    Scan scan = make_scan(3);
    scan.fields[2] = {"cartesianZ", "type=\"Integer\" minimum=\"7\" maximum=\"7\"", 0, {0, 0, 0}};
    // Without a range integers have 64 bits from -2^63 on: 5 is stored as 5 + 2^63.
    const std::uint64_t five = (std::uint64_t{1} << 63) + 5;
    scan.fields[1] = {"cartesianY", "type=\"Integer\"", 64, {five, five, five}};
    const PointSet set = parse_points(e57_file::make({scan}), "p.e57");
    ASSERT_EQ(set.size(), 3u);
    EXPECT_LT(distance(set.world(1), {0.02, 5, 7}), 1e-6);
}

TEST(E57Reader, JoinsScansByTheirPoses) {
    // The second scanner is rotated by a quarter about z: x is y, y is -x; and far away.
    const double half = std::sqrt(0.5);
    Scan turned = make_scan(40);
    turned.before_points =
        "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">" + std::to_string(half) +
        "</w><x type=\"Float\"/><y type=\"Float\">0</y><z type=\"Float\">" + std::to_string(half) +
        "</z></rotation><translation type=\"Structure\"><x type=\"Float\">4.5e6</x><y "
        "type=\"Float\">100</y><z type=\"Float\"/></translation></pose>";
    Scan first = make_scan(30);
    first.before_points =
        "<pose><translation><x type=\"Float\">4500010</x></translation></pose><name><![CDATA[<a>]]></name>";
    const PointSet set = parse_points(e57_file::make({first, turned}), "p.e57");
    ASSERT_EQ(set.size(), 70u);
    const auto [x, y, z] = place(21);
    EXPECT_LT(distance(set.world(21), {4500010 + 0.001 * x, 0.001 * y, 0.001 * z}), 2e-6);
    EXPECT_LT(distance(set.world(30 + 21), {4.5e6 - 0.001 * y, 100 + 0.001 * x, 0.001 * z}), 2e-6);
}

TEST(E57Reader, ReadsSphericalCoordinatesAndInvalidStates) {
    const double quarter = std::numbers::pi / 2;
    const Scan scan{
        {{"sphericalRange", kDouble, 64, {to_bits(2.0), to_bits(2.0), to_bits(2.0), to_bits(9.0)}},
         {"sphericalAzimuth", kDouble, 64, {to_bits(0.0), to_bits(quarter), to_bits(0.0), 0}},
         {"sphericalElevation", kDouble, 64, {to_bits(0.0), to_bits(0.0), to_bits(quarter), 0}},
         {"sphericalInvalidState", "type=\"Integer\" minimum=\"0\" maximum=\"2\"", 2, {0, 0, 0, 2}}},
        ""};
    const PointFile found = parse_point_file(e57_file::make({scan}), "p.e57");
    const PointSet& set = found.point_cloud.points;
    ASSERT_EQ(set.size(), 3u);
    EXPECT_EQ(found.without_return, 1u);
    EXPECT_LT(distance(set.world(0), {2, 0, 0}), 1e-6);
    EXPECT_LT(distance(set.world(1), {0, 2, 0}), 1e-6);
    EXPECT_LT(distance(set.world(2), {0, 0, 2}), 1e-6);
    Scan cartesian = make_scan(3);
    cartesian.fields.push_back(
        {"cartesianInvalidState", "type=\"Integer\" minimum=\"0\" maximum=\"2\"", 2, {0, 1, 0}});
    cartesian.fields[0].stored[2] = to_bits(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(parse_points(e57_file::make({cartesian}), "p.e57").size(), 1u);
}

TEST(E57Reader, ReadsPointAttributes) {
    Scan scan = make_scan(2);
    scan.fields.push_back({"intensity", kSingle, 32, {to_bits(0.25f), to_bits(1.0f)}});
    scan.fields.push_back({"colorRed", "type=\"Integer\" minimum=\"0\" maximum=\"255\"", 8, {0, 255}});
    scan.fields.push_back(
        {"colorGreen", "type=\"Integer\" minimum=\"0\" maximum=\"65535\"", 16, {65535, 257}});
    scan.fields.push_back({"colorBlue", kSingle, 32, {to_bits(1.0f), to_bits(0.0f)}});
    scan.fields.push_back({"returnIndex", "type=\"Integer\" minimum=\"0\" maximum=\"3\"", 2, {0, 1}});
    scan.fields.push_back({"returnCount", "type=\"Integer\" minimum=\"0\" maximum=\"4\"", 3, {1, 4}});
    scan.fields.push_back({"nor:normalX", kSingle, 32, {0, 0}});
    scan.before_points =
        "<colorLimits><colorRedMaximum>255</colorRedMaximum><colorBlueMaximum>1</colorBlueMaximum></"
        "colorLimits>";
    const std::string wkt =
        "<coordinateMetadata type=\"String\"><![CDATA[PROJCS[\"here\"]]]></coordinateMetadata>";
    const PointFile found = parse_point_file(e57_file::make({scan}, 100, wkt), "p.e57");
    EXPECT_EQ(found.format, "E57");
    EXPECT_EQ(found.system.name(), "here");
    EXPECT_EQ(found.point_cloud.intensities, (std::vector<float>{0.25f, 1}));
    EXPECT_EQ(found.point_cloud.colors, (std::vector<Rgb>{{0, 255, 255}, {255, 1, 0}}));
    EXPECT_EQ(found.point_cloud.return_numbers, (std::vector<std::uint8_t>{1, 2}));
    EXPECT_EQ(found.point_cloud.return_counts, (std::vector<std::uint8_t>{1, 4}));
}

TEST(E57Reader, RejectsDamagedFiles) {
    const std::string good = e57_file::make({make_scan(500)});
    std::string bytes = good;
    bytes[2000] = static_cast<char>(bytes[2000] ^ 1);
    EXPECT_EQ(error_of(bytes), "p.e57: page 2 of " + std::to_string(good.size() / 1024) +
                                   " of the E57 file is damaged: its checksum does not match");
    EXPECT_EQ(error_of(std::string_view(good).substr(0, 5000)),
              "p.e57: the file is cut off: it has 5000 of " + std::to_string(good.size()) +
                  " bytes, and the description of its points is at its end");
    EXPECT_EQ(error_of("ASTM-E57\1"), "p.e57: the file ends within its E57 header");
    EXPECT_EQ(error_of(e57_file::make({make_scan(0)})), "p.e57: it contains no points");
    EXPECT_EQ(error_of(e57_file::make({})), "p.e57: it contains no points");
    Scan scan = make_scan(3);
    scan.fields[0].attributes = "type=\"Integer\" minimum=\"4\" maximum=\"3\"";
    EXPECT_NE(error_of(e57_file::make({scan})).find("the range of the field 'cartesianX' is empty"),
              std::string::npos);
    scan.fields[0].name = "x";
    scan.fields[0].attributes = kDouble;
    EXPECT_EQ(error_of(e57_file::make({scan})), "p.e57: the points of a scan have no coordinates");
    const std::string entity = e57_file::make({make_scan(3)}, 100, "&a;");
    EXPECT_NE(error_of(entity).find("not valid XML"), std::string::npos);
}

TEST(E57Reader, ChecksCountsAgainstTheFile) {
    // All values are constant: only the count specifies the number of points.
    Scan scan = make_scan(1);
    for (Field& field : scan.fields)
        field = {field.name, "type=\"Integer\" minimum=\"1\" maximum=\"1\"", 0, {}};
    scan.fields[0].stored.assign(20, 0);
    EXPECT_EQ(parse_points(e57_file::make({scan}), "p.e57").size(), 20u);
    scan.fields[0].stored.assign(1000000, 0);
    EXPECT_EQ(error_of(e57_file::make({scan})),
              "p.e57: the E57 file is damaged: its XML specifies more points than it can contain");
}

TEST(E57Reader, RejectsEveryTruncation) {
    const std::string bytes = e57_file::make({make_scan(100)});
    for (std::size_t size = 8; size < bytes.size(); size += 5)
        EXPECT_THROW(parse_points(std::string_view(bytes).substr(0, size), "p.e57"), InvalidInput) << size;
}

TEST(E57Reader, DamagedFilesAreReadOrRejected) {
    const std::string good = e57_file::make({make_scan(40), make_scan(30, true)}, 9);
    const CounterRandom random(3, 1);
    for (std::uint64_t turn = 0; turn < 3000; ++turn) {
        std::string bytes = good;
        for (std::uint64_t k = 0; k < 3; ++k) {
            const std::uint64_t draw = random.bits(8 * turn + k);
            const std::size_t at = 8 + (draw >> 8) % (bytes.size() - 8);
            bytes[at] = static_cast<char>(draw);
            e57_file::mend(bytes, at / 1024);
        }
        try {
            for (const Vec3 p : parse_points(bytes, "p.e57").positions) ASSERT_TRUE(is_finite(p));
        } catch (const Error&) {  // expected for an invalid file
        }
    }
}

}  // namespace
}  // namespace coppice
