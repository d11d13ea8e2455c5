#include <algorithm>
#include <cmath>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/cloud/centerline_internal.h"
#include "coppice/extract/cloud/initial_tree_internal.h"
#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kWide = 0.9;       // share of the points of a stem base within the radius of the root
constexpr double kStraight = 3;     // [radius] maximum gap across which tubes are attached straight
constexpr double kStraightGap = 2;  // [spacing] added to this gap
// [radius + spacing] maximum distance from an end at which a tube is attached by that end
constexpr double kNearEnd = 4;
constexpr double kOfSpacing = 0.6;  // [spacing] additional radius of a tube that is not a bundle of twigs

/// Loose tubes, each identified by its first node. Roots and branches are added after their nodes.
struct Tubes {
    std::uint32_t count = 0;                     // number of nodes of tubes
    std::vector<std::uint32_t> of_node;          // tube of each node
    CompressedRows<std::uint32_t> ends, points;  // of each tube
    std::vector<double> length;                  // [m] of each tube
};

Tubes make_tubes(const InitialTree& tree, const FitSamples& samples) {
    Tubes tubes{
        tree.size(), std::vector<std::uint32_t>(tree.size()), {}, {}, std::vector<double>(tree.size(), 0)};
    const InitialTreeLinks links(tree);
    std::vector<std::uint32_t> tube_of_end(tree.size(), kNoIndex);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        tubes.of_node[n] = tree.parent[n] == kNoIndex ? n : tubes.of_node[tree.parent[n]];
        if (links.children(n).size() + (tree.parent[n] != kNoIndex) <= 1) tube_of_end[n] = tubes.of_node[n];
        if (tree.parent[n] != kNoIndex)
            tubes.length[tubes.of_node[n]] += distance(tree.position[n], tree.position[tree.parent[n]]);
    }
    tubes.ends = group_by(tube_of_end, tree.size());
    std::vector<std::uint32_t> tube_of_point(samples.node.size(), kNoIndex);
    for (std::size_t p = 0; p < samples.node.size(); ++p)
        if (samples.node[p] != kNoIndex) tube_of_point[p] = tubes.of_node[samples.node[p]];
    tubes.points = group_by(tube_of_point, tree.size());
    return tubes;
}

/// Adds a root in the middle of a stem base and assigns the points of the base to it.
void add_root(InitialTree& tree, FitSamples& samples, std::span<const std::uint32_t> base,
              std::span<const float> spacing) {
    Vec3d middle;
    for (const std::uint32_t p : base) middle += Vec3d(samples.positions[p]);
    middle = middle / static_cast<double>(base.size());
    std::vector<double> off;
    for (const std::uint32_t p : base)
        off.push_back(std::hypot(samples.positions[p].x - middle.x, samples.positions[p].y - middle.y));
    std::ranges::sort(off);
    const double wide = off[static_cast<std::size_t>(kWide * static_cast<double>(off.size() - 1))];
    const std::uint32_t root = tree.add(kNoIndex, middle, std::max(wide, 0.1 * double{spacing[base[0]]}));
    for (const std::uint32_t p : base) samples.node[p] = root;
}

/// Returns the end of a tube close to the point; otherwise the closest node of its segment.
std::uint32_t end_near(const InitialTree& tree, const FitSamples& samples, const Tubes& tubes,
                       std::uint32_t point, double spacing) {
    const Vec3d p(samples.positions[point]);
    std::uint32_t best = samples.node[point];
    const std::uint32_t parent = tree.parent[best];
    if (parent != kNoIndex && distance(tree.position[parent], p) < distance(tree.position[best], p))
        best = parent;
    double nearest = kNearEnd * (tree.radius[best] + spacing);
    for (const std::uint32_t e : tubes.ends[tubes.of_node[samples.node[point]]]) {
        const double d = distance(tree.position[e], p);
        if (d >= nearest) continue;
        nearest = d;
        best = e;
    }
    return best;
}

/// Moves a root onto the axis of the tube above it, which has the root `end`.
void align_root(InitialTree& tree, std::uint32_t root, std::uint32_t end) {
    const auto child = std::ranges::find(tree.parent, end) - tree.parent.begin();
    if (child == tree.size()) return;
    const Vec3d down = normalized(tree.position[end] - tree.position[static_cast<std::size_t>(child)], {});
    const double way = std::max(0.0, dot(tree.position[root] - tree.position[end], down));
    tree.position[root] = tree.position[end] + down * way;
    tree.radius[root] = tree.radius[end];
}

