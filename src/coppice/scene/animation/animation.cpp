#include "coppice/scene/animation/animation.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/options/quantity.h"
#include "coppice/pipeline/deform/valid_frames.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxFrames = 10'000;
constexpr std::size_t kMaxNamed = 100;  // maximum number of frozen frames in a report
constexpr double kSeconds = 4;          // default duration
constexpr std::size_t kFramesOfSwing = 8;

std::size_t compute_frames(double seconds, double rate) {
    const double count = std::round(seconds * rate);
    if (count < 1) {
        throw InvalidInput(fmt::format("{:g} s at {:g} frames a second make no frame; use a longer duration",
                                       seconds, rate));
    }
    if (count > static_cast<double>(kMaxFrames)) {
        throw InvalidInput(
            fmt::format("{:g} s at {:g} frames a second make {:.0f} frames; at most {} can be made", seconds,
                        rate, count, kMaxFrames));
    }
    return static_cast<std::size_t>(count);
}

void frame_surface(const QuadMesh& surface, std::vector<Vec3d>& points) {
    for (const Vec3 p : surface.positions) points.push_back(surface.origin + Vec3d(p));
}

FrameSeries series_with(const AnimationOptions& options, std::size_t count, double rate) {
    FrameSeries series;
    series.count = count;
    series.rate = rate;
    series.gif_colors = options.run.gif_colors;
    series.materials = options.materials;
    series.picture = options.picture;
    return series;
}

TextureView find_texture(const MeshResult& surface) {
    if (!surface.texture) return {};
    return {surface.texture->points, surface.texture->blends};
}

void note(MotionReport& report, std::size_t frame, double time, const ValidFrame& made) {
    report.not_converged += made.not_converged;
    report.folded += made.folded;
    report.crossings += made.crossings;
    if (!made.is_frozen()) return;
    ++report.frozen;
    report.wholly_frozen += made.whole_tree_frozen ? 1 : 0;
    if (report.first.size() < kMaxNamed)
        report.first.push_back(
            {frame, time, made.frozen_nodes, made.whole_tree_frozen, made.folded, made.crossings});
}

/// Returns the context without progress, because progress is reported for all frames together.
Context for_each_frame(const Context& ctx) {
    return {.threads = ctx.threads, .stop = ctx.stop, .progress = {}};
}

void report_frame(const Context& ctx, std::size_t frame, std::size_t count) {
    ctx.report(static_cast<float>(frame + 1) / static_cast<float>(count));
}

}  // namespace

void check_animation(const AnimationOptions& options, bool has_keys) {
    const bool is_windy = options.wind.speed > 0;
    if (!options.grow && !has_keys && !is_windy)
        throw InvalidInput("nothing would move; give keys, a wind speed, or let the tree grow");
    if (options.grow && (has_keys || is_windy)) {
        throw InvalidInput(
            "a tree that grows has other faces in every frame; leave the keys and the wind out, or the "
            "growth");
    }
    if (options.grow &&
        (options.mesh.method == MeshMethod::tetrahedra || options.mesh.method == MeshMethod::cylinders))
        throw InvalidInput("a tree that grows needs the method quads, ramifications or bmesh");
    if (options.grow && (options.mesh.slots.twigs || options.mesh.slots.cuts))
        throw InvalidInput("a tree that grows has one material for all faces");
}

Motion::Motion(const Skeleton& tree, std::optional<Keyframes> keys, const AnimationOptions& options)
    : rest_(rest_pose(tree)), keys_(std::move(keys)), rate_(double{options.run.rate}) {
    seconds_ = options.run.duration > 0 ? double{options.run.duration} : keys_ ? keys_->end() : kSeconds;
    const bool is_windy = options.wind.speed > 0;
    // An animation with keys includes the last moment; the wind is periodic, so its last moment equals the
    // first.
    frames_ = compute_frames(seconds_, rate_) + (is_windy ? 0 : 1);
    if (is_windy) wind_.emplace(tree, options.wind, seconds_, static_cast<int>(frames_ / kFramesOfSwing));
}

