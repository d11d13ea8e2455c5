#include "coppice/field/convolution_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "errors.h"
#include "field/support.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr Kernel kKernels[] = {Kernel::quartic, Kernel::cauchy, Kernel::scalis, Kernel::balls};
constexpr int kBlends[] = {1, 2, 4, 8};
/// Every kernel with one blend, and one kernel with all.
constexpr std::pair<Kernel, int> kFields[] = {
    {Kernel::quartic, 1}, {Kernel::quartic, 2}, {Kernel::quartic, 4}, {Kernel::quartic, 8},
    {Kernel::cauchy, 4},  {Kernel::scalis, 4},  {Kernel::balls, 1},   {Kernel::balls, 4}};

FieldOptions with_kernel(Kernel kernel, int blend = 4) { return {.kernel = kernel, .blend = blend}; }

FieldSample at(const ConvolutionField& field, Vec3 p) {
    FieldSample sample[1];
    field.sample_everywhere(std::span(&p, 1), sample);
    return sample[0];
}

/// Evaluates all segments in double precision, from the same constants; determines axes by walking up from
/// every segment.
kernel::Sample<double> in_double(const Skeleton& skeleton, const ConvolutionField& field, int blend,
                                 Vec3d p) {
    std::map<std::uint32_t, kernel::Sample<double>> axes;
    for (const NodeId n : nodes(skeleton)) {
        NodeId top = n;
        while (!skeleton.is_root(top) && skeleton.leader(skeleton.parent(top)) == top)
            top = skeleton.parent(top);
        const auto& s = field.segments()[n.index()];
        const kernel::SegmentConstants<double> wide{s.ax,    s.ay,     s.az,   s.ux,     s.uy,
                                                    s.uz,    s.begin,  s.end,  s.length, s.radius,
                                                    s.slope, s.weight, s.balls};
        const auto f = sample_segment(field.kernel(), wide, {p.x, p.y, p.z});
        kernel::Sample<double>& sum = axes[blend == 1 ? 0 : top.index()];
        sum = {sum.value + f.value, sum.gx + f.gx, sum.gy + f.gy, sum.gz + f.gz};
    }
    if (axes.size() == 1) return axes.begin()->second;
    double total = 0;
    for (const auto& [top, f] : axes) total += std::pow(f.value, blend);
    const double value = std::pow(total, 1.0 / blend);
    kernel::Sample<double> all{value, 0, 0, 0};
    for (const auto& [top, f] : axes) {
        const double share = value > 0 ? std::pow(f.value / value, blend - 1) : 0;
        all = {value, all.gx + share * f.gx, all.gy + share * f.gy, all.gz + share * f.gz};
    }
    return all;
}

/// Returns the distance from `start` along the unit vector u at which the value falls below the iso value.
float reach(const ConvolutionField& field, Vec3 start, Vec3 u, float unit) {
    float low = 0;
    while (at(field, start + (low + 0.01f * unit) * u).value >= 1) low += 0.01f * unit;
    float high = low + 0.01f * unit;
    for (int i = 0; i < 12; ++i) {
        const float middle = 0.5f * (low + high);
        (at(field, start + middle * u).value >= 1 ? low : high) = middle;
    }
    return low;
}

/// Points 0.3 to 1.7 radii from the lines of a skeleton.
std::vector<Vec3> points_near(const Skeleton& s, std::size_t count, std::uint64_t stage) {
    const CounterRandom random(7, stage);
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; points.size() < count; ++i) {
        const NodeId n(static_cast<std::uint32_t>(random.bits(6 * i) % s.size()));
        if (s.is_root(n)) continue;
        const Segment g = s.segment(n);
        const auto draw = [&](std::uint64_t j) {
            return static_cast<float>(random.uniform(6 * i + j, -1, 1));
        };
        const float t = 0.5f + 0.5f * draw(1);
        const Vec3 away = normalized(Vec3{draw(2), draw(3), draw(4)});
        points.push_back(lerp(g.a, g.b, t) +
                         (1 + 0.7f * draw(5)) * std::lerp(g.radius_a, g.radius_b, t) * away);
    }
    return points;
}

