#include "coppice/options/json.h"

#include "coppice/base/option_fields.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "comma_locale.h"
#include "errors.h"

namespace coppice {
namespace {

enum class Shade { light, dark };

struct Inner {
    float depth = 0.1f;
};

void list_fields(Inner& o, FieldList& list) {
    list.add(Field{"depth", "how deep", Unit::metre, 0.1, 2}, o.depth);
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
    std::optional<Vec3d> place;
    std::vector<std::string> words;
};

void list_fields(Sample& o, FieldList& list) {
    list.add(common_field("count", "Number of items.", Unit::none, 1, 9), o.count);
    list.add(Field{"open", "Opens it."}, o.open);
    list.add(Field{"shade", "Shade of the item."}, o.shade);
    list.add(Field{"inner", "Contents"}, o.inner);
    list.add(Field{"place", "Position of the item.", Unit::metre}, o.place);
    list.add(Field{"words", "Names of the item."}, o.words);
}

Json make_json(Sample sample) { return to_json(option_fields(sample)); }

Sample read_sample(const Json& json) {
    Sample sample;
    from_json(json, option_fields(sample), "file.json");
    return sample;
}

std::string catch_message(const char* text) {
    return test::error_of([&] { read_sample(Json::parse(text)); });
}

TEST(Json, OptionsRoundTrip) {
    Sample sample;
    sample.count = 7;
    sample.open = true;
    sample.shade = Shade::light;
    sample.inner.depth = 1.7f;
    sample.place = Vec3d{1, -2.5, 0.1};
    sample.words = {"bark", "wood"};
    const Json json = make_json(sample);
    EXPECT_EQ(json.dump(), R"({"count":7,"open":true,"shade":"light","inner":{"depth":1.7},)"
                           R"("place":[1.0,-2.5,0.1],"words":["bark","wood"]})");
    EXPECT_EQ(make_json(read_sample(json)), json);
    EXPECT_EQ(make_json(read_sample(make_json(Sample{}))), make_json(Sample{}));
}

TEST(Json, OmittedFieldsHaveTheirDefault) {
    const Sample sample = read_sample(Json::parse(R"({"open": true})"));
    EXPECT_TRUE(sample.open);
    EXPECT_EQ(sample.count, 3);
    EXPECT_EQ(sample.shade, Shade::dark);
}

TEST(Json, AcceptsFloatsAtTheirBounds) { EXPECT_EQ(read_sample(make_json(Sample{})).inner.depth, 0.1f); }

TEST(Json, NumbersAreIndependentOfTheLocale) {
    const test::CommaLocale comma;
    EXPECT_EQ(shortest(0.1f), 0.1);
    EXPECT_EQ(make_json(Sample{})["inner"].dump(), R"({"depth":0.1})");
    EXPECT_EQ(read_sample(Json::parse(R"({"inner": {"depth": 1.5}})")).inner.depth, 1.5f);
}

TEST(Json, ErrorsReportTheFieldAndTheRemedy) {
    EXPECT_EQ(catch_message(R"({"cuont": 4})"), "file.json: there is no field cuont; did you mean count?");
    EXPECT_EQ(catch_message(R"({"elephant": 4})"), "file.json: there is no field elephant");
    EXPECT_EQ(catch_message(R"({"two\nlines": 4})"), R"(file.json: there is no field two\nlines)");
    EXPECT_EQ(catch_message(R"({"count": 10})"), "file.json: count must be between 1 and 9, but is 10");
    EXPECT_EQ(catch_message(R"({"count": 1.5})"), "file.json: count must be a whole number");
    EXPECT_EQ(catch_message(R"({"count": 1e300})"), "file.json: count must be a whole number");
    EXPECT_EQ(catch_message(R"({"open": 1})"), "file.json: open must be true or false");
    EXPECT_EQ(catch_message(R"({"shade": "grey"})"), "file.json: shade must be one of light, dark");
    EXPECT_EQ(catch_message(R"({"shade": 1})"), "file.json: shade must be one of light, dark");
    EXPECT_EQ(catch_message(R"({"inner": {"depht": 1}})"),
              "file.json: inner: there is no field depht; did you mean depth?");
    EXPECT_EQ(catch_message(R"({"inner": 3})"), "file.json: inner must be an object with named fields");
    EXPECT_EQ(catch_message(R"({"place": [1, 2]})"), "file.json: place must be a list of three numbers");
    EXPECT_EQ(catch_message(R"({"words": "bark"})"), "file.json: words must be a list of texts");
    EXPECT_EQ(catch_message(R"([])"), "file.json must be an object with named fields");
}

TEST(Json, SchemaHasNameHelpTypeAndRange) {
    Sample defaults;
    const Json schema = make_schema(option_fields(defaults));
    ASSERT_EQ(schema.size(), 6u);
    EXPECT_EQ(
        schema[0].dump(),
        R"({"name":"count","help":"Number of items.","common":true,"type":"int","unit":"none","low":1.0,"high":9.0,"default":3})");
    EXPECT_EQ(
        schema[2].dump(),
        R"({"name":"shade","help":"Shade of the item.","common":false,"type":"choice","choices":["light","dark"],"default":"dark"})");
    EXPECT_EQ(schema[3]["fields"][0]["default"].dump(), "0.1");
    EXPECT_EQ(
        schema[4].dump(),
        R"({"name":"place","help":"Position of the item.","common":false,"type":"place","default":null})");
    EXPECT_EQ(schema[5].dump(),
              R"({"name":"words","help":"Names of the item.","common":false,"type":"texts","default":[]})");
}

}  // namespace
}  // namespace coppice
