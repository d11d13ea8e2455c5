// The selections that gestures write, for the nodes of foreign skeletons.

#include <gtest/gtest.h>

#include "acceptance/support.h"
#include "coppice/edit/anchor.h"
#include "coppice/edit/selection.h"
#include "coppice/io_skeleton/reader.h"

namespace coppice {
namespace {

TEST(AnchorsOfFiles, SelectExactlyTheirNode) {
    const auto files = test::skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no ../shared";
    for (const auto& file : files) {
        const EditableTree tree(read_skeleton(file).skeleton);
        for (const StableId n : tree.nodes()) {
            const std::string text = anchor_text(tree, n);
            EXPECT_EQ(selected(tree, parse_selection(text)), NodeSet{n}) << file << ": " << text;
        }
    }
}

}  // namespace
}  // namespace coppice
