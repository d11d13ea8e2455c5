#include "coppice/texture/bark.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <string>

#include "coppice/base/error.h"
#include "coppice/texture/bark_internal.h"
#include "described_options.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

constexpr int kWidth = 150, kHeight = 117;  // no powers of two, and not square

BarkOptions small(const BarkSpecies& species, int seed = 0) {
    BarkOptions o = species.options;
    o.width = kWidth;
    o.height = kHeight;
    o.seed = seed;
    return o;
}

constexpr int kChannels = 9;

/// All maps as numbers, kChannels of them per texel.
struct Values {
    int width, height;
    std::vector<float> values;

    explicit Values(const BarkMaps& m) : width(m.width), height(m.height) {
        for (std::size_t i = 0; i < m.size(); ++i) {
            values.push_back(static_cast<float>(m.heights[i]) / 256);
            for (const auto& map : {m.color[i], m.normal[i]})
                for (const std::uint8_t channel : map) values.push_back(channel);
            values.push_back(m.roughness[i]);
            values.push_back(m.occlusion[i]);
        }
    }
    float at(int x, int y, int channel) const {
        return values[static_cast<std::size_t>((y * width + x) * kChannels + channel)];
    }
};

/// Returns the mean difference of two columns or two rows.
double step_across(const Values& v, int channel, bool columns, int a, int b) {
    const int length = columns ? v.height : v.width;
    double sum = 0;
    for (int k = 0; k < length; ++k)
        sum += columns ? std::abs(v.at(a, k, channel) - v.at(b, k, channel))
                       : std::abs(v.at(k, a, channel) - v.at(k, b, channel));
    return sum / length;
}

TEST(Bark, DescribesEveryOption) {
    test::expect_described<BarkOptions>(8);
}  // bytes of padding before `color`

/// Returns the maximum step between adjacent columns or rows inside the tile.
double max_step_inside(const Values& v, int channel, bool columns) {
    double most = 0.2;  // of 255: rounding
    for (int at = 0; at + 1 < (columns ? v.width : v.height); ++at)
        most = std::max(most, step_across(v, channel, columns, at, at + 1));
    return most;
}

// The step across the edge is one of more than 100 alike. The means are of 117 or 150 texels that are not
// independent, so that a few of the 918 steps exceed all others of their map, by up to a fifth.
constexpr double kLike = 1.35;

TEST(Bark, TilesHaveNoSeam) {
    for (const BarkSpecies& species : bark_species()) {
        for (const int seed : {0, 1, 77}) {
            SCOPED_TRACE(std::string(species.name) + " " + std::to_string(seed));
            const Values v(make_bark(small(species, seed)));
            for (int channel = 0; channel < kChannels; ++channel) {
                for (const bool columns : {false, true}) {
                    const int last = (columns ? v.width : v.height) - 1;
                    EXPECT_LE(step_across(v, channel, columns, last, 0),
                              kLike * max_step_inside(v, channel, columns))
                        << "channel " << channel << (columns ? " columns" : " rows");
                }
            }
        }
    }
}

TEST(Bark, ATileThatIsCutHasASeam) {  // so that the test above can fail
    for (const char* const name : {"oak", "pine", "plane", "beech", "birch", "palm"}) {
        BarkOptions o = *find_bark(name);
        o.width = o.height = 400;
        const Values v(make_bark(o));
        EXPECT_GT(step_across(v, 2, true, 250, 0), kLike * max_step_inside(v, 2, true)) << name;
    }
}

TEST(Bark, TheNumberOfThreadsChangesNoBit) {
    for (const BarkSpecies& species : bark_species()) {
        SCOPED_TRACE(species.name);
        const BarkOptions o = small(species, 5);
        const BarkMaps one = make_bark(o, {.threads = 1});
        for (const unsigned threads : {2u, 7u}) {
            const BarkMaps many = make_bark(o, {.threads = threads});
            EXPECT_EQ(one.color, many.color);
            EXPECT_EQ(one.normal, many.normal);
            EXPECT_EQ(one.roughness, many.roughness);
            EXPECT_EQ(one.occlusion, many.occlusion);
            EXPECT_EQ(one.heights, many.heights);
        }
    }
}

