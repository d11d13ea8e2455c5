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

/// Stateless random numbers: a number depends only on (seed, stage, index), so that results do not depend on
/// the order of calls.
class CounterRandom {
  public:
    /// Random numbers of one stage of work: the stages of one seed are independent.
    constexpr CounterRandom(std::uint64_t seed, std::uint64_t stage)
        : key_(mix_bits(mix_bits(seed) ^ stage)) {}

    /// Returns 64 random bits.
    constexpr std::uint64_t bits(std::uint64_t index) const { return mix_bits(key_ ^ mix_bits(index)); }

    /// Returns a number uniform in [0, 1).
    constexpr double uniform(std::uint64_t index) const {
        return static_cast<double>(bits(index) >> 11) * 0x1p-53;
    }

    /// Returns a number uniform in [low, high); if the two are close, rounding may return `high` itself.
    constexpr double uniform(std::uint64_t index, double low, double high) const {
        return low + (high - low) * uniform(index);
    }

  private:
    std::uint64_t key_;
};

}  // namespace coppice
