#include "tree_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_skeleton/stated_axes.h"
#include "coppice/skeleton/frustum.h"
#include "files.h"
#include "tree_row.h"

namespace coppice::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// Sums over a group of branches of one tree.
struct BranchSums {
    double length = 0, area = 0, volume = 0;
    std::uint64_t branches = 0;
    std::uint32_t max_order = 0;

    void add(const Branch& b) {
        length += b.length;
        area += b.area;
        volume += b.volume;
        ++branches;
        max_order = std::max(max_order, b.order);
    }
};

void add_place(Json& row, std::string_view prefix, Vec3d p) {
    constexpr std::array kNames{"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis)
        row[fmt::format("{}{}", prefix, kNames[static_cast<std::size_t>(axis)])] = p[axis];
}

/// Returns the radius of the cylinder with the volume and length of a cone.
double equal_radius(const Frustum& cone) {
    const double a = cone.radius_a, b = cone.radius_b;
    return std::sqrt((a * a + a * b + b * b) / 3);
}

std::optional<CsvFile> begin(const std::filesystem::path& path) {
    if (path.empty()) return std::nullopt;
    if (path.extension() != ".csv")
        throw UsageError(
            fmt::format("'{}' is not the name of this table; use the extension .csv", path.string()));
    check_output_folder(path);
    return std::optional<CsvFile>(std::in_place, path);
}

}  // namespace

bool TreeTableFlags::any() const {
    return !trees.empty() || !branches.empty() || !cylinders.empty() || !taper.empty() || !crowns.empty();
}

void add_tree_table_options(OptionList& options, TreeTableFlags& flags) {
    options.output("--trees", "CSV", flags.trees, "Write a row for each tree of each skeleton.");
    options.output("--branches", "CSV", flags.branches, "Write a row for each branch of each skeleton.");
    options.output("--cylinders", "CSV", flags.cylinders, "Write a row for each segment of each skeleton.");
    options.output("--taper", "CSV", flags.taper,
                   "Write a row for each section of each stem of skeletons and points.");
    options.output("--crowns", "MESH", flags.crowns, "Write the convex hulls of all crowns (.ply, .obj).",
                   {.common = false});
}

void add_taper(CsvFile& out, const Json& begin, const StemForm& form, LengthUnit units) {
    for (const StemDiameter& d : form.taper) {
        Json row = begin;
        row[in_unit("height", units)] = d.height;
        row[in_unit("diameter", units)] = d.diameter;
        add_circle(row, d, {}, d.coverage > 0, units);
        add_place(row, "", d.center);
        out.add(row);
    }
}

void add_hull(TriMesh& out, const TriMesh& hull) {
    if (out.positions.empty()) out.origin = hull.origin;
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    const Vec3d shift = hull.origin - out.origin;
    for (const Vec3 p : hull.positions) out.positions.push_back(Vec3(Vec3d(p) + shift));
    for (const auto& [a, b, c] : hull.triangles) out.triangles.push_back({first + a, first + b, first + c});
}

bool write_crowns(Run& run, const std::filesystem::path& path, const TriMesh& hulls) {
    if (hulls.triangles.empty()) {
        run.warn("there are no crowns to write");
        return false;
    }
    run.stage("write crowns", [&](const Context& ctx) { write_mesh(path, hulls, {}, ctx); });
    return true;
}

TreeTables::TreeTables(const TreeTableFlags& flags, const TimberFlags& timber)
    : flags_(flags),
      timber_(timber),
      trees_(begin(flags.trees)),
      branches_(begin(flags.branches)),
      cylinders_(begin(flags.cylinders)),
      taper_(begin(flags.taper)) {
    (void)timber.tops();  // so that errors are reported before any work
    if (!flags.crowns.empty()) check_mesh_output(flags.crowns);
}

void TreeTables::add(Run& run, const std::string& path, int model, const SkeletonFile& file) {
    if (!flags_.any()) return;
    check_units(units_, path, file.units);
    const Json begin{{"file", path}, {"model", model}};
    run.stage("trees", [&](const Context& ctx) {
        const Skeleton& s = file.skeleton;
        const NodeAxes axes = find_axes(file);
        const BranchTable table = list_branches(s, axes.order, axes.axis);
        if (branches_) add_branches(begin, file, table);
        if (cylinders_) add_cylinders(begin, file, table);
        const std::vector<StemForm> forms = stem_forms(s);
        for (std::size_t t = 0; taper_ && t < forms.size(); ++t) {
            Json tree = begin;
            tree["tree"] = t + 1;
            add_taper(*taper_, tree, forms[t], file.units);
        }
        if (!trees_ && flags_.crowns.empty()) return;
        const std::vector<double> bases = crown_bases(s, forms);
        std::vector<double> above;
        for (std::size_t t = 0; t < forms.size(); ++t) above.push_back(forms[t].foot.z + bases[t]);
        const std::vector<Crown> crowns = measure_crowns(s, above, ctx);
        for (const Crown& crown : crowns) add_hull(crowns_, crown.hull);
        if (trees_) add_trees(begin, file, table, forms, bases, crowns);
    });
}

void TreeTables::add(const std::string& path, const StemForm& form, const Crown& crown) {
    if (taper_) {
        check_units(units_, path, LengthUnit::m);
        add_taper(*taper_, {{"file", path}, {"model", 1}, {"tree", 1}}, form);
    }
    add_hull(crowns_, crown.hull);
}

