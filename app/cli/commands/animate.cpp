#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "command.h"
#include "coppice/animate/animate_options.h"
#include "coppice/animate/wind.h"
#include "coppice/pipeline/carry/sound_frames.h"
#include "files.h"
#include "frame_sinks.h"
#include "options.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

constexpr std::size_t kMostFrames = 10'000;
constexpr std::size_t kMostNamed = 100;  // of held frames, in the report
constexpr float kSeconds = 4;            // of what does not say how long it lasts

struct AnimateFlags {
    std::filesystem::path tree;
    std::vector<std::filesystem::path> outputs;
    AnimateOptions run;
    WindOptions wind;
    MeshOptions mesh;
    RenderOptions picture;
    ReadSkeletonOptions read;
};

void check_flags(const AnimateFlags& flags) {
    if (flags.tree.empty() || flags.outputs.empty())
        throw UsageError("name the tree and the frames: coppice animate TREE -o FRAMES");
    for (const auto& output : flags.outputs) check_frames_output(output, true);
    if (!(flags.wind.speed > 0))
        throw UsageError("nothing would move; give the wind a speed with --wind-speed");
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

ExitCode animate(Run& run, const AnimateFlags& flags) {
    check_flags(flags);
    const double seconds = flags.run.duration > 0 ? double{flags.run.duration} : double{kSeconds};
    const std::size_t count = frames_of(flags, seconds);
    const SkeletonFile file = load_skeleton(run, flags.tree, flags.read);
    const Skeleton& tree = file.skeleton;
    CarriedMesh mesh =
        run.stage("mesh", [&](const Context& ctx) { return CarriedMesh(tree, flags.mesh, ctx); });
    const double rate = double{flags.run.rate};
    const std::vector<Pose> poses = run.stage("poses", [&](const Context& ctx) {
        constexpr std::size_t kFramesOfSwing = 8;
        const Wind wind(tree, flags.wind, seconds, static_cast<int>(count / kFramesOfSwing));
        std::vector<Pose> out;
        for (std::size_t i = 0; i < count; ++i) {
            ctx.throw_if_cancelled();
            out.push_back(wind.swayed(rest_pose(tree), static_cast<double>(i) / rate));
        }
        return out;
    });
    const FrameSeries series{.count = count,
                             .rate = rate,
                             .picture = flags.picture,
                             .framed = framed(mesh.made().quads().mesh, tree, poses)};
    std::vector<std::unique_ptr<FrameSink>> sinks;
    for (const auto& output : flags.outputs) sinks.push_back(open_sink(output, series));
    FrameLog log;
    double carrying = 0;
    run.stage("frames", [&](const Context& ctx) {
        const Context each{.threads = ctx.threads, .stop = ctx.stop, .progress = {}};
        SoundFrames frames(mesh);
        QuadMesh shown = mesh.made().quads().mesh;
        for (std::size_t i = 0; i < count; ++i) {
            const auto start = std::chrono::steady_clock::now();
            SoundFrame frame = frames.next(poses[i], each);
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
    run.counts()["frames"] = count;
    run.counts()["seconds_per_frame"] = carrying / static_cast<double>(count);
    log.report(run.counts());
    run.finish(fmt::format("{}: {} frames of {} quads{}", flags.tree.string(), grouped(count),
                           grouped(mesh.made().quads().mesh.quads.size()), log.text()));
    return kDone;
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
    options.files(
        "-o,--output", "FRAMES", flags->outputs,
        "what to write: .png, .ply, .obj, .stl (a file each frame: NAME_0000.png), .gif, .glb, .usda; may "
        "be repeated");
    options.fields(flags->run, "Time");
    options.fields(flags->wind, "Wind", {.prefix = "wind"});
    options.fields(flags->mesh, "Surface", animated_surface_flag_names());
    options.fields(flags->picture, "Picture");
    options.fields(flags->read, "Reading the skeleton");
    return {"animate", "Move a tree, in the wind or by keyframes, with one surface for all frames", options,
            [flags](Run& run, const GivenOptions&) { return animate(run, *flags); }};
}

}  // namespace coppice::cli
