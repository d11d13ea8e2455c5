#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace coppice::io_internal {

/// Adaptive model of [Said2004]: the frequencies of the symbols of an alphabet as intervals of [0, 2^15).
/// Initially all symbols are equally likely; memory is allocated when the first symbol is decoded.
class SymbolModel {
  public:
    /// `symbols` must be in [2, 2048].
    explicit SymbolModel(unsigned symbols) : symbols_(static_cast<std::uint16_t>(symbols)) {}

  private:
    friend class ArithmeticDecoder;

    void start();
    void update();

    /// Interval begins, terminated by 2^15; counts; and a table that accelerates the search.
    std::unique_ptr<std::uint16_t[]> data_;
    std::uint16_t* count_ = nullptr;
    std::uint16_t* table_ = nullptr;
    std::uint32_t total_ = 0, cycle_ = 0,
                  left_ = 0;  ///< sum of the counts; symbols between updates; symbols until the next update
    std::uint16_t symbols_;
    std::uint8_t shift_ = 0;  ///< bits to shift a value to obtain its table index
};

/// Adaptive model of a bit, with probabilities in multiples of 2^-13.
class BitModel {
    friend class ArithmeticDecoder;

    void update();

    std::uint32_t zeros_ = 1, total_ = 2, probability_ = 1u << 12, cycle_ = 4, left_ = 4;
};

/// Decoder of the arithmetic coding of [Said2004] in the variant of [Isenburg2013]: 32 bits, renormalized by
/// bytes.
///
/// For any input, symbols are within their alphabets and nothing is read beyond the end: zeros are used
/// there, and `damaged` reports it.
class ArithmeticDecoder {
  public:
    explicit ArithmeticDecoder(std::string_view bytes)
        : at_(bytes.data()), end_(bytes.data() + bytes.size()) {
        for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next_byte();
    }

    unsigned symbol(SymbolModel& model) {
        if (!model.data_) [[unlikely]]
            model.start();
        const std::uint16_t* const first = model.data_.get();
        const std::uint32_t whole = length_;
        length_ >>= kSymbolBits;
        const std::uint32_t value = std::min(value_ / length_, (1u << kSymbolBits) - 1);
        // Branches would be mispredicted half of the time in the first two steps; a third one is rare.
        std::size_t found = model.table_[value >> model.shift_];
        found += first[found + 1] <= value ? 1 : 0;
        found += first[found + 1] <= value ? 1 : 0;
        while (first[found + 1] <= value) ++found;
        const std::uint32_t low = first[found] * length_;
        const std::uint32_t high = found + 1 == model.symbols_ ? whole : first[found + 1] * length_;
        value_ -= low;
        length_ = high - low;
        renormalise();
        ++model.count_[found];
        if (--model.left_ == 0) model.update();
        return static_cast<unsigned>(found);
    }

    unsigned bit(BitModel& model) {
        const std::uint32_t zero = model.probability_ * (length_ >> kBitBits);
        const bool one = value_ >= zero;
        if (one) {
            value_ -= zero;
            length_ -= zero;
        } else {
            length_ = zero;
            ++model.zeros_;
        }
        renormalise();
        if (--model.left_ == 0) model.update();
        return one ? 1 : 0;
    }

    /// Returns the next 1 to 32 bits, decoded with a uniform model.
    std::uint32_t bits(unsigned count) {
        if (count > kMaxBits) {
            const std::uint32_t low = bits(16);
            return bits(count - 16) << 16 | low;
        }
        length_ >>= count;
        std::uint32_t value = value_ / length_;
        if (value >> count != 0) {
            missing_ = kMaxMissing + 1;
            value = (1u << count) - 1;
        }
        value_ -= length_ * value;
        renormalise();
        return value;
    }

    /// Returns whether bytes beyond the end were read, or bytes that no encoder writes.
    bool damaged() const { return missing_ > kMaxMissing; }

    /// Returns the first byte that was not read. Encoders end such that it is the first byte after their
    /// output.
    const char* position() const { return at_; }

  private:
    friend class SymbolModel;
    friend class BitModel;
    static constexpr unsigned kSymbolBits = 15, kBitBits = 13, kMaxBits = 19;
    static constexpr std::uint32_t kMinLength = 1u << 24;
    static constexpr std::uint32_t kMaxMissing = 4;  ///< number of look-ahead bytes

    std::uint8_t next_byte() {
        if (at_ != end_) [[likely]]
            return static_cast<std::uint8_t>(*at_++);
        missing_ = std::min(missing_ + 1, kMaxMissing + 1);
        return 0;
    }
    void renormalise() {
        if (end_ - at_ >= 4) [[likely]] {
            const int shift = std::countl_zero(length_) & 24;  // whole bytes
            value_ = static_cast<std::uint32_t>((std::uint64_t{value_} << 32 | next_four()) << shift >> 32);
            length_ <<= shift;
            at_ += shift / 8;
            return;
        }
        while (length_ < kMinLength) {
            value_ = value_ << 8 | next_byte();
            length_ <<= 8;
        }
    }
    std::uint32_t next_four() const {
        const auto byte = [&](int i) { return std::uint32_t{static_cast<std::uint8_t>(at_[i])}; };
        return byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    }

    const char* at_;
    const char* end_;
    std::uint32_t value_ = 0, length_ = 0xffffffff, missing_ = 0;
};

}  // namespace coppice::io_internal
