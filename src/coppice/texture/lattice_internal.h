#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/random.h"

namespace coppice::texture_internal {

/// A point of the tile: [m] x around the stem, y along it, upwards.
struct Place {
    float x, y;

    friend Place operator+(Place a, Place b) { return {a.x + b.x, a.y + b.y}; }
    friend Place operator-(Place a, Place b) { return {a.x - b.x, a.y - b.y}; }
    friend Place operator*(float s, Place a) { return {s * a.x, s * a.y}; }
};

inline float dot(Place a, Place b) { return a.x * b.x + a.y * b.y; }

/// The extent of a tile and of its texels, common to all its noises.
struct Tile {
    float width, height;              ///< [m]
    float texel_width, texel_height;  ///< [m]
    std::uint64_t seed;

    float texel() const { return std::max(texel_width, texel_height); }
};

inline float saturate(float x) { return x < 0 ? 0.0f : x > 1 ? 1.0f : x; }
inline float mix(float a, float b, float t) { return a + (b - a) * t; }
/// Returns 0 below `low`, 1 above `high`, with zero slope at both.
inline float smooth_step(float low, float high, float x) {
    const float t = saturate((x - low) / (high - low));
    return t * t * (3 - 2 * t);
}
/// Returns a rounded minimum that differs from std::min where |a - b| < k.
inline float smooth_min(float a, float b, float k) {
    const float h = std::max(k - std::abs(a - b), 0.0f) / k;
    return std::min(a, b) - 0.25f * h * h * k;
}
/// Returns the largest integer not above x; |x| < 2^31.
inline int round_down(float x) {
    const int i = static_cast<int>(x);
    return i - static_cast<int>(static_cast<float>(i) > x);
}

/// A grid of cells that divides a tile evenly, so that it continues without a seam. Cell sizes are rounded.
/// The lines of the grid are shifted at random: noises differ in their statistics there, which would show at
/// the edges of the tile if all grids had lines there.
class Lattice {
  public:
    Lattice(const Tile& tile, float cell_width, float cell_height, std::uint64_t stage, int min_period = 1)
        : columns_(period(tile.width, cell_width, min_period)),
          rows_(period(tile.height, cell_height, min_period)),
          cell_{tile.width / static_cast<float>(columns_), tile.height / static_cast<float>(rows_)},
          inverse_{1 / cell_.x, 1 / cell_.y} {
        const CounterRandom random(tile.seed, stage);
        shift_ = {static_cast<float>(random.uniform(1)), static_cast<float>(random.uniform(2))};
    }

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    Place cell() const { return cell_; }  ///< [m] size of a cell
    /// Returns the position in cells.
    Place in_cells(Place p) const { return {p.x * inverse_.x + shift_.x, p.y * inverse_.y + shift_.y}; }
    /// Returns the column or row of the tile that repeats at i.
    int column(int i) const { return wrapped(i, columns_); }
    int row(int i) const { return wrapped(i, rows_); }

  private:
    static int period(float extent, float cell, int min_period) {
        return std::clamp(static_cast<int>(std::lround(extent / cell)), min_period, 1 << 14);
    }
    static int wrapped(int i, int period) {
        if (i >= 0 && i < period) return i;
        const int r = i % period;
        return r < 0 ? r + period : r;
    }

    int columns_, rows_;
    Place cell_, inverse_, shift_;
};

/// Periodic gradient noise with zero mean, mostly in [-1, 1]. Source: [Perlin1985].
class Noise {
  public:
    Noise(const Tile& tile, float cell_width, float cell_height, std::uint64_t stage, float amplitude = 1);

    /// Returns whether the cells are large enough to be sampled: those of two texels fade out.
    bool is_visible() const { return amplitude_ > 0; }
    /// Adds the noise at the centres of the texels of a row, at height y [m]. Cost: 2 ns per texel.
    void add_row(float y, std::span<float> out) const;

