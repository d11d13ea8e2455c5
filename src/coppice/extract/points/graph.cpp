#include "coppice/extract/points/graph_internal.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/extract/points/normal_dispersion_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::extract_internal {
namespace {

constexpr double kTurn = 4;     // times (1 - cosine) of a turn, added to what a link costs
constexpr double kInward = 8;   // times (1 - cosine)^2 against how branches grow, the same
constexpr double kHeading = 3;  // [spacing] over which a path forgets how it went on
constexpr std::uint32_t kVoxelNeighbours = 10, kVoxelRank = 4;  // of voxels; whose distance is the spacing

bool lists(const Neighbours& neighbours, std::uint32_t row, std::uint32_t point) {
    return std::ranges::find(neighbours.of(row), point) != neighbours.of(row).end();
}

/// Calls visit(i, j, length) once for every link.
template <class Visit>
void for_each_link(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                   std::span<const Link> more, double longest, const Context& ctx, const Visit& visit) {
    for (std::uint32_t i = 0; i < ignored.size(); ++i) {
        poll_stop(ctx, i);
        if (ignored[i]) continue;
        for (std::uint32_t k = 0; k < neighbours.count; ++k) {
            const std::uint32_t j = neighbours.of(i)[k];
            const float length = neighbours.distances(i)[k];
            if (ignored[j] || double{length} > longest || (j < i && lists(neighbours, j, i))) continue;
            visit(i, j, length);
        }
    }
    for (const Link& link : more) visit(link.from, link.to, link.length);
}

/// Nearest points of other components, by a tree of boxes that knows which boxes belong to one part alone.
class NearestOther {
  public:
    NearestOther(std::span<const Vec3> points, std::span<const std::uint8_t> ignored, const Context& ctx)
        : points_(points), tree_(boxes_of(points, ignored, used_), ctx) {
        for (std::uint32_t l = 0; l < tree_.level_count(); ++l) part_.emplace_back(tree_.level(l).size());
    }

    std::span<const std::uint32_t> used() const { return used_; }

    void set_parts(std::span<const std::uint32_t> part_of) {
        part_of_ = part_of;
        for (std::uint32_t i = 0; i < part_[0].size(); ++i) part_[0][i] = part_of[used_[tree_.item(i)]];
        for (std::uint32_t l = 1; l < part_.size(); ++l) {
            for (std::uint32_t i = 0; i < part_[l].size(); ++i) {
                const std::uint32_t begin = BoxTree::kWidth * i;
                const auto end = std::min<std::uint32_t>(begin + BoxTree::kWidth,
                                                         static_cast<std::uint32_t>(part_[l - 1].size()));
                part_[l][i] = part_[l - 1][begin];
                for (std::uint32_t c = begin; c < end; ++c) {
                    if (part_[l - 1][c] != part_[l][i]) part_[l][i] = kNone;
                }
            }
        }
    }

    /// Lowers `squared` and sets `found` where a point of another part is nearer.
    void search(std::uint32_t point, double& squared, std::uint32_t& found) const {
        const Vec3d p(points_[point]);
        const std::uint32_t own = part_of_[point];
        const auto bound = [&](std::uint32_t level, std::uint32_t i) {
            if (part_[level][i] == own) return std::numeric_limits<double>::infinity();
            return distance_squared(tree_.level(level)[i], p);
        };
        tree_.search(bound, squared, [&](std::uint32_t item) {
            const double d = length_squared(Vec3d(points_[used_[item]]) - p);
            if (d >= squared) return;
            squared = d;
            found = used_[item];
        });
    }

  private:
    static std::vector<Box3> boxes_of(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                                      std::vector<std::uint32_t>& used) {
        std::vector<Box3> boxes;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if (ignored[i]) continue;
            used.push_back(i);
            boxes.push_back({points[i], points[i]});
        }
        return boxes;
    }

    std::span<const Vec3> points_;
    std::span<const std::uint32_t> part_of_;
    std::vector<std::uint32_t> used_;
    BoxTree tree_;
    std::vector<std::vector<std::uint32_t>> part_;  ///< of each box of a level; kNone = several
};

/// Times the cost of a link that goes on straight and outward.
double detour(const PathCost& rule, std::span<const Vec3> heading, std::uint32_t p, std::uint32_t q,
              Vec3 along) {
    double factor = 1;
    if (heading.empty()) return factor;
    if (length_squared(heading[p]) > 0) factor += kTurn * (1 - double{dot(along, heading[p])});
    if (rule.outward.empty()) return factor;
    const double off = 1 - double{dot(along, rule.outward[q])};
    return factor * (1 + kInward * off * off);
}

}  // namespace

