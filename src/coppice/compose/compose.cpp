#include "coppice/compose/compose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/random.h"
#include "coppice/compose/composed_tree_internal.h"

namespace coppice {
namespace {

using namespace compose_internal;
using Entry = TreeComposer::Entry;

constexpr double kXuExponent = 1.5;  // [Xu2007]

/// Sequence of random numbers.
class Draws {
  public:
    explicit Draws(std::uint64_t seed) : random_(seed, kStage) {}

    bool happens(double probability) { return random_.uniform(next_++) < probability; }
    double within(double most) { return random_.uniform(next_++, -most, most); }
    std::size_t below(std::size_t count) {
        return std::min(count - 1, static_cast<std::size_t>(random_.uniform(next_++) * double(count)));
    }

  private:
    static constexpr std::uint64_t kStage = 0x636f6d70;
    CounterRandom random_;
    std::uint64_t next_ = 0;
};

bool shorter(const Entry& a, const Entry& b) { return a.length[0] < b.length[0]; }

/// Algorithm that composes one tree.
class Composing {
  public:
    Composing(std::span<const Entry> laterals, std::span<const Entry> leaders, const ComposeOptions& options,
              const Skeleton& template_tree, std::uint64_t seed, const SolidField* crown)
        : laterals_(laterals),
          leaders_(leaders),
          options_(options),
          crown_(crown),
          draws_(seed),
          tree_(template_tree, options) {}

    ComposeResult run(const Context& ctx) {
        constexpr std::uint32_t kPoll = 256;
        // Inserted nodes are appended, so that the loop visits them later.
        for (std::uint32_t n = 0; n < tree_.size(); ++n) {
            if (n % kPoll == 0) ctx.throw_if_cancelled();
            if (tree_[n].gone || tree_[n].depth >= static_cast<std::uint32_t>(options_.depth)) continue;
            tree_.children(n, children_);
            if (children_.size() < 2) continue;
            for (const std::uint32_t first : children_) consider(n, first);
        }
        return {tree_.skeleton(options_), report_};
    }

  private:
    void consider(std::uint32_t node, std::uint32_t first) {
        const std::uint32_t order = tree_[node].order;
        if (!draws_.happens(double{options_.probability} *
                            std::pow(double{options_.probability_falloff}, order)))
            return;
        ++report_.chosen;
        const Place place = tree_.place(node, first);
        const std::span<const Entry> like = of_like_length(place);
        matching_.clear();
        for (const Entry& e : like) {
            const auto more = static_cast<std::int64_t>(e.orders[1]) - std::int64_t{tree_[first].orders};
            if (std::abs(more) <= options_.order_tolerance) matching_.push_back(&e);
        }
        if (matching_.empty()) {
            ++report_.unmatched;
            return;
        }
        tree_.take_out(place);
        for (int t = 0; t < options_.tries; ++t) {
            const Entry& entry = *matching_[draws_.below(matching_.size())];
            lay(place, entry);
            if (crown_ != nullptr && !is_inside()) {
                ++report_.outside;
            } else if (tree_.crosses(place, entry.tree.skeleton, positions_, radii_)) {
                ++report_.crossed;
            } else {
                tree_.put_in(place, entry.tree.skeleton, entry.length, entry.orders, positions_, radii_);
                report_.depth = std::max(report_.depth, tree_[tree_.size() - 1].depth);
                ++report_.replaced;
                return;
            }
        }
        tree_.put_back();
        ++report_.blocked;
    }

    std::span<const Entry> of_like_length(const Place& place) const {
        const std::span<const Entry> all = place.leads ? leaders_ : laterals_;
        const double most = 1 + double{options_.tolerance};
        const auto at = [&](double length) {
            return std::ranges::lower_bound(all, length, {}, [](const Entry& e) { return e.length[0]; });
        };
        const auto begin = at(place.length / most),
                   end = at(std::nextafter(place.length * most, std::numeric_limits<double>::infinity()));
        return {begin, end};
    }

