#include "coppice/base/option_fields.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace coppice {
namespace {

enum class Bark { smooth, rough };
enum class Nameless { one };

struct TrunkOptions {
    float height = 3;
    Bark bark = Bark::rough;
};

void list_fields(TrunkOptions& options, FieldList& list) {
    list.add(Field{"height", "from root to tip", Unit::metre, 1, 9}, options.height);
    list.add(Field{"bark", "how it feels"}, options.bark);
}

}  // namespace

template <>
struct EnumNames<Bark> {
    static constexpr std::array<std::string_view, 2> names{"smooth", "rough"};
};

namespace {

TEST(OptionFields, OnlyEnumsWithNamesAreNamedEnums) {
    static_assert(NamedEnum<Bark>);
    static_assert(!NamedEnum<Nameless>);
    static_assert(!NamedEnum<int>);
    EXPECT_EQ(name_of(Bark::smooth), "smooth");
    EXPECT_EQ(name_of(Bark::rough), "rough");
}

TEST(OptionFields, FieldHasNoUnitAndNoRangeByDefault) {
    constexpr Field kPlain{"bark", "how it feels"};
    EXPECT_EQ(kPlain.unit, Unit::none);
    EXPECT_GE(kPlain.low, kPlain.high);  // no range
}

TEST(OptionFields, ReferencesTheMembersInOrder) {
    TrunkOptions options;
    const std::vector<OptionField> members = option_fields(options);
    ASSERT_EQ(members.size(), 2u);
    EXPECT_EQ(members[0].field.name, "height");
    EXPECT_EQ(members[1].field.name, "bark");
    *std::get<float*>(members[0].ref) *= 2;
    EXPECT_EQ(options.height, 6);
    ChoiceRef bark = std::get<ChoiceRef>(members[1].ref);
    EXPECT_EQ(bark.name(), "rough");
    bark.set(0);
    EXPECT_EQ(options.bark, Bark::smooth);
}

}  // namespace
}  // namespace coppice
