// coppice_drag_bench: drags a branch of a tree back and forth, computes the surface in every frame, on the
// CPU or on the GPU that draws it, draws it by OpenGL, and prints as Markdown the times of a frame and of its
// steps.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <concepts>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>

#include "coppice/io_skeleton/reader.h"
#include "coppice/options/figures.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/render/contact_sheet.h"
#include "coppice/render/png.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/system/file.h"
#include "drag/drag_bench.h"
#include "machine.h"
#include "program.h"

namespace {

using namespace coppice;
using namespace coppice::bench;

struct Flags {
    ProgramFlags program{.threads = 0};
    std::filesystem::path tree, picture, sheet;
    double swing = 20;  // [degrees]
    DragOptions dragging;
    ViewOptions view;
    MeshOptions mesh;
};

std::string format_value(const auto& value) {
    if constexpr (std::floating_point<std::remove_cvref_t<decltype(value)>>)
        return fmt::format("{:.1f}", value);
    else
        return fmt::format("{}", value);
}

std::string make_markdown(const DragFigures& figures) {
    std::string out = fmt::format("{}\n\n", machine_description());
    if (!figures.note.empty()) out += fmt::format("Note: {}.\n\n", figures.note);
    out += "| figure | value |\n| --- | ---: |\n";
    visit_figures(figures, [&](std::string_view name, const auto& value) {
        out += fmt::format("| {} | {} |\n", name, format_value(value));
    });
    out += "\n| step | median, ms | 95 %, ms |\n| --- | ---: | ---: |\n";
    visit_figures(figures.seconds, [&](std::string_view name, const Statistics& s) {
        out += fmt::format("| {} | {:.4f} | {:.4f} |\n", name, 1e3 * s.p50, 1e3 * s.p95);
    });
    return out;
}

std::string make_json(const DragFigures& figures) {
    Json out{{"machine", machine_description()}};
    out.update(compute_figures(figures));
    if (!figures.note.empty()) out["note"] = figures.note;
    out["seconds"] = compute_figures(figures.seconds);
    return out.dump(1) + "\n";
}

void write_picture(const std::filesystem::path& path, const Image& picture) {
    if (!path.empty()) write_file(path, encode_png(picture));
}

void run(Flags& flags) {
    flags.dragging.swing = flags.swing * std::numbers::pi / 180;
    const Context ctx = flags.program.context();
    const Skeleton tree = flags.tree.empty() ? random_tree(3000, 1) : read_skeleton(flags.tree).skeleton;
    const QuadBuild build = build_quads(tree, flags.mesh, ctx);
    const auto backend = surface_backend(flags.mesh.device);
    const DragFigures figures = measure_drag(build, flags.dragging, flags.view, *backend, ctx);
    write_picture(flags.picture, figures.pictures.back());
    write_picture(flags.sheet, contact_sheet(figures.pictures));
    publish({.markdown = make_markdown(figures), .json = make_json(figures), .csv = {}}, flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    const std::map<std::string, Device> devices{
        {"auto", Device::automatic}, {"cpu", Device::cpu}, {"cuda", Device::cuda}};
    CLI::App app("Measures the frames of a dragged branch.");
    Flags flags;
    app.add_option("tree", flags.tree, "Skeleton instead of a synthetic tree of 3,000 segments.");
    app.add_option("--frames", flags.dragging.frames, "Number of frames.")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--segments", flags.dragging.segments,
                   "Approximate number of segments of the dragged branch.")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--swing", flags.swing, "Maximum angle in degrees to both sides of rest.")
        ->check(CLI::Range(0.0, 90.0))
        ->capture_default_str();
    app.add_option("--width", flags.view.camera.width, "Width of the images in pixels.")
        ->capture_default_str();
    app.add_option("--height", flags.view.camera.height, "Height of the images in pixels.")
        ->capture_default_str();
    app.add_option("--levels", flags.mesh.levels, "Number of subdivisions.")->capture_default_str();
    app.add_option("--device", flags.mesh.device, "Computes surfaces: auto, cpu or cuda.")
        ->transform(CLI::CheckedTransformer(devices));
    app.add_option("--picture", flags.picture, "Write the last frame to this image (.png).");
    app.add_option("--sheet", flags.sheet, "Write four frames to this image (.png).");
    app.add_option("--threads", flags.program.threads, "Number of threads; 0 uses all.")
        ->capture_default_str();
    app.add_option("--json", flags.program.json, "Write all figures to this file.");
    app.add_option("--markdown", flags.program.markdown, "Also write the tables to this file.");
    return run_program(app, argc, argv, [&] { run(flags); });
}
