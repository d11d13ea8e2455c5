#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/edit/cut.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

using namespace edit_internal;

namespace {

std::vector<StableId> parents_first(const EditableTree& tree) {
    std::vector<StableId> all;
    for (StableId root = tree.first_root(); root; root = tree.next_sibling(root))
        tree.visit_subtree(root, [&](StableId n) { all.push_back(n); });
    return all;
}

/// Quantities that pruning needs of a node and its descendants.
struct Branch {
    bool leads = false;  ///< continues the axis of its parent
    int order = 0;
    double length = 0;                                       ///< [m] longest path from its joint to a tip
    double shade = std::numeric_limits<double>::infinity();  ///< minimum over its tips
};

Column<StableId, Branch> find_branches(const EditableTree& tree, const std::vector<StableId>& order,
                                       const Column<StableId, double>& shade) {
    Column<StableId, Branch> branch(tree.slots());
    for (const StableId n : order) {
        const StableId leader = tree.leader(n);
        for (StableId c = tree.first_child(n); c; c = tree.next_sibling(c)) {
            branch[c].leads = c == leader;
            branch[c].order = branch[n].order + (c == leader ? 0 : 1);
        }
    }
    for (auto at = order.rbegin(); at != order.rend(); ++at) {
        Branch& b = branch[*at];
        if (tree.is_tip(*at)) b.shade = shade.size() > 0 ? shade[*at] : 0;
        if (tree.is_root(*at)) continue;
        const StableId parent = tree.parent(*at);
        b.length += distance(get_position(tree, *at), get_position(tree, parent));
        branch[parent].length = std::max(branch[parent].length, b.length);
        branch[parent].shade = std::min(branch[parent].shade, b.shade);
    }
    return branch;
}

/// Returns the maximum shade for which no branch is removed.
double allowed_shade(const EditableTree& tree, const Column<StableId, double>& shade, const PruneOptions& o) {
    double limit = o.shade > 0 ? double{o.shade} : std::numeric_limits<double>::infinity();
    if (o.shade_share <= 0) return limit;
    std::vector<double> tips;
    for (const StableId n : tree.nodes()) {
        if (tree.is_tip(n)) tips.push_back(shade[n]);
    }
    std::ranges::sort(tips, std::greater<>());
    const auto going = static_cast<std::size_t>(double{o.shade_share} * static_cast<double>(tips.size()));
    return std::min(limit, going < tips.size() ? tips[going] : -1.0);
}

bool goes(const PruneOptions& o, double allowed_shade, const Branch& b, float radius) {
    if (o.radius > 0 && radius < o.radius) return true;
    if (o.order >= 0 && b.order > o.order) return true;
    if (b.leads) return false;
    return (o.length > 0 && b.length < double{o.length}) || b.shade > allowed_shade;
}

double max_extent(const EditableTree& tree) {
    Box3 box;
    for (const StableId n : tree.nodes()) box.extend(tree.position(n));
    const Vec3 size = box.size();
    return std::max({size.x, size.y, size.z});
}

/// Evaluates a solid in world space at positions relative to the origin of the tree.
class SolidTest {
  public:
    SolidTest(const EditableTree& tree, const Solid& solid) : field_(solid), origin_(tree.origin()) {}

    bool inside(Vec3d local) const {
        const std::array<Vec3, 1> point{Vec3(origin_ + local)};
        std::array<float, 1> value{};
        field_.values(point, value);
        return value[0] >= Solid::kSurface;
    }
    std::vector<float> values(const std::vector<Vec3>& points) const {
        std::vector<float> out(points.size());
        field_.values(points, out);
        return out;
    }
    Vec3 world(const EditableTree& tree, StableId n) const { return Vec3(origin_ + get_position(tree, n)); }

  private:
    SolidField field_;
    Vec3d origin_;
};

/// Returns the parameter at which the segment from a to b crosses the surface; a is on the side that is kept.
double crossing(const SolidTest& test, Vec3d a, Vec3d b, bool keep_inside) {
    double low = 0, high = 1;
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (test.inside(lerp(a, b, middle)) == keep_inside ? low : high) = middle;
    }
    return low;
}

void cut_at_surface(TreeEdit& edit, const EditableTree& tree, StableId n, const SolidTest& test,
                    bool keep_inside) {
    constexpr double kMinStub = 1e-4;  // [segment length]
    const double t = crossing(test, get_position(tree, tree.parent(n)), get_position(tree, n), keep_inside);
    if (t > kMinStub && t < 1) split_segment(edit, tree, n, t);
    edit.remove_subtree(n);
}

}  // namespace

