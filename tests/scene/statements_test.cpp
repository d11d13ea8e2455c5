#include "coppice/scene/script/statements.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"

namespace coppice {
namespace {

std::string joined(const std::vector<ScenePiece>& pieces) {
    std::string out;
    for (const ScenePiece& piece : pieces) out += piece.text + "\n";
    return out;
}

TEST(PiecesOf, JoinToTheText) {
    const std::string text =
        "# a crown\n\nsphere a \\\n  radius=2\nfor i in 1..2\n  if i > 1\n sphere b${i}\n  end\nend\nundo\n";
    const auto pieces = find_pieces(text);
    EXPECT_EQ(joined(pieces), text);
    ASSERT_EQ(pieces.size(), 5u);
    EXPECT_EQ(pieces[2].text, "sphere a \\\n  radius=2");
    EXPECT_EQ(pieces[3].line, 5u);
    EXPECT_EQ(pieces[4].line, 10u);
}

TEST(PiecesOf, ContainUnclosedBlocksAsOnePiece) {
    const auto pieces = find_pieces("sphere a\nfor i in 1..2\nsphere b\nsphere c");
    ASSERT_EQ(pieces.size(), 2u);
    EXPECT_EQ(pieces[1].text, "for i in 1..2\nsphere b\nsphere c");
}

TEST(PiecesOf, ContainUnmatchedEndsAsPieces) {
    EXPECT_EQ(find_pieces("end\nend\nsphere a\n").size(), 3u);
    EXPECT_TRUE(find_pieces("").empty());
}

TEST(RunPiece, ErrorsReportTheLineOfTheText) {
    Scene scene;
    try {
        run_piece(scene, "repeat 2\n  sphere ${i}\nend", 7, "crown.coppice");
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_TRUE(std::string_view(error.what()).starts_with("crown.coppice:8")) << error.what();
    }
}

TEST(RunPiece, RejectsAnUnclosedBlock) {
    Scene scene;
    EXPECT_THROW(run_piece(scene, "repeat 2\nsphere a", 1, "crown"), InvalidInput);
    EXPECT_FALSE(scene.waits());
    EXPECT_TRUE(scene.state().objects.empty());
}

}  // namespace
}  // namespace coppice
