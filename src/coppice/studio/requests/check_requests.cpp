#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/base/progress.h"
#include "coppice/measure/surface_report.h"
#include "coppice/options/figures.h"
#include "coppice/studio/session_internal.h"

namespace coppice::studio_internal {
namespace {

std::string format_verdict(const SurfaceReport& report) {
    if (report.crossing_places && report.crossing_places->total > 0)
        return fmt::format("It intersects itself at {} places.", report.crossing_places->total);
    if (!report.sound()) return "It is not closed, or its faces are not consistent.";
    if (!report.covers_skeleton()) return "Branches of its skeleton are missing.";
    if (!report.is_whole()) return "It has more components than there are trees.";
    if (!report.joins_branches()) return "Branches of its skeleton are severed.";
    if (!report.reaches_tips()) return "It ends before tips of its skeleton.";
    if (!report.holds_volume()) return "Its volume differs from that of its skeleton.";
    return "It is closed, free of self-intersections, and has all branches.";
}

Json check(Studio& studio, const Request& request) {
    constexpr int kPlaces = 100;
    constexpr float kMade = 0.5f;  // of the time
    const ObjectPtr object = studio.object(request.kind(), request.text("name"));
    const ObjectPtr made = make_surface(studio, {object->kind(), request.text("name")},
                                        surface_options(request), narrow_progress(request.ctx, 0, kMade));
    const auto* surface = std::get_if<Surface>(&made->value);
    if (surface == nullptr) throw InvalidInput("only meshes, skeletons and solids can be checked");
    CheckOptions options;
    options.max_places = kPlaces;
    const std::string judge = request.text("skeleton", "");
    const ObjectPtr judged = judge.empty() ? object : studio.object(ObjectKind::skeleton, judge);
    const auto* tree = std::get_if<Skeleton>(&judged->value);
    const SurfaceReport report =
        check_surface(make_polygons(*surface), tree, options, narrow_progress(request.ctx, kMade, 1));
    Json places = Json::array();
    if (report.crossing_places) {
        for (const CrossingPlace& p : report.crossing_places->largest)
            places.push_back({p.place.x, p.place.y, p.place.z});
    }
    return {{"figures", compute_figures(report)},
            {"good", report.passes()},
            {"verdict", format_verdict(report)},
            {"crossings", places}};
}

}  // namespace

std::map<std::string, Handler> check_requests() { return {{"check", check}}; }

}  // namespace coppice::studio_internal