  private:
    Lattice lattice_;
    float texel_;  // [cells] width
    std::uint64_t key_;
    float amplitude_;
};

/// A sum of noises, each with half the cells and `gain` times the amplitude of the one before; mostly in
/// [-1, 1].
class Fractal {
  public:
    Fractal(const Tile& tile, float cell_width, float cell_height, int octaves, std::uint64_t stage,
            float gain = 0.5f);

    /// Sets the values at the centres of the texels of a row, at height y [m].
    void fill_row(float y, std::span<float> out) const;

  private:
    std::vector<Noise> octaves_;
};

/// The cell that contains a place.
struct Cell {
    float border;            ///< [m] distance from the border, rounded in the corners
    std::uint32_t id, next;  ///< random bits of the cell, and of the one beyond the closest border
    Place offset;            ///< [m] from the centre of the cell
};

/// Returns a number in [0, 1) from the bits of a cell; each `stage` in [0, 4) is another one.
inline float chance(std::uint32_t id, unsigned stage) {
    return static_cast<float>(static_cast<std::uint8_t>(id >> (8 * stage))) * (1.0f / 256);
}

/// Periodic cells around one centre in each cell of a lattice. Source: [Worley1996].
class Cells {
  public:
    /// `jitter` in [0, 1] moves the centres; `shift` moves every other row by up to half a cell, as in a
    /// wall; `rounding` [m] rounds the corners of the borders. `stagger` in [0, 1] moves each column along
    /// v, adjacent ones by half a cell and all of them evenly, so that cells do not end at common heights.
    Cells(const Tile& tile, float cell_width, float cell_height, float jitter, float rounding,
          std::uint64_t stage, float shift = 0, float stagger = 0);

    /// Returns the cell at a place. Cost: 50 ns.
    Cell operator()(Place p) const;

    /// Calls visit(offset [m] from the centre, id) for the centres in the 3 x 3 or, with reach 2, 5 x 5 cells
    /// around a place.
    template <class Visit>
    void visit(Place p, int reach, const Visit& visit) const {
        const Place c = lattice_.in_cells(p);
        const int i = round_down(c.x), j = round_down(c.y);
        const Place size = lattice_.cell();
        const Place inner{c.x - static_cast<float>(i), c.y - static_cast<float>(j)};
        const int i0 = lattice_.column(i), j0 = lattice_.row(j);
        for (int dj = -reach; dj <= reach; ++dj) {
            for (int di = -reach; di <= reach; ++di) {
                const Center& center = at(i0 + di, j0 + dj);
                const Place d{inner.x - center.place.x - static_cast<float>(di),
                              inner.y - center.place.y - static_cast<float>(dj)};
                visit(Place{d.x * size.x, d.y * size.y}, center.id);
            }
        }
    }

    Place cell_size() const { return lattice_.cell(); }

  private:
    static constexpr int kMargin = 4;  // so that neighbours need no modulo
    struct Center {
        Place place;  // [cells] within its cell
        std::uint32_t id;
    };
    /// The border with a neighbour: at `distance` from the centre in the direction of `normal`, in metres,
    /// for offsets from the centre in cells.
    struct Border {
        Place normal;
        float distance;
        std::uint32_t id;
    };

    void add_borders(int i, int j);
    std::span<const Border> borders(int i, int j) const {
        const auto at =
            static_cast<std::size_t>(lattice_.row(j)) * static_cast<std::size_t>(lattice_.columns()) +
            static_cast<std::size_t>(lattice_.column(i));
        return std::span(borders_).subspan(first_border_[at], first_border_[at + 1] - first_border_[at]);
    }

    const Center& at(int i, int j) const {
        return centers_[static_cast<std::size_t>(j + kMargin) * stride_ +
                        static_cast<std::size_t>(i + kMargin)];
    }

    Lattice lattice_;
    float rounding_;
    std::size_t stride_;
    std::vector<Center> centers_;
    std::vector<Border> borders_;            // of all cells, row by row
    std::vector<std::size_t> first_border_;  // of each cell
};

}  // namespace coppice::texture_internal