TEST(Bark, SeedsDiffer) {
    for (const BarkSpecies& species : bark_species())
        EXPECT_NE(make_bark(small(species, 1)).heights, make_bark(small(species, 2)).heights) << species.name;
}

TEST(Bark, NormalsAreThoseOfTheHeights) {
    for (const BarkSpecies& species : bark_species()) {
        SCOPED_TRACE(species.name);
        const BarkMaps m = make_bark(small(species));
        const auto height = [&](int x, int y) {
            const int i = (x + m.width) % m.width, j = (y + m.height) % m.height;
            return m.low + (m.high - m.low) *
                               static_cast<float>(m.heights[static_cast<std::size_t>(j * m.width + i)]) /
                               65535;
        };
        const float dx = 2 * m.tile_width / kWidth, dy = 2 * m.tile_height / kHeight;
        for (int y = 0; y < kHeight; y += 5) {
            for (int x = 0; x < kWidth; x += 3) {
                // v runs up, against the rows.
                const float u = (height(x - 1, y) - height(x + 1, y)) / dx;
                const float v = (height(x, y + 1) - height(x, y - 1)) / dy;
                const float scale = 127.5f / std::sqrt(u * u + v * v + 1);
                const BarkMaps::Texel n = m.normal[static_cast<std::size_t>(y * kWidth + x)];
                // One for the rounding of the normals, one for that of heights to 1/65535.
                EXPECT_NEAR(n[0], 127.5f + u * scale, 2);
                EXPECT_NEAR(n[1], 127.5f + v * scale, 2);
                EXPECT_NEAR(n[2], 127.5f + scale, 2);
            }
        }
    }
}

TEST(Bark, AFlatTileIsOpenAndItsNormalsPointOutwards) {
    BarkOptions o;
    o.width = o.height = 40;
    o.depth = 0;
    o.detail = 0;
    const BarkMaps m = make_bark(o);
    EXPECT_EQ(m.low, m.high);
    for (std::size_t i = 0; i < m.size(); ++i) {
        EXPECT_EQ(m.occlusion[i], 255);
        EXPECT_EQ(m.normal[i], (BarkMaps::Texel{128, 128, 255}));
        EXPECT_EQ(m.packed()[i], (BarkMaps::Texel{255, m.roughness[i], 0}));
    }
}

/// Returns the standard deviation of the brightness in waves of a third of the tile to the whole tile, in
/// percent of its mean.
double long_wave_contrast(const BarkMaps& m) {
    constexpr int kBlocks = 40;  // along each side
    std::vector<std::complex<double>> light(kBlocks * kBlocks);
    for (int y = 0; y < m.height; ++y) {
        for (int x = 0; x < m.width; ++x) {
            const int block = y * kBlocks / m.height * kBlocks + x * kBlocks / m.width;
            light[static_cast<std::size_t>(block)] += m.color[static_cast<std::size_t>(y * m.width + x)][1];
        }
    }
    const auto wave = [&](int across, int along) {
        std::complex<double> sum = 0;
        for (int i = 0; i < kBlocks * kBlocks; ++i) {
            const double phase = across * (i % kBlocks) + along * (i / kBlocks);
            sum +=
                light[static_cast<std::size_t>(i)] * std::polar(1.0, 2 * std::numbers::pi * phase / kBlocks);
        }
        return std::norm(sum);
    };
    double squares = 0;
    for (int along = -3; along <= 3; ++along)
        for (int across = -3; across <= 3; ++across) squares += wave(across, along);
    return 100 * std::sqrt(squares / wave(0, 0) - 1);
}

