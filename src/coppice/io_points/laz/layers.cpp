// Formats 6 to 10: each property of the records of a chunk is compressed separately, as in version 3 of
// [Isenburg2013], with separate models for each of the four scanner channels. Version 4 is identical for the
// properties read here.

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>

#include "coppice/base/progress.h"
#include "coppice/io_points/laz/chunk_internal.h"
#include "coppice/io_points/laz/colors_internal.h"
#include "coppice/io_points/laz/integers_internal.h"
#include "coppice/io_points/laz/prediction_internal.h"

namespace coppice::io_internal {
namespace {

/// The fields at the beginning of every record of these formats, as far as they are read.
struct Point14 {
    std::int32_t x = 0, y = 0, z = 0;
    unsigned return_number = 0, return_count = 0;
    unsigned flags = 0;  ///< classification flags, then direction and edge
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;

    explicit Point14(std::string_view bytes)
        : x(number_at<std::int32_t>(bytes, 0)),
          y(number_at<std::int32_t>(bytes, 4)),
          z(number_at<std::int32_t>(bytes, 8)),
          return_number(number_at<std::uint8_t>(bytes, 14) & 15u),
          return_count(number_at<std::uint8_t>(bytes, 14) >> 4),
          flags((number_at<std::uint8_t>(bytes, 15) & 15u) | (number_at<std::uint8_t>(bytes, 15) >> 2 & 48u)),
          intensity(number_at<std::uint16_t>(bytes, 12)),
          classification(number_at<std::uint8_t>(bytes, 16)) {}

    LasPoint point(const Rgb16& color, std::string_view extra) const {
        return {.place = {x, y, z},
                .withheld = (flags & 4u) != 0,
                .intensity = intensity,
                .return_number = static_cast<std::uint8_t>(return_number),
                .return_count = static_cast<std::uint8_t>(return_count),
                .classification = classification,
                .color = color,
                .extra = extra};
    }
    bool first() const { return return_number == 1; }
    bool last() const { return return_number >= return_count; }
    void move(std::int32_t dx, std::int32_t dy) {
        x = static_cast<std::int32_t>(static_cast<std::uint32_t>(x) + static_cast<std::uint32_t>(dx));
        y = static_cast<std::int32_t>(static_cast<std::uint32_t>(y) + static_cast<std::uint32_t>(dy));
    }
};

/// Returns the class of a point by the number of returns of its pulse and its return number; points are
/// predicted from the previous points of their class.
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

/// State of a scanner channel.
struct Channel {
    explicit Channel(const Point14& p) : last(p) {
        last_z.fill(p.z);
        last_intensity.fill(p.intensity);
    }

    Point14 last;
    bool time_changed = false;
    SymbolModels changes{8, 128}, return_counts{16, 16}, return_numbers{16, 16}, flags{64, 64},
        classes{64, 256};
    SymbolModel channels{3}, return_numbers_same_time{13};
    IntegerDecoder dx{32, 2}, dy{32, 22}, z{32, 20}, intensities{16, 4};
    std::array<RunningMedian, 12> median_dx, median_dy;
    std::array<std::int32_t, 8> last_z{};
    std::array<std::uint16_t, 8> last_intensity{};
};

/// The last value of an item for each channel, with its models. Items after the first one switch channels in
/// a particular way, on which files of version 3 rely: channel 0 is assumed for a point unless its channel
/// changed, and a channel that occurred before is predicted from the last one read. Version 4 does neither.
template <class Value, class Models>
class ByChannel {
  public:
    ByChannel(std::uint16_t version, std::size_t channel, const Value& first)
        : as_version3_(version < 4), at_(channel) {
        channels_[at_] = std::make_unique<OfChannel>(first);
    }

    /// Calls read(models, value), which replaces the last value by the next one.
    template <class Read>
    const Value& next(std::size_t channel, bool changed, const Read& read) {
        if (as_version3_ && !changed) channel = 0;
        OfChannel* from = channels_[at_].get();
        if (channel != at_) {
            at_ = channel;
            const bool fresh = !channels_[at_];
            if (fresh) channels_[at_] = std::make_unique<OfChannel>(from->last);
            if (fresh || !as_version3_) from = channels_[at_].get();
        }
        read(channels_[at_]->models, from->last);
        return from->last;
    }