Graph make_graph(const Neighbours& neighbours, std::span<const std::uint8_t> ignored,
                 std::span<const Link> more, const Context& ctx, double longest) {
    Graph graph;
    graph.first.assign(ignored.size() + 1, 0);
    for_each_link(neighbours, ignored, more, longest, ctx, [&](std::uint32_t i, std::uint32_t j, float) {
        ++graph.first[i];
        ++graph.first[j];
    });
    const std::uint32_t total = exclusive_scan(std::span(graph.first));
    graph.to.resize(total);
    graph.length.resize(total);
    std::vector<std::uint32_t> next(graph.first.begin(), graph.first.end());
    for_each_link(neighbours, ignored, more, longest, ctx,
                  [&](std::uint32_t i, std::uint32_t j, float length) {
                      graph.to[next[i]] = j;
                      graph.length[next[i]++] = length;
                      graph.to[next[j]] = i;
                      graph.length[next[j]++] = length;
                  });
    return graph;
}

Components components(const Graph& graph, const Context& ctx) {
    Components parts;
    parts.of.assign(graph.size(), kNone);
    std::vector<std::uint32_t> open;
    std::size_t turn = 0;
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        if (parts.of[i] != kNone) continue;
        const auto part = static_cast<std::uint32_t>(parts.size.size());
        parts.size.push_back(0);
        parts.of[i] = part;
        open.assign(1, i);
        while (!open.empty()) {
            const std::uint32_t p = open.back();
            open.pop_back();
            poll_stop(ctx, turn++);
            ++parts.size[part];
            for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
                if (parts.of[graph.to[e]] != kNone) continue;
                parts.of[graph.to[e]] = part;
                open.push_back(graph.to[e]);
            }
        }
    }
    return parts;
}

std::vector<Link> bridge_gaps(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                              const Components& parts, double limit, const Context& ctx) {
    std::vector<Link> bridges;
    if (parts.size.size() < 2) return bridges;
    NearestOther nearest(points, ignored, ctx);
    DisjointSets sets(parts.size.size());
    std::vector<std::uint32_t> part_of = parts.of;
    const auto members = compress_rows<std::uint32_t>(parts.size.size(), [&](const auto& put) {
        for (const std::uint32_t p : nearest.used()) put(parts.of[p], p);
    });
    for (bool joined = true; joined;) {
        for (std::uint32_t i = 0; i < part_of.size(); ++i) part_of[i] = sets.find(parts.of[i]);
        nearest.set_parts(part_of);
        std::vector<Link> best(parts.size.size(), {kNone, kNone, 0});
        parallel_for(ctx, parts.size.size(), 16, [&](std::size_t part) {
            double squared = limit * limit;
            for (const std::uint32_t p : members[part]) {
                if (ctx.stop.stop_requested()) return;  // one part may hold nearly all points
                std::uint32_t found = kNone;
                nearest.search(p, squared, found);
                if (found != kNone) best[part] = {p, found, static_cast<float>(std::sqrt(squared))};
            }
        });
        // Of the parts that are one already only the shortest way out counts; ties go to the lower number.
        std::vector<Link> chosen(parts.size.size(), {kNone, kNone, 0});
        for (std::uint32_t part = 0; part < best.size(); ++part) {
            Link& out = chosen[sets.find(part)];
            if (best[part].from != kNone && (out.from == kNone || best[part].length < out.length))
                out = best[part];
        }
        joined = false;
        for (const Link& link : chosen) {
            if (link.from == kNone || !sets.join(parts.of[link.from], parts.of[link.to])) continue;
            bridges.push_back(link);
            joined = true;
        }
    }
    return bridges;
}

/// Of each voxel that holds points the one closest to their mean.
std::vector<std::uint32_t> points_of_voxels(std::span<const Vec3> at, double edge, const Context& ctx) {
    const VoxelGrid grid = voxel_grid(at, edge, ctx);
    std::vector<std::uint32_t> point(grid.centroid.size(), kNone);
    std::vector<float> off(point.size(), std::numeric_limits<float>::infinity());
    for (std::uint32_t i = 0; i < at.size(); ++i) {
        const std::uint32_t v = grid.of_point[i];
        const float d = length_squared(at[i] - grid.centroid[v]);
        if (d >= off[v]) continue;
        off[v] = d;
        point[v] = i;
    }
    return point;
}

/// Links of at most `limit` [m] between the components of points that stand for ever larger voxels, each to
/// the closest others: more ways over gaps than the shortest one.
std::vector<Link> link_voxels(std::span<const Vec3> points, const Neighbours& neighbours,
                              std::span<const std::uint8_t> ignored, const Components& parts, double limit,
                              const Context& ctx) {
    std::vector<std::uint32_t> used;
    Buffer<Vec3> at;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
        if (ignored[p]) continue;
        used.push_back(p);
        at.push_back(points[p]);
    }
    std::vector<Link> links;
    const Buffer<float> spacing = local_spacing(neighbours, std::min(kVoxelRank, neighbours.count));
    for (double edge = 2 * double{median(spacing)}; edge <= limit && at.size() > 1; edge *= 2) {
        const std::vector<std::uint32_t> chosen = points_of_voxels(at, edge, ctx);
        Buffer<Vec3> next(chosen.size());
        std::vector<std::uint32_t> of(chosen.size());
        for (std::size_t v = 0; v < chosen.size(); ++v) {
            next[v] = at[chosen[v]];
            of[v] = used[chosen[v]];
        }
        at.swap(next);
        used.swap(of);
        const Neighbours near = nearest_neighbours(at, kVoxelNeighbours, ctx);
        for (std::uint32_t v = 0; v < at.size(); ++v) {
            for (std::uint32_t k = 0; k < near.count; ++k) {
                const std::uint32_t w = near.of(v)[k];
                const bool apart = parts.of[used[v]] != parts.of[used[w]];
                if (!apart || double{near.distances(v)[k]} > limit || (w < v && lists(near, w, v))) continue;
                links.push_back({used[v], used[w], near.distances(v)[k]});
            }
        }
    }
    return links;
}

