#include <limits>

#include "coppice/texture/lattice_internal.h"

namespace coppice::texture_internal {
namespace {

float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

/// Removes the part of a convex polygon with dot(p, normal) > distance.
void clip(std::vector<Place>& polygon, Place normal, float distance) {
    std::vector<Place> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Place a = polygon[k], b = polygon[(k + 1) % polygon.size()];
        const float over_a = dot(a, normal) - distance, over_b = dot(b, normal) - distance;
        if (over_a <= 0) kept.push_back(a);
        if ((over_a <= 0) != (over_b <= 0)) kept.push_back(a + (over_a / (over_a - over_b)) * (b - a));
    }
    polygon = std::move(kept);
}

}  // namespace

Noise::Noise(const Tile& tile, float cell_width, float cell_height, std::uint64_t stage, float amplitude)
    : lattice_(tile, cell_width, cell_height, stage),
      texel_(tile.texel_width / lattice_.cell().x),
      key_(CounterRandom(tile.seed, stage).bits(3)) {
    constexpr float kScale = 1.7f / 32768;
    const float texels = std::min(1 / texel_, lattice_.cell().y / tile.texel_height);
    amplitude_ = amplitude * kScale * saturate(texels - 1.5f);
}

void Noise::add_row(float y, std::span<float> out) const {
    const Place start = lattice_.in_cells({0, y});
    const int j = round_down(start.y);
    const float v = start.y - static_cast<float>(j);
    const std::uint64_t low = key_ ^ static_cast<std::uint64_t>(lattice_.row(j)) << 32;
    const std::uint64_t high = key_ ^ static_cast<std::uint64_t>(lattice_.row(j + 1)) << 32;
    const float weight = fade(v);
    // Along a row, the noise of both corners of a column is linear between two columns of the lattice.
    const auto column = [&](int i) {
        const auto at = static_cast<std::uint64_t>(lattice_.column(i));
        const std::uint64_t a = mix_bits(low ^ at), b = mix_bits(high ^ at);
        const auto part = [](std::uint64_t bits, int shift) {
            return static_cast<float>(static_cast<std::int16_t>(bits >> shift));
        };
        return Place{amplitude_ * mix(part(a, 0), part(b, 0), weight),
                     amplitude_ * mix(part(a, 16) * v, part(b, 16) * (v - 1), weight)};
    };
    int i = round_down(start.x + 0.5f * texel_);
    Place left = column(i), right = column(i + 1);
    for (std::size_t k = 0; k < out.size();) {
        const float first = start.x - static_cast<float>(i);
        const float texels = std::ceil((1 - first) / texel_ - 0.5f);
        const std::size_t end =
            std::clamp(static_cast<std::size_t>(std::max(texels, 0.0f)), k + 1, out.size());
        for (std::size_t m = k; m < end; ++m) {
            const float x = first + (static_cast<float>(static_cast<int>(m)) + 0.5f) * texel_;
            const float a = left.y + left.x * x, b = right.y + right.x * (x - 1);
            out[m] += a + fade(x) * (b - a);
        }
        k = end;
        left = right;
        right = column(++i + 1);
    }
}

Fractal::Fractal(const Tile& tile, float cell_width, float cell_height, int octaves, std::uint64_t stage,
                 float gain) {
    float amplitude = 1, squares = 0;
    for (int k = 0; k < octaves; ++k, amplitude *= gain) squares += amplitude * amplitude;
    amplitude = 1 / std::sqrt(squares);
    for (int k = 0; k < octaves; ++k, amplitude *= gain) {
        const float scale = std::ldexp(1.0f, -k);
        const Noise noise(tile, cell_width * scale, cell_height * scale,
                          stage * 64 + static_cast<unsigned>(k), amplitude);
        if (noise.is_visible()) octaves_.push_back(noise);
    }
}

void Fractal::fill_row(float y, std::span<float> out) const {
    std::ranges::fill(out, 0.0f);
    for (const Noise& noise : octaves_) noise.add_row(y, out);
}

