// Formats 0 to 5: each record is compressed as its difference from the previous one, in versions 1 and 2 of
// [Isenburg2013].

#include <array>
#include <memory>

#include "coppice/base/progress.h"
#include "coppice/io_points/laz/chunk_internal.h"
#include "coppice/io_points/laz/colors_internal.h"
#include "coppice/io_points/laz/integers_internal.h"
#include "coppice/io_points/laz/prediction_internal.h"

namespace coppice::io_internal {
namespace {

/// The fields at the beginning of every record of these formats.
struct Point10 {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint16_t intensity = 0;
    std::uint8_t returns = 0, classification = 0, angle = 0, user = 0;
    std::uint16_t source = 0;

    explicit Point10(std::string_view bytes)
        : x(number_at<std::int32_t>(bytes, 0)),
          y(number_at<std::int32_t>(bytes, 4)),
          z(number_at<std::int32_t>(bytes, 8)),
          intensity(number_at<std::uint16_t>(bytes, 12)),
          returns(number_at<std::uint8_t>(bytes, 14)),
          classification(number_at<std::uint8_t>(bytes, 15)),
          angle(number_at<std::uint8_t>(bytes, 16)),
          user(number_at<std::uint8_t>(bytes, 17)),
          source(number_at<std::uint16_t>(bytes, 18)) {}

    LasPoint point(const Rgb16& color, std::string_view extra) const {
        return {.place = {x, y, z},
                .withheld = (classification & 0x80) != 0,
                .intensity = intensity,
                .return_number = static_cast<std::uint8_t>(returns & 7),
                .return_count = static_cast<std::uint8_t>(returns >> 3 & 7),
                .classification = static_cast<std::uint8_t>(classification & 31),
                .color = color,
                .extra = extra};
    }
    void move(std::int32_t dx, std::int32_t dy) {
        x = static_cast<std::int32_t>(static_cast<std::uint32_t>(x) + static_cast<std::uint32_t>(dx));
        y = static_cast<std::int32_t>(static_cast<std::uint32_t>(y) + static_cast<std::uint32_t>(dy));
    }
};

std::int32_t compute_median(const std::array<std::int32_t, 3>& v) {
    return std::max(std::min(v[0], v[1]), std::min(std::max(v[0], v[1]), v[2]));
}

/// Models shared by versions 1 and 2: for the byte of changed fields, and for bytes by their previous values.
struct Point10Models {
    SymbolModel changes{64};
    SymbolModels returns{256, 256}, classes{256, 256}, users{256, 256};
    IntegerDecoder sources{16};
};

void read_byte(ArithmeticDecoder& in, std::uint8_t& byte, SymbolModels& by_last) {
    byte = static_cast<std::uint8_t>(in.symbol(by_last[byte]));
}

class Point10Version1 {
  public:
    void next(ArithmeticDecoder& in, Point10& p) {
        constexpr unsigned kMax = 19;
        const std::int32_t dx = dx_.read(in, compute_median(last_dx_));
        const unsigned x_bits = dx_.length();
        const std::int32_t dy = dy_.read(in, compute_median(last_dy_), std::min(x_bits, kMax));
        const unsigned bits = (x_bits + dy_.length()) / 2;
        p.move(dx, dy);
        p.z = z_.read(in, p.z, std::min(bits, kMax));
        const unsigned changes = in.symbol(models_.changes);
        if (changes & 32) p.intensity = static_cast<std::uint16_t>(intensities_.read(in, p.intensity, 0u));
        if (changes & 16) read_byte(in, p.returns, models_.returns);
        if (changes & 8) read_byte(in, p.classification, models_.classes);
        if (changes & 4) p.angle = static_cast<std::uint8_t>(angles_.read(in, p.angle, bits < 3 ? 1u : 0u));
        if (changes & 2) read_byte(in, p.user, models_.users);
        if (changes & 1) p.source = static_cast<std::uint16_t>(models_.sources.read(in, p.source, 0u));
        last_dx_[turn_] = dx;
        last_dy_[turn_] = dy;
        turn_ = (turn_ + 1) % 3;
    }

