#include "coppice/base/fields.h"

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

template <class Self, class Visitor>
requires SameOptions<Self, TrunkOptions>
constexpr void visit_fields(Self& options, Visitor&& visit) {
    visit(Field{"height", "from root to tip", Unit::metre, 1, 9}, options.height);
    visit(Field{"bark", "how it feels"}, options.bark);
}

}  // namespace

template <>
struct EnumNames<Bark> {
    static constexpr std::array<std::string_view, 2> names{"smooth", "rough"};
};

namespace {

TEST(Fields, AnEnumIsNamedOnlyWhereItHasNames) {
    static_assert(NamedEnum<Bark>);
    static_assert(!NamedEnum<Nameless>);
    static_assert(!NamedEnum<int>);
    EXPECT_EQ(name_of(Bark::smooth), "smooth");
    EXPECT_EQ(name_of(Bark::rough), "rough");
}

TEST(Fields, AFieldSaysNothingOfUnitAndRangeUnlessTold) {
    constexpr Field kPlain{"bark", "how it feels"};
    EXPECT_EQ(kPlain.unit, Unit::none);
    EXPECT_GE(kPlain.low, kPlain.high);  // no range
}

TEST(Fields, AVisitorReadsAndWritesTheMembersInOrder) {
    TrunkOptions options;
    std::vector<std::string> names;
    visit_fields(options, [&]<class T>(const Field& field, T& value) {
        names.emplace_back(field.name);
        if constexpr (std::is_same_v<T, float>) value *= 2;
    });
    EXPECT_EQ(names, (std::vector<std::string>{"height", "bark"}));
    EXPECT_EQ(options.height, 6);

    const TrunkOptions constant;
    float read = 0;
    visit_fields(constant, [&]<class T>(const Field&, const T& value) {
        if constexpr (std::is_same_v<T, float>) read = value;
    });
    EXPECT_EQ(read, 3);
}

}  // namespace
}  // namespace coppice
