#include <gtest/gtest.h>

#include "acceptance/support.h"
#include "coppice/io_skeleton/reader.h"
#include "tube_row_search.h"

namespace coppice {
namespace {

using namespace test;

TEST(AcceptanceFiles, SlicesReportTheSelfIntersectionsOfTheWholeMesh) {
    const std::vector<fs::path> files = skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no " << kShared;
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.filename());
        expect_same(read_skeleton(file).skeleton);
    }
}

}  // namespace
}  // namespace coppice