TEST(Bark, LargeAreasOfATileAreEquallyBright) {
    // Only the density of furrows and dark marks varies over such distances. Without even_colors, the
    // contrast of most species is 3 to 9 percent.
    constexpr double kLimit = 2.5, kWithFurrows = 8;
    const std::set<std::string_view> furrows{"oak", "willow", "poplar", "pine", "larch", "birch"};
    for (const BarkSpecies& species : bark_species()) {
        for (const int seed : {0, 1, 2}) {
            BarkOptions o = species.options;
            o.width = o.height = 200;
            o.seed = seed;
            EXPECT_LT(long_wave_contrast(make_bark(o)),
                      furrows.contains(species.name) ? kWithFurrows : kLimit)
                << species.name << " " << seed;
        }
    }
}

TEST(Bark, EvenColorsKeepsDetailsAndFurrows) {
    BarkMaps m;
    m.width = 120;
    m.height = 80;
    for (int i = 0; i < m.width * m.height; ++i) {
        const int x = i % m.width, y = i / m.width;
        const double slow = 1 + 0.2 * std::cos(2 * std::numbers::pi * (x / 120.0 + 2 * y / 80.0));
        // Furrows are wider on the left.
        const bool furrow = x % 10 < (x < 60 ? 4 : 2);
        const auto light = static_cast<std::uint8_t>(furrow ? 20 : slow * (y % 2 == 0 ? 100 : 120));
        m.color.push_back({light, light, light});
    }
    texture_internal::even_colors(m, {});
    for (int i = 0; i < m.width * m.height; ++i) {
        const int x = i % m.width, y = i / m.width, light = m.color[static_cast<std::size_t>(i)][0];
        if (x % 10 < (x < 60 ? 4 : 2)) {
            EXPECT_NEAR(light, 20, 6);
        } else {
            EXPECT_NEAR(light, y % 2 == 0 ? 100 : 120, 4) << x << " " << y;
        }
    }
}

TEST(Bark, FurrowsAreDarkerAndMoreOccludedThanRidges) {
    for (const char* const name : {"oak", "pine"}) {
        SCOPED_TRACE(name);
        BarkOptions o = *find_bark(name);
        o.width = o.height = 256;
        const BarkMaps m = make_bark(o);
        std::array<double, 2> light{}, open{}, count{};
        for (std::size_t i = 0; i < m.size(); ++i) {
            if (m.heights[i] > 20000 && m.heights[i] < 40000) continue;
            const std::size_t top = m.heights[i] >= 40000 ? 1 : 0;
            light[top] += m.color[i][1];
            open[top] += m.occlusion[i];
            ++count[top];
        }
        ASSERT_GT(count[0], 500);
        ASSERT_GT(count[1], 500);
        EXPECT_LT(light[0] / count[0], 0.8 * light[1] / count[1]);
        EXPECT_LT(open[0] / count[0], 0.85 * open[1] / count[1]);
    }
}

TEST(Bark, SmallTilesShowTheMeanOfLargeOnes) {
    // Each texel of the small tile is compared with the mean of 16 of the large one: without antialiasing,
    // the details would differ by their full contrast.
    constexpr int kFactor = 4;
    for (const BarkSpecies& species : bark_species()) {
        SCOPED_TRACE(species.name);
        BarkOptions o = species.options;
        o.width = 256;
        o.height = static_cast<int>(std::lround(256 * o.tile_height / o.tile_width));
        const BarkMaps coarse = make_bark(o);
        o.width *= kFactor;
        o.height *= kFactor;
        const BarkMaps fine = make_bark(o);
        double difference = 0;
        for (int y = 0; y < coarse.height; ++y) {
            for (int x = 0; x < coarse.width; ++x) {
                double mean = 0;
                for (int k = 0; k < kFactor * kFactor; ++k) {
                    const int row = y * kFactor + k / kFactor, column = x * kFactor + k % kFactor;
                    mean += fine.color[static_cast<std::size_t>(row * fine.width + column)][1];
                }
                mean /= kFactor * kFactor;
                difference +=
                    std::abs(mean - coarse.color[static_cast<std::size_t>(y * coarse.width + x)][1]);
            }
        }
        difference /= static_cast<double>(coarse.size());
        // Of 255; the lenticels of birch are thinner than the texels, and have the maximum contrast.
        EXPECT_LT(difference, species.name == "birch" ? 16 : 8);
    }
}

