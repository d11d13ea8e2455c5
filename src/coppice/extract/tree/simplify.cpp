#include "coppice/extract/tree/simplify_internal.h"

#include <algorithm>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/extract/tree/tree_edit_internal.h"
#include "coppice/skeleton/simplify_chain.h"

namespace coppice::extract_internal {
namespace {

constexpr double kForkSpacing = 0.5;  // [radius] closer forks are merged; they were separated by noise
// [radius] minimum distance of nodes; closer ones have too few samples of their own
constexpr double kMinSpacing = 0.9;

bool is_chain_node(const InitialTree& tree, const InitialTreeLinks& links, std::uint32_t n) {
    return tree.parent[n] != kNoIndex && !tree.fixed[n] && links.children(n).size() == 1;
}

/// Returns the nodes from `first`, the child of a root or fork, to the next fork or tip, preceded by their
/// parent.
std::vector<ChainPoint> chain_from(const InitialTree& tree, const InitialTreeLinks& links,
                                   std::uint32_t first) {
    const std::uint32_t fork = tree.parent[first];
    const bool leads = links.leader(fork) == first;
    std::vector<ChainPoint> chain{{tree.position[fork], tree.radius[leads ? fork : first], fork}};
    for (std::uint32_t n = first;; n = links.children(n)[0]) {
        chain.push_back({tree.position[n], tree.radius[n], n});
        if (!is_chain_node(tree, links, n)) return chain;
    }
}

/// Marks the nodes to keep; moves those that a jump in radius pushes apart.
std::vector<char> choose_nodes(InitialTree& tree, const InitialTreeLinks& links, double tolerance) {
    std::vector<char> kept(tree.size(), 0);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (is_chain_node(tree, links, n)) continue;
        kept[n] = 1;
        for (const std::uint32_t first : links.children(n)) {
            const bool leads = links.leader(n) == first;
            const SimplifiedChain chain =
                simplify_chain(chain_from(tree, links, first),
                               {tolerance, kMinSpacing, leads, leads ? 0 : kMinSpacing * tree.radius[n]});
            for (std::size_t i = 1; i + 1 < chain.points.size(); ++i) {
                kept[chain.points[i].node] = 1;
                tree.position[chain.points[i].node] = chain.points[i].position;
            }
        }
    }
    return kept;
}

/// If the removal of nodes would change the leading child, keeps the first nodes of all children.
void keep_leaders(const InitialTree& tree, const InitialTreeLinks& links, std::vector<char>& kept) {
    const auto first_radius = [&](std::uint32_t n) {
        while (!kept[n]) n = links.children(n)[0];
        return tree.radius[n];
    };
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const auto children = links.children(n);
        if (children.size() < 2) continue;
        const std::uint32_t leader = links.leader(n);
        const double radius = first_radius(leader);
        const bool stays = std::ranges::all_of(children, [&](std::uint32_t c) {
            const double r = first_radius(c);
            return c == leader || r < radius || (r == radius && leader < c);
        });
        if (stays) continue;
        for (const std::uint32_t c : children) kept[c] = 1;
    }
}

}  // namespace

void simplify(InitialTree& tree, FitSamples& samples, double tolerance) {
    remove_reversals(tree, samples);
    merge_forks(tree, samples, kForkSpacing);
    const InitialTreeLinks links(tree);
    std::vector<char> kept = choose_nodes(tree, links, tolerance);
    keep_leaders(tree, links, kept);
    // Only nodes with one child are removed; each is represented by the next kept node towards the tip.
    std::vector<std::uint32_t> parent(tree.size()), image(tree.size(), kNoIndex);
    InitialTree out;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t q = tree.parent[n] == kNoIndex ? kNoIndex : parent[tree.parent[n]];
        parent[n] = kept[n] ? out.add(q, tree.position[n], tree.radius[n], tree.fixed[n]) : q;
        if (kept[n]) image[n] = parent[n];
    }
    for (std::uint32_t n = tree.size(); n-- > 0;)
        if (!kept[n]) image[n] = image[links.children(n)[0]];
    tree = std::move(out);
    for (std::uint32_t& n : samples.node)
        if (n != kNoIndex) n = image[n];
}

}  // namespace coppice::extract_internal
