#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "architecture_options.h"
#include "command.h"
#include "coppice/extract/plot/crown.h"
#include "coppice/extract/stem/loose_components.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/io_skeleton/stated_axes.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/points/spacing.h"
#include "coppice/skeleton/architecture.h"
#include "coppice/skeleton/measure.h"
#include "coppice/system/file.h"
#include "csv_file.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "sums.h"
#include "timber.h"
#include "tree_tables.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;

struct TableFlags {
    std::vector<fs::path> files;
    fs::path output;
    bool no_surfaces = false;
    ArchitectureFlags architecture;
    TreeTableFlags parts;
    TimberFlags timber;
    ReadSkeletonOptions read;
    ReadPointsOptions read_points;

    /// Returns whether the table with a row for each file is requested.
    bool wants_rows() const { return !output.empty() || !parts.any(); }
};

/// Adds the height of a tree, the stem at breast height (1.3 m, therefore only in metres), and the crown.
void add_forestry(Json& row, const StemForm& form, const Crown& crown, double base) {
    row["height"] = form.height;
    if (form.breast.diameter > 0) row["dbh"] = form.breast.diameter;
    row.update({{"stems", form.stems},
                {"crown_area", crown.area},
                {"crown_diameter", crown.diameter()},
                {"crown_base", base},
                {"crown_volume", crown.hull_volume}});
}

/// Adds the crown of a single tree, ignoring loose components.
void add_crown(Json& row, const Skeleton& whole) {
    const LooseComponents parts = find_loose_components(whole);
    row["loose_parts"] = parts.loose.size();
    row["loose_length_percent"] = 100 * parts.share;
    if (parts.trees.size() != 1) return;  // only a single tree has a crown
    const Skeleton s = extract_parts(whole, parts.trees);
    const std::vector<StemForm> forms = stem_forms(s);
    // A root system below its root has no height, only a depth, which is part of its extent.
    if (forms.front().height < 0.5 * double{s.bounds().size().z}) return;
    const double base = crown_bases(s, forms).front(), above = forms.front().foot.z + base;
    add_forestry(row, forms.front(), measure_crowns(s, {&above, 1}).front(), base);
}

/// The figures of a row are in its units.
std::string plain_name(std::string_view name, int) { return std::string(name); }

void add_timber(Json& row, const SkeletonFile& file, const NodeAxes& axes, double volume,
                const TimberFlags& flags) {
    const Skeleton& s = file.skeleton;
    Timber(s, list_branches(s, axes.order, axes.axis), flags).add_all(row, plain_name);
    if (flags.wood_density > 0 && file.units == LengthUnit::m)
        row["biomass_kg"] = double{flags.wood_density} * volume;
}

void add_architecture(Json& row, const Skeleton& s, const NodeAxes& axes, const TableFlags& flags,
                      std::span<const double> limits) {
    constexpr std::size_t kOrders = 4;
    const std::vector<BranchOrder> orders = branch_orders(s, axes.order, axes.axis);
    std::uint64_t branches = 0;
    std::array<BranchOrder, kOrders> listed;
    for (std::size_t o = 0; o < orders.size(); ++o) {
        branches += orders[o].branches;
        listed[std::min(o, kOrders - 1)].length += orders[o].length;
        listed[std::min(o, kOrders - 1)].volume += orders[o].volume;
    }
    row.update({{"branches", branches},
                {"max_order", orders.size() - 1},
                {"strahler", std::ranges::max(strahler_orders(s))}});
    for (std::size_t o = 0; o < kOrders; ++o) {
        const std::string name = fmt::format("order_{}{}", o, o + 1 < kOrders ? "" : "_up");
        row["length_of_" + name] = listed[o].length;
        row["volume_of_" + name] = listed[o].volume;
    }
    for (const DiameterClass& c : diameter_classes(s, limits)) {
        const std::string name =
            std::isinf(c.to) ? fmt::format("from_{:g}", c.from) : fmt::format("below_{:g}", c.to);
        row["length_" + name] = c.length;
        row["volume_" + name] = c.volume;
    }
    const ShollProfile profile = sholl(s, flags.architecture.sholl_step);
    row["sholl_max"] = profile.most();
    row["sholl_radius"] = profile.critical_radius();
}

