#pragma once

#include <cstdint>
#include <vector>

#include "coppice/io_points/laz/arithmetic_internal.h"

namespace coppice::io_internal {

/// Decoder of integers that are stored as differences from a prediction: the number of bits of the
/// difference, with a model for each context, its highest 8 bits, with a model for each number of bits, and
/// the remaining bits unmodelled.
class IntegerDecoder {
  public:
    /// `bits` must be in [2, 32].
    explicit IntegerDecoder(unsigned bits, unsigned contexts = 1)
        : mask_(bits == 32 ? 0xffffffffu : (1u << bits) - 1) {
        lengths_.reserve(contexts);
        for (unsigned i = 0; i < contexts; ++i) lengths_.emplace_back(bits + 1);
        corrections_.reserve(bits);
        for (unsigned length = 1; length <= bits; ++length)
            corrections_.emplace_back(1u << std::min(length, kModelled));
    }

    /// Returns the integer in two's complement, limited to `bits`.
    std::uint32_t read(ArithmeticDecoder& in, std::uint32_t prediction, unsigned context = 0) {
        length_ = in.symbol(lengths_[context]);
        return (prediction + correction(in)) & mask_;
    }
    std::int32_t read(ArithmeticDecoder& in, std::int32_t prediction, unsigned context = 0) {
        return static_cast<std::int32_t>(read(in, static_cast<std::uint32_t>(prediction), context));
    }

    /// Returns the number of bits of the last difference.
    unsigned length() const { return length_; }

  private:
    static constexpr unsigned kModelled = 8;

    std::uint32_t correction(ArithmeticDecoder& in) {
        if (length_ == 0) return in.bit(zero_or_one_);
        if (length_ == 32) return 0x80000000u;
        std::uint32_t c = in.symbol(corrections_[length_ - 1]);
        if (length_ > kModelled) {
            const unsigned plain = length_ - kModelled;
            c = c << plain | in.bits(plain);
        }
        // Maps [0, 2^length) to [1 - 2^length, -2^(length - 1)] and [2^(length - 1) + 1, 2^length].
        return c >= 1u << (length_ - 1) ? c + 1 : c - ((1u << length_) - 1);
    }

    std::vector<SymbolModel> lengths_, corrections_;
    BitModel zero_or_one_;
    std::uint32_t mask_;
    unsigned length_ = 0;
};

}  // namespace coppice::io_internal
