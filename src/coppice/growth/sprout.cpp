#include "coppice/growth/sprout.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/base/random.h"
#include "coppice/growth/shade_grid_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kSproutGrain = 4096;
// Cosine of the maximum turn by which a shoot slides along a guard; without this limit, shoots would cover
// the wall that they meet.
constexpr double kMinAlong = 0.5;
constexpr std::uint32_t kNodesPerLook = 4096;  // between two checks of cancellation and memory
constexpr double kBytesOfNode = 160;           // including the data of a season

/// A node with its buds and leaves.
struct Metamer {
    Vec3 position;
    Vec3 direction;  // of the segment that ends here
    Vec3 side;       // unit vector perpendicular to it, reference of the bud angles
    float azimuth;   // of the first lateral bud, relative to `side`
    std::uint32_t parent;
    std::uint32_t id = 0;  // in the order of creation; index of its random numbers
    std::uint16_t order;
    std::uint16_t buds;     // bit set of the living lateral buds
    std::int32_t born = 0;  // season
    bool leads;             // it continues the axis of its parent
    bool tip;               // it has a living bud that would continue the axis
};

/// The data of a node in a season; sums include the node and all its descendants.
struct Share {
    double light = 0;          // sum
    std::uint32_t leaves = 0;  // number of nodes with leaves
    // Number of nodes on the axis from here to its living tip; kNoIndex if the tip is dead.
    std::uint32_t below_tip = kNoIndex;
    double weights = 0;    // sum of the weights of the receivers
    double vigour = 0;     // vigour received by the node
    double own_light = 0;  // at the node
};

