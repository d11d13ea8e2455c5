#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "coppice/io_points/laz/arithmetic_internal.h"

namespace coppice::io_internal {

/// Approximate median of recent differences, the middle of five stored values: a new value replaces the
/// maximum or, after a value of the upper half, the minimum.
class RunningMedian {
  public:
    std::int32_t get() const { return sorted_[2]; }
    void add(std::int32_t v) {
        const bool is_above = drops_greatest_ ? v >= sorted_[2] : v > sorted_[2];
        const std::size_t from = drops_greatest_ ? 0 : 1;
        const std::array<std::int32_t, 4> rest{sorted_[from], sorted_[from + 1], sorted_[from + 2],
                                               sorted_[from + 3]};
        sorted_ = {std::min(rest[0], v), std::max(rest[0], std::min(rest[1], v)),
                   std::max(rest[1], std::min(rest[2], v)), std::max(rest[2], std::min(rest[3], v)),
                   std::max(rest[3], v)};
        drops_greatest_ = !is_above;
    }

  private:
    std::array<std::int32_t, 5> sorted_{};
    bool drops_greatest_ = true;
};

/// Returns the context of `IntegerDecoder` for a coordinate by the number of bits of the differences read
/// before it: even numbers up to `most`, plus one for pulses with a single return.
inline unsigned coordinate_context(unsigned bits, unsigned most, bool single) {
    return (single ? 1u : 0u) + (bits < most ? bits & ~1u : most);
}

/// Models of the same alphabet, one for each context.
class SymbolModels {
  public:
    SymbolModels(unsigned count, unsigned symbols) {
        models_.reserve(count);
        for (unsigned i = 0; i < count; ++i) models_.emplace_back(symbols);
    }
    SymbolModel& operator[](std::size_t i) { return models_[i]; }

  private:
    std::vector<SymbolModel> models_;
};

}  // namespace coppice::io_internal
