#include "tree_row.h"

namespace coppice::cli {
namespace {

/// A figure, or an empty cell.
Figure cell_if(bool is_known, const Figure& figure) { return is_known ? figure : Figure(NotChecked{}); }

Figure text_cell(const std::string& text) { return cell_if(!text.empty(), text); }

/// Adds the figure of an optional value.
template <class Of, class Get>
Figure compute_cell(const Of* of, const Get& get) {
    return of != nullptr ? Figure(get(*of)) : Figure(NotChecked{});
}

void add_circle(Figures& out, const StemDiameter& breast) {
    const bool seen = breast.diameter > 0;
    out["dbh_deviation_m"] = cell_if(seen, breast.deviation);
    out["dbh_residual_m"] = cell_if(seen, breast.residual);
    out["dbh_coverage"] = cell_if(seen, breast.coverage);
}

/// Adds the diameter at breast height from the circles fitted to the points.
void add_diameter(Figures& out, double diameter, double low, double high) {
    const bool seen = diameter > 0;
    out["dbh_m"] = cell_if(seen, diameter);
    out["dbh_low_m"] = cell_if(seen, low);
    out["dbh_high_m"] = cell_if(seen, high);
}

/// Adds a figure of the skeleton.
void add_figure(Figures& out, const char* name, const TreeFigures* t, bool is_known,
                double TreeFigures::*figure) {
    out[name] = t != nullptr ? cell_if(is_known, t->*figure) : Figure(NotChecked{});
}

/// Adds the figures of the skeleton; for points also with their bounds.
void add_figures(Figures& out, const TreeFigures* t, bool of_points) {
    add_figure(out, "dbh_of_skeleton_m", t, t != nullptr && t->dbh > 0, &TreeFigures::dbh);
    add_figure(out, "length_m", t, true, &TreeFigures::length);
    add_figure(out, "length_low_m", t, of_points, &TreeFigures::length_low);
    add_figure(out, "length_high_m", t, of_points, &TreeFigures::length_high);
    add_figure(out, "volume_m3", t, true, &TreeFigures::volume);
    add_figure(out, "volume_low_m3", t, of_points, &TreeFigures::volume_low);
    add_figure(out, "volume_high_m3", t, of_points, &TreeFigures::volume_high);
    add_figure(out, "inferred", t, of_points, &TreeFigures::inferred);
    add_figure(out, "form", t, t != nullptr && t->form > 0, &TreeFigures::form);
}

void add_crown(Figures& out, const PlotTree* tree) {
    out["crown_area_m2"] = compute_cell(tree, [](const PlotTree& t) { return t.crown.area; });
    out["crown_base_m"] = compute_cell(tree, [](const PlotTree& t) { return t.crown_base; });
    out["crown_volume_m3"] = compute_cell(tree, [](const PlotTree& t) { return t.crown.hull_volume; });
    out["points"] = compute_cell(tree, [](const PlotTree& t) { return t.points; });
}

}  // namespace

Figures tree_row(const TreeRow& row, const TreeColumns& columns) {
    Figures out;
    if (columns.of_files) out["input"] = row.input;
    out["tree"] = cell_if(row.tree > 0, row.tree);
    if (columns.with_ids) out["tree_id"] = cell_if(row.id.has_value(), row.id.value_or(0));
    out["file"] = text_cell(row.skeleton);
    const Vec3d foot = row.foot.value_or(Vec3d{});
    out["x"] = cell_if(row.foot.has_value(), foot.x);
    out["y"] = cell_if(row.foot.has_value(), foot.y);
    out["z"] = cell_if(row.foot.has_value(), foot.z);
    const TreeFigures* t = row.figures;
    const StemForm* form = row.of_plot != nullptr ? &row.of_plot->form : nullptr;
    out["height_m"] =
        form != nullptr ? Figure(form->height) : compute_cell(t, [](const auto& f) { return f.height; });
    add_figure(out, "height_low_m", t, row.of_points, &TreeFigures::height_low);
    add_figure(out, "height_high_m", t, row.of_points, &TreeFigures::height_high);
    if (form != nullptr) {
        add_diameter(out, form->breast.diameter, form->breast.low(), form->breast.high());
    } else {
        const TreeFigures none;
        const TreeFigures& of = t != nullptr ? *t : none;
        add_diameter(out, of.dbh_of_points, of.dbh_low, of.dbh_high);
    }
    if (columns.of_plots) {
        add_circle(out, form != nullptr ? form->breast : StemDiameter{});
        out["stems"] = compute_cell(form, [](const StemForm& f) { return f.stems; });
    }
    add_figures(out, t, row.of_points);
    if (columns.of_plots) {
        add_crown(out, row.of_plot);
        out["color"] = text_cell(row.color);
    }
    out["warnings"] = text_cell(row.warnings);
    if (columns.of_files) out["error"] = text_cell(row.error);
    return out;
}

}  // namespace coppice::cli
