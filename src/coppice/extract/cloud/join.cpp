#include <algorithm>
#include <cmath>

#include "coppice/extract/cloud/draft_internal.h"
#include "coppice/extract/cloud/strand_internal.h"
#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kWide = 0.9;  // share of the foot's points within the radius of the root
constexpr double kStraight =
    3;  // [radius] over gaps no wider than that, and two spacings, tubes are joined straight
constexpr double kStraightGap = 2;  // [spacing]
constexpr double kNearEnd = 4;      // [radius + spacing] from its end, where a tube still hangs by that
constexpr double kOfSpacing =
    0.6;  // [spacing] that a tube may be thicker still, before it is a bundle of twigs

class Joiner {
  public:
    Joiner(DraftTree& tree, FitSamples& samples, const Graph& graph, std::span<const float> spacing,
           double step)
        : tree_(tree),
          samples_(samples),
          spacing_(spacing),
          tube_count_(tree.size()),
          tube_(tree.size()),
          strand_(samples.positions, graph, spacing, samples.node, step) {
        const DraftLinks links(tree);
        std::vector<std::uint32_t> tube_of_end(tree.size(), kNone);
        for (std::uint32_t n = 0; n < tube_count_; ++n) {
            tube_[n] = tree.parent[n] == kNone ? n : tube_[tree.parent[n]];
            if (links.children(n).size() + (tree.parent[n] != kNone) <= 1) tube_of_end[n] = tube_[n];
        }
        ends_ = group_by(tube_of_end, tube_count_);
        std::vector<std::uint32_t> tube_of_point(samples.node.size(), kNone);
        length_.assign(tube_count_, 0);
        for (std::size_t p = 0; p < samples.node.size(); ++p)
            if (samples.node[p] != kNone) tube_of_point[p] = tube_[samples.node[p]];
        points_ = group_by(tube_of_point, tube_count_);
        for (std::uint32_t n = 0; n < tube_count_; ++n) {
            if (tree.parent[n] != kNone)
                length_[tube_[n]] += distance(tree.position[n], tree.position[tree.parent[n]]);
        }
    }

    void add_root(std::span<const std::uint32_t> foot);
    void hang_all(const Paths& paths, const Context& ctx);

  private:
    bool hang(std::uint32_t entry, const Paths& paths);
    bool is_bundle(std::uint32_t entry, std::uint32_t end, std::uint32_t owner) const;
    std::uint32_t end_near(std::uint32_t point) const;
    void stand_on(std::uint32_t root, std::uint32_t end);

    DraftTree& tree_;
    FitSamples& samples_;
    std::span<const float> spacing_;
    std::uint32_t tube_count_;                     // nodes of tubes; roots and chains come after them
    std::vector<std::uint32_t> tube_;              // per node of a tube: its first one
    CompressedRows<std::uint32_t> ends_, points_;  // of each tube
    std::vector<double> length_;                   // [m] of each tube
    Strand strand_;
};

void Joiner::add_root(std::span<const std::uint32_t> foot) {
    Vec3d middle;
    for (const std::uint32_t p : foot) middle += Vec3d(samples_.positions[p]);
    middle = middle / static_cast<double>(foot.size());
    std::vector<double> off;
    for (const std::uint32_t p : foot)
        off.push_back(std::hypot(samples_.positions[p].x - middle.x, samples_.positions[p].y - middle.y));
    std::ranges::sort(off);
    const double wide = off[static_cast<std::size_t>(kWide * static_cast<double>(off.size() - 1))];
    const std::uint32_t root = tree_.add(kNone, middle, std::max(wide, 0.1 * double{spacing_[foot[0]]}));
    for (const std::uint32_t p : foot) samples_.node[p] = root;
}

/// The end of a tube that its point is near to, or else the node that is.
std::uint32_t Joiner::end_near(std::uint32_t point) const {
    const Vec3d p(samples_.positions[point]);
    std::uint32_t best = samples_.node[point];
    const std::uint32_t above = tree_.parent[best];
    if (above != kNone && distance(tree_.position[above], p) < distance(tree_.position[best], p))
        best = above;
    double nearest = kNearEnd * (tree_.radius[best] + double{spacing_[point]});
    for (const std::uint32_t e : ends_[tube_[samples_.node[point]]]) {
        const double d = distance(tree_.position[e], p);
        if (d >= nearest) continue;
        nearest = d;
        best = e;
    }
    return best;
}

