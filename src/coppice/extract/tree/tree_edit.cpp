#include "coppice/extract/tree/tree_edit_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::extract_internal {
namespace {

/// Returns the tipward node of the thinnest edge on the path between two nodes of one tree: kNoIndex if every
/// edge is thicker than `limit`, or if the nodes belong to different trees.
std::uint32_t thinnest_edge(const InitialTree& t, std::uint32_t a, std::uint32_t b, double limit) {
    std::vector<std::uint32_t> up_a{a}, up_b{b};
    while (t.parent[up_a.back()] != kNoIndex) up_a.push_back(t.parent[up_a.back()]);
    while (t.parent[up_b.back()] != kNoIndex) up_b.push_back(t.parent[up_b.back()]);
    if (up_a.back() != up_b.back()) return kNoIndex;
    while (!up_a.empty() && !up_b.empty() && up_a.back() == up_b.back()) {
        up_a.pop_back();
        up_b.pop_back();
    }
    std::uint32_t best = kNoIndex;
    for (const auto* way : {&up_a, &up_b}) {
        for (const std::uint32_t n : *way) {
            const double r = 0.5 * (t.radius[n] + t.radius[t.parent[n]]);
            if (r >= limit) continue;
            limit = r;
            best = n;
        }
    }
    return best;
}

bool is_ancestor(const InitialTree& t, std::uint32_t ancestor, std::uint32_t n) {
    while (n != kNoIndex && n != ancestor) n = t.parent[n];
    return n == ancestor;
}

/// Returns the nodes with at most one neighbour.
std::vector<std::uint32_t> find_ends(const InitialTree& t, const InitialTreeLinks& links) {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t n = 0; n < t.size(); ++n)
        if (links.children(n).size() + (t.parent[n] != kNoIndex) <= 1) ends.push_back(n);
    return ends;
}

std::vector<std::uint32_t> root_of_each(const InitialTree& t) {
    std::vector<std::uint32_t> root(t.size());
    for (std::uint32_t n = 0; n < t.size(); ++n) root[n] = t.parent[n] == kNoIndex ? n : root[t.parent[n]];
    return root;
}

/// Returns the node at a distance of at least `far` from an end, along the branch that ends there; the next
/// fork if that is closer; the end itself if it is isolated.
std::uint32_t inner_node(const InitialTree& t, const InitialTreeLinks& links, std::uint32_t end, double far) {
    const bool at_root = t.parent[end] == kNoIndex;
    std::uint32_t n = end;
    while (n == end || distance(t.position[n], t.position[end]) < far) {
        const auto children = links.children(n);
        if (at_root ? children.size() != 1 : (n != end && children.size() != 1) || t.parent[n] == kNoIndex)
            break;
        n = at_root ? children[0] : t.parent[n];
    }
    return n;
}

/// Possible attachment of the end of one tree to a segment of another.
struct Attachment {
    double cost;  // distance in radii of the segment
    std::uint32_t end, segment;
    double t;
};

/// Returns for each end the segment of another tree with the closest axis in radii, sorted by distance. The
/// axis of one must be within `reach` radii of the other.
std::vector<Attachment> find_attachments(const InitialTree& tree, std::span<const std::uint32_t> root,
                                         double reach, const Context& ctx) {
    // maximum ratio of radii of the end and the segment without additional cost
    constexpr double kThicker = 1.3;
    // maximum ratio of these radii; prevents a trunk from being attached to a twig
    constexpr double kMuchThicker = 2.5;
    std::vector<std::uint32_t> lower;
    std::vector<Box3> boxes;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t q = tree.parent[n];
        if (q == kNoIndex) continue;
        const double r = reach * std::max(tree.radius[n], tree.radius[q]);
        lower.push_back(n);
        boxes.push_back(capsule_box(Vec3(tree.position[n]), Vec3(tree.position[q]), static_cast<float>(r)));
    }
    std::vector<Attachment> attachments;
    if (boxes.empty() || reach <= 0) return attachments;
    const BoxTree index(boxes, ctx);
    for (const std::uint32_t e : find_ends(tree, InitialTreeLinks(tree))) {
        const double r = tree.radius[e];
        Attachment best{std::numeric_limits<double>::infinity(), e, kNoIndex, 0};
        Box3 at;
        for (const double way : {-reach * r, reach * r})
            at.extend(Vec3(tree.position[e] + Vec3d(way, way, way)));
        index.visit_overlapping(at, [&](std::uint32_t item) {
            const std::uint32_t n = lower[item];
            if (root[n] == root[e]) return;
            const RoundCone::ClosestPoint f = axis_cone(tree, n).closest_point(tree.position[e]);
            const double d = f.distance();
            if (d >= reach * std::max(f.radius, r) || r > kMuchThicker * f.radius) return;
            const double cost = d / f.radius + std::max(0.0, r / f.radius - kThicker);
            if (cost < best.cost || (cost == best.cost && n < best.segment)) best = {cost, e, n, f.t};
        });
        if (best.segment != kNoIndex) attachments.push_back(best);
    }
    std::sort(attachments.begin(), attachments.end(), [](const Attachment& a, const Attachment& b) {
        return a.cost != b.cost ? a.cost < b.cost : a.end < b.end;
    });
    return attachments;
}