/// How wide a gap may be that a component is joined over: no wider than a share of what it holds beyond.
std::vector<double> reach_of_parts(std::span<const Vec3> points, std::span<const std::uint8_t> ignored,
                                   const Components& parts, const GapRule& gap) {
    constexpr double kOfExtent = 0.3;
    constexpr std::uint32_t kFewest = 20;  // points
    std::vector<Box3> box(parts.size.size());
    for (std::uint32_t p = 0; p < points.size(); ++p)
        if (!ignored[p]) box[parts.of[p]].extend(points[p]);
    std::vector<double> out(box.size(), 0);
    for (std::size_t i = 0; i < box.size(); ++i)
        if (parts.size[i] >= kFewest)
            out[i] = std::clamp(kOfExtent * double{box[i].diagonal()}, gap.usual, gap.widest);
    return out;
}

ConnectedGraph connect_points(std::span<const Vec3> points, const Neighbours& neighbours,
                              std::span<const std::uint8_t> ignored, const GapRule& gap, const Context& ctx) {
    ConnectedGraph out;
    out.components = components(make_graph(neighbours, ignored, {}, ctx, gap.usual), ctx);
    out.bridges = bridge_gaps(points, ignored, out.components, gap.usual, ctx);
    std::vector<Link> links = out.bridges;
    const std::vector<Link> across =
        link_voxels(points, neighbours, ignored, out.components, gap.widest, ctx);
    for (const Link& link : across)
        if (double{link.length} <= gap.usual) links.push_back(link);
    if (!links.empty())
        out.components = components(make_graph(neighbours, ignored, links, ctx, gap.usual), ctx);
    const std::vector<double> reach = reach_of_parts(points, ignored, out.components, gap);
    std::vector<Link> wide = bridge_gaps(points, ignored, out.components, gap.widest, ctx);
    wide.insert(wide.end(), across.begin(), across.end());
    std::erase_if(wide, [&](const Link& link) {
        const std::uint32_t a = out.components.of[link.from], b = out.components.of[link.to];
        return a == b || double{link.length} > std::min(reach[a], reach[b]);
    });
    links.insert(links.end(), wide.begin(), wide.end());
    out.graph = make_graph(neighbours, ignored, links, ctx, gap.usual);
    if (wide.empty()) return out;
    const std::size_t before = out.components.size.size();
    out.components = components(out.graph, ctx);
    out.wide = static_cast<std::uint32_t>(before - out.components.size.size());
    return out;
}

Paths shortest_paths(const Graph& graph, std::span<const std::uint32_t> sources,
                     std::span<const std::uint32_t> taken, const PathCost& rule, const Context& ctx) {
    struct Entry {
        double cost;
        std::uint32_t point;
        bool operator>(const Entry& b) const { return cost != b.cost ? cost > b.cost : point > b.point; }
    };
    Paths paths;
    paths.parent.assign(graph.size(), kNone);
    paths.distance.assign(graph.size(), std::numeric_limits<float>::infinity());
    Buffer<double> cost(graph.size(), std::numeric_limits<double>::infinity());
    Buffer<Vec3> heading(rule.position.size(), Vec3{});
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (const std::uint32_t p : sources) {
        cost[p] = 0;
        open.push({0, p});
    }
    for (std::size_t turn = 0; !open.empty(); ++turn) {
        const auto [at, p] = open.top();
        open.pop();
        if (at > cost[p]) continue;
        poll_stop(ctx, turn);
        if (taken[p] == kNone) {
            paths.order.push_back(p);
            paths.distance[p] = static_cast<float>(at);
        }
        for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
            const std::uint32_t q = graph.to[e];
            if (taken[q] != kNone) continue;
            const double spacing = 0.5 * (double{rule.spacing[p]} + double{rule.spacing[q]});
            const double share = graph.length[e] / spacing;
            Vec3 along;
            if (!heading.empty()) along = normalized(rule.position[q] - rule.position[p], Vec3{});
            const double next = at + share * share * detour(rule, heading, p, q, along);
            if (!(next < cost[q])) continue;
            cost[q] = next;
            paths.parent[q] = p;
            if (!heading.empty()) {
                const auto keep = static_cast<float>(std::exp(-share / kHeading));
                heading[q] = normalized(keep * heading[p] + (1 - keep) * along, along);
            }
            open.push({next, q});
        }
    }
    return paths;
}

}  // namespace coppice::extract_internal
