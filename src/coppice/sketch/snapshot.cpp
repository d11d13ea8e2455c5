#include "coppice/sketch/snapshot.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"

namespace coppice {
namespace {

const Stroke* stroke_in(const SketchBranch& branch, std::uint32_t view) {
    const auto found = std::ranges::find(branch.strokes, view, &Stroke::view);
    return found == branch.strokes.end() || found->points.empty() ? nullptr : &*found;
}

/// Returns the position at which the first stem begins in a view.
PicturePoint find_base(const Sketch& sketch, std::uint32_t view, const std::string& where) {
    for (const SketchBranch& branch : sketch.branches)
        if (const Stroke* stroke = stroke_in(branch, view); stroke && !branch.parent)
            return stroke->points.front();
    throw InvalidInput(where +
                       ": no stem has a stroke in this view, so that its scale is unknown; draw the stem");
}

}  // namespace

SketchView snapshot_view(const Sketch& sketch, std::uint32_t view, const Snapshot& snapshot, double height,
                         const std::string& where) {
    if (!(height > 0)) throw InvalidInput(where + ": the height of the tree must be above 0 metres");
    if (snapshot.side == DrawingSide::top)
        throw InvalidInput(where + ": the height of the tree is not visible from the top");
    const PicturePoint base = find_base(sketch, view, where);
    double top = base.y;
    for (const SketchBranch& branch : sketch.branches) {
        if (const Stroke* stroke = stroke_in(branch, view))
            for (const PicturePoint p : stroke->points) top = std::min(top, p.y);
    }
    if (!(base.y - top >= 1))
        throw InvalidInput(where + ": no point in this view is above the base of its stem");
    const SketchView& given = sketch.views[view];
    SketchView out = drawing_view(snapshot.side, (base.y - top) / height, base);
    out.name = given.name;
    out.image = given.image;
    out.width = given.width;
    out.height = given.height;
    if (snapshot.field_of_view == 0) return out;
    if (given.width <= 0 || given.height <= 0)
        throw InvalidInput(where + ": field_of_view needs the width and height of the picture");
    const double focal = 0.5 * std::max(given.width, given.height) / std::tan(0.5 * snapshot.field_of_view);
    const double away = focal * height / (base.y - top);
    const double cx = 0.5 * given.width, cy = 0.5 * given.height;
    out.projection = Projection::perspective;
    out.k = {{{focal, 0, cx}, {0, focal, cy}, {0, 0, 1}}};
    out.t = {(base.x - cx) * away / focal, (base.y - cy) * away / focal, away};
    return out;
}

}  // namespace coppice
