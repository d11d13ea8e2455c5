#include <algorithm>
#include <cmath>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/cloud/bins_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kBinsGrain = 256;

std::uint32_t find_mode(std::vector<std::uint32_t>& values) {
    std::ranges::sort(values);
    std::uint32_t best = kNoIndex;
    std::size_t most = 0;
    for (std::size_t i = 0, j = 0; i < values.size(); i = j) {
        while (j < values.size() && values[j] == values[i]) ++j;
        if (j - i > most) {
            most = j - i;
            best = values[i];
        }
    }
    return best;
}

/// Returns the bin of every point on a path: its cost in steps.
std::vector<std::uint32_t> assign_bins(const Paths& paths, double step) {
    std::vector<std::uint32_t> bin(paths.distance.size(), kNoIndex);
    for (const std::uint32_t p : paths.order)
        bin[p] = static_cast<std::uint32_t>(std::min(double{paths.distance[p]} / step, 4e9));
    return bin;
}

/// Joins the points of each bin that are connected by short links, and those of each stem base.
DisjointSets connected_in_bins(std::span<const std::uint32_t> bin, const Graph& graph, const Paths& paths,
                               const BinRule& rule, const Context& ctx) {
    DisjointSets sets(bin.size());
    for (const auto& base : rule.bases) {
        for (const std::uint32_t p : base) sets.join(p, base[0]);
    }
    std::size_t turn = 0;
    for (const std::uint32_t p : paths.order) {
        poll_stop(ctx, turn++);
        for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
            const std::uint32_t q = graph.to[e];
            if (q < p && bin[q] == bin[p] &&
                graph.length[e] <= rule.link * std::max(rule.spacing[p], rule.spacing[q]))
                sets.join(p, q);
        }
    }
    return sets;
}

/// Numbers the sets of the points on paths by bins, so that parents precede; returns their number.
std::size_t number_sets(DisjointSets& sets, std::span<const std::uint32_t> bin, const Paths& paths,
                        std::vector<std::uint32_t>& bin_set) {
    std::vector<std::uint32_t> heads;
    for (const std::uint32_t p : paths.order) {
        if (sets.find(p) == p) heads.push_back(p);
    }
    std::ranges::stable_sort(heads, {}, [&](std::uint32_t p) { return bin[p]; });
    std::vector<std::uint32_t> number(bin.size(), kNoIndex);
    for (std::uint32_t i = 0; i < heads.size(); ++i) number[heads[i]] = i;
    bin_set.assign(bin.size(), kNoIndex);
    for (const std::uint32_t p : paths.order) bin_set[p] = number[sets.find(p)];
    return heads.size();
}

/// Sets position, radius and parent of a node from its points.
void place_node(CloudTree& tree, std::uint32_t n, std::span<const Vec3> points,
                std::span<const std::uint32_t> members, const Paths& paths,
                std::vector<std::uint32_t>& parents) {
    parents.clear();
    Vec3d sum;
    for (const std::uint32_t p : members) {
        sum += Vec3d(points[p]);
        if (paths.parent[p] == kNoIndex) continue;
        const std::uint32_t from = tree.node_of_point[paths.parent[p]];
        if (from != n) parents.push_back(from);
    }
    const auto size = static_cast<double>(members.size());
    tree.parent[n] = find_mode(parents);
    tree.position[n] = sum / size;
    double squared = 0;
    for (const std::uint32_t p : members) squared += length_squared(Vec3d(points[p]) - tree.position[n]);
    tree.radius[n] = std::sqrt(squared / size);
}

}  // namespace

void bin_paths(CloudTree& tree, std::span<const Vec3> points, const Graph& graph, const Paths& paths,
               const BinRule& rule, const Context& ctx) {
    const std::vector<std::uint32_t> bin = assign_bins(paths, rule.step);
    DisjointSets sets = connected_in_bins(bin, graph, paths, rule, ctx);
    std::vector<std::uint32_t> bin_set;
    const std::size_t count = number_sets(sets, bin, paths, bin_set);
    const auto members = group_by(bin_set, count);
    const std::uint32_t first = tree.size();
    for (const std::uint32_t p : paths.order) tree.node_of_point[p] = first + bin_set[p];
    for (std::size_t i = 0; i < count; ++i) tree.add(kNoIndex, {});
    parallel_for_ranges(ctx, count, kBinsGrain, [&](IndexRange range) {
        std::vector<std::uint32_t> parents;
        for (std::size_t i = range.begin; i < range.end; ++i)
            place_node(tree, first + static_cast<std::uint32_t>(i), points, members[i], paths, parents);
    });
}

}  // namespace coppice::extract_internal
