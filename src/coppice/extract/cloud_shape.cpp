#include "coppice/extract/cloud_shape_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/extract/cloud_fit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kRough = 1.4;        // times the reach that a twig on a tube that was found before must have
constexpr std::uint32_t kFewest = 3;  // points of a twig
constexpr float kFitted = 6;          // points of a circle that counts
constexpr double kCleanFit = 0.1;     // [radius] greatest residual of a circle that counts
constexpr double kLoose = 0.65;       // radius of a tube, of the mean distance of points that show none

bool is_fitted(const CloudTree& tree, std::uint32_t n) {
    return tree.weight[n] >= kFitted && tree.residual[n] < kCleanFit * tree.radius[n];
}

std::vector<std::uint32_t> points_beyond(const CloudTree& tree) {
    std::vector<std::uint32_t> count(tree.size(), 0);
    for (const std::uint32_t n : tree.node_of_point) {
        if (n != kNone) ++count[n];
    }
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        if (tree.parent[n] != kNone) count[tree.parent[n]] += count[n];
    }
    return count;
}

}  // namespace

std::uint32_t prune_twigs(CloudTree& tree, std::uint32_t first, std::span<const float> level, double reach) {
    const auto beyond = points_beyond(tree);
    std::vector<float> top(tree.size(), 0), low(tree.size(), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < level.size(); ++i) {
        const std::uint32_t n = tree.node_of_point[i];
        if (n == kNone || n < first) continue;
        top[n] = std::max(top[n], level[i]);
        low[n] = std::min(low[n], level[i]);
    }
    std::vector<std::uint32_t> next(tree.size(), kNone);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t above = tree.parent[n];
        if (above == kNone) continue;
        if (next[above] == kNone || top[n] >= top[next[above]]) next[above] = n;
        top[above] = std::max(top[above], top[n]);
    }
    std::vector<std::uint8_t> kept(tree.size(), 1);
    std::uint32_t gone = 0;
    for (std::uint32_t n = first; n < tree.size(); ++n) {
        const std::uint32_t above = tree.parent[n];
        if (above == kNone) continue;
        kept[n] = kept[above];
        const bool on_tube = above < first;
        if (!kept[n] || (next[above] == n && !on_tube)) continue;
        const double least = on_tube ? kRough * reach : reach;
        if (top[n] - low[n] >= least && beyond[n] >= kFewest) continue;
        kept[n] = 0;
        ++gone;
    }
    keep_nodes(tree, kept, true);
    return gone;
}

std::uint32_t prune_roughness(CloudTree& tree, double length) {
    std::vector<double> longest;
    const auto next = axis_children(tree, longest);
    // Whether a clean tube lies on the branch from a node on, or leaves it.
    std::vector<std::uint8_t> clean(tree.size(), 0), kept(tree.size(), 1);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        clean[n] |= is_fitted(tree, n);
        if (tree.parent[n] != kNone && clean[n]) clean[tree.parent[n]] = 1;
    }
    std::uint32_t gone = 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t above = tree.parent[n];
        if (above == kNone) continue;
        kept[n] = kept[above];
        if (!kept[n] || next[above] == n || clean[n] || !is_fitted(tree, above)) continue;
        const double out = longest[n] + distance(tree.position[n], tree.position[above]) - tree.radius[above];
        if (out >= length * tree.radius[above]) continue;
        kept[n] = 0;
        ++gone;
    }
    keep_nodes(tree, kept, true);
    return gone;
}

namespace {

/// A place on the segment that ends at `node`.
struct Place {
    std::uint32_t node = kNone;
    double t = 1;  ///< from the parent, 0, to the node, 1
    double cost = std::numeric_limits<double>::infinity();
};

/// Looks for the place on a segment from which a way to `start` is short and leads on as `direction` does.
void try_segment(const CloudTree& tree, std::uint32_t node, Vec3d start, Vec3d direction, Place& best) {
    if (tree.parent[node] == kNone) return;
    const Vec3d a = tree.position[tree.parent[node]], b = tree.position[node];
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const Vec3d way = start - lerp(a, b, t);
        const double l = length(way);
        const double cost = 2 * l - dot(way, direction);
        if (cost < best.cost) best = {node, t, cost};
    }
}

