#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <thread>

#include "command.h"
#include "coppice/base/parallel.h"
#include "coppice/compose/compose.h"
#include "coppice/io_database/tree_library.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/png.h"
#include "coppice/skeleton/measure.h"
#include "files.h"
#include "options.h"
#include "pictures.h"
#include "scene_files.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

constexpr std::size_t kBatch = 64;  // maximum number of trees in memory

struct ComposeFlags {
    std::filesystem::path host, library, output, mesh_output, sheet, crown;
    int seed = 1, count = 1, picture_size = 256;
    ComposeOptions compose;
    LibraryFilter which;
    ReadSkeletonOptions read;
    WriteSkeletonOptions write;
    MeshOptions mesh = options_of_written_surface();
};

void check_flags(const ComposeFlags& flags) {
    if (flags.host.empty() || flags.library.empty() || flags.output.empty())
        throw UsageError(
            "name template, library and output: coppice compose TEMPLATE --library LIBRARY -o SKELETON");
    flags.write.format == SkeletonFormat::automatic ? check_skeleton_output(flags.output)
                                                    : check_output_folder(flags.output);
    if (!flags.mesh_output.empty()) check_mesh_output(flags.mesh_output);
    check_picture_output(flags.sheet);
}

/// Returns the file name: tree.swc for a single tree, else tree_001.swc and so on.
std::filesystem::path numbered(const std::filesystem::path& path, std::size_t i, int count) {
    if (count == 1) return path;
    const std::size_t digits = std::max<std::size_t>(3, std::to_string(count).size());
    return path.parent_path() /
           fmt::format("{}_{:0{}}{}", path.stem().string(), i + 1, digits, path.extension().string());
}

/// Returns the solid that the crown may fill, in the coordinates of the template.
std::optional<SolidField> read_crown(Run& run, const ComposeFlags& flags, Vec3d origin) {
    if (flags.crown.empty()) return {};
    return SolidField(relative_to(solid_of_scene(run, flags.crown.string()), origin));
}

/// Returns the statistics of a measure over all trees.
Json spread(std::vector<double> values) {
    const auto [min, max] = std::ranges::minmax(values);
    double sum = 0, squares = 0;
    for (const double v : values) sum += v;
    const double mean = sum / static_cast<double>(values.size());
    for (const double v : values) squares += (v - mean) * (v - mean);
    return {{"mean", mean},
            {"deviation", std::sqrt(squares / static_cast<double>(values.size()))},
            {"min", min},
            {"max", max}};
}

/// Totals of all trees.
struct Totals {
    ComposeReport report;
    std::vector<double> length, volume, tips, height, nodes;

    void add(const ComposeResult& made) {
        const ComposeReport& r = made.report;
        report.chosen += r.chosen;
        report.replaced += r.replaced;
        report.unmatched += r.unmatched;
        report.crossed += r.crossed;
        report.outside += r.outside;
        report.blocked += r.blocked;
        report.depth = std::max(report.depth, r.depth);
        const SkeletonMeasures m = measure(made.skeleton);
        length.push_back(m.length);
        volume.push_back(m.volume);
        tips.push_back(m.tips);
        height.push_back(double{m.bounds.size().z});
        nodes.push_back(m.nodes);
    }

    void fill(Json& counts) const {
        counts["trees"] = length.size();
        counts.update(compute_figures(report));
        counts["variety"] = {{"length_m", spread(length)},
                             {"volume_m3", spread(volume)},
                             {"tips", spread(tips)},
                             {"height_m", spread(height)},
                             {"nodes", spread(nodes)}};
    }
};

/// Composes trees first .. first + count - 1; the seed increases by one from tree to tree.
std::vector<ComposeResult> compose_some(Run& run, const ComposeFlags& flags, const TreeComposer& composer,
                                        const Skeleton& host, const SolidField* crown, std::size_t first,
                                        std::size_t count) {
    return run.stage("compose", [&](const Context& ctx) {
        std::vector<std::optional<ComposeResult>> made(count);
        parallel_for(ctx, count, 1, [&](std::size_t i) {
            const auto seed = static_cast<std::uint64_t>(flags.seed) + first + i;
            made[i] = composer.compose(host, seed, crown, {.threads = 1, .stop = ctx.stop});
            write_skeleton(numbered(flags.output, first + i, flags.count), made[i]->skeleton, flags.write);
        });
        std::vector<ComposeResult> out;
        for (auto& m : made) out.push_back(*std::move(m));
        return out;
    });
}