/// Removes attachments between trees that are already connected.
void drop_cycles(std::vector<Attachment>& attachments, std::span<const std::uint32_t> root) {
    DisjointSets trees(root.size());
    std::erase_if(attachments,
                  [&](const Attachment& j) { return !trees.join(root[j.end], root[j.segment]); });
}

/// Adds a node for every attachment to its segment; sorts the attachments along segments and returns their
/// nodes.
std::vector<std::uint32_t> add_attachment_nodes(InitialTree& tree, std::vector<Attachment>& attachments) {
    std::sort(attachments.begin(), attachments.end(), [](const Attachment& a, const Attachment& b) {
        return a.segment != b.segment ? a.segment < b.segment : a.t != b.t ? a.t > b.t : a.end < b.end;
    });
    std::vector<std::uint32_t> place;
    for (std::size_t i = 0; i < attachments.size();) {
        const std::uint32_t n = attachments[i].segment, q = tree.parent[n];
        const Vec3d a = tree.position[q], d = tree.position[n] - a;
        const double ra = tree.radius[q], dr = tree.radius[n] - ra;
        std::uint32_t child = n;
        for (; i < attachments.size() && attachments[i].segment == n; ++i) {
            const std::uint32_t x = tree.add(q, a + d * attachments[i].t, ra + dr * attachments[i].t);
            tree.parent[child] = x;
            place.push_back(child = x);
        }
    }
    return place;
}

}  // namespace

std::vector<std::uint32_t> axis_children(const InitialTree& tree) {
    std::vector<std::uint32_t> child(tree.size(), kNoIndex);
    std::vector<double> longest(tree.size(), 0);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t parent = tree.parent[n];
        if (parent == kNoIndex) continue;
        const double way = longest[n] + distance(tree.position[n], tree.position[parent]);
        const std::uint32_t other = child[parent];
        const bool longer = other == kNoIndex || way >= longest[parent];
        longest[parent] = std::max(longest[parent], way);
        // A measured stem is the axis, regardless of the length of its limbs.
        const bool leads =
            other == kNoIndex || tree.fixed[n] == tree.fixed[other] ? longer : tree.fixed[n] != 0;
        if (leads) child[parent] = n;
    }
    return child;
}

std::vector<std::uint32_t> cut_loops(InitialTree& tree,
                                     const std::vector<std::pair<std::uint32_t, std::uint32_t>>& loops,
                                     bool keep) {
    for (const auto& [tip, touched] : loops) {
        const double joint = 0.5 * (tree.radius[tip] + tree.radius[touched]);
        const std::uint32_t cut = thinnest_edge(tree, tip, touched, joint);
        if (cut == kNoIndex) {
            if (keep) tree.add(tip, tree.position[touched], tree.radius[tip]);
            continue;
        }
        // The section tipward of the cut is attached where the loop was open.
        const bool tipward = is_ancestor(tree, cut, tip);
        const std::uint32_t inner = tipward ? tip : touched, outer = tipward ? touched : tip;
        const std::uint32_t from = tree.parent[cut];
        tree.parent[cut] = kNoIndex;
        reroot(tree, inner);
        tree.parent[inner] = outer;
        if (keep) tree.add(cut, tree.position[from], tree.radius[cut]);
    }
    return sort_parents_first(tree);
}

