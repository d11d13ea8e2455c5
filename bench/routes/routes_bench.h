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
    /// maximum number of timed runs of a route; fewer if they would take longer than `seconds`
    int repeat = 9;
    double seconds = 3;        ///< [s] per route for the timed runs; at least two are made
    double brute_seconds = 2;  ///< [s] per grid for every segment at every corner
    std::uint32_t shrink = 1;  ///< the trees of the papers have 1 / shrink^2 of their segments and triangles,
                               ///< and their grids 1 / shrink of their corners per side
    std::filesystem::path pictures;  ///< folder of images; empty: no images
};

/// One method from a skeleton to a surface, measured.
struct RouteResult {
    std::string name;               ///< "quads", "tetrahedra", "grid", ...
    double size = 0;                ///< [radii] requested edge of the tetrahedra, or [m] cell of the grid
    std::uint64_t tetrahedra = 0;   ///< of the finest level
    std::uint64_t sampled = 0;      ///< vertices of the finest tetrahedra, or corners of the grid
    std::uint64_t peak_bytes = 0;   ///< peak memory above the input
    std::vector<Measure> measures;  ///< "all", then by stage
    SurfaceFigures figures;
    std::optional<BruteForce> brute;

    double seconds() const { return stage("all"); }
    double stage(const std::string& name) const;  ///< [s] median; 0 if there is no such stage
};

/// All routes on one skeleton.
struct RoutesResult {
    std::string scene;
    std::uint64_t segments = 0;
    std::vector<RouteResult> routes;

    const RouteResult* find(const std::string& name) const;  ///< null if there is no such route
};

/// Compares quads and tetrahedra with default options, tetrahedra with two triangles for every quad, and a
/// grid with the same number of triangles as the default tetrahedra. All trees are closed by round ends.
RoutesResult compare_routes(const Scene& scene, const RoutesOptions& options, const Context& ctx);

/// Compares on a synthetic tree with the number of segments and triangles of one of the papers' trees:
/// tetrahedra, the paper's grids if there are any and one with the same number of triangles, and quads.
RoutesResult compare_paper(const PaperTree& tree, const RoutesOptions& options, const Context& ctx);

/// Compares default tetrahedra with the coarsest of a series of grids, each 1.25 times as fine as the
/// previous one, at which no twig is missing or severed.
RoutesResult compare_twigs(const Scene& scene, const RoutesOptions& options, const Context& ctx);

}  // namespace coppice::bench
