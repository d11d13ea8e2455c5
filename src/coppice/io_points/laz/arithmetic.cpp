#include <bit>

#include "coppice/io_points/laz/arithmetic_internal.h"

namespace coppice::io_internal {
namespace {

constexpr unsigned kMinTable = 64, kMaxTable = 512;  // table entries

}  // namespace

void SymbolModel::start() {
    const unsigned n = symbols_;
    const unsigned table = std::clamp(2 * std::bit_ceil(n), kMinTable, kMaxTable);
    data_ = std::make_unique_for_overwrite<std::uint16_t[]>(n + 1 + n + table);
    count_ = data_.get() + n + 1;
    table_ = count_ + n;
    shift_ = static_cast<std::uint8_t>(ArithmeticDecoder::kSymbolBits -
                                       static_cast<unsigned>(std::countr_zero(table)));
    std::fill(count_, count_ + n, std::uint16_t{1});
    cycle_ = n;
    update();
    cycle_ = left_ = (n + 6) / 2;
}

void SymbolModel::update() {
    constexpr std::uint32_t kMaxCounted = 1u << ArithmeticDecoder::kSymbolBits;
    const unsigned n = symbols_;
    total_ += cycle_;
    if (total_ > kMaxCounted) {
        total_ = 0;
        for (unsigned i = 0; i < n; ++i) {
            count_[i] = static_cast<std::uint16_t>((count_[i] + 1) / 2);
            total_ += count_[i];
        }
    }
    std::uint16_t* const first = data_.get();
    const std::uint32_t scale = 0x80000000u / total_;
    std::uint32_t sum = 0;
    for (unsigned i = 0; i < n; ++i) {
        first[i] = static_cast<std::uint16_t>(scale * sum >> (31 - ArithmeticDecoder::kSymbolBits));
        sum += count_[i];
    }
    first[n] = static_cast<std::uint16_t>(kMaxCounted);
    const unsigned places = kMaxCounted >> shift_;
    unsigned symbol = 0;
    for (unsigned i = 0; i < places; ++i) {
        while (first[symbol + 1] <= i << shift_) ++symbol;
        table_[i] = static_cast<std::uint16_t>(symbol);
    }
    cycle_ = std::min(5 * cycle_ / 4, (n + 6) * 8);
    left_ = cycle_;
}

void BitModel::update() {
    constexpr std::uint32_t kMaxCounted = 1u << ArithmeticDecoder::kBitBits;
    total_ += cycle_;
    if (total_ > kMaxCounted) {
        total_ = (total_ + 1) / 2;
        zeros_ = (zeros_ + 1) / 2;
        if (zeros_ == total_) ++total_;
    }
    probability_ = zeros_ * (0x80000000u / total_) >> (31 - ArithmeticDecoder::kBitBits);
    cycle_ = std::min(5 * cycle_ / 4, 64u);
    left_ = cycle_;
}

}  // namespace coppice::io_internal
