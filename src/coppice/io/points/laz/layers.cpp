// Formats 6 to 10: every property of the records of a chunk is packed by itself, as version 3 of [LAZ] has
// it, with models of their own for each of the scanner's four channels. Version 4 packs the properties read
// here alike.

#include <array>
#include <memory>

#include "coppice/base/progress.h"
#include "coppice/io/points/laz/chunk_internal.h"
#include "coppice/io/points/laz/integers_internal.h"
#include "coppice/io/points/laz/prediction_internal.h"

namespace coppice::io_internal {
namespace {

/// The part that every record of these formats begins with, as far as it is read.
struct Point14 {
    std::int32_t x = 0, y = 0, z = 0;
    unsigned return_number = 0, return_count = 0;
    unsigned flags = 0;  ///< those of the classification, then direction and edge

    explicit Point14(std::string_view bytes)
        : x(number_at<std::int32_t>(bytes, 0)),
          y(number_at<std::int32_t>(bytes, 4)),
          z(number_at<std::int32_t>(bytes, 8)),
          return_number(number_at<std::uint8_t>(bytes, 14) & 15u),
          return_count(number_at<std::uint8_t>(bytes, 14) >> 4),
          flags((number_at<std::uint8_t>(bytes, 15) & 15u) |
                (number_at<std::uint8_t>(bytes, 15) >> 2 & 48u)) {}

    LasPoint point() const { return {{x, y, z}, (flags & 4u) != 0}; }
    bool first() const { return return_number == 1; }
    bool last() const { return return_number >= return_count; }
    void move(std::int32_t dx, std::int32_t dy) {
        x = static_cast<std::int32_t>(static_cast<std::uint32_t>(x) + static_cast<std::uint32_t>(dx));
        y = static_cast<std::int32_t>(static_cast<std::uint32_t>(y) + static_cast<std::uint32_t>(dy));
    }
};

/// Of which points a point is taken for a successor, by the number of returns of its pulse and which of them
/// it is.
unsigned return_kind(unsigned a, unsigned b) {
    constexpr std::array<std::uint8_t, 16> kWithoutNumber{0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5};
    const unsigned least = std::min(a, b), most = std::max(a, b);
    switch (least) {
        case 0:
            return kWithoutNumber[most];
        case 1:
            return most == 1 ? 0 : most == 2 ? 1 : 3;
        case 2:
            return most == 2 ? 2 : most <= 10 ? 4 : 3;
        default:
            return most == least || (most == least + 1 && least >= 11) ? 5 : 4;
    }
}

/// What is known of a channel of the scanner.
struct Channel {
    explicit Channel(const Point14& p) : last(p) { last_z.fill(p.z); }

    Point14 last;
    bool time_changed = false;
    SymbolModels changes{8, 128}, return_counts{16, 16}, return_numbers{16, 16}, flags{64, 64};
    SymbolModel channels{3}, return_numbers_same_time{13};
    IntegerDecoder dx{32, 2}, dy{32, 22}, z{32, 20};
    std::array<RunningMedian, 12> median_dx, median_dy;
    std::array<std::int32_t, 8> last_z{};
};

/// The bytes of a chunk's layers, in their order.
class LayerCutter {
  public:
    LayerCutter(std::string_view sizes, std::string_view bytes) : sizes_(sizes), bytes_(bytes) {}

    /// [bytes] of all layers.
    std::uint64_t size() const {
        std::uint64_t sum = 0;
        for (std::size_t at = 0; at < sizes_.size(); at += 4) sum += number_at<std::uint32_t>(sizes_, at);
        return sum;
    }
    /// Nothing where the property is the same for all points of the chunk.
    std::optional<ArithmeticDecoder> next() {
        const std::string_view layer = cut();
        if (layer.empty()) return {};
        return ArithmeticDecoder(layer);
    }
    void pass() { cut(); }

  private:
    std::string_view cut() {
        const std::size_t size = number_at<std::uint32_t>(sizes_, 0);
        sizes_.remove_prefix(4);
        const std::string_view layer = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return layer;
    }
    std::string_view sizes_, bytes_;
};

std::size_t layer_count(const LazPacking& packing) {
    std::size_t count = 0;
    for (const LazPacking::Item& item : packing.items) {
        count += item.type == LazItem::point14     ? 9
                 : item.type == LazItem::rgb_nir14 ? 2
                 : item.type == LazItem::byte14    ? item.size
                                                   : 1;
    }
    return count;
}

class LayerReader {
  public:
    LayerReader(LayerCutter& layers, std::string_view first)
        : places_(layers.next()), heights_(layers.next()) {
        layers.pass();  // classification
        flags_ = layers.next();
        at_ = first_channel(first);
        channels_[at_] = std::make_unique<Channel>(Point14(first));
    }

