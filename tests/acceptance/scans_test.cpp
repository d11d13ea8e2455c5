// Foreign scans: the truth is unknown, but some results are impossible for a tree.

#include <gtest/gtest.h>

#include <cctype>

#include "acceptance/support.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/io_points/reader.h"
#include "coppice/skeleton/measure.h"

namespace coppice::test {
namespace {

std::vector<fs::path> scan_files() {
    std::vector<fs::path> files;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(kShared / "data" / "cloud", absent))
        if (entry.path().extension() != ".laz") files.push_back(entry.path());  // a plot that contains it
    for (const char* name :
         {"archi_Tree_1_point_cloud.las", "rtwig_cloud.txt", "itsme_buttressed_tree_1_pc.txt"}) {
        if (fs::exists(kShared / "data" / "qsm" / name)) files.push_back(kShared / "data" / "qsm" / name);
    }
    std::sort(files.begin(), files.end());
    return files;
}

class AcceptanceScans : public testing::TestWithParam<fs::path> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(AcceptanceScans);

/// Counts the nodes between forks that turn by more than 60 degrees, where both adjacent sections are `least`
/// [m] long.
double share_of_sharp_turns(const Skeleton& s, double least) {
    std::vector<int> children(s.size(), 0);
    for (const NodeId n : nodes(s))
        if (!s.is_root(n)) ++children[s.parent(n).index()];
    double turns = 0, sharp = 0;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const NodeId q = s.parent(n);
        if (s.is_root(q) || children[q.index()] != 1) continue;
        const Vec3d a(s.position(q) - s.position(s.parent(q))), b(s.position(n) - s.position(q));
        if (length(a) < least || length(b) < least) continue;
        ++turns;
        sharp += dot(a, b) < 0.5 * length(a) * length(b);
    }
    return sharp / std::max(turns, 1.0);
}

TEST_P(AcceptanceScans, ExtractsPlausibleTrees) {
    const PointSet points = read_points(GetParam());
    const CloudExtraction found = extract_from_cloud(points);
    const Skeleton& s = found.skeleton;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) {
            ASSERT_LE(s.radius(n), s.radius(s.parent(n)));
        }
        const NodeConfidence& c = found.confidence[n.index()];
        ASSERT_LE(c.radius_low, s.radius(n));
        ASSERT_GE(c.radius_high, s.radius(n));
    }
    EXPECT_LE(share_of_sharp_turns(s, found.cleaning.spacing), 0.02);
    const double height = double{s.bounds().size().z} / double{bounds(points).size().z};
    EXPECT_GT(height, 0.9);
    EXPECT_LT(height, 1.06);
}

INSTANTIATE_TEST_SUITE_P(Files, AcceptanceScans, testing::ValuesIn(scan_files()), [](const auto& file) {
    std::string name = file.param.filename();
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    return name;
});

}  // namespace
}  // namespace coppice::test
