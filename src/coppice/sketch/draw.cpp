#include "coppice/sketch/draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"

namespace coppice {
namespace {

constexpr double kOpening = 0.5;  // [rad] field of view of perspective cameras
constexpr double kFree = 1.1;     // factor on the radius of the visible sphere

SketchView view_at(double azimuth, const std::string& name, Vec3d middle, double radius,
                   const DrawSketchOptions& o) {
    const double size = o.size;
    SketchView view;
    view.name = name;
    view.width = view.height = o.size;
    view.projection = o.projection;
    const Vec3d right{-std::sin(azimuth), std::cos(azimuth), 0};
    view.r = {{{right.x, right.y, 0}, {0, 0, -1}, {-std::cos(azimuth), -std::sin(azimuth), 0}}};
    const bool perspective = o.projection == Projection::perspective;
    const double away = kFree * radius / std::sin(kOpening / 2);
    const double scale = perspective ? size / 2 / std::tan(kOpening / 2) : size / 2 / (kFree * radius);
    view.k = {{{scale, 0, size / 2}, {0, scale, size / 2}, {0, 0, 1}}};
    view.t = -(view.r * middle) + Vec3d{0, 0, perspective ? away : 0};
    return view;
}

/// Rounds to hundredths of a pixel, so that files remain readable.
double rounded(double pixels) { return std::round(100 * pixels) / 100; }

class Drawer {
  public:
    Drawer(const Skeleton& skeleton, const std::vector<SketchView>& views, const DrawSketchOptions& options)
        : skeleton_(skeleton), options_(options), branch_(skeleton.size(), 0) {
        sketch_.views = views;
    }

    Sketch run() {
        for (const NodeId n : nodes(skeleton_)) {
            const NodeId parent = skeleton_.parent(n);
            if (skeleton_.is_root(n)) {
                if (!skeleton_.is_tip(n)) add_branch({n}, {});
            } else if (skeleton_.leader(parent) != n) {
                add_branch({parent, n}, branch_[parent.index()]);
            }
        }
        if (sketch_.branches.empty()) throw InvalidInput("a skeleton without segments cannot be drawn");
        return std::move(sketch_);
    }

  private:
    Vec3d position(NodeId n) const { return skeleton_.origin() + Vec3d(skeleton_.position(n)); }

    /// Draws the branch that begins with these nodes. Nodes have larger ids than their parents, so that the
    /// branch of a node is known before its laterals.
    void add_branch(std::vector<NodeId> axis, std::optional<std::uint32_t> parent) {
        const auto index = static_cast<std::uint32_t>(sketch_.branches.size());
        while (!skeleton_.is_tip(axis.back())) axis.push_back(skeleton_.leader(axis.back()));
        for (std::size_t i = parent ? 1 : 0; i < axis.size(); ++i) branch_[axis[i].index()] = index;
        SketchBranch branch;
        branch.name = (parent ? "branch " : "stem ") + std::to_string(index + 1);
        branch.parent = parent;
        for (std::uint32_t v = 0; v < sketch_.views.size(); ++v)
            branch.strokes.push_back(make_stroke(axis, v, parent.has_value()));
        sketch_.branches.push_back(std::move(branch));
    }

    Stroke make_stroke(const std::vector<NodeId>& axis, std::uint32_t v, bool lateral) const {
        const SketchView& view = sketch_.views[v];
        Stroke stroke;
        stroke.view = v;
        const auto add = [&](Vec3d p, double radius) {
            const PicturePoint at = project(view, p);
            stroke.points.push_back({rounded(at.x), rounded(at.y)});
            stroke.widths.push_back(std::max(rounded(2 * radius * pixels_per_metre(view, p)), 0.01));
        };
        for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
            const Vec3d a = position(axis[i]), b = position(axis[i + 1]);
            // A lateral has its own radius from its start.
            const double ra = double{skeleton_.radius(axis[lateral && i == 0 ? 1 : i])},
                         rb = double{skeleton_.radius(axis[i + 1])};
            const double way = length(project(view, b) - project(view, a));
            const int pieces = std::max(1, static_cast<int>(std::lround(way / double{options_.spacing})));
            for (int k = 0; k < pieces; ++k)
                add(lerp(a, b, 1.0 * k / pieces), std::lerp(ra, rb, 1.0 * k / pieces));
        }
        add(position(axis.back()), double{skeleton_.radius(axis.back())});
        return stroke;
    }

    const Skeleton& skeleton_;
    const DrawSketchOptions& options_;
    std::vector<std::uint32_t> branch_;  ///< by node
    Sketch sketch_;
};

}  // namespace

std::vector<SketchView> choose_views(const Skeleton& skeleton, const DrawSketchOptions& options) {
    check_fields(options, "sketch");
    const Box3 bounds = skeleton.bounds();
    const Vec3d middle = skeleton.origin() + Vec3d(bounds.center());
    const double radius = std::max(0.5 * double{length(bounds.size())}, 1e-9);
    const double front = -std::numbers::pi / 2;
    return {view_at(front, "front", middle, radius, options),
            view_at(front + double{options.angle}, "side", middle, radius, options)};
}

Sketch draw_sketch(const Skeleton& skeleton, const std::vector<SketchView>& views,
                   const DrawSketchOptions& options) {
    check_fields(options, "sketch");
    return Drawer(skeleton, views, options).run();
}

void list_fields(DrawSketchOptions& o, FieldList& list) {
    list.add(common_field("projection", "Projection of the cameras of both views."), o.projection);
    list.add(common_field("angle", "Angle between the two views, counter-clockwise seen from above.",
                          Unit::radian, 0.01, 3.1),
             o.angle);
    list.add(common_field("size", "Width and height of the pictures in pixels.", Unit::none, 16, 16384),
             o.size);
    list.add(Field{"spacing", "Distance in pixels between the points of a stroke; nodes are points as well.",
                   Unit::none, 0.5, 1000},
             o.spacing);
}

}  // namespace coppice
