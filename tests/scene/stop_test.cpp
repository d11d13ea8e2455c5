// Latency of cancellation of the long-running functions of the modules below scene, in units of work: samples
// of a field and reports of progress. Times would depend on the machine.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "coppice/growth/grow.h"
#include "coppice/growth/tidy.h"
#include "coppice/implicit/polygonize/cached_field.h"
#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/implicit/shape/variational.h"
#include "coppice/points/edit_points.h"
#include "coppice/points/quality.h"
#include "coppice/points/sampling/generate.h"
#include "coppice/points/sampling/near_mesh.h"
#include "coppice/scene/scene.h"

namespace coppice {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

/// Counts the work of a call, and requests cancellation at a given count.
struct Probe {
    std::uint64_t stop_at_sample = kNever, stop_at_report = kNever;
    std::stop_source source;
    std::uint64_t samples = 0, samples_after = 0;
    std::vector<float> reports;
    std::uint64_t reports_after = 0;

    void add_samples(std::uint64_t count) {
        if (source.stop_requested()) samples_after += count;
        samples += count;
        if (samples >= stop_at_sample) source.request_stop();
    }
    void add_report(float fraction) {
        if (source.stop_requested()) ++reports_after;
        reports.push_back(fraction);
        if (reports.size() >= stop_at_report) source.request_stop();
    }
    Context context() {
        return {.threads = 1, .stop = source.get_token(), .progress = [this](float f) { add_report(f); }};
    }
};

/// A ball of radius 1 that counts its samples.
struct CountedBall {
    Probe& probe;
    float level() const { return 1; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        probe.add_samples(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const float r = length(points[i]);
            out[i] = {std::max(0.0f, 2 - r), r < 2 ? -normalized(points[i]) : Vec3{}};
        }
    }
};

const Box3 kBox{{-2, -2, -2}, {2, 2, 2}};

TriMesh octahedron() {
    TriMesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
}

PointSet uniform_points(int count) {
    Probe quiet;
    const CountedBall ball{quiet};
    return generate(FieldRef(ball), kBox, {.pattern = PointPattern::uniform, .count = count}).points;
}

Skeleton zigzag(std::uint32_t count) {
    std::vector<NodeId> parents(count);
    std::vector<Vec3> positions(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        parents[i] = i == 0 ? NodeId::none() : NodeId(i - 1);
        positions[i] = {1.5f, i % 2 == 0 ? 0.0f : 0.01f, 1e-4f * static_cast<float>(i)};
    }
    return Skeleton(parents, positions, std::vector<float>(count, 1e-5f), {});
}

struct Call {
    std::string name;
    std::function<void(Probe&)> run;
    double longest_step = 0.2;  ///< maximum progress between two reports, as a fraction of the total
};

Call generate_call(std::string name, const GenerateOptions& options) {
    return {"generate " + std::move(name), [options](Probe& probe) {
                const CountedBall ball{probe};
                generate(FieldRef(ball), kBox, options, probe.context());
            }};
}

Call scene_call(std::string name, std::string before, std::string line, double longest_step = 0.2) {
    return {"scene: " + std::move(name),
            [before = std::move(before), line = std::move(line)](Probe& probe) {
                Scene scene;
                scene.run_text(before, "x");
                scene.run(line, {}, probe.context());
            },
            longest_step};
}

std::vector<Call> calls() {
    std::vector<Call> all;
    for (const PointPattern pattern :
         {PointPattern::poisson_disk, PointPattern::clustered, PointPattern::uniform, PointPattern::jittered,
          PointPattern::blue_noise}) {
        all.push_back(generate_call(std::string(name_of(pattern)), {.pattern = pattern, .count = 20000}));
    }
    all[3].longest_step = 1;  // one batch of cells
    all[2].longest_step = 1;  // one batch of points
    all.push_back(generate_call("until full", {.count = 0, .distance = 0.1f}));
    all.push_back({"remove_random",
                   [points = uniform_points(50000)](Probe& probe) {
                       const CountedBall ball{probe};
                       remove_random(points, FieldRef(ball), {}, probe.context());
                   },
                   1});
    all.push_back({"near_mesh", [](Probe& probe) {
                       near_mesh(octahedron(), {.count = 20000, .even = true}, probe.context());
                   }});
    all.push_back({"quality",
                   [points = uniform_points(20000)](Probe& probe) { quality(points, {}, probe.context()); },
                   0.4});
    all.push_back({"polygonize", [](Probe& probe) {
                       const CountedBall ball{probe};
                       polygonize(FieldRef(ball), kBox, {.cell = 0.05f}, probe.context());
                   }});
    all.push_back({"polygonize a solid", [](Probe& probe) {
                       polygonize(SolidField(sphere({})), {.cell = 0.01f}, probe.context());
                   }});
    all.push_back({"CachedField", [](Probe& probe) {
                       const CountedBall ball{probe};
                       CachedField(FieldRef(ball), kBox, {.cell = 0.05f}, probe.context());
                   }});
    all.push_back({"Variational", [](Probe& probe) {
                       const PointSet ball = uniform_points(600);
                       std::vector<Vec3> points;
                       for (const Vec3 p : ball.positions) points.push_back(normalized(p));
                       Variational(points, points, {}, probe.context());
                   }});
    const auto grow_call = [](bool guarded) {
        return [guarded, points = uniform_points(5000)](Probe& probe) {
            const CountedBall ball{probe};
            const Guard guard(FieldRef(ball), {.side = GuardSide::inside});
            const std::vector<Root> roots{{{0, 0, -0.9f}, {}}};
            grow({points.positions, roots, guarded ? &guard : nullptr},
                 {.influence_radius = 0.5f, .kill_radius = 0.05f, .step = 0.03f}, probe.context());
        };
    };
    all.push_back({"grow", grow_call(false)});
    all.push_back({"grow with a guard", grow_call(true)});
    all.push_back({"tidy with a guard", [tree = zigzag(5000)](Probe& probe) {
                       const CountedBall ball{probe};
                       const Guard guard{FieldRef(ball)};
                       tidy(tree, {.smooth_passes = 10}, &guard, probe.context());
                   }});
    all.push_back(scene_call("pointset generate", "sphere s", "pointset generate s blue_noise count=5000"));
    all.push_back(scene_call("polygonize", "sphere s", "polygonize s cell=0.01"));
    all.push_back(scene_call("grow", "sphere s\npointset generate s uniform count=2000",
                             "grow t s influence_radius=0.6 kill_radius=0.1 step=0.05"));
    return all;
}

/// Returns the counts at which cancellation is requested, from the first on; a call that is nearly complete
/// may finish.
std::vector<std::uint64_t> moments(std::uint64_t count) {
    std::vector<std::uint64_t> out;
    if (count > 1) {
        for (std::uint64_t k = 0; k < 5; ++k) out.push_back(1 + k * (count - 1) / 5);
    }
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

// Maximum length of a range of a parallel loop and of a step of a serial one.
constexpr std::uint64_t kMaxSamples = 20'000;

TEST(Stop, EveryLongCallStopsSoonWhenCancelled) {
    std::uint64_t longest = 0;
    for (const Call& call : calls()) {
        SCOPED_TRACE(call.name);
        Probe whole;
        call.run(whole);
        std::vector<Probe> probes;
        for (const std::uint64_t m : moments(whole.samples)) probes.push_back({.stop_at_sample = m});
        for (const std::uint64_t m : moments(whole.reports.size())) probes.push_back({.stop_at_report = m});
        EXPECT_FALSE(probes.empty());
        for (Probe& probe : probes) {
            EXPECT_THROW(call.run(probe), Cancelled) << probe.stop_at_sample << " " << probe.stop_at_report;
            EXPECT_LE(probe.samples_after, kMaxSamples);
            EXPECT_LE(probe.reports_after, 1u);
            longest = std::max(longest, probe.samples_after);
        }
    }
    RecordProperty("longest", std::to_string(longest));
}

TEST(Stop, ProgressIncreasesInStepsToTheEnd) {
    for (const Call& call : calls()) {
        SCOPED_TRACE(call.name);
        Probe probe;
        call.run(probe);
        float before = 0;
        for (const float f : probe.reports) {
            EXPECT_GE(f, before);
            EXPECT_LE(f - before, call.longest_step) << "at " << before;
            before = f;
        }
        EXPECT_GE(before, 0.95f);
    }
}

}  // namespace
}  // namespace coppice