/// Moves a root to the axis of the tube that stands on it, of which `end` is the root now.
void Joiner::stand_on(std::uint32_t root, std::uint32_t end) {
    const auto child = std::ranges::find(tree_.parent, end) - tree_.parent.begin();
    if (child == tree_.size()) return;
    const Vec3d down = normalized(tree_.position[end] - tree_.position[static_cast<std::size_t>(child)], {});
    const double way = std::max(0.0, dot(tree_.position[root] - tree_.position[end], down));
    tree_.position[root] = tree_.position[end] + down * way;
    tree_.radius[root] = tree_.radius[end];
}

/// Whether a tube is so much thicker than what it hangs on that it is no branch of it.
bool Joiner::is_bundle(std::uint32_t entry, std::uint32_t end, std::uint32_t owner) const {
    if (tree_.parent[owner] == kNone) return false;
    const double radius = tree_.radius[end];
    return radius > kThickerThanBearer * tree_.radius[owner] + kOfSpacing * double{spacing_[entry]} &&
           length_[tube_[samples_.node[entry]]] < kStout * radius;
}

/// Hangs a tube on what the path from its lowest point meets, or takes its points from it.
bool Joiner::hang(std::uint32_t entry, const Paths& paths) {
    const std::uint32_t end = end_near(entry), base = strand_.trace(paths.parent[entry], paths);
    const std::uint32_t owner = samples_.node[base];
    if (is_bundle(entry, end, owner)) {
        for (const std::uint32_t p : points_[tube_[samples_.node[entry]]]) samples_.node[p] = kNone;
        return false;
    }
    root_at(tree_, end);
    const auto path = strand_.path();
    const std::uint32_t last = path.empty() ? base : path.back();
    const double gap =
        strand_.length() + distance(Vec3d(samples_.positions[last]), Vec3d(samples_.positions[entry]));
    if (path.empty() || gap < kStraight * tree_.radius[end] + kStraightGap * strand_.spacing()) {
        if (owner >= tube_count_ && tree_.parent[owner] == kNone) stand_on(owner, end);
        tree_.parent[end] = owner;
        return true;
    }
    strand_.shape(tree_.radius[owner]);
    tree_.parent[end] = strand_.add_to(tree_, samples_.node, owner);
    return true;
}

void Joiner::hang_all(const Paths& paths, const Context& ctx) {
    std::vector<std::uint32_t> entries;
    std::vector<char> gone(tube_count_, 1);
    for (const std::uint32_t p : paths.order) {
        const std::uint32_t n = samples_.node[p];
        if (n >= tube_count_ || !gone[tube_[n]]) continue;
        gone[tube_[n]] = 0;
        entries.push_back(p);
    }
    for (const std::uint32_t p : entries) {
        ctx.throw_if_cancelled();
        const std::uint32_t tube = tube_[samples_.node[p]];
        if (!hang(p, paths)) gone[tube] = 1;
    }
    // Tubes without a point of their own lie inside of others.
    for (std::uint32_t n = 0; n < tube_count_; ++n) gone[n] = gone[tube_[n]];
    gone.resize(tree_.size(), 0);
    const auto new_of_old = sort_parents_first(tree_, gone);
    for (std::uint32_t& n : samples_.node)
        if (n != kNone) n = new_of_old[n];
}

}  // namespace

std::uint64_t join_tubes(DraftTree& tree, FitSamples& samples, const Graph& graph, Feet feet,
                         std::span<const float> spacing, const DraftOptions& options, const Context& ctx) {
    std::vector<std::uint32_t> sources;
    for (const auto& foot : feet) sources.insert(sources.end(), foot.begin(), foot.end());
    const std::vector<std::uint32_t> taken(samples.node.size(), kNone);
    const Paths paths = shortest_paths(graph, sources, taken, spacing, ctx);
    Joiner joiner(tree, samples, graph, spacing, options.step);
    for (const auto& foot : feet) joiner.add_root(foot);
    joiner.hang_all(paths, ctx);
    return paths.order.size();
}

}  // namespace coppice::extract_internal