  private:
    struct OfChannel {
        explicit OfChannel(const Value& value) : last(value), models(value) {}
        Value last;
        Models models;
    };
    std::array<std::unique_ptr<OfChannel>, 4> channels_;
    bool as_version3_;
    std::size_t at_;
};

using Layer = std::optional<ArithmeticDecoder>;

bool is_damaged(const Layer& layer) { return layer && layer->damaged(); }

class ColorLayer {
  public:
    ColorLayer(Layer layer, std::uint16_t version, std::size_t channel, const Rgb16& first)
        : layer_(layer), colors_(version, channel, first) {}

    const Rgb16& read(std::size_t channel, bool changed) {
        return colors_.next(channel, changed, [&](Models& models, Rgb16& color) {
            if (layer_) color = models.decoder.read(*layer_, color);
        });
    }
    bool damaged() const { return is_damaged(layer_); }

  private:
    struct Models {
        explicit Models(const Rgb16&) {}
        ColorDecoder decoder;
    };
    Layer layer_;
    ByChannel<Rgb16, Models> colors_;
};

/// Extra bytes of records: a layer for each byte.
class ByteLayers {
  public:
    ByteLayers(std::vector<Layer> layers, std::uint16_t version, std::size_t channel, std::string_view first)
        : layers_(std::move(layers)), bytes_(version, channel, std::string(first)) {}

    std::string_view read(std::size_t channel, bool changed) {
        return bytes_.next(channel, changed, [&](Models& models, std::string& bytes) {
            for (std::size_t i = 0; i < layers_.size(); ++i) {
                if (!layers_[i]) continue;
                const unsigned difference = layers_[i]->symbol(models.of_byte[i]);
                bytes[i] = static_cast<char>(static_cast<std::uint8_t>(bytes[i]) + difference);
            }
        });
    }
    bool damaged() const { return std::ranges::any_of(layers_, is_damaged); }

  private:
    struct Models {
        explicit Models(const std::string& bytes) : of_byte(static_cast<unsigned>(bytes.size()), 256) {}
        SymbolModels of_byte;
    };
    std::vector<Layer> layers_;
    ByChannel<std::string, Models> bytes_;
};

/// Splits the bytes of a chunk into its layers, in order.
class LayerCutter {
  public:
    LayerCutter(std::string_view sizes, std::string_view bytes) : sizes_(sizes), bytes_(bytes) {}

    /// Returns the size of all layers in bytes.
    std::uint64_t size() const {
        std::uint64_t sum = 0;
        for (std::size_t at = 0; at < sizes_.size(); at += 4) sum += number_at<std::uint32_t>(sizes_, at);
        return sum;
    }
    /// Returns the next layer; nullopt if the property is constant in the chunk.
    Layer next() {
        const std::string_view layer = cut();
        if (layer.empty()) return {};
        return ArithmeticDecoder(layer);
    }
    /// Returns the next layer; nullopt also if it is not requested.
    Layer next_if(bool wanted) {
        if (wanted) return next();
        cut();
        return {};
    }

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
    /// Layers of empty columns of `out` are skipped.
    LayerReader(LayerCutter& layers, const LazPacking& packing, std::string_view first, const LasColumns& out)
        : places_(layers.next()),
          heights_(layers.next()),
          classes_(layers.next_if(!out.classes.empty())),
          flags_(layers.next()),
          intensities_(layers.next_if(!out.intensities.empty())),
          at_(first_channel(first)) {
        channels_[at_] = std::make_unique<Channel>(Point14(first));
        for (int i = 0; i < 4; ++i) layers.next_if(false);  // angle, user, source, time
        for (std::size_t i = 1; i < packing.items.size(); ++i)
            begin_item(packing.items[i], layers, packing, first, out);
    }

    LasPoint next() {
        Channel& channel = read_changes();
        Point14& p = channel.last;
        const bool time_changed = (changes_ & 16u) != 0;
        read_place(channel, time_changed);
        // Return type within the pulse: 0 intermediate, 1 last, 2 first, 3 single.
        const unsigned among = (p.first() ? 2u : 0u) + (p.last() ? 1u : 0u);
        if (classes_) {
            const unsigned from = (p.classification & 31u) * 2 + (among == 3 ? 1 : 0);
            p.classification = static_cast<std::uint8_t>(classes_->symbol(channel.classes[from]));
        }
        if (flags_) p.flags = flags_->symbol(channel.flags[p.flags]);
        if (intensities_) {
            std::uint16_t& last = channel.last_intensity[2 * among + (time_changed ? 1 : 0)];
            last = static_cast<std::uint16_t>(
                channel.intensities.read(*intensities_, std::uint32_t{last}, among));
            p.intensity = last;
        }
        channel.time_changed = time_changed;
        const bool channel_changed = (changes_ & 64u) != 0;
        return p.point(colors_ ? colors_->read(at_, channel_changed) : Rgb16{},
                       bytes_ ? bytes_->read(at_, channel_changed) : std::string_view());
    }

