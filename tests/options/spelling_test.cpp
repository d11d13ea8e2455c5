#include "coppice/options/spelling.h"

#include <gtest/gtest.h>

#include <vector>

namespace coppice {
namespace {

const std::vector<std::string> kWords{"mesh", "check", "wire-width", "width"};

TEST(Spelling, FindsTheSimilarWord) {
    EXPECT_EQ(nearest_spelling("mehs", kWords), "mesh");
    EXPECT_EQ(nearest_spelling("chek", kWords), "check");
    EXPECT_EQ(nearest_spelling("WIRE_WIDTH", kWords), "wire-width");
    EXPECT_EQ(nearest_spelling("witdh", kWords), "width");
}

TEST(Spelling, ReturnsNothingIfNoWordIsSimilar) {
    EXPECT_EQ(nearest_spelling("zebra", kWords), "");
    EXPECT_EQ(nearest_spelling("", kWords), "");
    EXPECT_EQ(nearest_spelling(std::string(100'000, 'w'), kWords), "");
    EXPECT_EQ(nearest_spelling("mesh", {}), "");
}

TEST(Spelling, FindsTheShortestWordWithThePrefix) {
    const std::vector<std::string> options{"influence_radius_of_all", "influence_radius", "kill_radius"};
    EXPECT_EQ(nearest_spelling("influence", options), "influence_radius");
    EXPECT_EQ(nearest_spelling("Influence-Rad", options), "influence_radius");
    EXPECT_EQ(nearest_spelling("kill", options), "kill_radius");
    EXPECT_EQ(nearest_spelling("ki", options), "");  // begins too many words
    EXPECT_EQ(nearest_spelling("radius", options), "");
}

TEST(Spelling, DidYouMeanIsASuffixOfASentence) {
    EXPECT_EQ(did_you_mean("mehs", kWords), "; did you mean mesh?");
    EXPECT_EQ(did_you_mean("zebra", kWords), "");
}

}  // namespace
}  // namespace coppice