/// Puts parents first again.
void sort_nodes(CloudTree& tree) {
    std::vector<std::uint32_t> order, image(tree.size());
    order.reserve(tree.size());
    const Rows children = group_by(tree.parent, tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.parent[n] == kNone) order.push_back(n);
    }
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (const std::uint32_t c : children.of(order[i])) order.push_back(c);
    }
    CloudTree out;
    for (const std::uint32_t n : order) {
        image[n] = out.add(tree.parent[n] == kNone ? kNone : image[tree.parent[n]], tree.position[n]);
        out.radius.back() = tree.radius[n];
        out.weight.back() = tree.weight[n];
        out.residual.back() = tree.residual[n];
    }
    for (std::uint32_t& n : tree.node_of_point) {
        if (n != kNone) n = image[n];
    }
    out.node_of_point = std::move(tree.node_of_point);
    tree = std::move(out);
}

}  // namespace

std::uint32_t repair_forks(CloudTree& tree) {
    std::vector<double> longest;
    const auto next = axis_children(tree, longest);
    const auto direction = axis_directions(tree, next);
    const std::uint32_t count = tree.size();
    struct Move {
        std::uint32_t lateral;
        Place to;
    };
    std::vector<Move> moves;
    for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t above = tree.parent[n];
        if (above == kNone || next[above] == n || next[n] == kNone) continue;
        const double reach = 3 * tree.radius[above] + distance(tree.position[n], tree.position[above]);
        Place best;
        std::uint32_t q = above;
        for (double way = 0; q != kNone && way < reach; q = tree.parent[q]) {
            try_segment(tree, q, tree.position[n], direction[n], best);
            if (tree.parent[q] != kNone) way += distance(tree.position[q], tree.position[tree.parent[q]]);
        }
        q = next[above];
        for (double way = 0; q != kNone && way < reach; q = next[q]) {
            try_segment(tree, q, tree.position[n], direction[n], best);
            way += distance(tree.position[q], tree.position[tree.parent[q]]);
        }
        if (best.node != kNone) moves.push_back({n, best});
    }
    // Several laterals of one segment: its new nodes follow one another.
    std::ranges::stable_sort(moves, [](const Move& a, const Move& b) {
        return a.to.node != b.to.node ? a.to.node < b.to.node : a.to.t < b.to.t;
    });
    for (std::size_t i = 0; i < moves.size(); ++i) {
        const auto [lateral, to] = moves[i];
        if (to.t == 0 || to.t == 1) {
            const std::uint32_t end = to.t == 1 ? to.node : tree.parent[to.node];
            tree.parent[lateral] = end;
            continue;
        }
        const std::uint32_t above = tree.parent[to.node];
        const bool same = i > 0 && moves[i - 1].to.node == to.node && moves[i - 1].to.t == to.t;
        if (same) {
            tree.parent[lateral] = above;
            continue;
        }
        const double first = i > 0 && moves[i - 1].to.node == to.node ? moves[i - 1].to.t : 0;
        const double t = (to.t - first) / (1 - first);
        const std::uint32_t middle = tree.add(above, lerp(tree.position[above], tree.position[to.node], t));
        tree.radius[middle] = std::lerp(tree.radius[above], tree.radius[to.node], t);
        tree.weight[middle] = std::min(tree.weight[above], tree.weight[to.node]);
        tree.residual[middle] = tree.residual[to.node];
        tree.parent[to.node] = middle;
        tree.parent[lateral] = middle;
    }
    sort_nodes(tree);
    return static_cast<std::uint32_t>(moves.size());
}

std::uint32_t extend_ends(CloudTree& tree, std::span<const Vec3> points) {
    std::vector<double> longest;
    const auto next = axis_children(tree, longest);
    const auto direction = axis_directions(tree, next);
    const Rows members = group_by(tree.node_of_point, tree.size());
    std::uint32_t moved = 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const bool tip = next[n] == kNone, root = tree.parent[n] == kNone;
        if (tip == root) continue;  // inner nodes, and trees of one node
        const Vec3d out = tip ? direction[n] : -direction[n];
        double far = 0;
        std::size_t count = 0;
        for (const std::uint32_t p : members.of(n)) {
            far = std::max(far, dot(Vec3d(points[p]) - tree.position[n], out));
            ++count;
        }
        if (count == 0 || !(far > 0)) continue;
        // The last of evenly strewn points lies short of the end by about one gap.
        tree.position[n] += out * (far * (1 + 1.0 / static_cast<double>(count)));
        ++moved;
    }
    return moved;
}