double gauss(const CounterRandom& random, std::uint64_t index) {  // [Box1958]
    const double u = 1 - random.uniform(index), v = random.uniform(index + 1);
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

class Sprouting {
  public:
    Sprouting(const SproutInput& input, const SproutOptions& options, const Context& ctx)
        : input_(input),
          o_(options),
          ctx_(ctx),
          random_(static_cast<std::uint64_t>(options.seed), 1),
          tropism_(normalized(Vec3d{o_.tropism_x, o_.tropism_y, o_.tropism_z}, {})),
          grid_({.cell = o_.shade_cell > 0 ? o_.shade_cell : 2 * o_.internode,
                 .shade = o_.shade,
                 .falloff = o_.shade_falloff,
                 .depth = o_.shade_depth}) {
        for (const Root& root : input.roots) {
            const Vec3 up = normalized(root.direction, Vec3{0, 0, 1});
            add({.position = root.position,
                 .direction = up,
                 .side =
                     turned(up, perpendicular(up), 2 * std::numbers::pi * random_.uniform(draw(next_id_, 0))),
                 .azimuth = 0,
                 .parent = kNoIndex,
                 .order = 0,
                 .buds = 0,
                 .leads = false,
                 .tip = true});
        }
        take_leaves_in(0);
    }

    SproutResult run() {
        int grown = 0;
        for (season_ = 1; season_ <= o_.seasons && !full_; ++season_) {
            check_in(ctx_, static_cast<std::size_t>(season_ - 1), static_cast<std::size_t>(o_.seasons));
            gather_light();
            if (shed_branches()) gather_light();
            share_vigour();
            const auto before = count();
            grow_buds();
            take_leaves_in(before);
            drop_old_leaves(before);
            if (count() > before) grown = season_;
            if (!input_.watch) continue;
            input_.watch({.nodes = count(), .rounds = season_, .limit = "seasons", .skeleton = [this] {
                              return skeleton();
                          }});
        }
        gather_light();
        shed_branches();
        ctx_.report(1);
        return {skeleton(), grown, shed_, barred_, full_};
    }

  private:
    std::uint32_t count() const { return static_cast<std::uint32_t>(nodes_.size()); }
    static std::uint64_t draw(std::uint32_t id, std::uint32_t subject) {
        return std::uint64_t{id} << 8 | subject;
    }

    static Vec3 turned(Vec3 axis, Vec3 side, double angle) {
        const Vec3d a(axis), s(side);
        return Vec3(normalized(s * std::cos(angle) + cross(a, s) * std::sin(angle), s));
    }

    bool has_leaves(const Metamer& m) const { return season_ - m.born <= o_.leaf_seasons; }
    bool is_full() const { return nodes_.size() >= static_cast<std::size_t>(o_.max_nodes); }

    std::uint32_t add(Metamer m) {
        m.id = next_id_++;
        m.born = season_;
        nodes_.push_back(m);
        return count() - 1;
    }

    void take_leaves_in(std::uint32_t first) {
        for (std::uint32_t i = first; i < count(); ++i) {
            if (i % kNodesPerLook == 0) look_up();
            grid_.add(nodes_[i].position);
        }
    }

    void drop_old_leaves(std::uint32_t end) {
        for (std::uint32_t i = 0; i < end; ++i) {
            if (i % kNodesPerLook == 0) look_up();
            if (season_ - nodes_[i].born == o_.leaf_seasons) grid_.remove(nodes_[i].position);
        }
    }

    void look_up() const {
        ctx_.throw_if_cancelled();
        const double bytes =
            static_cast<double>(grid_.bytes()) + kBytesOfNode * static_cast<double>(nodes_.size());
        if (input_.max_bytes <= 0 || bytes <= input_.max_bytes) return;
        throw InvalidInput(
            fmt::format("sprout: {} nodes and their shade need more than the {:.0f} MiB of memory that are "
                        "left; allow more memory, reduce max_nodes or seasons, or increase shade_cell",
                        nodes_.size(), input_.max_bytes / (1 << 20)));
    }

    // ---- light

    void gather_light() {
        share_.assign(nodes_.size(), {});
        parallel_for(ctx_, nodes_.size(), kSproutGrain, [&](std::size_t i) {
            // The shade of the cell includes the leaves of the node itself.
            const double own = has_leaves(nodes_[i]) ? double{o_.shade} : 0;
            share_[i].own_light = std::clamp(1 - grid_.shade(nodes_[i].position) + own, 0.0, 1.0);
        });
        for (std::uint32_t i = count(); i-- > 0;) {
            const Metamer& m = nodes_[i];
            Share& s = share_[i];
            if (has_leaves(m)) {
                s.light += s.own_light;
                ++s.leaves;
            }
            if (m.tip) s.below_tip = 0;
            if (m.parent == kNoIndex) continue;
            Share& below = share_[m.parent];
            below.light += s.light;
            below.leaves += s.leaves;
            if (m.leads && s.below_tip != kNoIndex) below.below_tip = s.below_tip + 1;
        }
    }

    bool is_to_shed(std::uint32_t i) const {
        const Metamer& m = nodes_[i];
        if (m.order == 0) return false;
        const Share& s = share_[i];
        if (s.leaves == 0) return true;
        return !m.leads && s.light < double{o_.shed_light} * s.leaves;
    }

    bool shed_branches() {
        std::vector<std::uint32_t> place(nodes_.size(), kNoIndex);
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < count(); ++i) {
            const Metamer& m = nodes_[i];
            const bool parent_goes = m.parent != kNoIndex && place[m.parent] == kNoIndex;
            if (parent_goes || is_to_shed(i)) {
                if (has_leaves(m)) grid_.remove(m.position);
                continue;
            }
            place[i] = kept;
            nodes_[kept] = m;
            if (m.parent != kNoIndex) nodes_[kept].parent = place[m.parent];
            ++kept;
        }
        const bool any = kept < count();
        shed_ += count() - kept;
        nodes_.resize(kept);
        return any;
    }

    // ---- shares

    // Returns the bits of the lateral buds of a node that sprout if they receive enough.
    std::uint32_t waking_buds(std::uint32_t i) const {
        const Metamer& m = nodes_[i];
        const Share& s = share_[i];
        if (m.buds == 0 || season_ - m.born > o_.bud_seasons || s.own_light < double{o_.bud_light}) return 0;
        const bool held =
            s.below_tip != kNoIndex && s.below_tip < static_cast<std::uint32_t>(o_.apical_dominance);
        return held ? 0 : m.buds;
    }

    double weight_of_tip(std::uint32_t i) const {
        const bool wakes = nodes_[i].tip && share_[i].own_light >= double{o_.bud_light};
        return wakes ? double{o_.apical_control} * share_[i].own_light : 0;
    }
    double weight_of_bud(std::uint32_t i) const {
        return (1 - double{o_.apical_control}) * share_[i].own_light;
    }
    double weight_of_branch(std::uint32_t i) const {
        const double control = o_.apical_control;
        return (nodes_[i].leads ? control : 1 - control) * share_[i].light;
    }

    // Distributes the vigour of a node to its tip's bud, its lateral buds and its children.
    void share_vigour() {
        for (std::uint32_t i = count(); i-- > 0;) {
            share_[i].weights += weight_of_tip(i) + std::popcount(waking_buds(i)) * weight_of_bud(i);
            if (nodes_[i].parent != kNoIndex) share_[nodes_[i].parent].weights += weight_of_branch(i);
        }
        for (std::uint32_t i = 0; i < count(); ++i) {
            const std::uint32_t parent = nodes_[i].parent;
            share_[i].vigour = parent == kNoIndex ? double{o_.vigour} * share_[i].light
                                                  : compute_share(parent, weight_of_branch(i));
        }
    }

    double compute_share(std::uint32_t i, double weight) const {
        return share_[i].weights > 0 ? share_[i].vigour * weight / share_[i].weights : 0;
    }

    int internodes(std::uint32_t i, double weight) const {
        return static_cast<int>(std::min(std::floor(compute_share(i, weight)), double(o_.max_internodes)));
    }

    // ---- shoots

    void grow_buds() {
        const std::uint32_t end = count();
        for (std::uint32_t i = 0; i < end && !full_; ++i) {
            if (i % kNodesPerLook == 0) look_up();
            if (const int n = internodes(i, weight_of_tip(i)); n > 0) grow_tip(i, n);
            const std::uint32_t waking = waking_buds(i);
            const int n = waking == 0 ? 0 : internodes(i, weight_of_bud(i));
            for (int bud = 0; n > 0 && bud < o_.buds; ++bud) {
                if ((waking >> bud & 1) != 0) grow_lateral(i, bud, n);
            }
        }
    }

    void grow_tip(std::uint32_t from, int n) {
        nodes_[from].tip = false;
        grow_on(from, n);
    }

    void grow_lateral(std::uint32_t from, int bud, int n) {
        const Metamer m = nodes_[from];
        const auto number = static_cast<std::uint32_t>(bud);
        nodes_[from].buds = static_cast<std::uint16_t>(m.buds & ~(1u << number));
        const double spread = double{o_.branching_spread} * gauss(random_, draw(m.id, 16 + 2 * number));
        const double angle = std::clamp(double{o_.branching_angle} + spread, 0.0, std::numbers::pi);
        const double azimuth = m.azimuth + 2 * std::numbers::pi * bud / o_.buds;
        const Vec3d across(turned(m.direction, m.side, azimuth));
        const Vec3d way = Vec3d(m.direction) * std::cos(angle) + across * std::sin(angle);
        const int order = std::min(m.order + 1, 0xffff);
        const auto first = step(from, way, order, false, n == 1);
        if (first) grow_on(*first, n - 1);
    }

    // Adds n segments to an axis, which then ends in a bud or dies.
    void grow_on(std::uint32_t from, int n) {
        std::uint32_t last = from;
        for (int k = 0; k < n; ++k) {
            const auto next = step(last, direction_on(last), nodes_[last].order, true, k + 1 == n);
            if (!next) break;
            last = *next;
        }
        const double chance = random_.uniform(draw(nodes_[last].id, 5));
        nodes_[last].tip = chance >= double{o_.tip_death};
    }

    Vec3d direction_on(std::uint32_t from) const {
        const Metamer& m = nodes_[from];
        const double weight = m.order == 0 ? o_.stem_tropism : o_.branch_tropism;
        Vec3d way = Vec3d(m.direction) + tropism_ * weight;
        if (o_.light_turn > 0) way += grid_.brighter(m.position) * double{o_.light_turn};
        if (o_.wobble > 0) {
            const Vec3d any{gauss(random_, draw(m.id, 6)), gauss(random_, draw(m.id, 8)),
                            gauss(random_, draw(m.id, 10))};
            way += normalized(any) * double{o_.wobble};
        }
        return normalized(way, Vec3d(m.direction));
    }

    /// Adds a segment; returns nullopt if the guard excludes it or the maximum number of nodes is reached.
    std::optional<std::uint32_t> step(std::uint32_t from, Vec3d way, int order, bool leads, bool ends) {
        if (is_full()) {
            full_ = true;
            return {};
        }
        const Metamer& m = nodes_[from];
        const double length = double{o_.internode} * std::pow(double{o_.internode_decay}, order);
        Vec3 to(Vec3d(m.position) + way * length);
        if (input_.guard) {
            const auto clear = input_.guard->step(m.position, Vec3(way), static_cast<float>(length));
            if (!clear || dot(Vec3d(normalized(*clear - m.position)), way) < kMinAlong) {
                ++barred_;
                return {};
            }
            to = *clear;
        }
        const Vec3 direction = normalized(to - m.position, Vec3(way));
        const bool bears = o_.buds > 0 && (!o_.whorls || ends);
        return add({.position = to,
                    .direction = direction,
                    .side = find_side(m, direction, leads),
                    .azimuth = leads ? std::remainder(m.azimuth + (bears ? o_.phyllotaxis : 0.0f),
                                                      2 * std::numbers::pi_v<float>)
                                     : 0,
                    .parent = from,
                    .order = static_cast<std::uint16_t>(order),
                    .buds = static_cast<std::uint16_t>(bears ? (1u << o_.buds) - 1 : 0),
                    .leads = leads,
                    .tip = ends});
    }

    // Along an axis the vector is transported without twist; the vector of a new axis is horizontal, so that
    // laterals in two rows spread like leaves.
    static Vec3 find_side(const Metamer& m, Vec3 direction, bool leads) {
        if (leads) return normalized(m.side - direction * dot(m.side, direction), perpendicular(direction));
        const Vec3 level = cross(direction, Vec3{0, 0, 1});
        return length(level) > 0.01f ? normalized(level) : perpendicular(direction);
    }

    Skeleton skeleton() const {
        std::vector<NodeId> parents;
        std::vector<Vec3> positions;
        for (const Metamer& m : nodes_) {
            parents.push_back(m.parent == kNoIndex ? NodeId::none() : NodeId(m.parent));
            positions.push_back(m.position);
        }
        std::vector<float> radii(nodes_.size(), 0.1f * o_.internode);
        return Skeleton(std::move(parents), std::move(positions), std::move(radii), input_.origin);
    }

    const SproutInput& input_;
    const SproutOptions& o_;
    const Context& ctx_;
    CounterRandom random_;
    Vec3d tropism_;
    ShadeGrid grid_;
    std::vector<Metamer> nodes_;
    std::vector<Share> share_;
    std::int32_t season_ = 0;
    std::uint32_t next_id_ = 0, shed_ = 0, barred_ = 0;
    bool full_ = false;
};

