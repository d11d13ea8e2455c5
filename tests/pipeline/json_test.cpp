#include "coppice/pipeline/json.h"

#include <gtest/gtest.h>

#include "errors.h"

namespace coppice {
namespace {

enum class Shade { light, dark };

struct Inner {
    float depth = 0.1f;
};

template <class Self, class Visitor>
requires SameOptions<Self, Inner>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"depth", "how deep", Unit::metre, 0.1, 2}, o.depth);
}

}  // namespace

template <>
struct EnumNames<Shade> {
    static constexpr std::array<std::string_view, 2> names{"light", "dark"};
};

namespace {

struct Sample {
    int count = 3;
    bool open = false;
    Shade shade = Shade::dark;
    Inner inner;
};

template <class Self, class Visitor>
requires SameOptions<Self, Sample>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"count", "how many", Unit::none, 1, 9}, o.count);
    visit(Field{"open", "whether it is open"}, o.open);
    visit(Field{"shade", "which shade"}, o.shade);
    visit(Field{"inner", "what is inside"}, o.inner);
}

std::string message_of(const char* text) {
    return test::error_of([&] { from_json<Sample>(Json::parse(text), "file.json"); });
}

TEST(RecipeJson, OptionsComeBackTheSame) {
    Sample sample;
    sample.count = 7;
    sample.open = true;
    sample.shade = Shade::light;
    sample.inner.depth = 1.7f;
    const Json json = to_json(sample);
    EXPECT_EQ(json.dump(), R"({"count":7,"open":true,"shade":"light","inner":{"depth":1.7}})");
    EXPECT_EQ(to_json(from_json<Sample>(json, "here")), json);
}

TEST(RecipeJson, WhatIsLeftOutKeepsItsDefault) {
    const Sample sample = from_json<Sample>(Json::parse(R"({"open": true})"), "here");
    EXPECT_TRUE(sample.open);
    EXPECT_EQ(sample.count, 3);
    EXPECT_EQ(sample.shade, Shade::dark);
}

TEST(RecipeJson, FloatsAtTheEndsOfTheirRangeAreTaken) {
    EXPECT_EQ(from_json<Sample>(to_json(Sample{}), "here").inner.depth, 0.1f);
}

TEST(RecipeJson, ErrorsNameTheFieldAndTheMend) {
    EXPECT_EQ(message_of(R"({"cuont": 4})"), "file.json: there is no field cuont; did you mean count?");
    EXPECT_EQ(message_of(R"({"elephant": 4})"), "file.json: there is no field elephant");
    EXPECT_EQ(message_of(R"({"count": 10})"), "file.json: count must lie between 1 and 9, but is 10");
    EXPECT_EQ(message_of(R"({"count": 1.5})"), "file.json: count must be a whole number");
    EXPECT_EQ(message_of(R"({"count": 1e300})"), "file.json: count must be a whole number");
    EXPECT_EQ(message_of(R"({"open": 1})"), "file.json: open must be true or false");
    EXPECT_EQ(message_of(R"({"shade": "grey"})"), "file.json: shade must be one of light, dark");
    EXPECT_EQ(message_of(R"({"shade": 1})"), "file.json: shade must be one of light, dark");
    EXPECT_EQ(message_of(R"({"inner": {"depht": 1}})"),
              "file.json: inner: there is no field depht; did you mean depth?");
    EXPECT_EQ(message_of(R"({"inner": 3})"), "file.json: inner must be an object with named fields");
    EXPECT_EQ(message_of(R"([])"), "file.json must be an object with named fields");
}

TEST(RecipeJson, TheSchemaHasWhatAFrontEndNeeds) {
    const Json schema = schema_of<Sample>();
    ASSERT_EQ(schema.size(), 4u);
    EXPECT_EQ(
        schema[0].dump(),
        R"({"name":"count","help":"how many","type":"int","unit":"none","low":1.0,"high":9.0,"default":3})");
    EXPECT_EQ(
        schema[2].dump(),
        R"({"name":"shade","help":"which shade","type":"choice","choices":["light","dark"],"default":"dark"})");
    EXPECT_EQ(schema[3]["fields"][0]["default"].dump(), "0.1");
}

}  // namespace
}  // namespace coppice