void add_extent(Json& row, const Box3& box) {
    row["width"] = double{std::max(box.size().x, box.size().y)};
    row["height"] = double{box.size().z};
}

void add_surface(Json& row, const PolygonMesh& mesh, const Context& ctx) {
    const ShapeReport report = shape(mesh, ctx);
    row.update({{"surface_watertight", topology(mesh, ctx).watertight()},
                {"surface_area", report.area},
                {"surface_volume", report.signed_volume}});
}

void add_surface(Run& run, Json& row, const Skeleton& s, const TableFlags& flags) {
    if (flags.no_surfaces) return;
    run.stage("surface", [&](const Context& ctx) {
        add_surface(row, to_polygons(mesh_skeleton(s, {}, ctx).quads().mesh), ctx);
    });
}

void describe(Run& run, Json& row, const SkeletonFile& file, const TableFlags& flags,
              std::span<const double> limits) {
    const Skeleton& s = file.skeleton;
    const SkeletonMeasures m = measure(s);
    row.update({{"format", file.format},
                {"units", name_of(file.units)},
                {"trees", m.trees},
                {"nodes", m.nodes},
                {"tips", m.tips},
                {"forks", m.branch_nodes},
                {"repairs", file.report.total()}});
    add_extent(row, s.bounds());
    row.update({{"radius_min", m.min_radius},
                {"radius_max", m.max_radius},
                {"length", m.length},
                {"longest_path", m.longest_path}});
    run.stage("measure", [&](const Context& ctx) { add_sums(row, file, m, plain_name, ctx); });
    if (file.units == LengthUnit::m) add_crown(row, s);
    const NodeAxes axes = find_axes(file);
    add_timber(row, file, axes, m.volume, flags.timber);
    add_architecture(row, s, axes, flags, limits);
    add_surface(run, row, s, flags);
}

/// Adds the figures that a cloud provides only partially.
struct CloudTree {
    StemForm form;
    Crown crown;  ///< above breast height: the lowest branch is unknown without a skeleton
};

CloudTree describe(Run& run, Json& row, const PointSet& points, const TimberFlags& timber) {
    row["units"] = name_of(LengthUnit::m);
    row["points"] = points.size();
    add_extent(row, bounds(points));
    return run.stage("measure", [&](const Context& ctx) {
        row["spacing"] = median_spacing(points, ctx);
        CloudTree out{stem_form(points, ctx), {}};
        out.crown = measure_crown(points, out.form.foot.z + kBreastHeight, ctx);
        add_forestry(row, out.form, out.crown, 0);
        add_stem_timber(row, out.form, timber, plain_name);
        return out;
    });
}

void describe(Run& run, Json& row, const PolygonMesh& mesh) {
    validate(mesh);
    Box3 box;
    for (const std::uint32_t v : mesh.corners) box.extend(mesh.positions[v]);
    row["units"] = name_of(LengthUnit::m);
    row["faces"] = mesh.face_count();
    if (!box.empty()) add_extent(row, box);
    run.stage("measure", [&](const Context& ctx) { add_surface(row, mesh, ctx); });
}

