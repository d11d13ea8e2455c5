#include <algorithm>
#include <cmath>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/extract/cloud/tree_internal.h"
#include "coppice/extract/stage_internal.h"

namespace coppice::extract_internal {
namespace {

class Binner {
  public:
    Binner(std::span<const Vec3> points, const Graph& graph, const Paths& paths,
           std::span<const float> spacing, Cut cut, const Context& ctx)
        : link_(cut.link),
          points_(points),
          graph_(graph),
          paths_(paths),
          spacing_(spacing),
          ctx_(ctx),
          level_(points.size(), kNone),
          set_(points.size()) {
        for (const std::uint32_t p : paths.order) {
            level_[p] = static_cast<std::uint32_t>(std::min(double{paths.distance[p]} / cut.step, 4e9));
        }
    }

    void run(std::span<const std::vector<std::uint32_t>> roots, CloudTree& tree) {
        for (const auto& root : roots) {
            for (const std::uint32_t p : root) set_.join(p, root[0]);
        }
        std::size_t turn = 0;
        for (const std::uint32_t p : paths_.order) {
            poll_stop(ctx_, turn++);
            for (std::uint32_t e = graph_.first[p]; e < graph_.first[p + 1]; ++e) {
                const std::uint32_t q = graph_.to[e];
                if (level_[q] == level_[p] && graph_.length[e] <= link_ * std::max(spacing_[p], spacing_[q]))
                    set_.join(p, q);
            }
        }
        add_nodes(tree);
    }

  private:
    void add_nodes(CloudTree& tree) {
        // Pieces by level, so that parents come first.
        std::vector<std::uint32_t> heads;
        for (const std::uint32_t p : paths_.order) {
            if (set_.find(p) == p) heads.push_back(p);
        }
        std::ranges::stable_sort(heads, {}, [&](std::uint32_t p) { return level_[p]; });
        std::vector<std::uint32_t> piece(points_.size(), kNone);
        for (std::uint32_t i = 0; i < heads.size(); ++i) piece[heads[i]] = i;
        std::vector<std::uint32_t> piece_of(points_.size(), kNone);
        for (const std::uint32_t p : paths_.order) piece_of[p] = piece[set_.find(p)];
        const auto members = group_by(piece_of, heads.size());
        const std::uint32_t first = tree.size();
        for (const std::uint32_t p : paths_.order) tree.node_of_point[p] = first + piece_of[p];
        std::vector<std::uint32_t> below;
        for (std::uint32_t i = 0; i < heads.size(); ++i) {
            poll_stop(ctx_, i);
            below.clear();
            Vec3d sum;
            for (const std::uint32_t p : members[i]) {
                sum += Vec3d(points_[p]);
                if (paths_.parent[p] == kNone) continue;
                const std::uint32_t from = tree.node_of_point[paths_.parent[p]];
                if (from != first + i) below.push_back(from);
            }
            const auto count = static_cast<double>(members[i].size());
            const std::uint32_t n = tree.add(most_frequent(below), sum / count);
            double squared = 0;
            for (const std::uint32_t p : members[i])
                squared += length_squared(Vec3d(points_[p]) - tree.position[n]);
            tree.radius[n] = std::sqrt(squared / count);
        }
    }

    static std::uint32_t most_frequent(std::vector<std::uint32_t>& values) {
        std::ranges::sort(values);
        std::uint32_t best = kNone;
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

    double link_;  // [spacing] longest that holds a piece together
    std::span<const Vec3> points_;
    const Graph& graph_;
    const Paths& paths_;
    std::span<const float> spacing_;
    const Context& ctx_;
    std::vector<std::uint32_t> level_;
    DisjointSets set_;
};

}  // namespace

std::vector<std::uint32_t> axis_children(const CloudTree& tree, std::vector<double>& longest) {
    std::vector<std::uint32_t> child(tree.size(), kNone);
    longest.assign(tree.size(), 0);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t above = tree.parent[n];
        if (above == kNone) continue;
        const double way = longest[n] + distance(tree.position[n], tree.position[above]);
        // >=: of equal ones the first in order of id.
        if (child[above] == kNone || way >= longest[above]) {
            longest[above] = way;
            child[above] = n;
        }
    }
    return child;
}

void bin_paths(CloudTree& tree, std::span<const Vec3> points, const Graph& graph, const Paths& paths,
               std::span<const std::vector<std::uint32_t>> roots, std::span<const float> spacing, Cut cut,
               const Context& ctx) {
    Binner(points, graph, paths, spacing, cut, ctx).run(roots, tree);
}

void keep_nodes(CloudTree& tree, std::span<const std::uint8_t> kept, bool hand_down) {
    std::vector<std::uint32_t> image(tree.size());
    CloudTree out;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t above = tree.parent[n] == kNone ? kNone : image[tree.parent[n]];
        image[n] = above;
        if (!kept[n]) continue;
        image[n] = out.add(above, tree.position[n]);
        out.radius.back() = tree.radius[n];
        out.weight.back() = tree.weight[n];
        out.residual.back() = tree.residual[n];
    }
    for (std::uint32_t& n : tree.node_of_point) {
        if (n != kNone) n = kept[n] || hand_down ? image[n] : kNone;
    }
    out.node_of_point = std::move(tree.node_of_point);
    tree = std::move(out);
}

}  // namespace coppice::extract_internal
