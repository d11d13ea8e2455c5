#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "measure.h"
#include "routes_grid.h"
#include "routes_papers.h"
#include "routes_surface.h"
#include "scenes.h"

namespace coppice::bench {

struct RoutesOptions {
    int repeat = 9;            ///< timed runs of a route; fewer where they would take longer than `seconds`
    double seconds = 3;        ///< [s] per route for the timed runs; two are made at least
    double brute_seconds = 2;  ///< [s] per grid for every segment at every corner
    std::uint32_t shrink = 1;  ///< the papers' trees have 1 / shrink^2 of their segments and triangles, and
                               ///< their grids 1 / shrink of their corners a side
    std::filesystem::path pictures;  ///< where pictures are put; none when empty
};

/// One way from a skeleton to a surface, measured.
struct RouteResult {
    std::string name;               ///< "quads", "tetrahedra", "grid", ...
    double size = 0;                ///< [radii] wish for the tetrahedra's edges, or [m] cell of the grid
    std::uint64_t tetrahedra = 0;   ///< of the finest level
    std::uint64_t sampled = 0;      ///< vertices of the finest tetrahedra, or corners of the grid
    std::uint64_t peak_bytes = 0;   ///< memory in use at the worst moment, above the input
    std::vector<Measure> measures;  ///< "all", then stage by stage
    SurfaceFigures figures;
    std::optional<BruteForce> brute;

    double seconds() const { return stage("all"); }
    double stage(const std::string& name) const;  ///< [s] median; 0 when there is none
};

/// All routes on one skeleton.
struct RoutesResult {
    std::string scene;
    std::uint64_t segments = 0;
    std::vector<RouteResult> routes;

    const RouteResult* find(const std::string& name) const;  ///< null when there is none
};

/// Quads and tetrahedra with default options, tetrahedra with two triangles for every quad, and a grid with
/// as many triangles as the default tetrahedra. All trees are closed by round ends.
RoutesResult compare_routes(const Scene& scene, const RoutesOptions& options, const Context& ctx);

/// A made-up tree of as many segments as one of the papers', with as many triangles: tetrahedra, the paper's
/// grids where there are any and one with as many triangles, and quads.
RoutesResult compare_paper(const PaperTree& tree, const RoutesOptions& options, const Context& ctx);

/// Default tetrahedra beside the coarsest of a row of grids, each 1.25 times as fine as the one before, at
/// which no twig is missing or severed.
RoutesResult compare_twigs(const Scene& scene, const RoutesOptions& options, const Context& ctx);

}  // namespace coppice::bench
