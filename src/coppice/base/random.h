#pragma once

#include <cstdint>

namespace coppice {

/// Mixes 64 bits so that every input bit changes half of the output bits [Steele2014].
constexpr std::uint64_t mix_bits(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// Random numbers without state: the draw depends on (seed, stage, index) alone, so no result depends on the
/// order of draws.
class CounterRandom {
  public:
    /// Draws of one stage of work: stages of one seed are independent.
    constexpr CounterRandom(std::uint64_t seed, std::uint64_t stage)
        : key_(mix_bits(mix_bits(seed) ^ stage)) {}

    /// 64 random bits
    constexpr std::uint64_t bits(std::uint64_t index) const { return mix_bits(key_ ^ mix_bits(index)); }

    /// Uniform in [0, 1).
    constexpr double uniform(std::uint64_t index) const {
        return static_cast<double>(bits(index) >> 11) * 0x1p-53;
    }

    /// Uniform in [low, high); where the two are close, rounding may give `high` itself.
    constexpr double uniform(std::uint64_t index, double low, double high) const {
        return low + (high - low) * uniform(index);
    }

  private:
    std::uint64_t key_;
};

}  // namespace coppice
