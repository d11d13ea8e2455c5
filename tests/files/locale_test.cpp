#include <gtest/gtest.h>

#include <array>

#include "comma_locale.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/system/file.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class Locale : public test::FolderTest {};

/// Returns the bytes of all written files, far from zero so that there are many digits.
std::string written(const std::filesystem::path& folder) {
    const Skeleton tree = random_tree(1500, 3);
    std::string bytes;
    for (const auto format : {SkeletonFormat::swc, SkeletonFormat::cylinders, SkeletonFormat::ply,
                              SkeletonFormat::obj, SkeletonFormat::json}) {
        bytes += encode_skeleton(tree, {.format = format, .binary = false});
    }
    PointSet points;
    points.positions.assign(tree.positions().begin(), tree.positions().end());
    points.origin = {12345.5, 0, 0};
    PolygonMesh mesh;
    mesh.positions = {{1234.5f, 0, 0}, {0, 1234.25f, 0}, {0, 0, 0.125f}};
    mesh.add_face(std::array<std::uint32_t, 3>{0, 1, 2});
    for (const char* name : {"p.xyz", "p.csv", "p.ply"}) {
        write_points(folder / name, points);
        bytes += read_file(folder / name);
    }
    for (const char* name : {"m.obj", "m.ply", "m.stl", "m.glb", "m.usda"}) {
        write_mesh(folder / name, mesh);
        bytes += read_file(folder / name);
    }
    return bytes;
}

TEST_F(Locale, DoesNotAffectWrittenFiles) {
    const std::string plain = written(folder_);
    const test::CommaLocale comma;
    EXPECT_EQ(written(folder_), plain);
}

TEST_F(Locale, DoesNotAffectReadFiles) {
    written(folder_);
    const Skeleton tree = random_tree(1500, 3);
    const PointSet points = read_points(folder_ / "p.xyz");
    const PolygonMesh mesh = read_mesh(folder_ / "m.obj");
    const test::CommaLocale comma;
    for (const auto format :
         {SkeletonFormat::swc, SkeletonFormat::ply, SkeletonFormat::obj, SkeletonFormat::json}) {
        const Skeleton back = parse_skeleton(encode_skeleton(tree, {.format = format, .binary = false}), "s",
                                             {.format = format, .scale = 0.5f})
                                  .skeleton;
        ASSERT_EQ(back.size(), tree.size());
        EXPECT_NEAR(back.radius(NodeId(0)), tree.radius(NodeId(0)) / 2, 1e-7f);
    }
    EXPECT_EQ(read_points(folder_ / "p.xyz"), points);
    EXPECT_EQ(read_points(folder_ / "p.csv"), points);
    EXPECT_EQ(read_mesh(folder_ / "m.obj").positions, mesh.positions);
    EXPECT_EQ(read_mesh(folder_ / "m.glb").positions.size(), 3u);
}

}  // namespace
}  // namespace coppice