std::uint32_t prune_stubs(InitialTree& tree, FitSamples& samples, double least) {
    const InitialTreeLinks links(tree);
    std::vector<char> gone(tree.size(), 0);
    std::vector<std::uint32_t> stands_for(tree.size());
    std::iota(stands_for.begin(), stands_for.end(), 0u);
    std::uint32_t count = 0;
    for (std::uint32_t tip = 0; tip < tree.size(); ++tip) {
        if (!links.is_tip(tip)) continue;
        std::uint32_t base = tip;
        while (tree.parent[base] != kNoIndex && links.children(tree.parent[base]).size() == 1)
            base = tree.parent[base];
        const std::uint32_t fork = tree.parent[base];
        if (fork == kNoIndex) continue;
        double rise = std::numeric_limits<double>::infinity();
        const auto look = [&](std::uint32_t n) {
            const RoundCone::ClosestPoint f = axis_cone(tree, n).closest_point(tree.position[tip]);
            rise = std::min(rise, f.distance() + tree.radius[tip] - f.radius);
        };
        if (tree.parent[fork] != kNoIndex) look(fork);
        for (const std::uint32_t c : links.children(fork))
            if (c != base && !gone[c]) look(c);
        if (!(rise < least * tree.radius[fork])) continue;
        ++count;
        for (std::uint32_t n = tip; n != fork; n = tree.parent[n]) {
            gone[n] = 1;
            stands_for[n] = fork;
        }
    }
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::uint32_t& n : samples.node)
        if (n != kNoIndex) n = new_of_old[stands_for[n]];
    return count;
}

std::uint32_t remove_reversals(InitialTree& tree, FitSamples& samples) {
    constexpr double kBack = -0.2;  // cosine between the segments
    const InitialTreeLinks links(tree);
    std::vector<char> gone(tree.size(), 0);
    std::vector<std::uint32_t> stands_for(tree.size());
    std::iota(stands_for.begin(), stands_for.end(), 0u);
    std::uint32_t count = 0;
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t parent = tree.parent[n];
        if (parent == kNoIndex || tree.fixed[n] || links.children(n).size() != 1) continue;
        std::uint32_t child = links.children(n)[0];
        while (gone[child]) child = links.children(child)[0];
        const Vec3d in = normalized(tree.position[n] - tree.position[parent], {});
        const Vec3d out = normalized(tree.position[child] - tree.position[n], {});
        if (!(dot(in, out) < kBack)) continue;
        gone[n] = 1;
        stands_for[n] = child;
        tree.parent[child] = parent;
        ++count;
    }
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::uint32_t& n : samples.node)
        if (n != kNoIndex) n = new_of_old[stands_for[n]];
    return count;
}

std::uint32_t merge_forks(InitialTree& tree, FitSamples& samples, double factor) {
    const InitialTreeLinks links(tree);
    std::vector<std::uint32_t> fork(tree.size(),
                                    kNoIndex);  // merged fork of a node, or the next one rootward
    std::vector<char> gone(tree.size(), 0);
    std::uint32_t count = 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t near = tree.parent[n] == kNoIndex ? kNoIndex : fork[tree.parent[n]];
        fork[n] = near;
        if (links.children(n).size() < 2) continue;
        if (near == kNoIndex || !(distance(tree.position[n], tree.position[near]) <
                                  factor * std::max(tree.radius[n], tree.radius[near]))) {
            fork[n] = n;
            continue;
        }
        if (tree.radius[n] > tree.radius[near] && !tree.fixed[near]) {
            tree.position[near] = tree.position[n];
            tree.radius[near] = tree.radius[n];
        }
        for (std::uint32_t i = n; i != near && !gone[i]; i = tree.parent[i]) gone[i] = 1;
        ++count;
    }
    if (count == 0) return 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t parent = tree.parent[n];
        if (!gone[n] && parent != kNoIndex && gone[parent]) tree.parent[n] = fork[parent];
    }
    const auto new_of_old = sort_parents_first(tree, gone);
    for (std::uint32_t& n : samples.node)
        if (n != kNoIndex) n = new_of_old[gone[n] ? fork[n] : n];
    return count;
}

