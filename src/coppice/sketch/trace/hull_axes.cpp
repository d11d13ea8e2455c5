#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "coppice/base/id.h"
#include "coppice/sketch/trace/hull_internal.h"

namespace coppice::sketch_internal {
namespace {

// minimum fraction of new pixels of a line in two views; below it, other lines already cover it
constexpr double kNew = 0.2;
constexpr double kShownWidth = 1.3;    // [silhouette width], plus
constexpr double kShownPixels = 2;     // [pixels]: radius around a line that it covers
constexpr double kStep = 0.5;          // [thickness] distance between the discs of a line
constexpr std::ptrdiff_t kSmooth = 4;  // number of cells on each side over which a node is averaged
constexpr double kEndCells = 2.5;      // [cells] excess length of a hull at an end
constexpr double kParentWidth = 1.5;   // [thickness of the parent] distance from the fork within which the
                                       // thickness of a line is that of its parent

class Chooser {
  public:
    Chooser(const Hull& hull, std::span<const HullPath> paths, std::span<const SketchView> views,
            std::span<const SilhouetteField> fields, std::span<const Mask> masks)
        : hull_(hull), pieces_(paths), views_(views), fields_(fields), masks_(masks), shown_(views.size()) {
        for (std::size_t v = 0; v < views.size(); ++v) {
            find_pixels(v);
            shown_[v].assign(masks[v].inside.size(), 0);
        }
    }

    /// Chooses ends by decreasing number of newly covered pixels, each with all its predecessors. Choosing
    /// one only decreases the gain of the others, so that only the first in the queue has to be re-evaluated.
    std::vector<char> run(const Context& ctx) {
        chosen_.assign(pieces_.size(), 0);
        std::priority_queue<std::pair<std::size_t, std::uint32_t>> queue;
        for (std::uint32_t p = 0; p < pieces_.size(); ++p)
            if (pieces_[p].is_tip) queue.emplace(compute_gain(p).pixels, p);
        while (!queue.empty()) {
            ctx.throw_if_cancelled();
            const std::uint32_t p = queue.top().second;
            queue.pop();
            const Gain gain = compute_gain(p);
            if (!queue.empty() && gain.pixels < queue.top().first) {
                if (gain.pixels > 0) queue.emplace(gain.pixels, p);
            } else if (gain.second_share >= kNew) {
                for (std::uint32_t q = p; q != kNoIndex && chosen_[q] == 0; q = pieces_[q].before) take(q);
            }
        }
        return std::move(chosen_);
    }

  private:
    /// Newly covered pixels of a path and its unchosen predecessors.
    struct Gain {
        std::size_t pixels = 0;   ///< in all views
        double second_share = 0;  ///< fraction of its own pixels, second largest value over the views
    };

    Gain compute_gain(std::uint32_t path) const {
        Gain out;
        double first = 0;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            std::size_t own = 0, fresh = 0;
            for (std::uint32_t q = path; q != kNoIndex && chosen_[q] == 0; q = pieces_[q].before) {
                own += pixels_[v][q].size();
                for (const std::size_t i : pixels_[v][q]) fresh += shown_[v][i] == 0 ? 1 : 0;
            }
            out.pixels += fresh;
            const double share = own > 0 ? static_cast<double>(fresh) / static_cast<double>(own) : 0;
            out.second_share = std::max(out.second_share, std::min(first, share));
            first = std::max(first, share);
        }
        return out;
    }

    void take(std::uint32_t path) {
        chosen_[path] = 1;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            walk(pieces_[path], v, [&](PicturePoint at, double) {
                const double wide = std::max(fields_[v].inside_by(at).value_or(0), 0.0);
                for_disc(at, kShownWidth * wide + kShownPixels, v, [&](std::size_t i) { shown_[v][i] = 1; });
            });
        }
    }

    void find_pixels(std::size_t v) {
        std::vector<std::uint32_t> last(masks_[v].inside.size(), kNoIndex);
        pixels_.emplace_back(pieces_.size());
        for (std::uint32_t p = 0; p < pieces_.size(); ++p) {
            walk(pieces_[p], v, [&](PicturePoint at, double radius) {
                for_disc(at, radius, v, [&](std::size_t i) {
                    if (last[i] == p) return;
                    last[i] = p;
                    pixels_[v][p].push_back(i);
                });
            });
        }
    }