/// Returns whether a tube of this radius and length is so much thicker than its parent branch that it is a
/// bundle of twigs.
bool is_bundle(const InitialTree& tree, std::uint32_t owner, double radius, double tube_length,
               double spacing) {
    if (tree.parent[owner] == kNoIndex) return false;
    return radius > kThickerThanBearer * tree.radius[owner] + kOfSpacing * spacing &&
           tube_length < kStout * radius;
}

/// Attaches the tube of point `entry` to the end of the path from there; for a bundle, unassigns its points
/// and returns false.
bool attach_tube(InitialTree& tree, FitSamples& samples, const Tubes& tubes, BranchPoints& points,
                 std::uint32_t entry, const Paths& paths) {
    const double spacing = double{points.spacing[entry]};
    const std::uint32_t tube = tubes.of_node[samples.node[entry]];
    const std::uint32_t end = end_near(tree, samples, tubes, entry, spacing);
    Centerline branch;
    const std::uint32_t start = trace_path(branch, points, paths.parent[entry], paths);
    const std::uint32_t owner = samples.node[start];
    if (is_bundle(tree, owner, tree.radius[end], tubes.length[tube], spacing)) {
        for (const std::uint32_t p : tubes.points[tube]) samples.node[p] = kNoIndex;
        return false;
    }
    reroot(tree, end);
    const std::uint32_t last = branch.path.empty() ? start : branch.path.back();
    const double gap =
        line_length(branch) + distance(Vec3d(samples.positions[last]), Vec3d(samples.positions[entry]));
    if (branch.path.empty() || gap < kStraight * tree.radius[end] + kStraightGap * branch.spacing) {
        if (owner >= tubes.count && tree.parent[owner] == kNoIndex) align_root(tree, owner, end);
        tree.parent[end] = owner;
        return true;
    }
    fit_centerline(branch, points, tree.radius[owner]);
    tree.parent[end] = add_branch(branch, tree, samples.node, owner);
    return true;
}

/// Returns the first point of every tube reached by paths, in their order.
std::vector<std::uint32_t> find_entries(const FitSamples& samples, const Tubes& tubes, const Paths& paths) {
    std::vector<std::uint32_t> entries;
    std::vector<char> entered(tubes.count, 0);
    for (const std::uint32_t p : paths.order) {
        const std::uint32_t n = samples.node[p];
        if (n >= tubes.count || entered[tubes.of_node[n]]) continue;
        entered[tubes.of_node[n]] = 1;
        entries.push_back(p);
    }
    return entries;
}

}  // namespace

std::uint64_t attach_tubes(InitialTree& tree, FitSamples& samples, const CloudInput& cloud,
                           std::span<const std::uint32_t> standing, bool add_roots, const Context& ctx) {
    std::vector<std::uint32_t> sources;
    const auto is_linked = [&](std::uint32_t p) { return cloud.graph.first[p] < cloud.graph.first[p + 1]; };
    for (std::uint32_t p = 0; p < samples.node.size(); ++p)
        if (samples.node[p] != kNoIndex && tree.fixed[samples.node[p]] && is_linked(p)) sources.push_back(p);
    for (const auto& base : cloud.bases) sources.insert(sources.end(), base.begin(), base.end());
    const std::vector<std::uint32_t> taken(samples.node.size(), kNoIndex);
    Paths paths;
    Tubes tubes;
    parallel_for(ctx, 2, 1, [&](std::size_t part) {
        if (part == 0) {
            paths = shortest_paths(cloud.graph, sources, taken, cloud.cost(samples.positions), ctx);
        } else {
            tubes = make_tubes(tree, samples);
        }
    });
    if (add_roots)
        for (const auto& base : cloud.bases) add_root(tree, samples, base, cloud.spacing);
    BranchPoints points{samples.positions, cloud.graph,        cloud.spacing,
                        samples.node,      cloud.options.step, cloud.options.narrow};
    std::vector<char> attached(tubes.count, 0);
    for (const std::uint32_t root : standing) attached[root] = 1;
    for (const std::uint32_t p : find_entries(samples, tubes, paths)) {
        ctx.throw_if_cancelled();
        const std::uint32_t tube = tubes.of_node[samples.node[p]];
        if (attached[tube]) continue;
        attached[tube] = attach_tube(tree, samples, tubes, points, p, paths);
    }
    // Tubes without own points are inside others.
    std::vector<char> gone(tree.size(), 0);
    for (std::uint32_t n = 0; n < tubes.count; ++n) gone[n] = !attached[tubes.of_node[n]];
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::uint32_t& n : samples.node)
        if (n != kNoIndex) n = new_of_old[n];
    return paths.order.size();
}

}  // namespace coppice::extract_internal
