#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "command.h"
#include "coppice/extract/stem/loose_components.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/extract/stem/tree_figures.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/options/json.h"
#include "coppice/points/spacing.h"
#include "coppice/scene/extraction.h"
#include "coppice/skeleton/measure.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "sums.h"
#include "timber.h"
#include "tree_row.h"

namespace coppice::cli {
namespace {

struct InfoFlags {
    std::filesystem::path file;
    bool json = false;
    bool forestry = false;
    TimberFlags timber;
    ReadSkeletonOptions read;
    ReadPointsOptions read_points;
};

Json numbers(Vec3d v) { return {v.x, v.y, v.z}; }

void add_size(Json& out, const Box3& box, Vec3d origin, LengthUnit unit = LengthUnit::m) {
    out[in_unit("size", unit)] = numbers(Vec3d(box.size()));
    out[in_unit("low", unit)] = numbers(Vec3d(box.low) + origin);
    out[in_unit("high", unit)] = numbers(Vec3d(box.high) + origin);
}

/// Adds the number of nodes of each SWC type, if the file has types.
void add_types(Json& out, std::span<const float> types) {
    std::map<float, std::uint64_t> counts;
    for (const float type : types) ++counts[type];
    constexpr std::size_t kMax = 20;
    if (counts.size() > kMax) return;
    for (const auto& [type, count] : counts) out[fmt::format("nodes_of_type_{}", type)] = count;
}

Json describe(const SkeletonFile& file, const Context& ctx) {
    const Skeleton& s = file.skeleton;
    const SkeletonMeasures m = measure(s);
    const auto [thinnest, thickest] = std::ranges::minmax(s.radii());
    Json out{{"kind", "skeleton"},
             {"format", file.format},
             {"units", name_of(file.units)},
             {"trees", m.trees},
             {"nodes", m.nodes},
             {"segments", m.segments},
             {"tips", m.tips},
             {"branch_nodes", m.branch_nodes},
             {in_unit("length", file.units), m.length}};
    add_sums(out, file, m, names_in(file.units), ctx);
    out[in_unit("radius_min", file.units)] = shortest(thinnest);
    out[in_unit("radius_max", file.units)] = shortest(thickest);
    add_size(out, s.bounds(), s.origin(), file.units);
    add_types(out, file.attribute("type"));
    out["repairs"] = file.report.total();
    const auto add = [&](std::string_view prefix, std::string_view name, std::uint32_t count) {
        if (count > 0) out[fmt::format("{}{}", prefix, name)] = count;
    };
    visit_errors(file.report, [&](std::string_view name, auto count) { add("repairs_", name, count); });
    visit_joints(file.report, [&](std::string_view name, auto count) { add("", name, count); });
    if (!file.notes.empty()) out["notes"] = file.notes;
    return out;
}

Json describe(const PolygonMesh& mesh, const Context& ctx) {
    validate(mesh);
    const TopologyReport t = topology(mesh, ctx);
    const ShapeReport s = shape(mesh, ctx);
    Box3 box;
    for (const std::uint32_t v : mesh.corners) box.extend(mesh.positions[v]);
    Json out{{"kind", "mesh"},
             {"vertices", t.vertices},
             {"faces", t.faces},
             {"quads", t.quads},
             {"components", t.components},
             {"euler", t.euler},
             {"watertight", t.watertight()},
             {"area_m2", s.area},
             {"volume_m3", s.signed_volume}};
    if (!box.empty()) add_size(out, box, mesh.origin);
    return out;
}

Json describe(const PointSet& points, const Context& ctx) {
    Json out{{"kind", "points"}, {"points", points.size()}, {"spacing_m", median_spacing(points, ctx)}};
    add_size(out, bounds(points), points.origin);
    return out;
}

/// Adds the number of trees with points, and the number of points without a tree.
void add_tree_ids(Json& out, std::vector<std::uint32_t> ids) {
    std::ranges::sort(ids);
    const auto none = static_cast<std::uint64_t>(std::ranges::upper_bound(ids, 0u) - ids.begin());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    out["tree_ids"] = ids.size() - (none > 0 ? 1 : 0);
    out["points_of_no_tree"] = none;
}

/// Adds the number of points of each class, and the other attributes of the points.
Json describe(const PointFile& file, const Context& ctx) {
    const PointCloud& scan = file.point_cloud;
    Json out = describe(scan.points, ctx);
    out["format"] = file.format;
    if (const std::string system = file.system.name(); !system.empty()) out["coordinate_system"] = system;
    if (file.without_return > 0) out["rays_without_return"] = file.without_return;
    if (file.missing > 0) out["points_missing"] = file.missing;
    if (!scan.classes.empty()) {
        std::array<std::uint64_t, 256> counts{};
        for (const std::uint8_t c : scan.classes) ++counts[c];
        for (std::size_t c = 0; c < counts.size(); ++c)
            if (counts[c] > 0) out[fmt::format("points_of_class_{}", c)] = counts[c];
    }
    if (!scan.colors.empty()) out["colors"] = true;
    if (!scan.intensities.empty()) {
        const auto [least, most] = std::ranges::minmax(scan.intensities);
        out["intensity"] = {double{least}, double{most}};
    }
    if (!scan.return_counts.empty()) out["max_returns"] = *std::ranges::max_element(scan.return_counts);
    if (!scan.tree_ids.empty()) add_tree_ids(out, scan.tree_ids);
    for (const PointDimension& d : file.dimensions)
        if (d.low <= d.high) out["dimension_" + d.name] = {d.low, d.high};
    return out;
}

/// Describes a diameter of a stem; omits unknown values.
Json describe(const StemDiameter& d) {
    Json out{{"height_m", d.height}, {"diameter_m", d.diameter}};
    if (d.coverage > 0) add_circle(out, d);
    return out;
}

/// Adds a figure with its bounds, if they are known.
void add_bounded(Json& out, std::string_view name, std::string_view unit, double value, double low,
                 double high) {
    out[fmt::format("{}_{}", name, unit)] = value;
    if (!(high > 0)) return;
    out[fmt::format("{}_low_{}", name, unit)] = low;
    out[fmt::format("{}_high_{}", name, unit)] = high;
}

/// Describes a stem in a slice; the heights of the stem and of the slice are unknown.
Json describe_in_slice(const StemForm& form) {
    Json out{{"place_m", numbers(form.foot)}};
    out.update(describe(form.breast));
    out.erase("height_m");
    return out;
}

/// Describes the forestry measures of one tree.
Json describe(const StemForm& form) {
    if (form.height == 0 && form.breast.diameter > 0) return describe_in_slice(form);
    Json out{{"foot_m", numbers(form.foot)}, {"on_ground", form.on_ground}};
    add_bounded(out, "height", "m", form.height, form.height_low, form.height_high);
    out["stems"] = form.stems;
    if (form.breast.diameter > 0) {
        out["dbh_m"] = form.breast.diameter;
        if (form.breast.coverage > 0) {
            out.update({{"dbh_low_m", form.breast.low()}, {"dbh_high_m", form.breast.high()}});
            add_circle(out, form.breast, "dbh_");
        }
    }
    for (const StemDiameter& d : form.taper) out["taper"].push_back(describe(d));
    return out;
}

/// Formats the figures for people: the taper as one line for each section.
std::string forestry_text(Json figures) {
    const Json taper = figures.value("taper", Json::array());
    figures.erase("taper");
    std::string text = figures_text(figures);
    if (!taper.empty()) text += "taper\n";
    for (const Json& section : taper) {
        std::string line;
        for (const auto& [name, figure] : section.items())
            line += fmt::format("  {} {:<9.4g}", name, figure.get<double>());
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

/// Appends the forestry measures of each tree to the figures of points or of a skeleton.
std::string forestry(Json figures, const std::vector<Json>& trees, bool json) {
    if (!json) {
        std::string text = figures_text(figures);
        for (const Json& tree : trees) text += "\nforestry\n" + forestry_text(tree);
        return text;
    }
    figures["forestry"] = trees.size() == 1 ? trees.front() : Json(trees);
    return figures_json(figures);
}

/// The trees of a file in metres, without loose components.
struct FileTrees {
    Skeleton skeleton;
    std::vector<TreeFigures> figures;  ///< with bounds if the file comes from an extraction
};

FileTrees make_trees(const SkeletonFile& file, const LooseComponents& parts) {
    Skeleton s = extract_parts(file.skeleton, parts.trees);
    std::vector<TreeFigures> figures =
        tree_figures(s, node_confidence(kept_attributes(file.attributes, file.skeleton, s)));
    return {std::move(s), std::move(figures)};
}

/// Adds implausible figures of trees, if any.
void add_doubts(Json& out, std::span<const TreeFigures> trees) {
    for (std::size_t t = 0; t < trees.size(); ++t)
        for (const std::string& doubt : trees[t].doubts)
            out["doubts"].push_back(trees.size() == 1 ? doubt : fmt::format("tree {}: {}", t + 1, doubt));
}

/// Adds the figures of a tree except those of its stem.
void add_wood(Json& out, const TreeFigures& t) {
    add_bounded(out, "length", "m", t.length, t.length_low, t.length_high);
    add_bounded(out, "volume", "m3", t.volume, t.volume_low, t.volume_high);
    if (t.volume_high > 0) out["inferred"] = t.inferred;
    if (t.form > 0) out["form"] = t.form;
    add_doubts(out, {&t, 1});
}

/// Describes the forestry measures of each tree of a skeleton in metres.
std::vector<Json> describe_trees(const FileTrees& trees, const TimberFlags& flags) {
    const Skeleton& s = trees.skeleton;
    const BranchTable table = list_branches(s);
    const Timber timber(s, table, flags);
    std::vector<double> volumes(s.tree_count(), 0);
    for (const Branch& branch : table.branches) volumes[branch.tree] += branch.volume;
    std::vector<Json> out;
    for (StemForm& form : stem_forms(s)) {
        const std::size_t tree = out.size();
        form.height_low = trees.figures[tree].height_low;
        form.height_high = trees.figures[tree].height_high;
        Json& figures = out.emplace_back(describe(form));
        add_wood(figures, trees.figures[tree]);
        timber.add_tree(figures, tree, names_in(LengthUnit::m));
        if (flags.wood_density > 0) figures["biomass_kg"] = double{flags.wood_density} * volumes[tree];
    }
    return out;
}

/// Adds the loose components of a skeleton, if any.
void add_loose_components(Json& out, const LooseComponents& parts) {
    if (parts.loose.empty()) return;
    out["loose_parts"] = parts.loose.size();
    out["loose_length_percent"] = 100 * parts.share;
    out["notes"].push_back(fmt::format(
        "{} of its {} connected components are short and not on the ground: they are not counted as trees",
        parts.loose.size(), parts.loose.size() + parts.trees.size()));
}

/// Throws UsageError for --forestry with a mesh, in which stems cannot be found.
ExitCode info_of_stems(Run& run, const InfoFlags& flags, FileKind kind) {
    if (kind == FileKind::mesh) {
        throw UsageError(
            fmt::format("--forestry is for points and skeletons, and '{0}' is a mesh; make a skeleton of it "
                        "with coppice extract {0} -o SKELETON",
                        flags.file.string()));
    }
    if (kind == FileKind::points && flags.timber.wood_density > 0) {
        throw UsageError(
            fmt::format("biomass requires a skeleton; make one of '{0}' with coppice extract {0} -o SKELETON",
                        flags.file.string()));
    }
    std::string text;
    if (kind == FileKind::skeleton) {
        const SkeletonFile file = load_skeleton(run, flags.file, flags.read);
        if (file.units != LengthUnit::m) {
            throw UsageError(
                fmt::format("--forestry measures 1.3 m above the ground, and '{}' is in {}; convert it to "
                            "metres with --scale, or specify --units m if it is in metres",
                            flags.file.string(), name_of(file.units)));
        }
        text = run.stage("measure", [&](const Context& ctx) {
            const LooseComponents parts = find_loose_components(file.skeleton);
            Json figures = describe(file, ctx);
            add_loose_components(figures, parts);
            return forestry(std::move(figures), describe_trees(make_trees(file, parts), flags.timber),
                            flags.json);
        });
    } else {
        const PointSet points = load_points(run, flags.file, flags.read.up, flags.read_points);
        text = run.stage("measure", [&](const Context& ctx) {
            Json figures = describe(points, ctx);
            std::vector<StemForm> forms = slice_forms(points, ctx);
            if (forms.empty()) {
                forms.push_back(stem_form(points, ctx));
            } else {
                figures["slice"] = true;
            }
            std::vector<Json> trees;
            for (const StemForm& form : forms) {
                trees.push_back(describe(form));
                add_stem_timber(trees.back(), form, flags.timber, names_in(LengthUnit::m));
            }
            return forestry(std::move(figures), trees, flags.json);
        });
    }
    run.print(text);
    run.finish(flags.file.string() + " read");
    return kDone;
}

ExitCode info(Run& run, const InfoFlags& flags) {
    if (flags.file.empty()) throw UsageError("name the file: coppice info FILE");
    if (!flags.forestry && flags.timber.any()) throw UsageError("timber and biomass require --forestry");
    (void)flags.timber.tops();  // so that errors are reported before any work
    Json figures;
    const FileKind kind = kind_of_input(run, flags.file, flags.read.format);
    if (flags.forestry) return info_of_stems(run, flags, kind);
    if (kind == FileKind::skeleton) {
        const SkeletonFile file = load_skeleton(run, flags.file, flags.read);
        figures = run.stage("measure", [&](const Context& ctx) {
            Json out = describe(file, ctx);
            if (file.units == LengthUnit::m)
                add_doubts(out, make_trees(file, find_loose_components(file.skeleton)).figures);
            return out;
        });
    } else if (kind == FileKind::points) {
        const PointFile scan = load_point_file(run, flags.file, {.distances = false, .ranges = true},
                                               flags.read.up, flags.read_points);
        figures = run.stage("measure", [&](const Context& ctx) { return describe(scan, ctx); });
    } else {
        const PolygonMesh mesh = load_mesh(run, flags.file, flags.read.up);
        figures = run.stage("measure", [&](const Context& ctx) { return describe(mesh, ctx); });
    }
    run.print(flags.json ? figures_json(figures) : figures_text(figures));
    run.finish(flags.file.string() + " read");
    return kDone;
}

}  // namespace

Command info_command() {
    const auto flags = std::make_shared<InfoFlags>();
    OptionList options;
    options.file("file", "FILE", flags->file, "Skeleton, mesh or points to read.");
    options.flag("--json", flags->json, "Print JSON instead of a table.");
    options.flag("--forestry", flags->forestry,
                 "Also print the height of the tree, its diameter at breast height (1.3 m) and its taper.");
    add_timber_options(options, flags->timber);
    options.fields(flags->read, "Reading a skeleton");
    options.fields(flags->read_points, kReadPointsGroup);
    return {"info", "Print a summary of a skeleton, mesh or point file.", options,
            [flags](Run& run, const GivenOptions&) { return info(run, *flags); }};
}

}  // namespace coppice::cli
