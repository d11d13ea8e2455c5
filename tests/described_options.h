#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "coppice/base/check_fields.h"

namespace coppice::test {

/// Returns the number of bytes of the members; enums have the size of an int.
inline std::size_t count_bytes(const std::vector<OptionField>& members) {
    std::size_t bytes = 0;
    for (const OptionField& member : members) {
        bytes += std::visit(
            []<class Ref>(const Ref& ref) {
                if constexpr (std::is_same_v<Ref, std::vector<OptionField>>)
                    return count_bytes(ref);
                else if constexpr (std::is_same_v<Ref, ChoiceRef>)
                    return sizeof(int);
                else
                    return sizeof(*ref);
            },
            member.ref);
    }
    return bytes;
}

/// Checks that every member of an option struct is listed once, and has a unique name, a help text and a
/// default in range. `padding`: bytes of the struct that belong to no member.
template <class Options>
void expect_described(std::size_t padding = 0) {
    Options options;
    std::set<std::string> names;
    const std::vector<OptionField> members = option_fields(options);
    for (const OptionField& member : members) {
        EXPECT_TRUE(names.emplace(member.field.name).second) << member.field.name;
        EXPECT_FALSE(member.field.help.empty()) << member.field.name;
    }
    EXPECT_EQ(count_bytes(members) + padding, sizeof(Options));
    EXPECT_NO_THROW(check_fields(options, "options"));
}

}  // namespace coppice::test