Pose Motion::at(double time) const {
    Pose pose = keys_ ? keys_->at(time) : rest_;
    return wind_ ? wind_->swayed(pose, time) : pose;
}

GrowthFrames growth_frames(const AnimateOptions& options) {
    const double seconds = options.duration > 0 ? double{options.duration} : kSeconds;
    return {seconds, compute_frames(seconds, double{options.rate})};
}

FrameSeries make_series(const SkinnedMesh& mesh, const Motion& motion, const AnimationOptions& options) {
    constexpr std::size_t kMaxPoses = 32;
    FrameSeries series = series_with(options, motion.frames(), motion.rate());
    series.rest = &mesh.made().quads().mesh;
    series.texture = find_texture(mesh.made());
    series.face_materials = mesh.made().slots;
    // The camera shows the surface at rest and the nodes in a sample of the poses.
    frame_surface(*series.rest, series.framed);
    for (std::size_t i = 0; i < motion.frames(); i += 1 + motion.frames() / kMaxPoses) {
        const Pose pose = motion.at(motion.time(i));
        for (const Vec3 p : pose.positions) series.framed.push_back(mesh.skeleton().origin() + Vec3d(p));
    }
    return series;
}

FrameSeries make_series(const QuadMesh& last, const GrowthFrames& frames, const AnimationOptions& options) {
    FrameSeries series = series_with(options, frames.frames, double{options.run.rate});
    frame_surface(last, series.framed);
    return series;
}

MotionReport make_frames(SkinnedMesh& mesh, const Motion& motion, const FrameSinks& sinks,
                         const Context& ctx) {
    using Clock = std::chrono::steady_clock;
    const Context each = for_each_frame(ctx);
    MotionReport report;
    ValidFrames frames(mesh);
    QuadMesh shown = mesh.made().quads().mesh;
    for (std::size_t i = 0; i < motion.frames(); ++i) {
        ctx.throw_if_cancelled();
        const auto start = Clock::now();
        ValidFrame frame = frames.next(motion.at(motion.time(i)), each);
        report.carrying += std::chrono::duration<double>(Clock::now() - start).count();
        note(report, i, motion.time(i), frame);
        shown.positions = std::move(frame.positions);
        for (const auto& sink : sinks) sink->add({shown, find_texture(mesh.made())}, each);
        report_frame(ctx, i, motion.frames());
    }
    for (const auto& sink : sinks) sink->finish(each);
    return report;
}

std::uint64_t make_frames(const Skeleton& tree, const GrowthFrames& frames, const AnimationOptions& options,
                          const FrameSinks& sinks, const Context& ctx) {
    const Context each = for_each_frame(ctx);
    const GrowingTree growing(tree, options.growing);
    std::uint64_t crossings = 0;
    for (std::size_t i = 0; i < frames.frames; ++i) {
        ctx.throw_if_cancelled();
        const double part = static_cast<double>(i + 1) / static_cast<double>(frames.frames);
        const MeshResult now = mesh_skeleton(growing.at(part), options.mesh, each);
        crossings += now.quads().repair.pairs_after;
        for (const auto& sink : sinks) sink->add({now.quads().mesh, find_texture(now)}, each);
        report_frame(ctx, i, frames.frames);
    }
    for (const auto& sink : sinks) sink->finish(each);
    return crossings;
}

std::string to_text(const MotionReport& report, std::size_t frames, std::size_t quads) {
    const std::string frozen =
        report.frozen == 0
            ? ""
            : fmt::format("; {} with frozen branches that would fold or intersect", grouped(report.frozen));
    return fmt::format("{} frames of {} quads{}", grouped(frames), grouped(quads), frozen);
}

std::string text_of_growth(std::size_t frames, std::size_t quads) {
    return fmt::format("{} frames of a tree that grows to {} quads", grouped(frames), grouped(quads));
}

}  // namespace coppice
