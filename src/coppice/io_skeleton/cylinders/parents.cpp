#include "coppice/io_skeleton/cylinders/parents_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/spatial/kd_tree.h"

namespace coppice {

namespace {

/// Finds cylinders by tree number and id.
class IdIndex {
  public:
    IdIndex(const std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree) {
        entries_.reserve(cylinders.size());
        for (std::uint32_t i = 0; i < cylinders.size(); ++i)
            entries_.push_back({tree.empty() ? 0 : tree[i], cylinders[i].id, i});
        std::ranges::sort(entries_);
    }

    std::uint32_t find(std::uint32_t tree, std::int64_t id) const {
        const auto at = std::ranges::lower_bound(entries_, Entry{tree, id, 0});
        return at != entries_.end() && is_same(*at, Entry{tree, id, 0}) ? std::get<2>(*at) : kNoIndex;
    }

    /// Returns the second cylinder with an id that occurs twice in a tree; kNoIndex if there is none.
    std::uint32_t repeated() const {
        const auto at = std::ranges::adjacent_find(entries_, is_same);
        return at == entries_.end() ? kNoIndex : std::get<2>(*(at + 1));
    }

  private:
    using Entry = std::tuple<std::uint32_t, std::int64_t, std::uint32_t>;
    static bool is_same(const Entry& a, const Entry& b) {
        return std::get<0>(a) == std::get<0>(b) && std::get<1>(a) == std::get<1>(b);
    }
    std::vector<Entry> entries_;
};

double known_radius(const RawCylinder& c) { return c.radius > 0 ? c.radius : 0; }

/// Returns the cost of a link from the start of a cylinder to another one; infinite if the link is too long.
double compute_cost(const RawCylinder& child, const RawCylinder& parent) {
    const double reach = std::max(distance(child.start, child.end), distance(parent.start, parent.end));
    const Vec3d along = parent.end - parent.start;
    // The region behind the start of the other cylinder belongs to its parent; only its end counts there.
    const bool is_ahead = dot(child.start - parent.start, along) > 0;
    const double gap = is_ahead ? segment_distance(child.start, child.start, parent.start, parent.end)
                                : distance(child.start, parent.end);
    const double a = known_radius(child), b = known_radius(parent);
    if (!(gap <= reach + a + b)) return std::numeric_limits<double>::infinity();
    return a > b && b > 0 ? gap * a / b : gap;
}

/// Joins the cylinders of one tree.
class Joiner {
  public:
    Joiner(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> members)
        : cylinders_(cylinders), members_(members) {}

    void run(const Context& ctx) {
        std::vector<Link> links = find_links(ctx);
        std::ranges::sort(links);
        DisjointSets joined(members_.size());
        std::vector<bool> has_parent(members_.size(), false);
        for (const auto& [cost, child, parent] : links) {
            if (has_parent[child] || !joined.join(child, parent)) continue;
            has_parent[child] = true;
            at(child).parent = at(parent).id;
        }
    }

  private:
    using Link = std::tuple<double, std::uint32_t, std::uint32_t>;  // cost, child, parent

    RawCylinder& at(std::uint32_t i) { return cylinders_[members_[i]]; }

    /// Returns the links from each start to the cylinders with the closest ends.
    std::vector<Link> find_links(const Context& ctx) {
        constexpr std::size_t kMaxNear = 9;  // may include the end of the same cylinder
        const Vec3d origin = at(0).start;
        std::vector<Vec3> ends;
        ends.reserve(members_.size());
        for (std::uint32_t i = 0; i < members_.size(); ++i) ends.emplace_back(at(i).end - origin);
        const KdTree tree(ends, ctx);
        const std::size_t count = std::min(kMaxNear, ends.size());
        std::array<std::uint32_t, kMaxNear> near{};
        std::array<double, kMaxNear> squared{};
        std::vector<Link> links;
        for (std::uint32_t i = 0; i < members_.size(); ++i) {
            tree.nearest(Vec3(at(i).start - origin), std::span(near).first(count),
                         std::span(squared).first(count));
            for (const std::uint32_t j : std::span(near).first(count)) {
                const double cost =
                    j == i ? std::numeric_limits<double>::infinity() : compute_cost(at(i), at(j));
                if (std::isfinite(cost)) links.emplace_back(cost, i, j);
            }
        }
        return links;
    }