TEST(Bark, ThinStemsHaveFlatterBark) {
    for (const char* const name : {"oak", "pine", "spruce", "cedar", "palm"}) {
        SCOPED_TRACE(name);
        BarkOptions o = *find_bark(name);
        o.width = o.height = 200;
        const BarkMaps old = make_bark(o);
        o.diameter = o.mature_diameter / 8;
        const BarkMaps young = make_bark(o);
        // The age is 1 - ln 8 / ln 12 = 0.16 in place of 1.
        EXPECT_LT(young.high - young.low, 0.45f * (old.high - old.low));
    }
}

TEST(Bark, RoughnessHasTheGivenMean) {
    for (const BarkSpecies& species : bark_species()) {
        const BarkMaps m = make_bark(small(species));
        const double mean = std::accumulate(m.roughness.begin(), m.roughness.end(), 0.0) / 255 /
                            static_cast<double>(m.roughness.size());
        EXPECT_NEAR(mean, species.options.roughness, 0.06) << species.name;
    }
}

TEST(Bark, SpeciesAndKindsAreFoundByName) {
    std::set<std::string_view> names;
    std::set<BarkKind> kinds;
    for (const BarkSpecies& species : bark_species()) {
        EXPECT_TRUE(names.insert(species.name).second) << species.name;
        kinds.insert(species.options.kind);
        EXPECT_EQ(find_bark(species.name)->spacing, species.options.spacing);
    }
    EXPECT_EQ(kinds.size(), EnumNames<BarkKind>::names.size());
    EXPECT_EQ(find_bark("plated")->spacing, find_bark("pine")->spacing);
    EXPECT_FALSE(find_bark("granite"));
}

TEST(Bark, RejectsInvalidOptions) {
    const auto error = [](auto change) {
        BarkOptions o;
        o.width = o.height = 16;
        change(o);
        return error_of([&] { make_bark(o); });
    };
    EXPECT_EQ(error([](BarkOptions& o) { o.width = 0; }), "bark: width must be between 1 and 4096, but is 0");
    EXPECT_EQ(error([](BarkOptions& o) { o.height = 4097; }),
              "bark: height must be between 1 and 4096, but is 4097");
    EXPECT_EQ(error([](BarkOptions& o) { o.tile_width = 0; }),
              "bark: tile_width must be between 0.001 and 10, but is 0");
    EXPECT_NE(error([](BarkOptions& o) { o.depth = std::numeric_limits<float>::quiet_NaN(); }), "no error");
    EXPECT_EQ(error([](BarkOptions& o) {
                  o.color = Vec3d{0, 2, 0};
              }),
              "bark: color must have three values from 0 to 1, but has 2");
    EXPECT_EQ(
        error([](BarkOptions& o) { o.spacing = 0.0002f; }),
        "bark: a tile with tile_width 0.5 m has more than 1000 cells of the pattern, which have 0.0002 m; "
        "increase spacing or stretch, or reduce tile_width");
}

TEST(Bark, AcceptsExtremeSizes) {
    for (const BarkSpecies& species : bark_species()) {
        SCOPED_TRACE(species.name);
        BarkOptions o = species.options;
        o.width = 1;
        o.height = 1;
        EXPECT_EQ(make_bark(o).size(), 1u);
        o.width = 300;
        o.height = 3;
        o.spacing = 1;
        o.stretch = 100;
        o.depth = 0.2f;
        o.irregularity = o.detail = 3;
        o.patches = 1;
        EXPECT_EQ(make_bark(o).size(), 900u);
    }
}

TEST(Bark, CanBeCancelled) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(make_bark({}, {.stop = stop.get_token()}), Cancelled);
}

}  // namespace
}  // namespace coppice
