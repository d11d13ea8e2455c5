#include "coppice/scene/words.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"
#include "errors.h"

namespace coppice {
namespace {

std::string catch_message(const std::string& text) {
    return test::error_of([&] { scene_lines(text, "a.coppice"); });
}

TEST(SceneLines, SkipsBlanksAndCommentsAndCountsThem) {
    const auto lines = scene_lines("\n# a comment\r\n  sphere s # ball\r\n\n\tline l", "x");
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].number, 3u);
    EXPECT_EQ(lines[0].text, "  sphere s # ball");
    EXPECT_EQ(lines[1].number, 5u);
}

TEST(SceneLines, JoinsLinesThatEndInABackslash) {
    const auto lines = scene_lines("polyline p \\\n0,0,0 \\\n1,1,1\nsphere s", "x");
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0].text, "polyline p  0,0,0  1,1,1");
    EXPECT_EQ(lines[0].number, 1u);
    EXPECT_EQ(lines[1].number, 4u);
}

TEST(SceneLines, RejectsInvalidText) {
    EXPECT_EQ(catch_message("sphere s\nsphere \x01"),
              "a.coppice:2: the line contains bytes that are not text");
    EXPECT_EQ(catch_message(std::string("a\0b", 3)),
              "a.coppice:1: the line contains bytes that are not text");
    EXPECT_EQ(catch_message("sphere s \\"),
              "a.coppice:1: nothing follows the backslash at the end of the line");
    EXPECT_NE(catch_message(std::string(kLongestLine + 1, 'a')).find("longer"), std::string::npos);
    std::string many;
    for (std::size_t i = 0; i <= kMaxLines; ++i) many += "list\n";
    EXPECT_NE(catch_message(many).find("more than 100000 commands"), std::string::npos);
}

TEST(SceneWords, SplitsAtBlanksAndRecognizesKeys) {
    const auto words = scene_words("grow tree\ts step=0.1 name=\"a b\" # rest=1");
    ASSERT_EQ(words.size(), 5u);
    EXPECT_EQ(words[1].text, "tree");
    EXPECT_EQ(words[3].key, "step");
    EXPECT_EQ(words[3].text, "0.1");
    EXPECT_EQ(words[4].key, "name");
    EXPECT_EQ(words[4].text, "a b");
}

TEST(SceneWords, AQuotedWordHasNoKey) {
    const auto words = scene_words(R"(save "a=b \"c\" \\ d.obj" e)");
    ASSERT_EQ(words.size(), 3u);
    EXPECT_EQ(words[1].key, "");
    EXPECT_EQ(words[1].text, "a=b \"c\" \\ d.obj");
}

TEST(SceneWords, RejectsAnOpenQuote) { EXPECT_THROW(scene_words("save \"a b"), InvalidInput); }

TEST(SceneWords, QuotedWordsRoundTrip) {
    for (const std::string text :
         {"plain", "with blank", "a=b", "#x", "", "q\"uote", "back\\slash", "1,2,3"}) {
        const auto words = scene_words("save " + quoted_word(text));
        ASSERT_EQ(words.size(), 2u) << text;
        EXPECT_EQ(words[1].text, text);
        EXPECT_EQ(words[1].key, "");
    }
}

}  // namespace
}  // namespace coppice