    std::vector<RawCylinder>& cylinders_;
    std::span<const std::uint32_t> members_;
};

/// Returns whether distances between the cylinders are finite; others are refused by the repair.
bool are_placed(const std::vector<RawCylinder>& cylinders) {
    constexpr double kMax = 1e15;
    const auto is_placed = [](Vec3d p) {
        return std::abs(p.x) <= kMax && std::abs(p.y) <= kMax && std::abs(p.z) <= kMax;
    };
    return std::ranges::all_of(cylinders,
                               [&](const RawCylinder& c) { return is_placed(c.start) && is_placed(c.end); });
}

}  // namespace

void join_by_place(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree,
                   const Context& ctx) {
    if (cylinders.empty() || !are_placed(cylinders)) return;
    std::vector<std::uint32_t> order(cylinders.size());
    std::iota(order.begin(), order.end(), 0u);
    if (!tree.empty()) std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return tree[i]; });
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        for (end = begin + 1; end < order.size(); ++end)
            if (!tree.empty() && tree[order[end]] != tree[order[begin]]) break;
        Joiner(cylinders, std::span(order).subspan(begin, end - begin)).run(ctx);
    }
}

void direct_from_base(std::vector<RawCylinder>& cylinders) {
    const IdIndex index(cylinders, {});
    std::vector<std::uint32_t> parent;
    parent.reserve(cylinders.size());
    for (const RawCylinder& c : cylinders)
        parent.push_back(c.parent < 0 ? kNoIndex : index.find(0, c.parent));
    double onwards = 0, backwards = 0;
    std::uint32_t root = kNoIndex;
    bool have_one_base = true;
    for (std::uint32_t i = 0; i < cylinders.size(); ++i) {
        const RawCylinder& c = cylinders[i];
        if (parent[i] != kNoIndex) {
            onwards += distance(c.start, cylinders[parent[i]].end);
            backwards += distance(c.end, cylinders[parent[i]].start);
            continue;
        }
        have_one_base = have_one_base && (root == kNoIndex || c.parent == cylinders[root].parent);
        if (root == kNoIndex || c.radius > cylinders[root].radius) root = i;
    }
    if (backwards < onwards)
        for (RawCylinder& c : cylinders) std::swap(c.start, c.end);
    if (root == kNoIndex || !have_one_base || cylinders[root].parent < 0) return;
    for (std::uint32_t i = 0; i < cylinders.size(); ++i)
        if (parent[i] == kNoIndex) cylinders[i].parent = i == root ? -1 : cylinders[root].id;
}

void number_across_trees(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree,
                         const std::string& source) {
    const IdIndex index(cylinders, tree);
    if (const std::uint32_t twin = index.repeated(); twin != kNoIndex) {
        throw InvalidInput(fmt::format(
            "{}, line {}: the id {} was used before in this tree; give every cylinder of a tree a unique id",
            source, cylinders[twin].line, cylinders[twin].id));
    }
    const auto unknown = static_cast<std::int64_t>(cylinders.size()) + 1;
    for (std::uint32_t i = 0; i < cylinders.size(); ++i) {
        if (cylinders[i].parent < 0) continue;
        const std::uint32_t parent = index.find(tree[i], cylinders[i].parent);
        cylinders[i].parent = parent == kNoIndex ? unknown : std::int64_t{parent} + 1;
    }
    for (std::uint32_t i = 0; i < cylinders.size(); ++i) cylinders[i].id = std::int64_t{i} + 1;
}

void count_within_trees(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree) {
    if (tree.empty()) return;
    std::vector<std::int64_t> count(std::ranges::max(tree) + std::size_t{1}, 0);
    for (const std::uint32_t t : tree) ++count[t];
    for (std::size_t i = 0; i < tree.size(); ++i)
        if (cylinders[i].parent > count[tree[i]]) return;
    std::ranges::fill(count, 0);
    for (std::size_t i = 0; i < tree.size(); ++i) cylinders[i].id = ++count[tree[i]];
}

}  // namespace coppice