void check_options(const SproutOptions& o) {
    check_fields(o, "sprout");
    if (o.tropism_x == 0 && o.tropism_y == 0 && o.tropism_z == 0 &&
        (o.stem_tropism != 0 || o.branch_tropism != 0)) {
        throw InvalidInput(
            "sprout: tropism needs a direction, but tropism_x, tropism_y and tropism_z are all 0");
    }
}

void check_root(const SproutInput& input, const SproutOptions& o, std::size_t number) {
    const Root& root = input.roots[number];
    if (!is_finite(root.position) || !is_finite(root.direction))
        throw InvalidInput(fmt::format("sprout: root {} is not finite; use finite numbers", number));
    const float far =
        std::max({std::abs(root.position.x), std::abs(root.position.y), std::abs(root.position.z)});
    // An internode is then at least 16 times the distance between adjacent floats.
    if (far * 0x1p-19f > o.internode) {
        throw InvalidInput(
            fmt::format("sprout: an internode of {} m is too short at a distance of {} m from the origin; "
                        "move the root closer to the origin or increase the internode",
                        o.internode, far));
    }
    if (input.guard && !input.guard->allows(root.position))
        throw InvalidInput(
            fmt::format("sprout: root {} is in a region that the guard excludes; move it", number));
}

}  // namespace