Column<StableId, double> shade_of_tips(const EditableTree& tree, double cell) {
    constexpr double kShade = 0.2, kFade = 0.5;  // shade of a tip in its own cell, and factor per layer
    constexpr int kLayers = 7;
    using Cube = std::array<std::int32_t, 3>;
    const auto find_cube = [&](StableId n) {
        const Vec3d p = get_position(tree, n) / cell;
        Cube out{};
        for (int axis = 0; axis < 3; ++axis)
            out[static_cast<std::size_t>(axis)] =
                static_cast<std::int32_t>(std::clamp(std::floor(p[axis]), -1e9, 1e9));
        return out;
    };
    // Tips are sorted by cell, and the shade of a cell is summed over all cells above it, because few cells
    // contain tips.
    std::vector<std::pair<Cube, StableId>> tips;
    for (const StableId n : tree.nodes()) {
        if (tree.is_tip(n)) tips.emplace_back(find_cube(n), n);
    }
    std::ranges::sort(tips);
    const auto count_in = [&](const Cube& c) {
        const auto first = std::ranges::lower_bound(tips, std::pair(c, StableId(0)));
        const auto last = std::ranges::upper_bound(tips, std::pair(c, StableId::none()));
        return static_cast<double>(last - first);
    };
    Column<StableId, double> shade(tree.slots(), 0.0);
    for (std::size_t i = 0; i < tips.size(); ++i) {
        const auto& [cube, tip] = tips[i];
        if (i > 0 && tips[i - 1].first == cube) {
            shade[tip] = shade[tips[i - 1].second];
            continue;
        }
        double sum = -kShade;  // a tip does not shade itself
        double strength = kShade;
        for (std::int32_t up = 0; up < kLayers; ++up, strength *= kFade) {
            for (std::int32_t x = -up; x <= up; ++x) {
                for (std::int32_t y = -up; y <= up; ++y)
                    sum += strength * count_in({cube[0] + x, cube[1] + y, cube[2] + up});
            }
        }
        shade[tip] = sum;
    }
    return shade;
}

EditChange prune(EditableTree& tree, const NodeSet& nodes, const PruneOptions& options) {
    check_set(tree, nodes);
    Column<StableId, double> shade;
    if (options.shade > 0 || options.shade_share > 0) {
        const double extent = max_extent(tree);
        const double cell = options.shade_cell > 0 ? double{options.shade_cell} : extent / 50;
        if (!(cell > 0))
            throw InvalidInput("the tree has no extent in which shade could be computed; set shade_cell");
        shade = shade_of_tips(tree, cell);
    }
    const std::vector<StableId> order = parents_first(tree);
    const Column<StableId, Branch> branch = find_branches(tree, order, shade);
    const double max_shade = allowed_shade(tree, shade, options);
    TreeEdit edit(tree);
    for (const StableId n : order) {
        if (tree.contains(n) && !tree.is_root(n) && holds(nodes, n) &&
            goes(options, max_shade, branch[n], tree.radius(n)))
            edit.remove_subtree(n);
    }
    return edit.commit();
}

EditChange prune_by_solid(EditableTree& tree, const NodeSet& nodes, const Solid& solid, bool keep_inside) {
    check_set(tree, nodes);
    const SolidTest test(tree, solid);
    const std::vector<StableId> order = parents_first(tree);
    std::vector<Vec3> points;
    for (const StableId n : order) points.push_back(test.world(tree, n));
    const std::vector<float> values = test.values(points);
    Column<StableId, std::uint8_t> wanted(tree.slots()),
        reaches(tree.slots());  // by node: whether it is kept; whether it or a descendant is kept
    for (std::size_t i = order.size(); i-- > 0;) {
        const StableId n = order[i];
        wanted[n] = (values[i] >= Solid::kSurface) == keep_inside;
        if (wanted[n] != 0) reaches[n] = 1;
        if (!tree.is_root(n) && reaches[n] != 0) reaches[tree.parent(n)] = 1;
    }
    TreeEdit edit(tree);
    std::uint32_t kept = 0;
    for (const StableId n : order) {
        if (!tree.contains(n)) continue;
        kept += wanted[n];
        if (tree.is_root(n) || wanted[n] != 0 || !holds(nodes, n)) continue;
        if (wanted[tree.parent(n)] != 0) {
            cut_at_surface(edit, tree, n, test, keep_inside);
        } else if (reaches[n] == 0 || !keep_inside) {
            edit.remove_subtree(n);
        }
    }
    if (kept == 0) {
        throw InvalidInput(
            fmt::format("all of the tree is {} the solid, so that no node would remain; move the solid",
                        keep_inside ? "outside" : "within"));
    }
    return edit.commit();
}

}  // namespace coppice
