// Reads the third-party files next to the checkout, if they exist.

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/stated_axes.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "paths.h"

namespace coppice {
namespace {

const std::filesystem::path kData = source_dir() / ".." / "shared" / "data";

std::vector<std::filesystem::path> files_in(const char* folder) {
    std::vector<std::filesystem::path> files;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(kData / folder, error))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

TEST(SkeletonData, EverySwcFileHasTheNodesOfItsTable) {
    // Numbers of nodes and roots from data/README.md.
    const std::map<std::string, std::pair<std::size_t, std::size_t>> expected{
        {"neurom_simple", {9, 1}},
        {"neurom_Neuron", {847, 1}},
        {"neurom_Neuron_disconnected_components", {843, 5}},
        {"neurom_z_jump", {11, 1}},
        {"neurom_fat_end", {10, 1}},
        {"morphio_simple-windows-eol", {9, 1}},
        {"treestoolbox_25HSS", {2252, 1}},
        {"arbor_pyramidal", {5799, 1}},
        {"arbor_720575940661139073", {8798, 1}},
        {"morphopy_EC3-60126.CNG", {13070, 1}},
        {"navis_722817260", {4332, 1}},
        {"navis_1734350788", {4465, 1}},
        {"modulartree_small", {188, 1}}};
    const auto files = files_in("swc");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    std::size_t counted = 0;
    for (const auto& path : files) {
        SCOPED_TRACE(path.filename());
        const auto raw = parse_swc(read_file(path), path.string()).nodes;
        const auto known = expected.find(path.stem().string());
        if (known != expected.end()) {
            EXPECT_EQ(raw.size(), known->second.first);
        }
        const SkeletonFile file = read_skeleton(path);
        EXPECT_EQ(file.format, "swc");
        EXPECT_EQ(file.skeleton.size() + file.report.zero_length + file.report.coincident, raw.size());
        if (known != expected.end()) {
            EXPECT_EQ(file.skeleton.tree_count(), known->second.second);
            ++counted;
        }
    }
    EXPECT_EQ(counted, expected.size());
}

TEST(SkeletonData, EveryCylinderListIsOneTree) {
    const auto files = files_in("qsm");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    int read = 0;
    for (const auto& path : files) {
        const std::string name = path.filename().string();
        if (name.find("_pc") != std::string::npos || name.find("cloud") != std::string::npos) continue;
        SCOPED_TRACE(name);
        const SkeletonFile file = read_skeleton(path);
        EXPECT_EQ(file.format, path.extension() == ".mat" ? "mat" : "cylinders");
        EXPECT_EQ(file.skeleton.tree_count(), 1u);
        EXPECT_EQ(file.report.missing_parents, 0u);
        EXPECT_EQ(file.report.missing_radii, 0u);
        ++read;
    }
    EXPECT_EQ(read, 13);
}

TEST(SkeletonData, CylinderSumsMatchTreeQsm) {
    // TotalVolume [l], TotalLength [m] and TotalArea [m^2] of treedata in each file.
    const std::map<std::string, std::array<double, 3>> stated{
        {"itsme_buttressed_tree_1_qsm_1.mat", {1027.1587, 49.521217, 20.044167}},
        {"itsme_tree_1_qsm.mat", {263.65649, 21.5828, 8.2213478}},
        {"qsm2r_QSM_Juglans_regia_S.mat", {15.266079, 49.129166, 2.7752077}},
        {"qsm2shade_walnut.mat", {151.13193, 296.37903, 18.39921}},
        {"rtwig_QSM.mat", {21.567524, 32.799881, 2.4975157}}};
    const auto files = files_in("qsm");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    std::size_t compared = 0;
    for (const auto& path : files) {
        const auto known = stated.find(path.filename().string());
        if (known == stated.end()) continue;
        SCOPED_TRACE(path.filename());
        const SkeletonFile file = read_skeleton(path);
        ASSERT_TRUE(file.declared.has_value());
        const auto [litres, length, area] = known->second;
        EXPECT_NEAR(1000 * file.declared->volume, litres, 1e-5 * litres);
        EXPECT_NEAR(file.declared->length, length, 1e-5 * length);
        EXPECT_NEAR(file.declared->area, area, 1e-5 * area);
        ++compared;
    }
    EXPECT_EQ(compared, stated.size());
}

TEST(SkeletonData, BranchesMatchTreeQsm) {
    const auto files = files_in("qsm");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    int compared = 0;
    for (const auto& path : files) {
        if (path.extension() != ".mat" && path.filename() != "archi_Tree_1_TreeQSM.txt") continue;
        SCOPED_TRACE(path.filename());
        const SkeletonFile file = read_skeleton(path);
        const std::span<const float> axis = file.attribute("axis");
        const std::set<float> numbers(axis.begin(), axis.end());
        std::size_t branches = 0;
        const NodeAxes axes = find_axes(file);
        for (const BranchOrder& o : branch_orders(file.skeleton, axes.order, axes.axis))
            branches += o.branches;
        EXPECT_EQ(branches, numbers.size());
        ++compared;
    }
    EXPECT_EQ(compared, 6);
}

TEST(SkeletonData, CylindersWithoutParentsFindTheirParents) {
    const auto files = files_in("qsm");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    for (const char* name : {"rtwig_QSM.csv", "rtwig_QSM2.csv", "qsm2shade_walnut.cylinders.csv"}) {
        SCOPED_TRACE(name);
        const std::string text = read_file(kData / "qsm" / name);
        const auto known = parse_cylinders(text, name).cylinders;
        const std::size_t at = text.find("parent");
        const auto found =
            parse_cylinders(text.substr(0, at) + "former" + text.substr(at + 6), name).cylinders;
        ASSERT_EQ(found.size(), known.size());
        std::size_t same = 0;
        for (std::size_t i = 0; i < known.size(); ++i) same += found[i].parent == known[i].parent;
        // Cylinders of SimpleForest and aRchi start where their parents end.
        EXPECT_GE(same, (std::string_view(name).starts_with("rtwig") ? 1.0 : 0.96) * known.size());
    }
}

TEST(SkeletonData, MatFilesMatchTheirTables) {
    const auto files = files_in("qsm");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    for (const auto& path : files) {
        if (path.extension() != ".mat") continue;
        SCOPED_TRACE(path.filename());
        auto table_path = path;
        table_path.replace_extension(".cylinders.csv");
        const auto table = parse_cylinders(read_file(table_path), table_path.string()).cylinders;
        const auto mat = parse_mat(read_file(path), path.string(), 0).cylinders;
        ASSERT_EQ(mat.size(), table.size());
        for (std::size_t i = 0; i < mat.size(); ++i) {
            EXPECT_EQ(mat[i].parent, table[i].parent);
            EXPECT_NEAR(mat[i].radius, table[i].radius, 1e-6);
            // The table has five decimals of the start and six digits of the axis.
            EXPECT_NEAR(distance(mat[i].start, table[i].start), 0, 2e-5);
            EXPECT_NEAR(distance(mat[i].end, table[i].end), 0, 4e-5);
        }
    }
}

/// Returns the message of refusal, or "no error" for a file from which `expected` is read.
std::string read_damaged(const std::string& bytes, const std::vector<RawCylinder>& expected) {
    return test::error_of([&] {
        const auto read = parse_mat(bytes, "damaged.mat", 0).cylinders;
        ASSERT_EQ(read.size(), expected.size());
        for (std::size_t i = 0; i < read.size(); ++i) {
            ASSERT_EQ(read[i].parent, expected[i].parent);
            ASSERT_EQ(read[i].start, expected[i].start);
            ASSERT_EQ(read[i].end, expected[i].end);
            ASSERT_EQ(read[i].radius, expected[i].radius);
        }
    });
}

TEST(SkeletonData, DamagedMatFilesAreRejectedOrReadUnchanged) {
    const auto files = files_in("qsm");
    if (files.empty()) GTEST_SKIP() << "no data next to the checkout";
    const std::string whole = read_file(kData / "qsm" / "itsme_tree_1_qsm.mat");
    const auto cylinders = parse_mat(whole, "whole.mat", 0).cylinders;
    for (std::size_t size = 0; size < whole.size(); size += 7) {
        EXPECT_EQ(read_damaged(whole.substr(0, size), cylinders).find("damaged.mat: "), 0u) << size;
    }
    // Compressed data have a checksum. They are preceded by 116 bytes of text that are not read, and little
    // else.
    constexpr std::size_t kText = 116, kHeader = 136;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string flipped = whole;
        flipped[i] = static_cast<char>(flipped[i] ^ 0x55);
        const std::string answer = read_damaged(flipped, cylinders);
        if (i < kText) {
            EXPECT_EQ(answer, "no error") << i;
        } else if (i >= kHeader) {
            EXPECT_EQ(answer.find("damaged.mat: "), 0u) << i;
        } else {
            EXPECT_TRUE(answer == "no error" || answer.starts_with("damaged.mat: ")) << i;
        }
    }
}

TEST(SkeletonData, PointCloudsAreNotReadAsSkeletons) {
    for (const char* name : {"qsm/rtwig_cloud.txt", "qsm/itsme_buttressed_tree_1_pc.txt"}) {
        if (!std::filesystem::exists(kData / name)) GTEST_SKIP() << "no data next to the checkout";
        EXPECT_THROW(read_skeleton(kData / name), Unsupported);
    }
}

}  // namespace
}  // namespace coppice
