#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/io_points/reader.h"

namespace coppice {
namespace {

const std::string kHead =
    "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\n"
    "COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";

std::string to_bytes(std::initializer_list<float> values) {
    std::string bytes;
    for (const float v : values) {
        std::array<char, 4> raw{};
        std::memcpy(raw.data(), &v, 4);
        bytes.append(raw.data(), 4);
    }
    return bytes;
}

std::string number(std::uint32_t v) {
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &v, 4);
    return bytes;
}

const std::string kAscii = kHead + "DATA ascii\n1 2 3 0\n4 5.5 6 16711680\n";
const std::string kBinary = kHead + "DATA binary\n" + to_bytes({1, 2, 3, 0, 4, 5.5f, 6, 0});

/// Compresses the fields in sequence, here as literal runs of up to 32 bytes and, at the end, one copy of
/// four zeros.
std::string compressed_file() {
    const std::string fields = to_bytes({1, 4, 2, 5.5f, 3, 6, 0});  // the last number is copied
    std::string packed;
    packed += static_cast<char>(fields.size() - 1);
    packed += fields;
    packed += static_cast<char>(2 << 5);  // copies 2 + 2 bytes
    packed += static_cast<char>(3);       // from 4 back
    return kHead + "DATA binary_compressed\n" + number(static_cast<std::uint32_t>(packed.size())) +
           number(32) + packed;
}

std::string error_of(std::string_view bytes) {
    try {
        parse_points(bytes, "p.pcd");
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return "no error";
}

std::string with(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

TEST(PcdReader, ReadsAllThreeEncodings) {
    for (const std::string& bytes : {kAscii, kBinary, compressed_file()}) {
        const PointSet set = parse_points(bytes, "p.pcd");
        ASSERT_EQ(set.size(), 2u);
        EXPECT_EQ(set.world(0), Vec3d(1, 2, 3));
        EXPECT_EQ(set.world(1), Vec3d(4, 5.5, 6));
    }
}

TEST(PcdReader, FindsTheFieldsByName) {
    const std::string bytes =
        "VERSION 0.7\nFIELDS label z f y x\nSIZE 1 2 4 4 8\nTYPE U I F I F\nCOUNT 1 1 2 1 1\nWIDTH 1\nHEIGHT "
        "1\n"
        "DATA binary\n";
    std::string row(1 + 2 + 8 + 4 + 8, '\0');
    const std::int16_t z = -7;
    const std::int32_t y = -100000;
    const double x = 0.25;
    std::memcpy(row.data() + 1, &z, 2);
    std::memcpy(row.data() + 11, &y, 4);
    std::memcpy(row.data() + 15, &x, 8);
    const PointSet set = parse_points(bytes + row, "p.pcd");
    EXPECT_EQ(set.world(0), Vec3d(0.25, -100000, -7));
}

TEST(PcdReader, SkipsPointsWithoutAPosition) {
    const std::string bytes = with(kAscii, "1 2 3 0", "nan nan nan 0");
    EXPECT_EQ(parse_points(bytes, "p.pcd").size(), 1u);
}

TEST(PcdReader, ReportsErrors) {
    EXPECT_EQ(error_of(with(kAscii, "4 5.5 6 16711680\n", "")),
              "p.pcd: the file is cut off: its header specifies 2 points, but it contains 1");
    EXPECT_EQ(error_of(with(kAscii, "5.5", "x5")), "p.pcd:13: 'x5' is not a number");
    EXPECT_EQ(error_of(with(kAscii, " 16711680", "")), "p.pcd:13: it has 3 values, but the fields need 4");
    EXPECT_EQ(error_of(with(kAscii, "x y z", "x y w")), "p.pcd: the points lack a field x, y or z");
    EXPECT_EQ(error_of(with(kAscii, "TYPE F", "TYPE Q")), "p.pcd:5: 'Q' is not a field type");
    EXPECT_EQ(error_of(with(kAscii, "SIZE 4", "SIZE 3")), "p.pcd:4: '3' is not a field size");
    EXPECT_EQ(error_of(with(kAscii, "SIZE 4 4", "SIZE 4")), "p.pcd:4: it has 3 values for 4 fields");
    EXPECT_EQ(error_of(with(kAscii, "DATA ascii", "DATA morse")),
              "p.pcd:11: DATA must be ascii, binary or binary_compressed");
    EXPECT_EQ(error_of(kHead), "p.pcd: the file ends within its PCD header: there is no line DATA");
    EXPECT_EQ(error_of(with(kBinary, "POINTS 2", "POINTS 99999999999")),
              "p.pcd: the file is cut off: its header specifies 99999999999 points, but it contains 2");
    EXPECT_EQ(error_of(with(kAscii, "4 5.5", "1e40 5.5")), "p.pcd: point 1 is not finite or beyond 1e30");
}

TEST(PcdReader, RejectsDamagedCompression) {
    const std::string good = compressed_file();
    const std::size_t data = good.find("compressed\n") + 11;
    for (std::size_t size = data; size < good.size(); ++size) {
        EXPECT_THROW(parse_points(std::string_view(good).substr(0, size), "p.pcd"), InvalidInput) << size;
    }
    std::string bytes = good;
    bytes.back() = 100;  // copies from before the start
    EXPECT_EQ(error_of(bytes), "p.pcd: its compressed points are cut off or damaged");
    bytes = good;
    bytes.replace(data + 4, 4, number(0xfffffff0u));  // specifies more than the bytes can decompress to
    EXPECT_EQ(error_of(bytes), "p.pcd: its compressed points are cut off or damaged");
}

TEST(PcdReader, DamagedFilesAreReadOrRejected) {
    const CounterRandom random(6, 1);
    for (const std::string& good : {kAscii, kBinary, compressed_file()}) {
        for (std::uint64_t turn = 0; turn < 2000; ++turn) {
            std::string bytes = good;
            for (std::uint64_t k = 0; k < 3; ++k) {
                const std::uint64_t draw = random.bits(8 * turn + k);
                bytes[10 + (draw >> 8) % (bytes.size() - 10)] = static_cast<char>(draw);
            }
            try {
                const PointSet set = parse_points(bytes, "p.pcd");
                for (const Vec3 p : set.positions) ASSERT_TRUE(is_finite(p));
            } catch (const Error&) {  // expected for an invalid file
            }
        }
    }
}

}  // namespace
}  // namespace coppice
