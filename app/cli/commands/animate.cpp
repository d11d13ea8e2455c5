#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "command.h"
#include "coppice/animate/animate_options.h"
#include "coppice/animate/growing.h"
#include "coppice/animate/wind.h"
#include "coppice/io/file.h"
#include "coppice/pipeline/carry/sound_frames.h"
#include "coppice/scene/keyframes.h"
#include "files.h"
#include "frame_sinks.h"
#include "options.h"
#include "scene_files.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

constexpr std::size_t kMostFrames = 10'000;
constexpr std::size_t kMostNamed = 100;  // of held frames, in the report
constexpr float kSeconds = 4;            // of what does not say how long it lasts

struct AnimateFlags {
    std::filesystem::path tree;
    std::vector<std::filesystem::path> outputs;
    std::filesystem::path keys;
    std::vector<std::filesystem::path> more_keys;  // texts, not files
    bool grow = false;
    AnimateOptions run;
    WindOptions wind;
    GrowingOptions growing;
    MeshOptions mesh;
    RenderOptions picture;
    ReadSkeletonOptions read;
};

void check_flags(const AnimateFlags& flags) {
    if (flags.tree.empty() || flags.outputs.empty())
        throw UsageError("name the tree and the frames: coppice animate TREE -o FRAMES");
    for (const auto& output : flags.outputs) check_frames_output(output, !flags.grow);
    const bool has_keys = !flags.keys.empty() || !flags.more_keys.empty();
    if (flags.grow && (has_keys || flags.wind.speed > 0))
        throw UsageError(
            "a tree that grows has other faces in every frame; leave --keys and the wind out, or --grow");
    if (flags.grow &&
        (flags.mesh.method == MeshMethod::tetrahedra || flags.mesh.method == MeshMethod::cylinders))
        throw UsageError("--grow needs --method quads, ramifications or bmesh");
    if (!flags.grow && !has_keys && !(flags.wind.speed > 0))
        throw UsageError("nothing would move; give keys with --keys, a wind with --wind-speed, or --grow");
}

std::size_t frames_of(const AnimateFlags& flags, double seconds) {
    const double count = std::round(seconds * double{flags.run.rate});
    if (count < 1) {
        throw UsageError(fmt::format("{:g} s at {:g} frames a second make no frame; give a longer --duration",
                                     seconds, double{flags.run.rate}));
    }
    if (count > static_cast<double>(kMostFrames)) {
        throw UsageError(
            fmt::format("{:g} s at {:g} frames a second make {:.0f} frames; at most {} can be made", seconds,
                        double{flags.run.rate}, count, kMostFrames));
    }
    return static_cast<std::size_t>(count);
}

/// The keys of the file and of the command line; none where there are none.
std::optional<Keyframes> load_keys(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    std::string text, source = "--key";
    if (!flags.keys.empty()) {
        source = flags.keys.string();
        text =
            run.stage("read", [&](const Context& ctx) { return read_file(flags.keys, kLargestScene, ctx); });
    }
    for (const auto& key : flags.more_keys) text.append(key.string()).append(1, '\n');
    if (text.empty() && flags.keys.empty()) return {};
    return run.stage("keys", [&](const Context& ctx) { return Keyframes(tree, text, source, {}, ctx); });
}

/// The motion of a tree, and how many frames it has.
struct Motion {
    std::vector<Pose> poses;
    std::size_t keys = 0;
};

Motion motion_of(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    const std::optional<Keyframes> keys = load_keys(run, flags, tree);
    const double seconds = flags.run.duration > 0 ? double{flags.run.duration}
                           : keys                 ? keys->end()
                                                  : double{kSeconds};
    const bool is_windy = flags.wind.speed > 0;
    // Of keys the last moment is shown too; of the wind it is the first again.
    const std::size_t count = frames_of(flags, seconds) + (is_windy ? 0 : 1);
    return run.stage("poses", [&](const Context& ctx) {
        constexpr std::size_t kFramesOfSwing = 8;
        Motion out{.poses = {}, .keys = keys ? keys->size() : 0};
        std::optional<Wind> wind;
        if (is_windy) wind.emplace(tree, flags.wind, seconds, static_cast<int>(count / kFramesOfSwing));
        for (std::size_t i = 0; i < count; ++i) {
            ctx.throw_if_cancelled();
            const double time = static_cast<double>(i) / double{flags.run.rate};
            Pose pose = keys ? keys->at(time) : rest_pose(tree);
            out.poses.push_back(wind ? wind->swayed(pose, time) : std::move(pose));
        }
        return out;
    });
}

