#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/texture/lattice_internal.h"

namespace coppice {
namespace {

using namespace texture_internal;

constexpr Tile kTile{0.7f, 0.4f, 0.7f / 512, 0.4f / 512, 3};

Place place(int k) {
    const CounterRandom random(1, 2);
    return {0.7f * static_cast<float>(random.uniform(static_cast<std::uint64_t>(2 * k))),
            0.4f * static_cast<float>(random.uniform(static_cast<std::uint64_t>(2 * k + 1)))};
}

TEST(Lattice, AWholeNumberOfCellsFitsTheTile) {
    const Lattice lattice(kTile, 0.13f, 0.3f, 1);
    EXPECT_EQ(lattice.columns(), 5);  // 0.7 / 0.13 = 5.4
    EXPECT_EQ(lattice.rows(), 1);     // 0.4 / 0.3 = 1.3
    EXPECT_FLOAT_EQ(lattice.cell().x, 0.14f);
    EXPECT_EQ(lattice.column(-1), 4);
    EXPECT_EQ(lattice.column(12), 2);
}

std::vector<float> row(const Fractal& noise, float y) {
    std::vector<float> out(512);
    noise.fill_row(y, out);
    return out;
}

TEST(Lattice, NoisesRepeatWithTheTile) {
    const Fractal noise(kTile, 0.09f, 0.05f, 4, 1);
    for (const float y : {0.0f, 0.1234f, 0.3999f}) {
        const std::vector<float> a = row(noise, y), b = row(noise, y + 0.4f);
        double inside = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_NEAR(a[i], b[i], 1e-4f);  // y has 64 cells, in float: 4e-6 cells
            if (i > 0) inside = std::max(inside, double{std::abs(a[i] - a[i - 1])});
        }
        EXPECT_LE(std::abs(a.front() - a.back()), 1.5 * inside);
    }
}

TEST(Lattice, NoisesAreContinuous) {
    // A cell has 37 texels; the slope of a noise is at most about 4 per cell.
    const Fractal noise(kTile, 0.05f, 0.05f, 1, 1);
    for (int j = 0; j + 1 < 512; ++j) {
        const float y = 0.4f / 512 * (static_cast<float>(j) + 0.5f);
        const std::vector<float> a = row(noise, y), above = row(noise, y + 0.4f / 512);
        for (std::size_t i = 0; i + 1 < a.size(); ++i) {
            ASSERT_LT(std::abs(a[i + 1] - a[i]), 0.15f);
            ASSERT_LT(std::abs(above[i] - a[i]), 0.15f);
        }
    }
}

TEST(Lattice, NoisesHaveZeroMeanAndUnitRange) {
    const Fractal noise(kTile, 0.01f, 0.01f, 1, 1);
    double sum = 0, squares = 0, count = 0;
    for (int j = 0; j < 512; ++j) {
        for (const float n : row(noise, 0.4f / 512 * (static_cast<float>(j) + 0.5f))) {
            EXPECT_LT(std::abs(n), 1.7);
            sum += n;
            squares += double{n} * n;
            ++count;
        }
    }
    // The deviation is about 0.4: its standard error of the mean over 2800 independent cells is 0.008.
    EXPECT_NEAR(sum / count, 0, 0.03);
    EXPECT_NEAR(std::sqrt(squares / count), 0.4, 0.1);
}

TEST(Lattice, NoisesBelowTwoTexelsFadeOut) {
    EXPECT_FALSE(Noise(kTile, 0.0014f, 0.01f, 1).is_visible());  // one texel wide
    EXPECT_TRUE(Noise(kTile, 0.01f, 0.01f, 1).is_visible());
}

TEST(Lattice, CellsRepeatWithTheTile) {
    const Cells shifted(kTile, 0.05f, 0.1f, 1, 0.002f, 1, 1),
        staggered(kTile, 0.05f, 0.1f, 1, 0.002f, 1, 1, 1);
    for (int k = 0; k < 1000; ++k) {
        const Cells& cells = k % 2 == 0 ? shifted : staggered;
        const Place p = place(k);
        const Cell a = cells(p), b = cells(p + Place{0.7f, -0.4f});
        if (a.border < 1e-4f) continue;  // another cell by rounding
        EXPECT_EQ(a.id, b.id);
        EXPECT_NEAR(a.border, b.border, 1e-5f);
        EXPECT_NEAR(a.offset.x, b.offset.x, 1e-5f);
    }
}

TEST(Lattice, BorderIsTheDistanceToTheNextCell) {
    const Cells plain(kTile, 0.05f, 0.1f, 0.8f, 1e-6f, 1),
        staggered(kTile, 0.05f, 0.1f, 0.9f, 1e-6f, 1, 0, 1);
    int borders = 0;
    for (int k = 0; k < 600; ++k) {
        const Cells& cells = k % 2 == 0 ? plain : staggered;
        const Place p = place(k);
        const Cell cell = cells(p);
        ASSERT_GE(cell.border, 0);
        // Within the distance, all cells are the same; a bit farther, at least one is another cell.
        bool other = false;
        for (int d = 0; d < 64; ++d) {
            const float angle = static_cast<float>(d) * 0.0981748f;
            const Place to{std::cos(angle), std::sin(angle)};
            EXPECT_EQ(cells(p + 0.98f * cell.border * to).id, cell.id);
            other = other || cells(p + (1.03f * cell.border + 1e-5f) * to).id != cell.id;
        }
        EXPECT_TRUE(other);
        ++borders;
    }
    EXPECT_EQ(borders, 600);
}

}  // namespace
}  // namespace coppice