    /// Computes the positions and radii of all nodes of a child tree at a place.
    void lay(const Place& place, const Entry& entry) {
        const Skeleton& s = entry.tree.skeleton;
        const Frame frame = compute_frame(place, entry.tree);
        positions_.resize(s.size());
        // On a thicker parent branch the first node keeps its distance from the bark, because forks inside a
        // branch create intersecting surfaces.
        const Vec3d root = place.position;
        const Vec3d start = root + frame.z * std::max(0.0, place.radius - double{entry.tree.parent_radius});
        for (const NodeId n : nodes(s)) {
            const Vec3d from = s.is_root(n) ? root : start;
            positions_[n.index()] = Vec3(from + frame.to_world(Vec3d(s.position(n))));
        }
        radii_.assign(s.radii().begin(), s.radii().end());
        const double first = first_radius(place, entry.length[0]);
        const double scale = first / double{s.radius(NodeId(1))};
        for (float& r : radii_) r = static_cast<float>(double{r} * scale);
        if (options_.radii == ComposeRadii::xu) thin_out(s, entry.length);
    }

    /// Returns the first radius of an inserted branch: from the replaced branch and the lengths that both
    /// carry; with Xu's rule, for a lateral, from the parent branch.
    double first_radius(const Place& place, double length) const {
        if (place.leads) return place.first_radius;
        const bool xu = options_.radii == ComposeRadii::xu;
        const double wanted =
            xu ? place.radius * std::pow(length / std::max(place.node_length, length), kXuExponent)
               : place.first_radius * std::pow(length / place.length, 1 / double{options_.pipe_exponent});
        return std::min(wanted, place.thickest_sibling);
    }

    /// Computes each radius from the previous one and the lengths that both carry, with the radius of the
    /// thinnest tip as minimum.
    void thin_out(const Skeleton& s, const std::vector<double>& length) {
        float least = std::numeric_limits<float>::infinity();
        for (const NodeId n : nodes(s)) {
            if (s.is_tip(n)) least = std::min(least, radii_[n.index()]);
        }
        const auto above = [&](NodeId n) {
            double sum = 0;
            for (const NodeId c : s.children(n)) sum += length[c.index()];
            return sum;
        };
        for (std::uint32_t i = 2; i < s.size(); ++i) {
            const NodeId n(i), p = s.parent(n);
            const double ratio = above(p) > 0 ? length[i] / above(p) : 0;
            const double r = double{radii_[p.index()]} * std::pow(std::min(1.0, ratio), kXuExponent);
            radii_[i] = std::min(radii_[p.index()], std::max(least, static_cast<float>(r)));
        }
    }

    Frame compute_frame(const Place& place, const ChildTree& tree) {
        Vec3d z = place.direction;
        if (options_.pose == ComposePose::own && !place.leads) {
            const Frame side = branch_frame(place.parent_direction, place.direction);
            const auto a = double{tree.inclination};
            z = side.z * std::cos(a) + side.x * std::sin(a);
        }
        const Frame about = branch_frame(z, place.parent_direction);
        const double stray = std::tan(std::min(double{options_.turn}, 1.5));
        z = normalized(z + about.x * draws_.within(stray) + about.y * draws_.within(stray), z);
        z = normalized(lerp(z, kUp, double{options_.phototropism}), z);
        return rolled(branch_frame(z, place.parent_direction), draws_.within(double{options_.roll}));
    }

    bool is_inside() {
        values_.resize(positions_.size());
        crown_->values(positions_, values_);
        // The root is the existing branch node.
        return std::all_of(values_.begin() + 1, values_.end(), [&](float v) { return v >= crown_->level(); });
    }