/// Points that are to be in all pictures: the surface at rest, and the nodes in some of the poses.
std::vector<Vec3d> framed(const QuadMesh& rest, const Skeleton& s, std::span<const Pose> poses) {
    constexpr std::size_t kMostPoses = 32;
    std::vector<Vec3d> out;
    for (const Vec3 p : rest.positions) out.push_back(rest.origin + Vec3d(p));
    for (std::size_t i = 0; i < poses.size(); i += 1 + poses.size() / kMostPoses) {
        for (const Vec3 p : poses[i].positions) out.push_back(s.origin() + Vec3d(p));
    }
    return out;
}

std::vector<std::unique_ptr<FrameSink>> open_sinks(const AnimateFlags& flags, const FrameSeries& series) {
    std::vector<std::unique_ptr<FrameSink>> sinks;
    for (const auto& output : flags.outputs) sinks.push_back(open_sink(output, series));
    return sinks;
}

/// What became of the frames.
class FrameLog {
  public:
    void add(std::size_t frame, double time, const SoundFrame& made) {
        not_converged_ += made.not_converged;
        folded_ += made.folded;
        crossings_ += made.crossings;
        if (!made.is_held()) return;
        ++held_;
        whole_ += made.whole_tree_held ? 1 : 0;
        if (named_.size() >= kMostNamed) return;
        Figures one;
        one["frame"] = frame;
        one["time"] = time;
        one["held_nodes"] = made.held_nodes;
        one["whole_tree"] = made.whole_tree_held;
        one["folded"] = made.folded;
        one["crossings"] = made.crossings;
        named_.emplace_back(std::move(one));
    }
    void report(Figures& counts) const {
        counts["frames_held"] = held_;
        counts["frames_wholly_held"] = whole_;
        counts["folds_avoided"] = folded_;
        counts["crossings_avoided"] = crossings_;
        counts["not_converged"] = not_converged_;
        if (!named_.empty()) counts["held"] = named_;
    }
    std::string text() const {
        return held_ == 0 ? ""
                          : fmt::format("; {} held back where branches would fold or cross", grouped(held_));
    }

  private:
    std::uint64_t held_ = 0, whole_ = 0, folded_ = 0, crossings_ = 0, not_converged_ = 0;
    Figure::List named_;
};

/// One surface for all frames.
ExitCode animate_motion(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    const Motion motion = motion_of(run, flags, tree);
    const std::size_t count = motion.poses.size();
    const double rate = double{flags.run.rate};
    CarriedMesh mesh =
        run.stage("mesh", [&](const Context& ctx) { return CarriedMesh(tree, flags.mesh, ctx); });
    const QuadMesh& rest = mesh.made().quads().mesh;
    const auto sinks = open_sinks(flags, {.count = count,
                                          .rate = rate,
                                          .rest = &rest,
                                          .gif_colors = flags.run.gif_colors,
                                          .picture = flags.picture,
                                          .framed = framed(rest, tree, motion.poses)});
    FrameLog log;
    double carrying = 0;
    run.stage("frames", [&](const Context& ctx) {
        const Context each{.threads = ctx.threads, .stop = ctx.stop, .progress = {}};
        SoundFrames frames(mesh);
        QuadMesh shown = rest;
        for (std::size_t i = 0; i < count; ++i) {
            const auto start = std::chrono::steady_clock::now();
            SoundFrame frame = frames.next(motion.poses[i], each);
            carrying += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            log.add(i, static_cast<double>(i) / rate, frame);
            shown.positions = std::move(frame.positions);
            for (const auto& sink : sinks) sink->add(shown, each);
            ctx.report(static_cast<float>(i + 1) / static_cast<float>(count));
        }
        for (const auto& sink : sinks) sink->finish(each);
    });
    run.add_stage("frames: carry", carrying);
    count_surface(run, mesh.made());
    run.counts()["keys"] = motion.keys;
    run.counts()["frames"] = count;
    run.counts()["seconds_per_frame"] = carrying / static_cast<double>(count);
    log.report(run.counts());
    run.finish(fmt::format("{}: {} frames of {} quads{}", flags.tree.string(), grouped(count),
                           grouped(rest.quads.size()), log.text()));
    return kDone;
}