TEST(ConvolutionField, VectorizedFloatsMatchDoubles) {
    for (const std::string name : {"random_large", "random_hard_1", "whorl_8", "short_segments_010"}) {
        const Skeleton s = zoo_skeleton(name);
        for (const auto& [k, blend] : kFields) {
            SCOPED_TRACE(name + ", " + std::string(name_of(k)) + ", " + std::to_string(blend));
            const ConvolutionField field(s, with_kernel(k, blend));
            const auto points = points_near(s, 500, 1);
            std::vector<FieldSample> samples(points.size());
            field.sample_everywhere(points, samples);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const auto f = in_double(s, field, blend, Vec3d(points[i]));
                const Vec3d g{f.gx, f.gy, f.gz};
                EXPECT_NEAR(samples[i].value, f.value, 4e-5 * (1 + f.value));
                if (f.value < 1e-4 && blend > 1) continue;  // the norm omits the smallest values
                EXPECT_LT(distance(Vec3d(samples[i].gradient), g), 2e-4 * (1 / 0.05 + length(g)));
            }
        }
    }
}

TEST(ConvolutionField, GradientMatchesFiniteDifferencesOnATree) {
    const Skeleton s = zoo_skeleton("random_1");
    for (const auto& [k, blend] : kFields) {
        const ConvolutionField field(s, with_kernel(k, blend));
        for (const Vec3 p : points_near(s, 100, 2)) {
            // The quartic field has only continuous first derivatives: use differences over a small step.
            const auto f = [&, n = blend](Vec3d q) { return in_double(s, field, n, q); };
            EXPECT_LT(test::gradient_error(f, Vec3d(p), 1e-7), 2e-3);
        }
    }
}

TEST(ConvolutionField, SamplesAreBitIdenticalInAnyBatch) {
    const Skeleton s = zoo_skeleton("random_1");
    const auto points = points_near(s, 61, 3);
    for (const auto& [k, blend] : kFields) {
        const ConvolutionField field(s, with_kernel(k, blend));
        std::vector<FieldSample> whole(points.size()), part(points.size());
        field.sample_everywhere(points, whole);
        for (std::size_t first = 0; first < 20; ++first) {
            for (std::size_t count = 1; count <= 40; ++count) {
                field.sample_everywhere(std::span(points).subspan(first, count),
                                        std::span(part).first(count));
                ASSERT_EQ(std::memcmp(part.data(), whole.data() + first, count * sizeof(FieldSample)), 0);
            }
        }
        field.sample_everywhere({}, {});
    }
}

TEST(ConvolutionField, ListsMatchAllSegmentsWithoutPassingBranches) {
    for (const std::string name :
         {"straight_chain", "fork_60", "whorl_8", "short_segments_045", "thin_lateral_90", "soma"}) {
        const Skeleton s = zoo_skeleton(name);
        for (const Kernel k : {Kernel::quartic, Kernel::scalis}) {
            SCOPED_TRACE(name + ", " + std::string(name_of(k)));
            ConvolutionField field(s, with_kernel(k));
            for (const NodeId n : nodes(s)) {
                if (s.is_root(n)) continue;
                const Segment g = s.segment(n);
                const FieldRegion region[] = {
                    {capsule_box(g.a, g.b, 1.5f * std::max(g.radius_a, g.radius_b)), n}};
                field.set_regions(region);
                for (const Vec3 p : points_near(s, 200, 4)) {
                    if (!region[0].box.overlaps(capsule_box(p, p, 0))) continue;
                    FieldSample sample[1];
                    field.sample(0, std::span(&p, 1), sample);
                    EXPECT_NEAR(sample[0].value, at(field, p).value, 1e-6f * (1 + sample[0].value));
                }
            }
        }
    }
}

TEST(ConvolutionField, ASingleNodeIsABall) {
    for (const Kernel k : kKernels) {
        for (const float radius : {1e-4f, 1.0f, 300.0f}) {
            const Skeleton s({NodeId{}}, {{1, 2, 3}}, {radius});
            const ConvolutionField field(s, with_kernel(k));
            for (const Vec3 u : {Vec3{1, 0, 0}, {0, 0.6f, 0.8f}, {0, 0, 1}, {0, 0, -1}}) {
                if (radius < 1e-3f) continue;
                EXPECT_NEAR(reach(field, {1, 2, 3}, u, radius), radius, 1e-3f * radius);
            }
            EXPECT_GT(at(field, {1, 2, 3}).value, 1.5f);
        }
    }
}