Cells::Cells(const Tile& tile, float cell_width, float cell_height, float jitter, float rounding,
             std::uint64_t stage, float shift, float stagger)
    : lattice_(tile, cell_width, cell_height, stage, 2),
      rounding_(std::max(rounding, 1e-7f)),
      stride_(static_cast<std::size_t>(lattice_.columns() + 2 * kMargin)) {
    const CounterRandom random(tile.seed, stage);
    // Rows alternate only if their number is even.
    const float every_other = lattice_.rows() % 2 == 0 ? shift : 0;
    const int columns = lattice_.columns();
    const auto move_column = [&](int column) {
        const int step = column * (columns / 2) % columns;
        return stagger * (static_cast<float>(step) / static_cast<float>(columns) - 0.5f);
    };
    for (int j = -kMargin; j < lattice_.rows() + kMargin; ++j) {
        for (int i = -kMargin; i < lattice_.columns() + kMargin; ++i) {
            const int row = lattice_.row(j);
            const std::uint64_t bits = random.bits(static_cast<std::uint64_t>(row + 1) << 32 |
                                                   static_cast<std::uint32_t>(lattice_.column(i)));
            const auto unit = [&](unsigned at) {
                return static_cast<float>((bits >> at) & 0xffff) / 65536 - 0.5f;
            };
            const float moved = row % 2 == 0 ? -0.25f : 0.25f;
            const Place place{
                0.5f + moved * every_other + jitter * unit(0),
                0.5f + move_column(lattice_.column(i)) + (1 - 0.5f * stagger) * jitter * unit(16)};
            centers_.push_back({place, static_cast<std::uint32_t>(bits >> 32)});
        }
    }
    for (int j = 0; j < lattice_.rows(); ++j)
        for (int i = 0; i < lattice_.columns(); ++i) add_borders(i, j);
    first_border_.push_back(borders_.size());
}

void Cells::add_borders(int i, int j) {
    constexpr float kFar = 4;
    first_border_.push_back(borders_.size());
    const Center& own = at(i, j);
    const Place size = lattice_.cell();
    std::vector<Place> polygon{{-kFar, -kFar}, {kFar, -kFar}, {kFar, kFar}, {-kFar, kFar}};
    std::vector<Border> all;
    for (int dj = -2; dj <= 2; ++dj) {
        for (int di = -2; di <= 2; ++di) {
            if (di == 0 && dj == 0) continue;
            const Center& center = at(i + di, j + dj);
            const Place to = center.place + Place{static_cast<float>(di), static_cast<float>(dj)} - own.place;
            const Place metric{to.x / size.x, to.y / size.y};
            const float scale = 1 / std::max(std::sqrt(dot(metric, metric)), 1e-20f);
            all.push_back({scale * to, 0.5f * scale * dot(to, to), center.id});
            clip(polygon, all.back().normal, all.back().distance);
        }
    }
    // Only those that touch the polygon can be the closest border at a place within it.
    for (const Border& border : all) {
        const float reach = 1e-3f * border.distance;
        const bool touches = std::ranges::any_of(
            polygon, [&](Place p) { return dot(p, border.normal) >= border.distance - reach; });
        if (touches) borders_.push_back(border);
    }
}

Cell Cells::operator()(Place p) const {
    const Place c = lattice_.in_cells(p);
    const int i = round_down(c.x), j = round_down(c.y);
    const int i0 = lattice_.column(i), j0 = lattice_.row(j);
    const Place inner{c.x - static_cast<float>(i), c.y - static_cast<float>(j)};
    float closest = std::numeric_limits<float>::max();
    int ci = 0, cj = 0;
    Place d{};
    for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
            const Place e =
                inner - at(i0 + di, j0 + dj).place - Place{static_cast<float>(di), static_cast<float>(dj)};
            const float squared = dot(e, e);
            if (squared >= closest) continue;
            closest = squared;
            ci = di;
            cj = dj;
            d = e;
        }
    }
    const std::uint32_t id = at(i0 + ci, j0 + cj).id;
    const Place size = lattice_.cell();
    float border = std::numeric_limits<float>::max(), nearest = border;
    Cell cell{0, id, id, {d.x * size.x, d.y * size.y}};
    for (const Border& b : borders(i0 + ci, j0 + cj)) {
        const float distance = b.distance - dot(d, b.normal);
        if (distance < nearest) {
            nearest = distance;
            cell.next = b.id;
        }
        if (distance - border < rounding_) border = smooth_min(border, distance, rounding_);
    }
    cell.border = std::max(border, 0.0f);
    return cell;
}

}  // namespace coppice::texture_internal