/// A surface of its own for each frame.
ExitCode animate_growth(Run& run, const AnimateFlags& flags, const Skeleton& tree) {
    const double seconds = flags.run.duration > 0 ? double{flags.run.duration} : double{kSeconds};
    const std::size_t count = frames_of(flags, seconds);
    const GrowingTree growing(tree, flags.growing);
    const MeshResult last =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(tree, flags.mesh, ctx); });
    const auto sinks = open_sinks(flags, {.count = count,
                                          .rate = double{flags.run.rate},
                                          .gif_colors = flags.run.gif_colors,
                                          .picture = flags.picture,
                                          .framed = framed(last.quads().mesh, tree, {})});
    std::uint64_t crossings = 0;
    run.stage("frames", [&](const Context& ctx) {
        const Context each{.threads = ctx.threads, .stop = ctx.stop, .progress = {}};
        for (std::size_t i = 0; i < count; ++i) {
            const double part = static_cast<double>(i + 1) / static_cast<double>(count);
            const MeshResult now = mesh_skeleton(growing.at(part), flags.mesh, each);
            crossings += now.quads().knots.pairs_after;
            for (const auto& sink : sinks) sink->add(now.quads().mesh, each);
            ctx.report(static_cast<float>(i + 1) / static_cast<float>(count));
        }
        for (const auto& sink : sinks) sink->finish(each);
    });
    count_surface(run, last);
    run.counts()["frames"] = count;
    run.counts()["crossings"] = crossings;
    run.finish(fmt::format("{}: {} frames of a tree that grows to {} quads", flags.tree.string(),
                           grouped(count), grouped(last.quads().mesh.quads.size())));
    return kDone;
}

ExitCode animate(Run& run, const AnimateFlags& flags) {
    check_flags(flags);
    const SkeletonFile file = load_skeleton(run, flags.tree, flags.read);
    return flags.grow ? animate_growth(run, flags, file.skeleton) : animate_motion(run, flags, file.skeleton);
}

/// The surface beside pictures and keys.
FlagNames animated_surface_flag_names() {
    FlagNames surface = surface_flag_names();
    surface.names.insert(surface.names.end(), {{"field.width", "--field-width"}});
    return surface;
}

}  // namespace

Command animate_command() {
    const auto flags = std::make_shared<AnimateFlags>();
    OptionList options;
    options.file("tree", "TREE", flags->tree, "skeleton to animate");
    options.files("-o,--output", "FRAMES", flags->outputs,
                  "what to write: .png, .ply, .obj, .stl (a file each frame: NAME_0000.png), .gif, .mp4 (by "
                  "ffmpeg), .glb, .usda; may "
                  "be repeated");
    options.file(
        "--keys", "FILE", flags->keys,
        "keys, one a line: seconds, perhaps an easing, a colon and edits, as in 2 out: bend near(0,0,3) 20");
    options.files("--key", "KEY", flags->more_keys, "a key as text, after those of --keys; may be repeated");
    options.flag("--grow", flags->grow,
                 "grow the tree up from its root, with a surface of its own in every frame");
    options.fields(flags->run, "Time");
    options.fields(flags->growing, "Growth", {.prefix = "grow"});
    options.fields(flags->wind, "Wind", {.prefix = "wind"});
    options.fields(flags->mesh, "Surface", animated_surface_flag_names());
    options.fields(flags->picture, "Picture");
    options.fields(flags->read, "Reading the skeleton");
    return {"animate", "Move a tree by keys or in the wind, with one surface for all frames, or let it grow",
            options, [flags](Run& run, const GivenOptions&) { return animate(run, *flags); }};
}

}  // namespace coppice::cli