TEST(ConvolutionField, ContainsEveryNodeOfTheZoo) {
    for (const auto& [name, s] : skeleton_zoo()) {
        for (const Kernel k : kKernels) {
            const ConvolutionField field(s, with_kernel(k));
            std::vector<FieldSample> samples(s.size());
            field.sample_everywhere(s.positions(), samples);
            for (const NodeId n : nodes(s)) {
                EXPECT_GT(samples[n.index()].value, 1.2f)
                    << name << ", " << name_of(k) << ", node " << n.index();
                EXPECT_TRUE(is_finite(samples[n.index()].gradient)) << name << ", node " << n.index();
            }
        }
    }
}

TEST(ConvolutionField, ValuesAreNeverNegative) {
    const Skeleton s = zoo_skeleton("random_large_hard");
    const CounterRandom random(7, 5);
    const Box3 box = s.bounds();
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const auto draw = [&](std::uint64_t j) {
            return static_cast<float>(random.uniform(3 * i + j, -1, 1));
        };
        points.push_back(box.center() + box.diagonal() * Vec3{draw(0), draw(1), draw(2)});
    }
    points.push_back({1e8f, -1e8f, 1e8f});
    std::vector<FieldSample> samples(points.size());
    for (const Kernel k : kKernels) {
        ConvolutionField(s, with_kernel(k)).sample_everywhere(points, samples);
        for (const FieldSample& f : samples) {
            EXPECT_GE(f.value, 0);
            EXPECT_TRUE(std::isfinite(f.value) && is_finite(f.gradient));
        }
    }
}

TEST(ConvolutionField, TheSurfaceEndsOneRadiusBeyondTips) {
    for (const Kernel k : kKernels) {
        for (const float tip_radius : {1.0f, 0.8f, 0.5f}) {  // slopes 0, -0.02, -0.05
            const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {1, tip_radius});
            const ConvolutionField field(s, with_kernel(k));
            const float r = reach(field, {0, 0, 10}, {0, 0, 1}, tip_radius) / tip_radius;
            EXPECT_GT(r, 0.95f) << name_of(k) << ' ' << tip_radius;
            EXPECT_LT(r, 1.05f) << name_of(k) << ' ' << tip_radius;
        }
    }
}

TEST(ConvolutionField, RadiusScaleWidensBranchesButPreservesTips) {
    for (const Kernel k : {Kernel::quartic, Kernel::scalis}) {
        for (const float scale : {0.9f, 1.013f, 1.25f}) {
            const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {1, 0.8f});
            FieldOptions options = with_kernel(k);
            options.radius_scale = scale;
            const ConvolutionField field(s, options);
            EXPECT_NEAR(reach(field, {0, 0, 5}, {1, 0, 0}, 1), 0.9f * scale, 0.012f)
                << name_of(k) << ' ' << scale;
            EXPECT_NEAR(reach(field, {0, 0, 10}, {0, 0, 1}, 0.8f), 0.8f, 0.05f) << name_of(k) << ' ' << scale;
        }
    }
}

TEST(ConvolutionField, RootsHaveTheirRadiusAtACutBase) {
    const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {1, 0.9f});
    for (const auto& [kernel, tolerance] :
         {std::pair{Kernel::quartic, 0.01f}, {Kernel::cauchy, 0.03f}, {Kernel::scalis, 0.01f}}) {
        const ConvolutionField field(s, with_kernel(kernel));
        EXPECT_NEAR(reach(field, {0, 0, 0}, {1, 0, 0}, 1), 1, tolerance) << name_of(kernel);
        EXPECT_NEAR(reach(field, {0, 0, 5}, {1, 0, 0}, 1), 0.95f, 0.012f) << name_of(kernel);
    }
}

TEST(ConvolutionField, RadiusIsAccurateAlongALongSegment) {
    const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {3000, 4000, 0}}, {1, 1});
    const ConvolutionField field(s, {});
    const Vec3 middle{2100, 2800, 0};
    EXPECT_NEAR(reach(field, middle, {0, 0, 1}, 1), 1, 1e-3f);
    EXPECT_NEAR(reach(field, middle, {0.8f, -0.6f, 0}, 1), 1, 1e-3f);
}

