#include "coppice/scene/script/statements.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"

namespace coppice {
namespace {

std::string joined(const std::vector<SceneSection>& sections) {
    std::string out;
    for (const SceneSection& piece : sections) out += piece.text + "\n";
    return out;
}

TEST(FindSections, JoinToTheText) {
    const std::string text =
        "# a crown\n\nsphere a \\\n  radius=2\nfor i in 1..2\n  if i > 1\n sphere b${i}\n  end\nend\nundo\n";
    const auto sections = find_sections(text);
    EXPECT_EQ(joined(sections), text);
    ASSERT_EQ(sections.size(), 5u);
    EXPECT_EQ(sections[2].text, "sphere a \\\n  radius=2");
    EXPECT_EQ(sections[3].line, 5u);
    EXPECT_EQ(sections[4].line, 10u);
}

TEST(FindSections, ContainUnclosedBlocksAsOneSection) {
    const auto sections = find_sections("sphere a\nfor i in 1..2\nsphere b\nsphere c");
    ASSERT_EQ(sections.size(), 2u);
    EXPECT_EQ(sections[1].text, "for i in 1..2\nsphere b\nsphere c");
}

TEST(FindSections, ContainUnmatchedEndsAsSections) {
    EXPECT_EQ(find_sections("end\nend\nsphere a\n").size(), 3u);
    EXPECT_TRUE(find_sections("").empty());
}

TEST(RunSection, ErrorsReportTheLineOfTheText) {
    Scene scene;
    try {
        run_section(scene, "repeat 2\n  sphere ${i}\nend", 7, "crown.coppice");
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_TRUE(std::string_view(error.what()).starts_with("crown.coppice:8")) << error.what();
    }
}

TEST(RunSection, RejectsAnUnclosedBlock) {
    Scene scene;
    EXPECT_THROW(run_section(scene, "repeat 2\nsphere a", 1, "crown"), InvalidInput);
    EXPECT_FALSE(scene.waits());
    EXPECT_TRUE(scene.state().objects.empty());
}

}  // namespace
}  // namespace coppice