namespace {

/// Weighted isotonic regression: values that never rise, nearest in squares.
void fall(std::vector<double>& value, std::vector<double>& weight) {
    struct Block {
        double mean, weight;
        std::size_t count;
    };
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < value.size(); ++i) {
        blocks.push_back({value[i], weight[i], 1});
        while (blocks.size() > 1 && blocks[blocks.size() - 2].mean < blocks.back().mean) {
            const Block b = blocks.back();
            blocks.pop_back();
            Block& a = blocks.back();
            a.mean = (a.mean * a.weight + b.mean * b.weight) / (a.weight + b.weight);
            a.weight += b.weight;
            a.count += b.count;
        }
    }
    std::size_t i = 0;
    for (const Block& b : blocks) {
        for (std::size_t k = 0; k < b.count; ++k) value[i++] = b.mean;
    }
}

double median_of(std::vector<double> v) {
    std::ranges::nth_element(v, v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2));
    return v[v.size() / 2];
}

/// ln r = a + b ln(length beyond), from the nodes with good fits.
struct Allometry {
    double a = 0, b = 0;
    double radius(double beyond) const { return std::exp(a + b * std::log(beyond)); }
};

Allometry allometry_of(const CloudTree& tree, std::span<const double> beyond, double floor) {
    double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (!is_fitted(tree, n) || !(beyond[n] > 0)) continue;
        const double w = std::min(tree.weight[n], 100.0f), x = std::log(beyond[n]),
                     y = std::log(tree.radius[n]);
        sw += w;
        sx += w * x;
        sy += w * y;
        sxx += w * x * x;
        sxy += w * x * y;
    }
    if (sw == 0) return {std::log(floor), 0};
    const double var = sxx / sw - sx / sw * sx / sw;
    Allometry fit;
    fit.b = var > 1e-6 ? std::clamp((sxy / sw - sx / sw * sy / sw) / var, 0.0, 1.5) : 0;
    fit.a = (sy - fit.b * sx) / sw;
    return fit;
}

}  // namespace

void settle_radii(CloudTree& tree, double least_radius) {
    std::vector<double> longest, beyond(tree.size(), 0);
    const auto next = axis_children(tree, longest);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t above = tree.parent[n];
        if (above != kNone) beyond[above] += beyond[n] + distance(tree.position[n], tree.position[above]);
    }
    const Allometry law = allometry_of(tree, beyond, least_radius);
    std::vector<double> value, weight;
    std::vector<std::uint32_t> axis;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t above = tree.parent[n];
        if (above != kNone && next[above] == n) continue;
        axis.clear();
        value.clear();
        weight.clear();
        for (std::uint32_t m = n; m != kNone; m = next[m]) axis.push_back(m);
        for (const std::uint32_t m : axis) {
            const bool fitted = is_fitted(tree, m);
            const double guess = law.radius(std::max(beyond[m], 0.5 * least_radius));
            value.push_back(fitted               ? tree.radius[m]
                            : tree.radius[m] > 0 ? std::min(guess, kLoose * tree.radius[m])
                                                 : guess);
            weight.push_back(fitted ? double{tree.weight[m]} : 1.0);
        }
        std::vector<double> even = value;
        for (std::size_t i = 0; i < value.size(); ++i) {
            const std::size_t first = i < 2 ? 0 : i - 2, last = std::min(i + 3, value.size());
            even[i] = median_of({value.begin() + static_cast<std::ptrdiff_t>(first),
                                 value.begin() + static_cast<std::ptrdiff_t>(last)});
        }
        fall(even, weight);
        const double most = above == kNone ? std::numeric_limits<double>::infinity() : tree.radius[above];
        for (std::size_t i = 0; i < axis.size(); ++i)
            tree.radius[axis[i]] = std::max(std::min(even[i], most), least_radius);
    }
}

}  // namespace coppice::extract_internal
