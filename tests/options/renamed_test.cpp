#include "coppice/options/renamed.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/options/json.h"

namespace coppice {
namespace {

struct Bounds {
    float low = 1;
};

void list_fields(Bounds& o, FieldList& list) {
    list.add(Field{"min_diameter", "Minimum diameter.", Unit::metre, 0, 10}, o.low);
}

float read_low(const char* json) {
    Bounds bounds;
    from_json(Json::parse(json), option_fields(bounds), "a.json");
    return bounds.low;
}

TEST(Renamed, FormerNamesMapToPresentOnes) {
    EXPECT_EQ(present_name("least_diameter"), "min_diameter");
    EXPECT_EQ(present_name("edge"), "tetra_edge");
    EXPECT_EQ(present_name("tetra_edge"), "");
    EXPECT_EQ(present_name(""), "");
}

TEST(Renamed, JsonAcceptsFormerNames) {
    EXPECT_EQ(read_low(R"({"least_diameter": 3})"), 3);
    EXPECT_EQ(read_low(R"({"min_diameter": 4})"), 4);
    EXPECT_EQ(read_low(R"({"min_diameter": 4, "least_diameter": 3})"), 4);
    // The former name of a field that the object does not have is as unknown as any other name.
    EXPECT_THROW(read_low(R"({"least_angle": 1})"), InvalidInput);
}

}  // namespace
}  // namespace coppice
