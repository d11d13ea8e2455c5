#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "command.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/render/picture.h"
#include "coppice/render/silhouette.h"
#include "coppice/sketch/draw.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/sketch/trace/trace.h"
#include "coppice/system/file.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "results.h"

namespace coppice::cli {
namespace {

constexpr const char* kSketchGroup = "From a sketch";
constexpr const char* kDrawGroup = "From a skeleton to a sketch";

struct SketchFlags {
    std::filesystem::path input, output;
    bool trace = false;
    SketchOptions sketch;
    DrawSketchOptions draw;
    ReadSkeletonOptions read;
    WriteSkeletonOptions write;
};

void check_flags(const GivenOptions& given, const SketchFlags& flags) {
    if (flags.input.empty() || flags.output.empty())
        throw UsageError("name both files: coppice sketch FILE.sketch.json -o SKELETON");
    check_output_folder(flags.output);
    const bool draws = is_sketch_name(flags.output);
    if (flags.trace) {
        if (!draws || !is_sketch_name(flags.input)) {
            throw UsageError(
                "--trace makes a sketch of the images that another one names: coppice sketch "
                "VIEWS.sketch.json -o NEW.sketch.json --trace");
        }
        if (const Option* option = first_of_groups(given, {kSketchGroup, kDrawGroup}))
            throw UsageError(fmt::format("{} does nothing with --trace", option->name));
        return;
    }
    if (is_sketch_name(flags.input) == draws) {
        throw UsageError(
            fmt::format("'{}' and '{}': one must be a sketch, with a name that ends in .sketch.json, and the "
                        "other one a skeleton",
                        flags.input.string(), flags.output.string()));
    }
    if (!draws && flags.write.format == SkeletonFormat::automatic &&
        kind_to_write(flags.output, FileKind::skeleton) != FileKind::skeleton) {
        throw UsageError(fmt::format("'{}' is not the name of a skeleton", flags.output.string()));
    }
    if (const Option* option = first_of_groups(given, {draws ? kSketchGroup : kDrawGroup})) {
        throw UsageError(fmt::format("{} is for making {}", option->name,
                                     draws ? "a skeleton of a sketch" : "a sketch of a skeleton"));
    }
}

Json compute_figures(const Sketch& sketch, const StrokeFit& stroke) {
    return {{"view", sketch.views[stroke.view].name},
            {"points", stroke.points},
            {"left_out", stroke.left_out},
            {"reversed", stroke.reversed},
            {"rms_error_pixels", stroke.rms_error},
            {"max_error_pixels", stroke.max_error}};
}

Json compute_figures(const Sketch& sketch, const BranchFit& fit) {
    Json strokes = Json::array();
    for (const StrokeFit& stroke : fit.strokes) strokes.push_back(compute_figures(sketch, stroke));
    return {{"name", sketch.branches[fit.branch].name},
            {"made", fit.refused.empty()},
            {"angle_degrees", fit.angle * 180 / std::numbers::pi},
            {"matched", fit.matched},
            {"length_m", fit.length},
            {"guessed_radius", fit.guessed_radius},
            {"strokes", strokes}};
}

/// Fills the report; returns the largest error of a stroke [pixels].
double fill_report(Run& run, const Sketch& sketch, const SketchResult& result) {
    Json branches = Json::array();
    std::uint64_t refused = 0, left_out = 0, reversed = 0, guessed = 0;
    double most = 0;
    for (const BranchFit& fit : result.branches) {
        branches.push_back(compute_figures(sketch, fit));
        guessed += fit.guessed_radius ? 1 : 0;
        for (const StrokeFit& stroke : fit.strokes) {
            left_out += stroke.left_out;
            reversed += stroke.reversed ? 1 : 0;
            if (fit.refused.empty()) most = std::max(most, stroke.rms_error);
        }
        if (fit.refused.empty()) continue;
        ++refused;
        run.warn(fit.refused);
    }
    run.count_skeleton(result.skeleton);
    run.counts().update({{"branches", sketch.branches.size()},
                         {"refused", refused},
                         {"guessed_radii", guessed},
                         {"rms_error_pixels", most},
                         {"strokes", branches}});
    run.repairs().update({{"points_left_out", left_out}, {"strokes_reversed", reversed}});
    return most;
}

ExitCode make_skeleton(Run& run, const SketchFlags& flags) {
    const Sketch sketch =
        run.stage("read", [&](const Context& ctx) { return read_sketch(flags.input, ctx); });
    const SketchResult result = run.stage("sketch", [&](const Context& ctx) {
        return reconstruct(sketch, flags.sketch, flags.input.string(), ctx);
    });
    run.stage("write", [&](const Context& ctx) {
        store_skeleton(run, flags.output, result.skeleton, flags.write, {}, ctx);
    });
    const double error = fill_report(run, sketch, result);
    run.finish(fmt::format("{}: {} nodes of {} branches, at most {:.1f} pixels from a stroke",
                           flags.output.string(), grouped(result.skeleton.size()),
                           grouped(sketch.branches.size()), error));
    return kDone;
}

ExitCode draw(Run& run, const SketchFlags& flags) {
    const SkeletonFile file = load_skeleton(run, flags.input, flags.read);
    const Sketch sketch = run.stage("draw", [&](const Context&) {
        return draw_sketch(file.skeleton, choose_views(file.skeleton, flags.draw), flags.draw);
    });
    run.stage("write", [&](const Context&) { write_sketch(flags.output, sketch); });
    run.counts()["branches"] = sketch.branches.size();
    run.finish(fmt::format("{}: {} branches", flags.output.string(), grouped(sketch.branches.size())));
    return kDone;
}

/// Reads the image of a view; its path is relative to the sketch.
Mask load_silhouette(Run& run, const std::filesystem::path& sketch, const SketchView& view) {
    if (view.image.empty())
        throw InvalidInput(
            fmt::format("{}: the view '{}' names no image to trace", sketch.string(), view.name));
    const std::filesystem::path path = sketch.parent_path() / view.image;
    return run.stage("read", [&](const Context& ctx) {
        return compute_silhouette(decode_picture(read_file(path, kLargestFile, ctx), path.string()));
    });
}

ExitCode trace_file(Run& run, const SketchFlags& flags) {
    const SketchCameras cameras =
        run.stage("read", [&](const Context& ctx) { return read_cameras(flags.input, ctx); });
    std::vector<Mask> silhouettes;
    for (const SketchView& view : cameras.views)
        silhouettes.push_back(load_silhouette(run, flags.input, view));
    const TraceResult result = run.stage("trace", [&](const Context& ctx) {
        return trace_views(cameras, silhouettes, flags.input.string(), ctx);
    });
    run.stage("write", [&](const Context&) { write_sketch(flags.output, result.sketch); });
    run.counts()["branches"] = result.sketch.branches.size();
    run.counts()["tips_seen"] = result.tips;
    const std::string seen = result.tips.size() == 2
                                 ? fmt::format("{} and {}", grouped(result.tips[0]), grouped(result.tips[1]))
                                 : grouped(result.tips[0]);
    run.finish(fmt::format("{}: {} branches from {} visible tips; check them, and correct errors",
                           flags.output.string(), grouped(result.sketch.branches.size()), seen));
    return kDone;
}

ExitCode sketch_file(Run& run, const GivenOptions& given, const SketchFlags& flags) {
    check_flags(given, flags);
    if (flags.trace) return trace_file(run, flags);
    return is_sketch_name(flags.output) ? draw(run, flags) : make_skeleton(run, flags);
}

}  // namespace

Command sketch_command() {
    const auto flags = std::make_shared<SketchFlags>();
    OptionList options;
    options.file("input", "FILE", flags->input,
                 "Sketch to read (.sketch.json), or a skeleton to convert to a sketch.");
    options.output("-o,--output", "FILE", flags->output, "Skeleton or sketch to write.");
    options.flag("--trace", flags->trace,
                 "Propose strokes from the silhouettes in the images of the sketch, for correction by hand.");
    options.fields(flags->sketch, kSketchGroup);
    options.fields(flags->write, "Writing the skeleton",
                   {.names = {{"format", "--output-format"}, {"up", "--output-up"}}, .without = {"units"}});
    options.fields(flags->draw, kDrawGroup);
    options.fields(flags->read, "Reading a skeleton");
    return {
        "sketch",
        "Reconstruct a skeleton from strokes drawn in two or more views, or draw a skeleton as such strokes.",
        options, [flags](Run& run, const GivenOptions& given) { return sketch_file(run, given, *flags); }};
}

}  // namespace coppice::cli
