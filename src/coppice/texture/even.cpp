#include <array>
#include <complex>
#include <functional>
#include <numbers>

#include "coppice/texture/bark_internal.h"

namespace coppice::texture_internal {
namespace {

constexpr int kMaxFrequency = 3;  // [1/tile]
constexpr std::size_t kRows = 8;

using Complex = std::complex<float>;

/// exp(-2 pi i k x) at the centres of `size` texels, for the frequencies k that they resolve.
class Waves {
  public:
    explicit Waves(int size)
        : size_(static_cast<std::size_t>(size)), max_(std::min(kMaxFrequency, (size - 1) / 2)) {
        for (int k = 0; k <= max_; ++k) {
            for (int i = 0; i < size; ++i)
                values_.emplace_back(std::polar(1.0, -2 * std::numbers::pi * k * (i + 0.5) / size));
        }
    }

    int max_frequency() const { return max_; }
    Complex operator()(int k, std::size_t i) const {
        const Complex value = values_[static_cast<std::size_t>(std::abs(k)) * size_ + i];
        return k < 0 ? std::conj(value) : value;
    }

  private:
    std::size_t size_;
    int max_;
    std::vector<Complex> values_;
};

/// The amplitudes of a wave of the weights, and of the brightness times its weight.
struct Amplitudes {
    Complex weight, light;
};

/// The amplitudes of the waves across a row by frequency.
using RowWaves = std::array<Amplitudes, kMaxFrequency + 1>;

void add_product(RowWaves& sum, Complex factor, const RowWaves& waves) {
    for (std::size_t k = 0; k < sum.size(); ++k) {
        sum[k].weight += factor * waves[k].weight;
        sum[k].light += factor * waves[k].light;
    }
}

float compute_light(const BarkMaps::Texel& t) {
    return 0.3f * static_cast<float>(t[0]) + 0.6f * static_cast<float>(t[1]) +
           0.1f * static_cast<float>(t[2]);
}

float compute_mean_light(const BarkMaps& maps, const Context& ctx) {
    const auto sum = [&](IndexRange range) {
        float out = 0;
        for (std::size_t i = range.begin; i < range.end; ++i) out += compute_light(maps.color[i]);
        return out;
    };
    return parallel_reduce(ctx, maps.size(), 4096, 0.0f, sum, std::plus<float>{}) /
           static_cast<float>(maps.size());
}

/// The brightness of the outer surface, smoothed to at most kMaxFrequency periods across and along the tile.
/// Furrows and dark marks have no weight: their density varies, but the colours next to them should not.
class SmoothLight {
  public:
    SmoothLight(const BarkMaps& maps, const Context& ctx)
        : across_(maps.width), along_(maps.height), mean_(compute_mean_light(maps, ctx)) {
        const auto width = static_cast<std::size_t>(maps.width);
        std::vector<RowWaves> rows(static_cast<std::size_t>(maps.height));
        parallel_for(ctx, rows.size(), kRows, [&](std::size_t row) {
            rows[row] = transform(std::span(maps.color).subspan(row * width, width));
        });
        for (int k = -along_.max_frequency(); k <= along_.max_frequency(); ++k) {
            RowWaves& sum = waves_.emplace_back();
            for (std::size_t row = 0; row < rows.size(); ++row) add_product(sum, along_(k, row), rows[row]);
        }
    }

    /// Sets the ratio of the mean to the brightness at the texels of a row.
    void fill_gains(std::size_t row, std::span<float> out) const {
        RowWaves own{};
        int k = -along_.max_frequency();
        for (const RowWaves& waves : waves_) add_product(own, std::conj(along_(k++, row)), waves);
        std::vector<float> light(out.size(), own[0].light.real()), weight(out.size(), own[0].weight.real());
        for (int wave = 1; wave <= across_.max_frequency(); ++wave) {
            const Amplitudes& at = own[static_cast<std::size_t>(wave)];
            add_wave(wave, 2.0f * at.light, light);
            add_wave(wave, 2.0f * at.weight, weight);
        }
        const Amplitudes& all = waves_[static_cast<std::size_t>(along_.max_frequency())][0];
        const float mean = all.light.real() / std::max(all.weight.real(), 1e-3f);
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = std::clamp(mean * weight[i] / std::max(light[i], 1e-3f), 0.5f, 2.0f);
    }

  private:
    void add_wave(int k, Complex amplitude, std::span<float> sum) const {
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const Complex wave = across_(k, i);
            sum[i] += wave.real() * amplitude.real() + wave.imag() * amplitude.imag();
        }
    }

    RowWaves transform(std::span<const BarkMaps::Texel> row) const {
        std::vector<float> light(row.size()), weight(row.size());
        for (std::size_t i = 0; i < row.size(); ++i) {
            light[i] = compute_light(row[i]);
            weight[i] = smooth_step(0.4f * mean_, 0.8f * mean_, light[i]);
            light[i] *= weight[i];
        }
        RowWaves out{};
        for (int k = 0; k <= across_.max_frequency(); ++k)
            out[static_cast<std::size_t>(k)] = {compute_amplitude(k, weight), compute_amplitude(k, light)};
        return out;
    }

    Complex compute_amplitude(int k, std::span<const float> values) const {
        float real = 0, imaginary = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            real += values[i] * across_(k, i).real();
            imaginary += values[i] * across_(k, i).imag();
        }
        return {real, imaginary};
    }

    Waves across_, along_;
    float mean_;
    std::vector<RowWaves> waves_;  // by frequency along the tile
};

}  // namespace

void even_colors(BarkMaps& maps, const Context& ctx) {
    const SmoothLight light(maps, ctx);
    const auto width = static_cast<std::size_t>(maps.width);
    parallel_for_ranges(ctx, static_cast<std::size_t>(maps.height), kRows, [&](IndexRange rows) {
        std::vector<float> gains(width);
        for (std::size_t row = rows.begin; row < rows.end; ++row) {
            light.fill_gains(row, gains);
            for (std::size_t i = 0; i < width; ++i) {
                for (std::uint8_t& channel : maps.color[row * width + i])
                    channel = to_byte(gains[i] * (1.0f / 255) * static_cast<float>(channel));
            }
        }
    });
}

}  // namespace coppice::texture_internal