std::uint32_t extend_ends(InitialTree& tree, FitSamples& samples) {
    constexpr double kAround = 1.5, kRim = 0.7, kFlat = 0.15, kMoved = 0.1, kStraight = 1.2;  // [radius]
    struct End {
        std::uint32_t neighbour = kNoIndex;
        Vec3d outward;
        double reach = -1e300, rim = -1e300;
    };
    const InitialTreeLinks links(tree);
    std::vector<End> end(tree.size());
    const auto each = [&](const auto& visit) {
        for (std::size_t i = 0; i < samples.positions.size(); ++i) {
            if (samples.node[i] == kNoIndex) continue;
            for (const std::uint32_t n : {samples.node[i], tree.parent[samples.node[i]]}) {
                if (n == kNoIndex || end[n].neighbour == kNoIndex) continue;
                const Vec3d v = Vec3d(samples.positions[i]) - tree.position[n];
                const double along = dot(v, end[n].outward), across = length(v - end[n].outward * along);
                if (across < kAround * tree.radius[n]) visit(i, n, along, across);
            }
        }
    };
    for (const std::uint32_t n : find_ends(tree, links)) {
        if (tree.fixed[n] && tree.parent[n] == kNoIndex) continue;  // the base of a stem
        const std::uint32_t q = inner_node(tree, links, n, kStraight * tree.radius[n]);
        if (q == n) continue;
        end[n].outward = normalized(tree.position[n] - tree.position[q], {});
        if (length_squared(end[n].outward) > 0) end[n].neighbour = q;
    }
    each([&](std::size_t, std::uint32_t n, double along, double across) {
        end[n].reach = std::max(end[n].reach, along);
        if (across > kRim * tree.radius[n]) end[n].rim = std::max(end[n].rim, along);
    });
    std::uint32_t count = 0;
    std::vector<char> flat(tree.size(), 0);
    std::vector<double> shift(tree.size(), 0);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const End& e = end[n];
        if (e.neighbour == kNoIndex || e.reach < -1e299) continue;
        const double r = tree.radius[n];
        flat[n] = e.rim > e.reach - kFlat * r;
        const double back = -0.9 * distance(tree.position[n], tree.position[e.neighbour]);
        shift[n] = std::max(flat[n] ? e.reach : e.reach - r, std::max(back, -0.5 * r));
        if (std::abs(shift[n]) > kMoved * r) ++count;
    }
    each([&](std::size_t i, std::uint32_t n, double along, double across) {
        if (flat[n] && along > end[n].reach - kFlat * tree.radius[n] && across < 0.9 * tree.radius[n])
            samples.node[i] = kNoIndex;
    });
    for (std::uint32_t n = 0; n < tree.size(); ++n) tree.position[n] += end[n].outward * shift[n];
    return count;
}

std::uint32_t join_trees(InitialTree& tree, double reach, const Context& ctx) {
    const std::vector<std::uint32_t> root = root_of_each(tree);
    std::vector<Attachment> attachments = find_attachments(tree, root, reach, ctx);
    drop_cycles(attachments, root);
    const std::vector<std::uint32_t> place = add_attachment_nodes(tree, attachments);
    for (std::size_t i = 0; i < attachments.size(); ++i) {
        reroot(tree, attachments[i].end);
        tree.parent[attachments[i].end] = place[i];
    }
    return static_cast<std::uint32_t>(attachments.size());
}

void choose_roots(InitialTree& tree, int up, std::optional<Vec3d> wanted) {
    const InitialTreeLinks links(tree);
    const std::vector<std::uint32_t> root = root_of_each(tree);
    const std::vector<std::uint32_t> ends = find_ends(tree, links);
    std::vector<std::uint32_t> chosen(tree.size(), kNoIndex);
    for (const std::uint32_t e : ends) {
        std::uint32_t& best = chosen[root[e]];
        if (best == kNoIndex || tree.position[e][up] < tree.position[best][up]) best = e;
    }
    if (wanted) {
        const auto nearest =
            std::min_element(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) {
                return distance(tree.position[a], *wanted) < distance(tree.position[b], *wanted);
            });
        if (nearest != ends.end()) chosen[root[*nearest]] = *nearest;
    }
    for (const std::uint32_t e : chosen)
        if (e != kNoIndex) reroot(tree, e);
}

std::vector<NodeConfidence> rate_nodes(const InitialTree& tree, const FitSamples& samples, float& residual,
                                       const Context& ctx) {
    const std::vector<float> off = fit_residuals(tree, samples, ctx);
    std::vector<NodeConfidence> confidence(tree.size());
    std::vector<double> sum(tree.size(), 0);
    double total = 0;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < off.size(); ++i) {
        const std::uint32_t n = samples.node[i];
        if (n == kNoIndex) continue;
        const double r = std::abs(off[i]) / tree.radius[n];
        sum[n] += r;
        total += r;
        ++count;
        ++confidence[n].samples;
    }
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (confidence[n].samples > 0)
            confidence[n].residual = static_cast<float>(sum[n] / confidence[n].samples);
    }
    residual = count > 0 ? static_cast<float>(total / static_cast<double>(count)) : 0;
    return confidence;
}

}  // namespace coppice::extract_internal
