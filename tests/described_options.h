#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <type_traits>

#include "coppice/base/fields.h"

namespace coppice::test {

/// Checks that every member of an option struct is visited once, and has a unique name, a help text and a
/// default in range. `padding`: bytes of the struct that belong to no member.
template <class Options>
void expect_described(std::size_t padding = 0) {
    const Options options;
    std::set<std::string> names;
    std::size_t bytes = padding;
    visit_fields(options, [&](const Field& field, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        EXPECT_TRUE(names.emplace(field.name).second) << field.name;
        EXPECT_FALSE(field.help.empty()) << field.name;
        bytes += sizeof(value);
        if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
            // A bound may be a decimal that the type cannot represent.
            EXPECT_GE(value, static_cast<T>(field.low)) << field.name;
            EXPECT_LE(value, static_cast<T>(field.high)) << field.name;
        }
    });
    EXPECT_EQ(bytes, sizeof(Options));
}

}  // namespace coppice::test
