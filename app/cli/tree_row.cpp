#include "tree_row.h"

#include <array>
#include <span>
#include <string_view>

#include "files.h"

namespace coppice::cli {
namespace {

constexpr std::array<std::string_view, 2> kHeightBounds{"height_low_m", "height_high_m"};
constexpr std::array<std::string_view, 7> kSizes{
    "length_m", "length_low_m", "length_high_m", "volume_m3", "volume_low_m3", "volume_high_m3", "inferred"};

Json text_cell(const std::string& text) { return known(text, !text.empty()); }

/// Adds the figure of an optional value.
template <class Of, class Get>
Json compute_cell(const Of* of, const Get& get) {
    return of != nullptr ? Json(get(*of)) : Json();
}

/// Adds the diameter at breast height from the circles fitted to the points.
void add_diameter(Json& out, double diameter, double low, double high) {
    const bool seen = diameter > 0;
    out.update({{"dbh_m", known(diameter, seen)},
                {"dbh_low_m", known(low, seen)},
                {"dbh_high_m", known(high, seen)}});
}

/// Adds figures of the skeleton under their names in reports; for points also their bounds.
void add_figures(Json& out, const TreeFigures* t, bool of_points, std::span<const std::string_view> names) {
    const Json figures = compute_figures(t != nullptr ? *t : TreeFigures{});
    for (const std::string_view name : names) {
        const bool bound =
            name.find("_low_") != name.npos || name.find("_high_") != name.npos || name == "inferred";
        out[std::string(name)] = known(figures[std::string(name)], t != nullptr && (of_points || !bound));
    }
}

void add_crown(Json& out, const PlotTree* tree) {
    out["crown_area_m2"] = compute_cell(tree, [](const PlotTree& t) { return t.crown.area; });
    out["crown_base_m"] = compute_cell(tree, [](const PlotTree& t) { return t.crown_base; });
    out["crown_volume_m3"] = compute_cell(tree, [](const PlotTree& t) { return t.crown.hull_volume; });
    out["points"] = compute_cell(tree, [](const PlotTree& t) { return t.points; });
}

}  // namespace

void add_circle(Json& out, const StemDiameter& d, const std::string& prefix, bool is_known, LengthUnit unit) {
    out[in_unit(prefix + "deviation", unit)] = known(d.deviation, is_known);
    out[in_unit(prefix + "residual", unit)] = known(d.residual, is_known);
    out[prefix + "coverage"] = known(d.coverage, is_known);
}

Json tree_row(const TreeRow& row, const TreeColumns& columns) {
    Json out;
    if (columns.of_files) out["input"] = row.input;
    out["tree"] = known(row.tree, row.tree > 0);
    if (columns.with_ids) out["tree_id"] = known(row.id.value_or(0), row.id.has_value());
    out["file"] = text_cell(row.skeleton);
    const Vec3d foot = row.foot.value_or(Vec3d{});
    const bool placed = row.foot.has_value();
    out.update({{"x", known(foot.x, placed)}, {"y", known(foot.y, placed)}, {"z", known(foot.z, placed)}});
    const TreeFigures* t = row.figures;
    const StemForm* form = row.of_plot != nullptr ? &row.of_plot->form : nullptr;
    out["height_m"] =
        form != nullptr ? Json(form->height) : compute_cell(t, [](const auto& f) { return f.height; });
    add_figures(out, t, row.of_points, kHeightBounds);
    if (form != nullptr) {
        add_diameter(out, form->breast.diameter, form->breast.low(), form->breast.high());
    } else {
        const TreeFigures none;
        const TreeFigures& of = t != nullptr ? *t : none;
        add_diameter(out, of.dbh_of_points, of.dbh_low, of.dbh_high);
    }
    if (columns.of_plots) {
        const StemDiameter breast = form != nullptr ? form->breast : StemDiameter{};
        add_circle(out, breast, "dbh_", breast.diameter > 0);
        out["stems"] = compute_cell(form, [](const StemForm& f) { return f.stems; });
    }
    out["dbh_of_skeleton_m"] = known(t != nullptr ? t->dbh : 0, t != nullptr && t->dbh > 0);
    add_figures(out, t, row.of_points, kSizes);
    out["form"] = known(t != nullptr ? t->form : 0, t != nullptr && t->form > 0);
    if (columns.of_plots) {
        add_crown(out, row.of_plot);
        out["color"] = text_cell(row.color);
    }
    out["warnings"] = text_cell(row.warnings);
    if (columns.of_files) out["error"] = text_cell(row.error);
    return out;
}

}  // namespace coppice::cli
