#include "coppice/base/hash.h"

#include <gtest/gtest.h>

#include <array>
#include <string_view>

namespace coppice {
namespace {

std::uint64_t of(std::string_view text) {
    return Hash().add(std::span<const char>(text.data(), text.size())).value();
}

TEST(Hash, MatchesThePublishedTestVectors) {
    // Test vectors of FNV-1a, 64 bits: http://www.isthe.com/chongo/src/fnv/test_fnv.c
    EXPECT_EQ(of(""), 0xcbf29ce484222325ull);
    EXPECT_EQ(of("a"), 0xaf63dc4c8601ec8cull);
    EXPECT_EQ(of("foobar"), 0x85944171f73967e8ull);
}

TEST(Hash, HashOfPartsEqualsTheHashOfTheWhole) {
    const std::array<std::uint32_t, 3> whole{7, 8, 9};
    const std::uint64_t parts =
        Hash().add(whole[0]).add(std::span<const std::uint32_t>(whole).subspan(1)).value();
    EXPECT_EQ(parts, Hash().add(std::span<const std::uint32_t>(whole)).value());
}

TEST(Hash, DistinguishesOrderAndSign) {
    EXPECT_NE(of("ab"), of("ba"));
    EXPECT_NE(Hash().add(0.0f).value(), Hash().add(-0.0f).value());  // bytes, not values
}

}  // namespace
}  // namespace coppice