/// Adds the rows of a file: one for each of its models.
void add_rows(Run& run, std::vector<Json>& rows, TreeTables& parts, const fs::path& path,
              const TableFlags& flags, std::span<const double> limits) {
    const FileKind kind = kind_of_input(run, path, flags.read.format);
    rows.back()["kind"] = name_of(kind);
    if (kind == FileKind::points) {
        const PointSet points = load_points(run, path, flags.read.up, flags.read_points);
        const CloudTree tree = describe(run, rows.back(), points, flags.timber);
        return parts.add(path.string(), tree.form, tree.crown);
    }
    if (kind == FileKind::mesh) {
        if (flags.wants_rows()) describe(run, rows.back(), load_mesh(run, path, flags.read.up));
        return;
    }
    const Json begun = rows.back();
    ReadSkeletonOptions read = flags.read;
    read.model = std::max(read.model, 1);
    for (std::size_t models = 1;; ++read.model) {
        const SkeletonFile file = load_skeleton(run, path, read);
        if (flags.read.model == 0) models = file.models;
        if (file.models > 1) rows.back()["model"] = read.model;
        parts.add(run, path.string(), read.model, file);
        if (flags.wants_rows()) describe(run, rows.back(), file, flags, limits);
        if (static_cast<std::size_t>(read.model) >= models) return;
        rows.push_back(begun);
    }
}

/// Adds the rows of all files. A file that cannot be read or measured has its error in the row.
std::vector<Json> make_rows(Run& run, TreeTables& parts, const TableFlags& flags,
                            std::span<const double> limits) {
    std::vector<Json> rows;
    for (const fs::path& path : files_within(flags.files)) {
        rows.emplace_back()["file"] = path.string();
        try {
            add_rows(run, rows, parts, path, flags, limits);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error& error) {
            rows.back()["error"] = std::string(error.what());
            if (!flags.wants_rows()) run.warn(error.what());
        }
    }
    return rows;
}

void write_rows(Run& run, const fs::path& path, const std::vector<Json>& rows) {
    if (path.empty()) return run.print(to_csv(rows));
    if (path.extension() == ".csv") return write_file(path, to_csv(rows));
    write_file(path, figures_json({{"files", rows}}));
}

ExitCode table(Run& run, const TableFlags& flags) {
    if (flags.files.empty()) throw UsageError("name the files: coppice table FILES... -o TABLE.csv");
    if (!flags.output.empty() && flags.output.extension() != ".json" && flags.output.extension() != ".csv")
        throw UsageError(fmt::format("'{}' is not the name of a table; use the extension .csv or .json",
                                     flags.output.string()));
    if (!flags.output.empty()) check_output_folder(flags.output);
    const std::vector<double> limits = flags.architecture.limits();
    TreeTables parts(flags.parts, flags.timber);
    const std::vector<Json> rows = make_rows(run, parts, flags, limits);
    std::string written = parts.commit(run);
    const auto failed = static_cast<std::uint64_t>(
        std::ranges::count_if(rows, [](const Json& row) { return row.contains("error"); }));
    if (flags.wants_rows()) {
        write_rows(run, flags.output, rows);
        written += fmt::format("{}{}: {} rows, {} of them with an error", written.empty() ? "" : "; ",
                               flags.output.empty() ? "table" : flags.output.string(), grouped(rows.size()),
                               grouped(failed));
    }
    run.counts().update({{"rows", rows.size()}, {"failed", failed}});
    run.finish(written);
    return kDone;
}

}  // namespace

Command table_command() {
    const auto flags = std::make_shared<TableFlags>();
    OptionList options;
    options.files("files", "FILES", flags->files, "Skeletons, points and meshes, or folders of them.");
    options.output("-o,--output", "TABLE", flags->output,
                   "Table to write (.csv, .json); by default CSV is printed, unless another table is named.");
    add_tree_table_options(options, flags->parts);
    options.flag("--no-surfaces", flags->no_surfaces, "Do not compute surfaces, which is the slowest part.");
    add_timber_options(options, flags->timber);
    add_architecture_options(options, flags->architecture);
    options.fields(flags->read, "Reading a skeleton");
    options.fields(flags->read_points, kReadPointsGroup);
    return {"table", "Measure many files: one row each, with lengths, volumes, forks, orders and crown.",
            options, [flags](Run& run, const GivenOptions&) { return table(run, *flags); }};
}

}  // namespace coppice::cli
