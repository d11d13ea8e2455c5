#include "coppice/io/ply_header.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "skeleton/text.h"

namespace coppice {
namespace {

using test::error_of;
using test::to_bytes;

const std::string kHead =
    "ply\nformat ascii 1.0\ncomment  made by hand \nelement vertex 2\nproperty float x\nproperty uchar red\n"
    "element face 1\nproperty list uint8 int32 vertex_indices\nproperty double area\nend_header\n";

std::string with_format(const std::string& format) {
    std::string head = kHead;
    return head.replace(head.find("ascii"), 5, format);
}

std::string reversed(std::string bytes) {
    std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

/// Returns all values of all rows, lists after their lengths.
std::vector<double> all_values(const std::string& file) {
    const PlyHeader header = parse_ply_header(file, "t.ply");
    PlyRows rows(file, header, "t.ply");
    std::vector<double> values;
    PlyRow row;
    for (const PlyElement& element : header.elements) {
        rows.begin_element(element);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            rows.read(row);
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                if (element.properties[p].is_list())
                    values.push_back(static_cast<double>(row.list(p).size()));
                for (const double v : row.list(p)) values.push_back(v);
            }
        }
    }
    return values;
}

const std::vector<double> kValues{1.5, 255, -2.25, 7, 3, 0, 1, -1, 0.1};

TEST(PlyHeader, HasElementsAndProperties) {
    const PlyHeader header = parse_ply_header(kHead, "t.ply");
    EXPECT_EQ(header.encoding, PlyEncoding::ascii);
    ASSERT_EQ(header.elements.size(), 2u);
    EXPECT_EQ(header.elements[0].name, "vertex");
    EXPECT_EQ(header.elements[0].count, 2u);
    EXPECT_EQ(header.elements[0].find({"y", "red"}), 1u);
    EXPECT_FALSE(header.elements[0].find({"y"}));
    EXPECT_FALSE(header.elements[0].has_list());
    EXPECT_TRUE(header.elements[1].has_list());
    EXPECT_EQ(header.elements[0].min_row_bytes(PlyEncoding::little_endian), 5u);
    EXPECT_EQ(header.elements[1].min_row_bytes(PlyEncoding::little_endian), 9u);
    ASSERT_EQ(header.comments.size(), 1u);
    EXPECT_EQ(header.comments[0], "made by hand");
    EXPECT_EQ(header.data_offset, kHead.size());
}

TEST(PlyRows, AsciiValuesMaySpanLines) {
    EXPECT_EQ(all_values(kHead + "1.5 255\r\n-2.25\n7\n3 0 1 -1 0.1"), kValues);
}

TEST(PlyRows, ReadsBothByteOrders) {
    const std::string little = to_bytes(1.5f) + to_bytes<std::uint8_t>(255) + to_bytes(-2.25f) +
                               to_bytes<std::uint8_t>(7) + to_bytes<std::uint8_t>(3) + to_bytes(0) +
                               to_bytes(1) + to_bytes(-1) + to_bytes(0.1);
    const std::string big = reversed(to_bytes(1.5f)) + "\xff" + reversed(to_bytes(-2.25f)) + "\x07" + "\x03" +
                            reversed(to_bytes(0)) + reversed(to_bytes(1)) + reversed(to_bytes(-1)) +
                            reversed(to_bytes(0.1));
    EXPECT_EQ(all_values(with_format("binary_little_endian") + little), kValues);
    EXPECT_EQ(all_values(with_format("binary_big_endian") + big), kValues);
}

TEST(PlyRows, FixedRowsAreReturnedAsOneBlock) {
    const std::string file =
        "ply\nformat binary_little_endian 1.0\nelement a 2\nproperty uchar v\nelement b 1\nproperty uchar v\n"
        "end_header\nabc";
    const PlyHeader header = parse_ply_header(file, "t.ply");
    PlyRows rows(file, header, "t.ply");
    rows.begin_element(header.elements[0]);
    EXPECT_EQ(rows.take_fixed_rows(), "ab");
    rows.begin_element(header.elements[1]);
    rows.skip_element();
    EXPECT_EQ(rows.offset(), file.size());
}

TEST(PlyRows, RejectsTruncatedFilesOfEveryLength) {
    const std::string binary =
        with_format("binary_little_endian") + std::string(10, '\0') + "\x01" + std::string(12, '\0');
    ASSERT_NO_THROW(all_values(binary));
    for (std::size_t size = 0; size < binary.size(); ++size) {
        EXPECT_THROW(all_values(binary.substr(0, size)), InvalidInput) << size;
    }
}

TEST(PlyRows, RejectsHugeCountsBeforeAllocation) {
    std::string head = kHead;
    head.replace(head.find("vertex 2"), 8, "vertex 9007199254740992");
    EXPECT_EQ(error_of<InvalidInput>([&] { all_values(head + "1 2 3 4"); }),
              "t.ply: the header specifies 9007199254740992 rows of 'vertex', but the file is too short for "
              "them; it is truncated or damaged");
    EXPECT_EQ(error_of<InvalidInput>([&] { all_values(kHead + "1 2 3 4 4000000000 1 2"); }),
              "t.ply: the list 'vertex_indices' specifies 4000000000 items, more than the file can contain "
              "in row 1 "
              "of 'face'");
    EXPECT_THROW(all_values(kHead + "1 2 3 4 -1 1 2"), InvalidInput);
    EXPECT_THROW(all_values(kHead + "1 2 3 4 nan 1 2"), InvalidInput);
}

TEST(PlyHeader, ErrorsReportTheLine) {
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_ply_header(text, "t.ply"); });
    };
    EXPECT_EQ(error("plx\n"), "t.ply: not a PLY file: it does not start with 'ply'");
    EXPECT_EQ(error("ply\nformat ascii 1.0\n"),
              "t.ply: the PLY header has no end_header; the file is truncated");
    EXPECT_EQ(error("ply\nend_header\n"), "t.ply: the PLY header has no 'format' line");
    EXPECT_EQ(error("ply\nformat text 1.0\n"),
              "t.ply:2: the format must be ascii, binary_little_endian or binary_big_endian");
    EXPECT_EQ(error("ply\nproperty float x\n"), "t.ply:2: a property precedes the first element");
    EXPECT_EQ(error("ply\nelement vertex -1\n"), "t.ply:2: expected 'element NAME COUNT'");
    EXPECT_EQ(error("ply\nelement vertex 1\nproperty half x\n"), "t.ply:3: 'half' is not a PLY type");
    EXPECT_EQ(error("ply\nelement f 1\nproperty list float int v\n"),
              "t.ply:3: the length of a list must be an integer");
    EXPECT_EQ(error("ply\nelement f 1\nproperty list uchar v\n"),
              "t.ply:3: expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    EXPECT_EQ(error("ply\nhello\n"), "t.ply:2: 'hello' is not a keyword of a PLY header");
    EXPECT_EQ(error("ply\nformat ascii 1.0\nelement vertex 5\nend_header\n"),
              "t.ply: the PLY element 'vertex' has rows but no properties");
}

}  // namespace
}  // namespace coppice