void TreeTables::add_trees(const Json& begin, const SkeletonFile& file, const BranchTable& table,
                           std::span<const StemForm> forms, std::span<const double> bases,
                           std::span<const Crown> crowns) {
    std::vector<BranchSums> stems(forms.size()), laterals(forms.size());
    for (const Branch& b : table.branches) (b.is_stem() ? stems : laterals)[b.tree].add(b);
    const FigureName name = names_in(file.units);
    const bool in_metres = file.units == LengthUnit::m;  // breast height is 1.3 m
    const Timber timber(file.skeleton, table, timber_);
    for (std::size_t t = 0; t < forms.size(); ++t) {
        const BranchSums &stem = stems[t], &others = laterals[t];
        const double height = forms[t].height, volume = stem.volume + others.volume;
        Json row = begin;
        row["tree"] = t + 1;
        add_place(row, "", forms[t].foot);
        row[name("height", 1)] = height;
        row[name("dbh", 1)] = known(forms[t].breast.diameter, in_metres && forms[t].breast.diameter > 0);
        row[name("volume", 3)] = volume;
        row[name("stem_volume", 3)] = stem.volume;
        row[name("lateral_volume", 3)] = others.volume;
        row[name("length", 1)] = stem.length + others.length;
        row[name("stem_length", 1)] = stem.length;
        row[name("lateral_length", 1)] = others.length;
        row[name("area", 2)] = stem.area + others.area;
        row[name("stem_area", 2)] = stem.area;
        row[name("lateral_area", 2)] = others.area;
        row["laterals"] = others.branches;
        row["max_order"] = others.max_order;
        row[name("crown_base", 1)] = bases[t];
        row[name("crown_length", 1)] = height - bases[t];
        row["crown_ratio"] = known((height - bases[t]) / height, height > 0);
        row[name("crown_diameter", 1)] = crowns[t].diameter();
        row[name("crown_diameter_max", 1)] = crowns[t].max_width;
        row[name("crown_area", 2)] = crowns[t].area;
        row[name("crown_hull_area", 2)] = crowns[t].hull_area;
        row[name("crown_hull_volume", 3)] = crowns[t].hull_volume;
        timber.add_tree(row, t, name);
        if (timber_.wood_density > 0)
            row["biomass_kg"] = known(double{timber_.wood_density} * volume, in_metres);
        trees_->add(row);
    }
}

void TreeTables::add_branches(const Json& begin, const SkeletonFile& file, const BranchTable& table) {
    const FigureName name = names_in(file.units);
    for (std::size_t i = 0; i < table.branches.size(); ++i) {
        const Branch& b = table.branches[i];
        Json row = begin;
        row["tree"] = b.tree + 1;
        row["branch"] = i + 1;
        row["parent"] = b.parent == kNoIndex ? Json() : Json(b.parent + 1);
        row["order"] = b.order;
        row["cylinders"] = b.segments;
        row[name("diameter", 1)] = b.diameter;
        row[name("length", 1)] = b.length;
        row[name("area", 2)] = b.area;
        row[name("volume", 3)] = b.volume;
        row[name("height", 1)] = b.height;
        row["angle_deg"] = kDegrees * b.angle;
        row["azimuth_deg"] = kDegrees * b.azimuth;
        row["zenith_deg"] = kDegrees * b.zenith;
        branches_->add(row);
    }
}

void TreeTables::add_cylinders(const Json& begin, const SkeletonFile& file, const BranchTable& table) {
    const Skeleton& s = file.skeleton;
    const auto name = [&](std::string_view of) { return in_unit(of, file.units); };
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Segment segment = s.segment(n);
        const Frustum cone = frustum(segment);
        const std::uint32_t branch = table.branch_of[n.index()];
        const NodeId parent = s.parent(n);
        Json row = begin;
        row["tree"] = table.branches[branch].tree + 1;
        row["cylinder"] = n.index();
        row["parent"] = s.is_root(parent) ? Json() : Json(parent.index());
        const NodeId next = table.next_of[n.index()];
        row["extension"] = next ? Json(next.index()) : Json();
        row["branch"] = branch + 1;
        row["order"] = table.branches[branch].order;
        row["position"] = table.position_of[n.index()];
        row[name("radius")] = equal_radius(cone);
        row[name("start_radius")] = cone.radius_a;
        row[name("end_radius")] = cone.radius_b;
        row[name("length")] = cone.length;
        add_place(row, "start_", s.origin() + Vec3d(segment.a));
        add_place(row, "axis_", normalized(Vec3d(segment.b) - Vec3d(segment.a)));
        cylinders_->add(row);
    }
}

std::string TreeTables::commit(Run& run) {
    std::vector<std::string> written;
    const auto finish = [&](std::optional<CsvFile>& table, const std::filesystem::path& path,
                            std::string_view subject) {
        if (!table) return;
        if (table->rows() == 0) run.warn(fmt::format("there are no {} to list", subject));
        table->commit();
        run.counts()[subject] = table->rows();
        written.push_back(fmt::format("{}: {} {}", path.string(), grouped(table->rows()), subject));
    };
    finish(trees_, flags_.trees, "trees");
    finish(branches_, flags_.branches, "branches");
    finish(cylinders_, flags_.cylinders, "cylinders");
    finish(taper_, flags_.taper, "sections");
    if (!flags_.crowns.empty() && write_crowns(run, flags_.crowns, crowns_))
        written.push_back(flags_.crowns.string());
    return fmt::format("{}", fmt::join(written, "; "));
}

}  // namespace coppice::cli