TEST(ConvolutionField, AnAxisFollowsTheLeader) {
    // 0 - 1 - 2 - 3 is the trunk; 4 and 5 are laterals at 1, and 6 continues 4.
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(1), NodeId(4)},
                     {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}, {0, 0, 6}, {2, 0, 2}, {-2, 0, 2}, {4, 0, 2}},
                     {1, 1, 1, 1, 0.3f, 0.4f, 0.3f});
    ConvolutionField field(s, {});
    EXPECT_EQ(std::vector(field.axes().begin(), field.axes().end()),
              (std::vector<std::uint32_t>{0, 0, 0, 0, 4, 5, 4}));
    const FieldRegion regions[] = {{s.bounds(), NodeId(1)}};
    field.set_regions(regions);
    const auto list = field.candidates(0);
    EXPECT_EQ(std::vector(list.begin(), list.end()), (std::vector<std::uint32_t>{1, 2, 3, 4, 6, 5}));
}

TEST(ConvolutionField, SingleAxisIsThePlainSumForAnyBlend) {
    const Skeleton s = zoo_skeleton("straight_chain");
    const auto points = points_near(s, 200, 6);
    for (const Kernel k : kKernels) {
        std::vector<FieldSample> plain(points.size()), blended(points.size());
        ConvolutionField(s, with_kernel(k, 1)).sample_everywhere(points, plain);
        ConvolutionField(s, with_kernel(k, 8)).sample_everywhere(points, blended);
        EXPECT_EQ(std::memcmp(plain.data(), blended.data(), plain.size() * sizeof(FieldSample)), 0);
    }
    // The same, except for rounding, if another axis is in the list, but out of reach.
    std::vector<NodeId> parent(s.parents().begin(), s.parents().end());
    std::vector<Vec3> position(s.positions().begin(), s.positions().end());
    std::vector<float> radius(s.radii().begin(), s.radii().end());
    parent.insert(parent.end(), {NodeId{}, NodeId(s.size())});
    position.insert(position.end(), {Vec3{1000, 0, 0}, {1000, 0, 5}});
    radius.insert(radius.end(), {1, 1});
    const Skeleton two(parent, position, radius);
    const ConvolutionField alone(s, {});
    for (const int blend : kBlends) {
        const ConvolutionField with_neighbour(two, {.blend = blend});
        for (const Vec3 p : points) {
            const FieldSample a = at(alone, p), b = at(with_neighbour, p);
            EXPECT_NEAR(a.value, b.value, 4e-5f * (1 + a.value)) << blend;
            EXPECT_LT(distance(a.gradient, b.gradient), 1e-4f * (1 / 0.05f + length(a.gradient))) << blend;
        }
    }
}

TEST(ConvolutionField, LargerBlendReducesTheSwellingOfLaterals) {
    // A lateral with a tenth of the trunk's radius, at a right angle, measured at one and four of its radii
    // above the trunk's surface. Expected: F_lateral^n = 1 - F_trunk^n on long lines.
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, -20}, {0, 0, 0}, {0, 0, 20}, {10, 0, 0}}, {1, 1, 1, 0.1f});
    const std::array<float, 4> one_above{1.180f, 1.055f, 1.010f, 1.001f}, four_above{1.006f, 1, 1, 1};
    for (std::size_t i = 0; i < std::size(kBlends); ++i) {
        const ConvolutionField field(s, {.blend = kBlends[i]});
        const auto swelling = [&](float height) {
            return reach(field, {1 + 0.1f * height, 0, 0}, {0, 1, 0}, 0.1f) / 0.1f;
        };
        EXPECT_NEAR(swelling(1), one_above[i], 0.002f) << kBlends[i];
        EXPECT_NEAR(swelling(4), four_above[i], 0.002f) << kBlends[i];
    }
}

TEST(ConvolutionField, LargerBlendReducesTheSwellingAtForks) {
    // Two equal children at 60 degrees from the trunk's direction: radius perpendicular to their plane, and
    // upwards.
    const float sine = std::sqrt(0.75f);
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, -50}, {0, 0, 0}, {50 * sine, 0, 25}, {-50 * sine, 0, 25}}, {1, 1, 1, 1});
    const std::array<float, 4> across{1.090f, 1.027f, 1.004f, 1.000f}, up{1.313f, 1.234f, 1.186f, 1.161f};
    for (std::size_t i = 0; i < std::size(kBlends); ++i) {
        const ConvolutionField field(s, {.blend = kBlends[i]});
        EXPECT_NEAR(reach(field, {0, 0, 0}, {0, 1, 0}, 1), across[i], 0.002f) << kBlends[i];
        EXPECT_NEAR(reach(field, {0, 0, 0}, {0, 0, 1}, 1), up[i], 0.002f) << kBlends[i];
    }
}