SproutResult sprout(const SproutInput& input, const SproutOptions& options, const Context& ctx) {
    check_options(options);
    if (input.roots.empty())
        throw InvalidInput("sprout: there is no root to grow from; specify at least one");
    for (std::size_t i = 0; i < input.roots.size(); ++i) check_root(input, options, i);
    return Sprouting(input, options, ctx).run();
}

void list_fields(SproutOptions& o, FieldList& list) {
    list.add(common_field("seasons", "Number of seasons in which buds sprout.", Unit::none, 0, 1000),
             o.seasons);
    list.add(common_field("internode", "Length of the segments of the stem.", Unit::metre, 1e-4, 1e3),
             o.internode);
    list.add(Field{"internode_decay", "Ratio of the lengths of segments of consecutive branch orders.",
                   Unit::none, 0.1, 1},
             o.internode_decay);
    list.add(Field{"max_internodes", "Maximum number of segments that a bud makes in a season.", Unit::none,
                   1, 1000},
             o.max_internodes);
    list.add(common_field("branching_angle", "Mean angle between a branch and its parent axis.", Unit::radian,
                          0, 3.1),
             o.branching_angle);
    list.add(Field{"branching_spread", "Standard deviation of the branching angle.", Unit::radian, 0, 1.5},
             o.branching_spread);
    list.add(
        common_field("phyllotaxis", "Angle about the axis from the buds of one node to those of the next.",
                     Unit::radian, -6.3, 6.3),
        o.phyllotaxis);
    list.add(
        common_field("buds", "Number of lateral buds per node, evenly spaced around it.", Unit::none, 0, 16),
        o.buds);
    list.add(Field{"whorls", "Only the last node of a season's shoot has lateral buds."}, o.whorls);
    list.add(Field{"vigour", "Number of segments that grow per leaf in full light.", Unit::none, 0, 100},
             o.vigour);
    list.add(
        common_field("apical_control",
                     "Share of growth that continues straight on, against one lateral with as much light: "
                     "larger values give a straight leader.",
                     Unit::none, 0, 1),
        o.apical_control);
    list.add(Field{"apical_dominance", "Number of nodes below a living tip with inhibited lateral buds.",
                   Unit::none, 0, 1000},
             o.apical_dominance);
    list.add(Field{"tip_death", "Probability that a tip dies after a season's shoot.", Unit::none, 0, 1},
             o.tip_death);
    list.add(Field{"tropism_x", "Preferred direction of axes, x component.", Unit::none, -1, 1}, o.tropism_x);
    list.add(Field{"tropism_y", "Preferred direction of axes, y component.", Unit::none, -1, 1}, o.tropism_y);
    list.add(Field{"tropism_z", "Preferred direction of axes, z component.", Unit::none, -1, 1}, o.tropism_z);
    list.add(Field{"stem_tropism", "Weight of the preferred direction for the stem.", Unit::none, -10, 10},
             o.stem_tropism);
    list.add(
        Field{"branch_tropism", "Weight of the preferred direction for branches; they hang if it is below 0.",
              Unit::none, -10, 10},
        o.branch_tropism);
    list.add(Field{"light_turn", "Weight of the direction towards more light.", Unit::none, 0, 10},
             o.light_turn);
    list.add(Field{"wobble", "Weight of a random direction.", Unit::none, 0, 10}, o.wobble);
    list.add(Field{"bud_light", "Minimum light in which buds sprout; 1 is full light.", Unit::none, 0, 1},
             o.bud_light);
    list.add(Field{"bud_seasons", "Number of seasons after which a lateral bud dies.", Unit::none, 1, 1000},
             o.bud_seasons);
    list.add(
        Field{"shed_light",
              "Minimum mean light of the leaves of a branch, below which it is shed; 0 sheds only branches "
              "without leaves.",
              Unit::none, 0, 1},
        o.shed_light);
    list.add(Field{"leaf_seasons", "Number of seasons that the leaves of a node live.", Unit::none, 1, 1000},
             o.leaf_seasons);
    list.add(Field{"shade", "Light that the leaves of a node absorb in their cell.", Unit::none, 0, 1},
             o.shade);
    list.add(Field{"shade_falloff", "Ratio of the shade in a layer of cells to the layer above.", Unit::none,
                   0, 1},
             o.shade_falloff);
    list.add(Field{"shade_depth",
                   "Number of shaded layers of cells below, and of cells on each side in the lowest layer.",
                   Unit::none, 0, 32},
             o.shade_depth);
    list.add(Field{"shade_cell", "Edge length of a cell; 0 uses two internodes.", Unit::metre, 0, 1e4},
             o.shade_cell);
    list.add(Field{"max_nodes", "Number of nodes at which growth stops.", Unit::none, 1, 1e8}, o.max_nodes);
    list.add(common_field("seed", "Seed of all random numbers.", Unit::none, 0, 2147483647), o.seed);
}

}  // namespace coppice
