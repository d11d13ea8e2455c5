#include "coppice/io_mesh/solid_writer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "coppice/base/error.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class SolidWriter : public test::FolderTest {};

SolidMesh one_tetra() {
    SolidMesh out;
    out.origin = {10, 0, 0};
    out.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    out.tetra = {{0, 1, 2, 3}};
    return out;
}

std::string read_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
    T out;
    std::memcpy(&out, bytes.data() + at, sizeof out);
    return out;
}

TEST_F(SolidWriter, DeterminesTheFormatByName) {
    EXPECT_EQ(solid_format_of_name("a.vtu"), SolidFormat::vtu);
    EXPECT_EQ(solid_format_of_name("a.msh"), SolidFormat::msh);
    EXPECT_EQ(solid_format_of_name("a.ply"), std::nullopt);
    EXPECT_THROW(write_solid(folder_ / "a.ply", one_tetra()), Unsupported);
    EXPECT_THROW(write_solid(folder_ / "a.vtu", SolidMesh{}), InvalidInput);
}

TEST_F(SolidWriter, WritesVtuAsBase64WithSizes) {
    write_solid(folder_ / "a.vtu", one_tetra());
    const std::string text = read_bytes(folder_ / "a.vtu");
    EXPECT_NE(text.find("NumberOfPoints=\"4\" NumberOfCells=\"1\""), std::string::npos);
    // 32 bytes; 0, 1, 2, 3 as Int64.
    EXPECT_NE(text.find("Name=\"connectivity\" format=\"binary\">IAAAAAAAAAA="
                        "AAAAAAAAAAABAAAAAAAAAAIAAAAAAAAAAwAAAAAAAAA=</DataArray>"),
              std::string::npos)
        << text;
    // One byte: the number of VTK's tetrahedron, 10.
    EXPECT_NE(text.find("Name=\"types\" format=\"binary\">AQAAAAAAAAA=Cg==</DataArray>"), std::string::npos);
    // 96 bytes, beginning with 10 as a double: 0x4024000000000000.
    EXPECT_NE(text.find("NumberOfComponents=\"3\" format=\"binary\">YAAAAAAAAAA=AAAAAAAAJEA"),
              std::string::npos);
}

TEST_F(SolidWriter, WritesGmshNumberedFromOne) {
    write_solid(folder_ / "a.msh", one_tetra());
    const std::string bytes = read_bytes(folder_ / "a.msh");
    ASSERT_TRUE(bytes.starts_with("$MeshFormat\n2.2 1 8\n"));
    const std::size_t nodes = bytes.find("$Nodes\n4\n") + 9, elements = bytes.find("$Elements\n1\n") + 12;
    EXPECT_EQ(number_at<std::int32_t>(bytes, nodes + 28), 2);
    EXPECT_EQ(number_at<double>(bytes, nodes + 32), 11);
    const std::int32_t expected[]{4, 1, 2, 1, 1, 1, 1, 2, 3, 4};
    for (std::size_t i = 0; i < std::size(expected); ++i)
        EXPECT_EQ(number_at<std::int32_t>(bytes, elements + 4 * i), expected[i]);
    EXPECT_TRUE(bytes.ends_with("\n$EndElements\n"));
}

TEST_F(SolidWriter, WritesManyItemsInOrder) {
    // More than one run of items.
    SolidMesh many;
    for (int i = 0; i < 100'000; ++i) many.positions.push_back({static_cast<float>(i), 0, 0});
    for (std::uint32_t i = 0; i + 3 < 100'000; ++i) many.tetra.push_back({i, i + 1, i + 2, i + 3});
    write_solid(folder_ / "one.vtu", many, {.threads = 1});
    write_solid(folder_ / "many.vtu", many, {.threads = 4});
    EXPECT_EQ(read_bytes(folder_ / "one.vtu"), read_bytes(folder_ / "many.vtu"));
    write_solid(folder_ / "a.msh", many);
    const std::string bytes = read_bytes(folder_ / "a.msh");
    const std::size_t nodes = bytes.find("$Nodes\n100000\n") + 14;
    EXPECT_EQ(number_at<std::int32_t>(bytes, nodes + 28 * 99'999), 100'000);
    EXPECT_EQ(number_at<double>(bytes, nodes + 28 * 99'999 + 4), 99'999);
}

}  // namespace
}  // namespace coppice