  private:
    Point10Models models_;
    IntegerDecoder dx_{32}, dy_{32, 20}, z_{32, 20}, intensities_{16}, angles_{8, 2};
    std::array<std::int32_t, 3> last_dx_{}, last_dy_{};
    std::size_t turn_ = 0;
};

// Class of a point by the number of returns of its pulse and its return number; points are predicted from the
// previous points of their class. Valid pairs have classes of their own, invalid ones share them.
constexpr std::uint8_t kReturnKind[8][8] = {{15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
                                            {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
                                            {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
                                            {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};

class Point10Version2 {
  public:
    void next(ArithmeticDecoder& in, Point10& p) {
        const unsigned changes = in.symbol(models_.changes);
        if (changes & 32) read_byte(in, p.returns, models_.returns);
        const unsigned number = p.returns & 7u, count = p.returns >> 3 & 7u;
        const unsigned kind = kReturnKind[count][number];
        const unsigned level = number > count ? number - count : count - number;
        if (changes & 16) {
            last_intensity_[kind] = static_cast<std::uint16_t>(
                intensities_.read(in, std::uint32_t{last_intensity_[kind]}, std::min(kind, 3u)));
        }
        p.intensity = last_intensity_[kind];
        if (changes & 8) read_byte(in, p.classification, models_.classes);
        if (changes & 4) {
            const unsigned backward = p.returns >> 6 & 1u;
            p.angle = static_cast<std::uint8_t>(p.angle + in.symbol(angles_[backward]));
        }
        if (changes & 2) read_byte(in, p.user, models_.users);
        if (changes & 1)
            p.source = static_cast<std::uint16_t>(models_.sources.read(in, std::uint32_t{p.source}));
        read_place(in, p, kind, level, count == 1);
    }

  private:
    void read_place(ArithmeticDecoder& in, Point10& p, unsigned kind, unsigned level, bool single) {
        const std::int32_t dx = dx_.read(in, median_dx_[kind].get(), single ? 1u : 0u);
        median_dx_[kind].add(dx);
        const std::int32_t dy =
            dy_.read(in, median_dy_[kind].get(), coordinate_context(dx_.length(), 20, single));
        median_dy_[kind].add(dy);
        p.move(dx, dy);
        const unsigned bits = (dx_.length() + dy_.length()) / 2;
        p.z = z_.read(in, last_z_[level], coordinate_context(bits, 18, single));
        last_z_[level] = p.z;
    }

    Point10Models models_;
    IntegerDecoder dx_{32, 2}, dy_{32, 22}, z_{32, 20}, intensities_{16, 4};
    SymbolModels angles_{2, 256};
    std::array<RunningMedian, 16> median_dx_, median_dy_;
    std::array<std::uint16_t, 16> last_intensity_{};
    std::array<std::int32_t, 8> last_z_{};
};

/// Another item of a record: it must be decoded even if it is not requested, because the next item follows
/// it.
class OtherItem {
  public:
    virtual ~OtherItem() = default;
    virtual void next(ArithmeticDecoder& in) = 0;
};

/// GPS times, as differences or multiples of the last difference. The times themselves are not stored, but
/// decoding depends on whether the last difference was zero.
class GpsTimeVersion1 : public OtherItem {
  public:
    void next(ArithmeticDecoder& in) override {
        if (last_ == 0) {
            const unsigned code = in.symbol(from_zero_);
            if (code == 1) last_ = differences_.read(in, 0, 0);
            if (code == 2) read_whole(in);
            return;
        }
        const unsigned multiple = in.symbol(multiples_);
        if (multiple == kUnchanged) return;
        if (multiple == kWhole) return read_whole(in);
        if (multiple == 1) {
            last_ = differences_.read(in, last_, 1);
            extremes_ = 0;
        } else if (multiple == 0) {
            take_extreme(differences_.read(in, last_ / 4, 2));
        } else {
            const std::int32_t difference = differences_.read(in, times(multiple),
                                                              multiple < 10   ? 3u
                                                              : multiple < 50 ? 4u
                                                                              : 5u);
            if (multiple == kMax) take_extreme(difference);
        }
    }

  private:
    static constexpr unsigned kMax = 509, kWhole = 510, kUnchanged = 511;

    static void read_whole(ArithmeticDecoder& in) {
        for (int i = 0; i < 4; ++i) in.bits(16);
    }
    std::int32_t times(unsigned multiple) const {
        return static_cast<std::int32_t>(multiple * static_cast<std::uint32_t>(last_));
    }
    /// The fourth consecutive difference out of the range of the multiples becomes the last difference.
    void take_extreme(std::int32_t difference) {
        if (++extremes_ <= 3) return;
        last_ = difference;
        extremes_ = 0;
    }

    SymbolModel multiples_{512}, from_zero_{3};
    IntegerDecoder differences_{32, 6};
    std::int32_t last_ = 0;
    int extremes_ = 0;
};

/// GPS times of version 2, which uses four times in turn because pulses of several scanners may be
/// interleaved.
class GpsTimeVersion2 : public OtherItem {
  public:
    void next(ArithmeticDecoder& in) override {
        // A writer switches to another time at most once, followed by the difference of that time.
        for (int turn = 0; turn < 4; ++turn) {
            const unsigned next = times_[at_].last == 0 ? read_from_zero(in) : read_multiple(in);
            if (next == 0) return;
            at_ = (at_ + next) & 3;
        }
    }

  private:
    static constexpr unsigned kMax = 500, kMin = 510, kWhole = 512;  // 511: unchanged
    struct Time {
        std::int32_t last = 0;
        int extremes = 0;
    };

    /// Returns the number of times to advance, or 0 if a time was read.
    unsigned read_from_zero(ArithmeticDecoder& in) {
        const unsigned code = in.symbol(from_zero_);
        if (code > 2) return code - 2;
        if (code == 1) times_[at_] = {differences_.read(in, 0, 0), 0};
        if (code == 2) read_whole(in);
        return 0;
    }
    unsigned read_multiple(ArithmeticDecoder& in) {
        Time& time = times_[at_];
        const unsigned code = in.symbol(multiples_);
        if (code > kWhole) return code - kWhole;
        if (code == kWhole) {
            read_whole(in);
        } else if (code == 1) {
            differences_.read(in, time.last, 1);
            time.extremes = 0;
        } else if (code == 0) {
            take_extreme(time, differences_.read(in, 0, 7));
        } else if (code == kMax) {
            take_extreme(time, differences_.read(in, times(500, time), 4));
        } else if (code == kMin) {
            take_extreme(time, differences_.read(in, times(-10, time), 6));
        } else if (code < kMax) {
            differences_.read(in, times(static_cast<int>(code), time), code < 10 ? 2u : 3u);
        } else if (code < kMin) {
            differences_.read(in, times(static_cast<int>(kMax) - static_cast<int>(code), time), 5);
        }
        return 0;
    }
    void read_whole(ArithmeticDecoder& in) {
        differences_.read(in, 0, 8);
        in.bits(16);
        in.bits(16);
        newest_ = (newest_ + 1) & 3;
        at_ = newest_;
        times_[at_] = {};
    }
    static std::int32_t times(int multiple, const Time& time) {
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(multiple) *
                                         static_cast<std::uint32_t>(time.last));
    }
    static void take_extreme(Time& time, std::int32_t difference) {
        if (++time.extremes > 3) time = {difference, 0};
    }

    SymbolModel multiples_{516}, from_zero_{6};
    IntegerDecoder differences_{32, 9};
    std::array<Time, 4> times_;
    std::size_t at_ = 0, newest_ = 0;
};

/// The colours of a record.
class ColorItem : public OtherItem {
  public:
    Rgb16 color{};
};

template <class Decoder>
class ColorOf : public ColorItem {
  public:
    void next(ArithmeticDecoder& in) override { color = decoder_.read(in, color); }

  private:
    Decoder decoder_;
};

class WavePacket : public OtherItem {
  public:
    void next(ArithmeticDecoder& in) override {
        in.symbol(indices_);
        last_offset_ = in.symbol(offsets_[last_offset_]);
        if (last_offset_ == 2) offset_differences_.read(in, 0);
        if (last_offset_ == 3) {
            for (int i = 0; i < 4; ++i) in.bits(16);
        }
        sizes_.read(in, 0);
        return_points_.read(in, 0);
        for (unsigned axis = 0; axis < 3; ++axis) directions_.read(in, 0, axis);
    }

  private:
    SymbolModel indices_{256};
    SymbolModels offsets_{4, 4};
    IntegerDecoder offset_differences_{32}, sizes_{32}, return_points_{32}, directions_{32, 3};
    unsigned last_offset_ = 0;
};

/// Extra bytes of a record.
class BytesItem : public OtherItem {
  public:
    explicit BytesItem(unsigned count) : bytes(count, '\0') {}
    std::string bytes;
};

class BytesVersion1 : public BytesItem {
  public:
    explicit BytesVersion1(unsigned count) : BytesItem(count), differences_(8, count) {}
    void next(ArithmeticDecoder& in) override {
        for (unsigned i = 0; i < bytes.size(); ++i) {
            const std::uint32_t last = static_cast<std::uint8_t>(bytes[i]);
            bytes[i] = static_cast<char>(differences_.read(in, last, i));
        }
    }

  private:
    IntegerDecoder differences_;
};

class BytesVersion2 : public BytesItem {
  public:
    explicit BytesVersion2(unsigned count) : BytesItem(count), differences_(count, 256) {}
    void next(ArithmeticDecoder& in) override {
        for (unsigned i = 0; i < bytes.size(); ++i)
            bytes[i] = static_cast<char>(static_cast<std::uint8_t>(bytes[i]) + in.symbol(differences_[i]));
    }

  private:
    SymbolModels differences_;
};

std::unique_ptr<OtherItem> other_item(const LazPacking::Item& item) {
    const bool old = item.version == 1;
    switch (item.type) {
        case LazItem::gps_time11:
            if (old) return std::make_unique<GpsTimeVersion1>();
            return std::make_unique<GpsTimeVersion2>();
        case LazItem::rgb12:
            if (old) return std::make_unique<ColorOf<OldColorDecoder>>();
            return std::make_unique<ColorOf<ColorDecoder>>();
        case LazItem::wave_packet13:
            return std::make_unique<WavePacket>();
        default:
            if (old) return std::make_unique<BytesVersion1>(item.size);
            return std::make_unique<BytesVersion2>(item.size);
    }
}

template <class Points>
std::optional<std::size_t> unpack(const LazChunk& chunk, const LazPacking& packing, LasRecordRange& out,
                                  const Context& ctx) {
    Point10 p(chunk.bytes);
    Rgb16 first_color{};
    if (packing.color > 0) first_color = color_at(chunk.bytes, packing.color);
    const std::string_view first_extra = chunk.bytes.substr(packing.extra, packing.record - packing.extra);
    out.put(p.point(first_color, first_extra));
    ArithmeticDecoder in(chunk.bytes.substr(packing.record));
    if (chunk.count > 1) {  // avoids the cost of the models
        const Rgb16* color = &first_color;
        std::string_view extra;
        std::vector<std::unique_ptr<OtherItem>> others;
        for (std::size_t i = 1; i < packing.items.size(); ++i) {
            others.push_back(other_item(packing.items[i]));
            if (packing.items[i].type == LazItem::rgb12) {
                auto& item = static_cast<ColorItem&>(*others.back());
                item.color = first_color;
                color = &item.color;
            } else if (packing.items[i].type == LazItem::byte) {
                auto& item = static_cast<BytesItem&>(*others.back());
                item.bytes = first_extra;
                extra = item.bytes;
            }
        }
        Points points;
        for (std::uint64_t i = 1; i < chunk.count; ++i) {
            poll_stop(ctx, i);
            points.next(in, p);
            for (const auto& item : others) item->next(in);
            if (in.damaged()) return {};
            out.put(p.point(*color, extra));
        }
    }
    return static_cast<std::size_t>(in.position() - chunk.bytes.data());
}

}  // namespace

std::optional<std::size_t> unpack_records(const LazChunk& chunk, const LazPacking& packing,
                                          LasRecordRange& out, const Context& ctx) {
    if (chunk.bytes.size() < packing.record) return {};
    return packing.items[0].version == 1 ? unpack<Point10Version1>(chunk, packing, out, ctx)
                                         : unpack<Point10Version2>(chunk, packing, out, ctx);
}

}  // namespace coppice::io_internal