    bool damaged() const {
        return !places_ || places_->damaged() || is_damaged(heights_) || is_damaged(classes_) ||
               is_damaged(flags_) || is_damaged(intensities_) || (colors_ && colors_->damaged()) ||
               (bytes_ && bytes_->damaged());
    }

  private:
    /// Assigns the layers of an item after the first one.
    void begin_item(const LazPacking::Item& item, LayerCutter& layers, const LazPacking& packing,
                    std::string_view first, const LasColumns& out) {
        if (item.type == LazItem::byte14) {
            std::vector<Layer> own;
            for (unsigned i = 0; i < item.size; ++i) own.push_back(layers.next_if(out.need_extra()));
            if (out.need_extra())
                bytes_.emplace(std::move(own), item.version, at_, first.substr(packing.extra, item.size));
            return;
        }
        const bool colored = item.type != LazItem::wave_packet14;
        Layer layer = layers.next_if(colored && !out.colors.empty());
        if (item.type == LazItem::rgb_nir14) layers.next_if(false);  // near infrared
        if (colored && !out.colors.empty())
            colors_.emplace(layer, item.version, at_, color_at(first, packing.color));
    }

    static std::size_t first_channel(std::string_view record) {
        return number_at<std::uint8_t>(record, 15) >> 4 & 3u;
    }

    /// Reads which properties change, and the values that precede the coordinates: channel and returns.
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

    void read_place(Channel& channel, bool time_changed) {
        Point14& p = channel.last;
        const bool single = p.return_count == 1;
        const unsigned kind = 2 * return_kind(p.return_count, p.return_number) + (time_changed ? 1u : 0u);
        const std::int32_t dx = channel.dx.read(*places_, channel.median_dx[kind].get(), single ? 1u : 0u);
        channel.median_dx[kind].add(dx);
        const std::int32_t dy = channel.dy.read(*places_, channel.median_dy[kind].get(),
                                                coordinate_context(channel.dx.length(), 20, single));
        channel.median_dy[kind].add(dy);
        p.move(dx, dy);
        if (!heights_) return;
        const unsigned level =
            std::min(7u, p.return_count > p.return_number ? p.return_count - p.return_number
                                                          : p.return_number - p.return_count);
        const unsigned bits = (channel.dx.length() + channel.dy.length()) / 2;
        p.z = channel.z.read(*heights_, channel.last_z[level], coordinate_context(bits, 18, single));
        channel.last_z[level] = p.z;
    }

    Layer places_, heights_, classes_, flags_, intensities_;
    std::optional<ColorLayer> colors_;
    std::optional<ByteLayers> bytes_;
    std::array<std::unique_ptr<Channel>, 4> channels_;
    std::size_t at_ = 0;
    unsigned changes_ = 0;
};

}  // namespace

std::optional<std::size_t> unpack_layers(const LazChunk& chunk, const LazPacking& packing,
                                         LasRecordRange& out, const Context& ctx) {
    const std::size_t table = 4 * layer_count(packing), head = packing.record + 4 + table;
    if (chunk.bytes.size() < head) return {};
    if (number_at<std::uint32_t>(chunk.bytes, packing.record) < chunk.count) return {};
    LayerCutter layers(chunk.bytes.substr(packing.record + 4u, table), chunk.bytes.substr(head));
    const std::uint64_t size = layers.size();
    if (size > chunk.bytes.size() - head) return {};
    out.put(Point14(chunk.bytes)
                .point(packing.color > 0 ? color_at(chunk.bytes, packing.color) : Rgb16{},
                       chunk.bytes.substr(packing.extra, packing.record - packing.extra)));
    if (chunk.count > 1) {
        LayerReader reader(layers, packing, chunk.bytes, *out.columns);
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