    LasPoint next() {
        Channel& channel = read_changes();
        Point14& p = channel.last;
        const bool time_changed = (changes_ & 16u) != 0;
        const bool single = p.return_count == 1;
        const unsigned kind = 2 * return_kind(p.return_count, p.return_number) + (time_changed ? 1u : 0u);
        const std::int32_t dx = channel.dx.read(*places_, channel.median_dx[kind].get(), single ? 1u : 0u);
        channel.median_dx[kind].add(dx);
        const std::int32_t dy = channel.dy.read(*places_, channel.median_dy[kind].get(),
                                                coordinate_context(channel.dx.length(), 20, single));
        channel.median_dy[kind].add(dy);
        p.move(dx, dy);
        if (heights_) read_height(channel, single);
        if (flags_) p.flags = flags_->symbol(channel.flags[p.flags]);
        channel.time_changed = time_changed;
        return p.point();
    }

    bool damaged() const {
        return !places_ || places_->damaged() || (heights_ && heights_->damaged()) ||
               (flags_ && flags_->damaged());
    }

  private:
    static std::size_t first_channel(std::string_view record) {
        return number_at<std::uint8_t>(record, 15) >> 4 & 3u;
    }

    /// Reads what changes, and what leads to the coordinates: channel and returns.
    Channel& read_changes() {
        Channel* channel = channels_[at_].get();
        const unsigned from = (channel->last.first() ? 1u : 0u) + (channel->last.last() ? 2u : 0u) +
                              (channel->time_changed ? 4u : 0u);
        changes_ = places_->symbol(channel->changes[from]);
        if (changes_ & 64u) {
            at_ = (at_ + places_->symbol(channel->channels) + 1) & 3u;
            if (!channels_[at_]) channels_[at_] = std::make_unique<Channel>(channel->last);
            channel = channels_[at_].get();
        }
        Point14& p = channel->last;
        if (changes_ & 4u) p.return_count = places_->symbol(channel->return_counts[p.return_count]);
        switch (changes_ & 3u) {
            case 0:
                break;
            case 1:
                p.return_number = (p.return_number + 1) & 15u;
                break;
            case 2:
                p.return_number = (p.return_number + 15) & 15u;
                break;
            default:
                p.return_number =
                    changes_ & 16u
                        ? places_->symbol(channel->return_numbers[p.return_number])
                        : (p.return_number + 2 + places_->symbol(channel->return_numbers_same_time)) & 15u;
        }
        return *channel;
    }

    void read_height(Channel& channel, bool single) {
        Point14& p = channel.last;
        const unsigned level =
            std::min(7u, p.return_count > p.return_number ? p.return_count - p.return_number
                                                          : p.return_number - p.return_count);
        const unsigned bits = (channel.dx.length() + channel.dy.length()) / 2;
        p.z = channel.z.read(*heights_, channel.last_z[level], coordinate_context(bits, 18, single));
        channel.last_z[level] = p.z;
    }

    std::optional<ArithmeticDecoder> places_, heights_, flags_;
    std::array<std::unique_ptr<Channel>, 4> channels_;
    std::size_t at_ = 0;
    unsigned changes_ = 0;
};

}  // namespace

std::optional<std::size_t> unpack_layers(const LazChunk& chunk, const LazPacking& packing, LasPart& out,
                                         const Context& ctx) {
    const std::size_t table = 4 * layer_count(packing), head = packing.record + 4 + table;
    if (chunk.bytes.size() < head) return {};
    if (number_at<std::uint32_t>(chunk.bytes, packing.record) < chunk.count) return {};
    LayerCutter layers(chunk.bytes.substr(packing.record + 4u, table), chunk.bytes.substr(head));
    const std::uint64_t size = layers.size();
    if (size > chunk.bytes.size() - head) return {};
    out.put(Point14(chunk.bytes).point());
    if (chunk.count > 1) {
        LayerReader reader(layers, chunk.bytes);
        for (std::uint64_t i = 1; i < chunk.count; ++i) {
            poll_stop(ctx, i);
            if (reader.damaged()) return {};
            out.put(reader.next());
        }
        if (reader.damaged()) return {};
    }
    return head + static_cast<std::size_t>(size);
}

}  // namespace coppice::io_internal
