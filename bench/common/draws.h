#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "coppice/base/random.h"

namespace coppice::bench {

/// A sequence of random numbers, for data that is generated in a fixed order.
class Draws {
  public:
    explicit Draws(std::uint64_t seed, std::uint64_t stream = 0) : random_(seed, stream) {}
    double uniform(double low, double high) { return random_.uniform(next_++, low, high); }
    /// Returns a normally distributed number with mean 0 and variance 1.
    double normal() {
        const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
        return radius * std::cos(2 * std::numbers::pi * uniform(0, 1));
    }

  private:
    CounterRandom random_;
    std::uint64_t next_ = 0;
};

}  // namespace coppice::bench