TEST(ConvolutionField, BlendOfTwoEqualAxesIsTheirNorm) {
    // Two coincident trees: two axes with the same value everywhere.
    const Skeleton s({NodeId{}, NodeId(0), NodeId{}, NodeId(2)},
                     {{0, 0, 0}, {0, 0, 10}, {0, 0, 0}, {0, 0, 10}}, {1, 1, 1, 1});
    const Skeleton one({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {1, 1});
    const Vec3 p{0.8f, 0.3f, 4};
    const FieldSample alone = at(ConvolutionField(one, {}), p);
    for (const int blend : kBlends) {
        const float factor = std::pow(2.0f, 1.0f / static_cast<float>(blend));
        const FieldSample f = at(ConvolutionField(s, {.blend = blend}), p);
        EXPECT_NEAR(f.value, factor * alone.value, 1e-5f) << blend;
        EXPECT_LT(distance(f.gradient, factor * alone.gradient), 1e-4f) << blend;
    }
}

TEST(ConvolutionField, BlendedValuesAreFiniteEverywhere) {
    // 500 coincident spokes back and forth result in values of thousands; beyond the support everything is 0.
    std::vector<NodeId> parent{NodeId{}};
    std::vector<Vec3> position{{0, 0, 0}};
    for (std::uint32_t i = 0; i < 500; ++i) {
        parent.push_back(NodeId(i));
        position.push_back({0, 0, i % 2 == 0 ? 3.0f : 0.0f});
    }
    for (std::uint32_t i = 0; i < 500; ++i) {
        parent.push_back(NodeId(0));
        position.push_back({0, 0, 3});
    }
    const Skeleton s(parent, position, std::vector<float>(parent.size(), 1.0f));
    std::vector<Vec3> points;
    for (int i = 0; i < 4000; ++i) points.push_back({0.0005f * static_cast<float>(i), 0, 1.5f});
    points.push_back({1e8f, 1e8f, -1e8f});
    std::vector<FieldSample> samples(points.size());
    for (const Kernel k : kKernels) {
        for (const int blend : kBlends) {
            ConvolutionField(s, with_kernel(k, blend)).sample_everywhere(points, samples);
            EXPECT_GT(samples[0].value, 1000) << name_of(k) << ' ' << blend;
            for (const FieldSample& f : samples) {
                ASSERT_TRUE(std::isfinite(f.value) && is_finite(f.gradient)) << name_of(k) << ' ' << blend;
                ASSERT_GE(f.value, 0);
                if (f.value == 0 && blend > 1) {
                    ASSERT_EQ(length(f.gradient), 0);
                }
            }
        }
    }
}

TEST(ConvolutionField, RejectsBlendsThatAreNotPowersOfTwo) {
    const Skeleton s = zoo_skeleton("one_segment");
    EXPECT_EQ(test::error_of([&] { ConvolutionField(s, {.blend = 3}); }),
              "field: blend must be 1, 2, 4 or 8, but is 3");
    EXPECT_THROW(ConvolutionField(s, {.blend = 0}), InvalidInput);
    EXPECT_THROW(ConvolutionField(s, {.blend = 16}), InvalidInput);
}

TEST(ConvolutionField, SatisfiesFieldRef) {
    const Skeleton s = zoo_skeleton("one_segment");
    ConvolutionField field(s, {});
    const FieldRegion regions[] = {{s.bounds(), NodeId(1)}};
    field.set_regions(regions);
    const FieldRef ref(field);
    const Vec3 p[] = {lerp(s.position(NodeId(0)), s.position(NodeId(1)), 0.4f) + Vec3{0.3f, 0, 0}};
    FieldSample sample[1];
    ref.sample(0, p, sample);
    EXPECT_EQ(ref.level(), 1);
    EXPECT_EQ(sample[0].value, at(field, p[0]).value);
    EXPECT_LT(sample[0].gradient.x, 0);  // the field decreases outwards
}

}  // namespace
}  // namespace coppice
