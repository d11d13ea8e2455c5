#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace coppice::io_internal {

/// How often each symbol of an alphabet came so far, as intervals of [0, 2^15): the adaptive model of
/// [Said2004]. It starts with all of them equally likely, and takes memory when the first symbol is asked
/// for.
class SymbolModel {
  public:
    /// `symbols` from 2 to 2048.
    explicit SymbolModel(unsigned symbols) : symbols_(static_cast<std::uint16_t>(symbols)) {}

  private:
    friend class ArithmeticDecoder;

    void start();
    void update();

    /// Where intervals begin, ended by 2^15; counts; and a table of where to begin to look.
    std::unique_ptr<std::uint16_t[]> data_;
    std::uint16_t* count_ = nullptr;
    std::uint16_t* table_ = nullptr;
    std::uint32_t total_ = 0, cycle_ = 0, left_ = 0;  ///< counted; symbols between updates; until the next
    std::uint16_t symbols_;
    std::uint8_t shift_ = 0;  ///< of a value to its place in the table
};

/// The same for 0 and 1, in steps of 2^-13.
class BitModel {
    friend class ArithmeticDecoder;

    void update();

    std::uint32_t zeros_ = 1, total_ = 2, probability_ = 1u << 12, cycle_ = 4, left_ = 4;
};

/// Undoes the arithmetic coding of [Said2004], as [Isenburg2013] has it: 32 bits, carried on byte by byte.
///
/// Whatever the bytes are, symbols lie within their alphabets and nothing is read beyond the end: zeros are
/// taken there, and `damaged` says so.
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
        // Steps that branch would be guessed wrong half of the time; a third one is rare.
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

    /// The next 1 to 32 bits, all values equally likely.
    std::uint32_t bits(unsigned count) {
        if (count > kMostBits) {
            const std::uint32_t low = bits(16);
            return bits(count - 16) << 16 | low;
        }
        length_ >>= count;
        std::uint32_t value = value_ / length_;
        if (value >> count != 0) {
            missing_ = kMostMissing + 1;
            value = (1u << count) - 1;
        }
        value_ -= length_ * value;
        renormalise();
        return value;
    }

    /// Whether bytes were asked for that are not there, or that no encoder writes.
    bool damaged() const { return missing_ > kMostMissing; }

    /// The first byte that was not taken. Encoders end so that it is the first that does not belong to them.
    const char* position() const { return at_; }

  private:
    friend class SymbolModel;
    friend class BitModel;
    static constexpr unsigned kSymbolBits = 15, kBitBits = 13, kMostBits = 19;
    static constexpr std::uint32_t kLeastLength = 1u << 24;
    static constexpr std::uint32_t kMostMissing = 4;  ///< those that are looked ahead

    std::uint8_t next_byte() {
        if (at_ != end_) [[likely]]
            return static_cast<std::uint8_t>(*at_++);
        missing_ = std::min(missing_ + 1, kMostMissing + 1);
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
        while (length_ < kLeastLength) {
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