    /// Calls visit(place, radius) [pixels] along the image of a path, outside its parent.
    template <class Visit>
    void walk(const HullPath& path, std::size_t v, const Visit& visit) const {
        const Vec3d fork = hull_.center(path.cells.front());
        const double within = path.before == kNoIndex ? 0 : hull_.thickness(path.cells.front());
        double since = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < path.cells.size(); ++k) {
            const Vec3d p = hull_.center(path.cells[k]);
            const double thick = hull_.thickness(path.cells[k]);
            if (k > 0) since += distance(p, hull_.center(path.cells[k - 1]));
            const bool is_last = k + 1 == path.cells.size();
            if (!is_last && (distance(p, fork) < within || since < kStep * thick)) continue;
            since = 0;
            visit(project(views_[v], p), thick * pixels_per_metre(views_[v], p));
        }
    }

    /// Calls visit(index) for the pixels of the silhouette in a disc.
    template <class Visit>
    void for_disc(PicturePoint at, double radius, std::size_t v, const Visit& visit) const {
        const Mask& mask = masks_[v];
        const auto from = [&](double c) { return static_cast<int>(std::max(c - radius, 0.0)); };
        const auto to = [&](double c, int size) {
            return static_cast<int>(std::min(c + radius, size - 1.0));
        };
        for (int y = from(at.y); y <= to(at.y, mask.height); ++y) {
            for (int x = from(at.x); x <= to(at.x, mask.width); ++x) {
                const PicturePoint off = PicturePoint{x + 0.5, y + 0.5} - at;
                if (dot(off, off) <= radius * radius && mask.at(x, y)) visit(mask.index(x, y));
            }
        }
    }

    const Hull& hull_;
    std::span<const HullPath> pieces_;
    std::span<const SketchView> views_;
    std::span<const SilhouetteField> fields_;
    std::span<const Mask> masks_;
    std::vector<std::vector<std::vector<std::size_t>>> pixels_;  ///< by view and path
    std::vector<std::vector<std::uint8_t>> shown_;               ///< covered pixels by view
    std::vector<char> chosen_;                                   ///< by path
};

/// Returns the chosen paths; a path with a single successor is merged with it.
std::vector<HullPath> joined(std::span<const HullPath> paths, std::span<const char> chosen) {
    std::vector<std::uint32_t> children(paths.size(), 0), made(paths.size(), kNoIndex);
    for (std::size_t p = 0; p < paths.size(); ++p)
        if (chosen[p] != 0 && paths[p].before != kNoIndex) ++children[paths[p].before];
    std::vector<HullPath> out;
    for (std::size_t p = 0; p < paths.size(); ++p) {
        if (chosen[p] == 0) continue;
        const HullPath& path = paths[p];
        if (path.before != kNoIndex && children[path.before] == 1) {
            made[p] = made[path.before];
            auto& cells = out[made[p]].cells;
            cells.insert(cells.end(), path.cells.begin() + 1, path.cells.end());
        } else {
            made[p] = static_cast<std::uint32_t>(out.size());
            out.push_back(path);
            if (path.before != kNoIndex) out.back().before = made[path.before];
        }
        out[made[p]].is_tip = children[p] == 0;
    }
    return out;
}

/// Sets the radii [m] of cells near an end of the hull, ordered from the end: a round or blunt end gets the
/// width of the section before it.
void widen_end(const Hull& hull, std::span<const std::uint32_t> from_end, std::span<double> radii) {
    std::size_t k = 0;
    const auto away = [&](std::size_t i) {
        return distance(hull.center(from_end[i]), hull.center(from_end.front()));
    };
    while (k + 1 < radii.size() && away(k) < radii[k] + kEndCells * hull.size) ++k;
    std::fill(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(k), radii[k]);
}

/// Returns the radii [m] along a path.
std::vector<double> compute_radii(const Hull& hull, const HullPath& path) {
    std::vector<std::uint32_t> cells = path.cells;
    const Vec3d fork = hull.center(cells.front());
    const double within = path.before == kNoIndex ? 0 : kParentWidth * hull.thickness(cells.front());
    std::vector<double> out;
    double known = hull.thickness(cells.back());
    for (std::size_t i = cells.size(); i-- > 0;) {
        if (distance(hull.center(cells[i]), fork) >= within) known = hull.thickness(cells[i]);
        out.push_back(known);
    }
    std::ranges::reverse(cells);
    if (path.is_tip) widen_end(hull, cells, out);
    std::ranges::reverse(cells);
    std::ranges::reverse(out);
    if (path.before == kNoIndex) widen_end(hull, cells, out);
    return out;
}

}  // namespace

std::vector<HullPath> explaining(const Hull& hull, std::span<const HullPath> paths,
                                 std::span<const SketchView> views, std::span<const SilhouetteField> fields,
                                 std::span<const Mask> silhouettes, const Context& ctx) {
    return joined(paths, Chooser(hull, paths, views, fields, silhouettes).run(ctx));
}

std::vector<RawNode> find_nodes(const Hull& hull, std::span<const HullPath> paths) {
    std::vector<RawNode> out;
    std::vector<std::int64_t> last(paths.size(), -1);
    for (std::size_t p = 0; p < paths.size(); ++p) {
        const HullPath& path = paths[p];
        const std::vector<double> radii = compute_radii(hull, path);
        const auto size = static_cast<std::ptrdiff_t>(path.cells.size());
        // All paths that begin at the base share its single node.
        last[p] = path.before != kNoIndex ? last[path.before] : out.empty() ? -1 : 0;
        for (std::ptrdiff_t i = last[p] < 0 ? 0 : 1; i < size; ++i) {
            const std::ptrdiff_t reach = std::min({kSmooth, i, size - 1 - i});
            RawNode node{.id = static_cast<std::int64_t>(out.size()), .parent = last[p], .position = {}};
            for (std::ptrdiff_t k = i - reach; k <= i + reach; ++k) {
                const auto at = static_cast<std::size_t>(k);
                const auto share = 1.0 / static_cast<double>(2 * reach + 1);
                node.position += hull.center(path.cells[at]) * share;
                node.radius += radii[at] * share;
            }
            last[p] = node.id;
            out.push_back(node);
        }
    }
    return out;
}

}  // namespace coppice::sketch_internal