/// Meshes trees and writes their surfaces, several trees at a time, because a single tree cannot use many
/// threads. Returns the surface of the last one.
MeshResult mesh_some(Run& run, const ComposeFlags& flags, std::span<const ComposeResult> made,
                     std::size_t first) {
    return run.stage("mesh", [&](const Context& ctx) {
        std::optional<MeshResult> last;
        const unsigned threads = ctx.threads > 0 ? ctx.threads : std::thread::hardware_concurrency();
        const Context within{.threads = std::max(1u, threads / static_cast<unsigned>(made.size())),
                             .stop = ctx.stop};
        parallel_for(ctx, made.size(), 1, [&](std::size_t i) {
            MeshResult surface = mesh_skeleton(made[i].skeleton, flags.mesh, within);
            write_surface(numbered(flags.mesh_output, first + i, flags.count), surface, {}, within);
            if (i + 1 == made.size()) last = std::move(surface);
        });
        return *std::move(last);
    });
}

ExitCode compose(Run& run, const ComposeFlags& flags) {
    check_flags(flags);
    const SkeletonFile host = load_skeleton(run, flags.host, flags.read);
    const std::optional<SolidField> crown = read_crown(run, flags, host.skeleton.origin());
    const TreeComposer composer(
        run.stage("read library",
                  [&](const Context& ctx) { return read_child_trees(flags.library, flags.which, ctx); }),
        flags.compose);
    Totals totals;
    std::vector<Skeleton> drawn;
    std::string surfaces;
    const auto count = static_cast<std::size_t>(flags.count);
    for (std::size_t first = 0; first < count; first += kBatch) {
        const std::vector<ComposeResult> made =
            compose_some(run, flags, composer, host.skeleton, crown ? &*crown : nullptr, first,
                         std::min(kBatch, count - first));
        for (const ComposeResult& tree : made) {
            totals.add(tree);
            if (!flags.sheet.empty()) drawn.push_back(tree.skeleton);
        }
        if (flags.mesh_output.empty()) continue;
        const MeshResult last = mesh_some(run, flags, made, first);
        const auto name = numbered(flags.mesh_output, first + made.size() - 1, flags.count);
        surfaces = fmt::format("; {}: {}", name.string(), count_surface(run, last));
    }
    if (!flags.sheet.empty()) {
        std::vector<const Skeleton*> trees;
        for (const Skeleton& s : drawn) trees.push_back(&s);
        const std::vector<Image> pictures = draw_each(run, trees, flags.picture_size);
        run.stage("write", [&](const Context&) { write_sheet(flags.sheet, pictures); });
    }
    totals.fill(run.counts());
    const ComposeReport& r = totals.report;
    if (r.chosen > 0 && r.replaced == 0)
        run.warn(
            "no branch was replaced; see unmatched and blocked in the report, or try a greater --tolerance");
    run.finish(fmt::format("{}: {} trees, {} of {} branches replaced, {} blocked, {} without a match{}",
                           numbered(flags.output, count - 1, flags.count).string(), grouped(count),
                           grouped(r.replaced), grouped(r.chosen), grouped(r.blocked), grouped(r.unmatched),
                           surfaces));
    return kDone;
}

}  // namespace

Command compose_command() {
    const auto flags = std::make_shared<ComposeFlags>();
    OptionList options;
    options.file("template", "TEMPLATE", flags->host, "Skeleton with the branches to replace.");
    options.output("-o,--output", "SKELETON", flags->output,
                   "Skeleton to write; several are numbered tree_001.swc, tree_002.swc and so on.");
    options.file("--library", "LIBRARY", flags->library,
                 "Library of branches to insert, as written by coppice library.");
    options.value({common_field("seed", "Seed of the first tree; it increases by one for each further tree.",
                                Unit::none, 0, 2e9),
                   &flags->seed});
    options.value({common_field("count", "Number of trees to compose.", Unit::none, 1, 1e6), &flags->count});
    options.file("--crown", "SCENE[:SOLID]", flags->crown,
                 "Solid of a scene that inserted branches must not leave, as crown.coppice:s; without a name "
                 "the last one.");
    options.output("--sheet", "PNG", flags->sheet, "Also draw all trees on one sheet.");
    options.value({{"picture_size", "Width and height of each image in pixels.", Unit::none, 16, 4096},
                   &flags->picture_size});
    options.output("--then-mesh", "MESH", flags->mesh_output,
                   "Also write the surface of every tree, numbered like --output.");
    options.may_replace("--output", "template");
    options.fields(flags->compose, "Composing");
    FlagNames which = library_flag_names();
    which.common = MemberNames{"ids", "tags"};
    options.fields(flags->which, "Trees of the library to use", which);
    options.fields(flags->read, "Reading the template", {.common = MemberNames{}});
    options.fields(flags->write, "Writing",
                   {.names = {{"format", "--output-format"}, {"up", "--output-up"}}, .without = {"units"}});
    options.fields(flags->mesh, "Surface of --then-mesh", then_mesh_flag_names());
    return {"compose", "Compose variants of a tree by replacing branches with those of a library.", options,
            [flags](Run& run, const GivenOptions&) { return compose(run, *flags); }};
}

}  // namespace coppice::cli