    std::span<const Entry> laterals_, leaders_;
    const ComposeOptions& options_;
    const SolidField* crown_;
    Draws draws_;
    ComposedTree tree_;
    ComposeReport report_;
    std::vector<std::uint32_t> children_;
    std::vector<const Entry*> matching_;
    std::vector<Vec3> positions_;
    std::vector<float> radii_, values_;
};

}  // namespace

TreeComposer::TreeComposer(std::vector<ChildTree> library, const ComposeOptions& options)
    : options_(options) {
    check_fields(options, "compose");
    if (library.empty()) throw InvalidInput("compose: the library has no such branches to compose from");
    for (ChildTree& tree : library) {
        if (tree.skeleton.size() < 2 || tree.skeleton.tree_count() != 1)
            throw InvalidInput("compose: a child tree needs a root and at least one segment");
        BranchSizes sizes(tree.skeleton);
        laterals_ += tree.leads ? 0 : 1;
        entries_.push_back({std::move(tree), std::move(sizes.length), std::move(sizes.orders)});
    }
    std::stable_partition(entries_.begin(), entries_.end(), [](const Entry& e) { return !e.tree.leads; });
    const auto middle = entries_.begin() + static_cast<std::ptrdiff_t>(laterals_);
    std::stable_sort(entries_.begin(), middle, shorter);
    std::stable_sort(middle, entries_.end(), shorter);
}

ComposeResult TreeComposer::compose(const Skeleton& template_tree, std::uint64_t seed,
                                    const SolidField* crown, const Context& ctx) const {
    const std::span<const Entry> all(entries_);
    return Composing(all.first(laterals_), all.subspan(laterals_), options_, template_tree, seed, crown)
        .run(ctx);
}

void list_fields(ComposeOptions& o, FieldList& list) {
    list.add(common_field("probability", "Probability that a branch on a main axis is replaced.", Unit::none,
                          0, 1),
             o.probability);
    list.add(Field{"probability_falloff", "Factor on the probability for each further branch order.",
                   Unit::none, 0, 1},
             o.probability_falloff);
    list.add(
        common_field("depth",
                     "Number of replacement passes: 1 replaces branches of the template, 2 also branches "
                     "of the inserted ones, and so on.",
                     Unit::none, 1, 20),
        o.depth);
    list.add(Field{"tolerance",
                   "Maximum relative difference of length between a branch and the one that it replaces.",
                   Unit::none, 0, 100},
             o.tolerance);
    list.add(Field{"order_tolerance",
                   "Maximum difference in the number of branch orders between a branch and the one that it "
                   "replaces.",
                   Unit::none, 0, 100},
             o.order_tolerance);
    list.add(Field{"pose",
                   "Direction of inserted branches: that of the replaced branch, or its azimuth with the "
                   "inclination to their own parent branch."},
             o.pose);
    list.add(Field{"turn", "Maximum random deviation of the directions of branches.", Unit::radian, 0, 3.15},
             o.turn);
    list.add(Field{"roll", "Maximum random roll of branches about themselves.", Unit::radian, 0, 3.15},
             o.roll);
    list.add(Field{"phototropism",
                   "Fraction by which the directions of branches are interpolated towards vertical.",
                   Unit::none, 0, 1},
             o.phototropism);
    list.add(
        common_field("radii",
                     "Radii of inserted branches: scaled to the branch replaced, by the length that each "
                     "node carries, or by the pipe model."),
        o.radii);
    list.add(Field{"pipe_exponent", "Exponent of the pipe model for scaled and pipes.", Unit::none, 2, 3},
             o.pipe_exponent);
    list.add(
        Field{"clearance",
              "Minimum distance between axes as a multiple of the sum of their radii; 0 disables the test.",
              Unit::none, 0, 100},
        o.clearance);
    list.add(Field{"tries", "Maximum number of candidate branches and rolls for each replacement.",
                   Unit::none, 1, 1000},
             o.tries);
    list.add(
        Field{"max_nodes",
              "Maximum number of nodes, including nodes of replaced branches; a larger tree is an error.",
              Unit::none, 1, 5e7},
        o.max_nodes);
}

}  // namespace coppice
