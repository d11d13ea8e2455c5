#include "coppice/scene/file_kind.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"
#include "coppice/system/file.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class FileKinds : public test::FolderTest {
  protected:
    std::optional<FileKind> detect_kind(const std::string& name, std::string_view bytes) {
        AtomicFile file(folder_ / name);
        file.write(bytes);
        file.commit();
        return kind_of_file(folder_ / name);
    }
};

TEST_F(FileKinds, FollowNameAndContent) {
    using enum FileKind;
    EXPECT_EQ(detect_kind("a.swc", ""), skeleton);
    EXPECT_EQ(detect_kind("a.stl", ""), mesh);
    EXPECT_EQ(detect_kind("a.LAS", ""), points);
    EXPECT_EQ(detect_kind("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), skeleton);
    EXPECT_EQ(detect_kind("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), mesh);
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n";
    EXPECT_EQ(detect_kind("a.ply", head + "end_header\n"), points);
    EXPECT_EQ(detect_kind("a.ply", head + "element face 0\nend_header\n"), points);
    EXPECT_EQ(detect_kind("a.ply", head + "element face 1\nend_header\n"), mesh);
    EXPECT_EQ(detect_kind("a.ply", head + "element edge 1\nend_header\n"), skeleton);
    EXPECT_EQ(detect_kind("a.off", "OFF\n# points\n3 0 0\n"), points);
    EXPECT_EQ(detect_kind("a.off", "OFF 3 1 0\n"), mesh);
    EXPECT_EQ(detect_kind("a.txt", "1 2 3\n4 5 6\n"), points);
    EXPECT_EQ(detect_kind("a.txt", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.1 1\n"), skeleton);
}

TEST_F(FileKinds, OfUnknownNamesFollowTheContent) {
    using enum FileKind;
    EXPECT_EQ(detect_kind("a.dat", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.1 1\n"), skeleton);
    EXPECT_EQ(detect_kind("a.dat", "OFF\n3 0 0\n"), points);
    EXPECT_EQ(detect_kind("a.dat", "solid x\nfacet normal 0 0 1\n"), mesh);
    EXPECT_EQ(detect_kind("a.dat", "LASF"), points);
    EXPECT_EQ(detect_kind("photo.jpg", "\xff\xd8\xff\xe0 JFIF"), std::nullopt);
    EXPECT_EQ(detect_kind("photo.png", "\x89PNG\r\n\x1a\n"), std::nullopt);
    EXPECT_EQ(detect_kind("notes.md", "# Notes\n\nThe oak was scanned in May.\n"), std::nullopt);
    EXPECT_EQ(detect_kind("empty", ""), std::nullopt);
    EXPECT_THROW(kind_of_file(folder_ / "missing.jpg"), IoError);
    EXPECT_THROW(kind_of_file(folder_ / "missing.swc"), IoError);
}

TEST(OutputKind, FollowsTheNameOnly) {
    using enum FileKind;
    EXPECT_EQ(kind_of_output("a.glb", skeleton), mesh);
    EXPECT_EQ(kind_of_output("a.swc", mesh), skeleton);
    EXPECT_EQ(kind_of_output("a.ply", skeleton), skeleton);
    EXPECT_EQ(kind_of_output("a.obj", mesh), mesh);
    EXPECT_EQ(kind_of_output("a.jpg", mesh), std::nullopt);
}

}  // namespace
}  // namespace coppice
