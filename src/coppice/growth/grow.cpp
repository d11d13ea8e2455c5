#include "coppice/growth/grow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/base/random.h"
#include "coppice/growth/attractor_set_internal.h"
#include "coppice/growth/node_grid_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kGrowGrain = 1024;   // minimum number of nodes per thread
constexpr std::size_t kGuardedGrain = 64;  // the same if each node samples a field
// Relative to the number of attractors: minimum length at which their directions do not cancel.
constexpr double kMinPull = 1e-6;

void check_options(const GrowOptions& o) {
    check_fields(o, "grow");
    if (o.kill_radius < o.step) {
        throw InvalidInput(fmt::format("grow: kill_radius must be at least the step of {}, but is {}", o.step,
                                       o.kill_radius));
    }
    if (o.influence_radius < o.kill_radius) {
        throw InvalidInput(
            fmt::format("grow: influence_radius must be at least the kill_radius of {}, but is {}",
                        o.kill_radius, o.influence_radius));
    }
    if (o.tropism_weight > 0 && o.tropism_x == 0 && o.tropism_y == 0 && o.tropism_z == 0) {
        throw InvalidInput(
            "grow: tropism needs a direction, but tropism_x, tropism_y and tropism_z are all 0");
    }
}

void check_position(Vec3 p, float step, const char* subject, std::size_t number) {
    if (!is_finite(p)) throw InvalidInput(fmt::format("grow: {} {} has no finite position", subject, number));
    const float far = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    // A step is then at least 16 times the distance between adjacent floats.
    if (far * 0x1p-19f <= step) return;
    throw InvalidInput(
        fmt::format("grow: a step of {} is too small at {} {}, which is {} from the origin; move the scene "
                    "closer to the origin or increase the step",
                    step, subject, number, far));
}

void check_tree(const Skeleton& tree, const GrowOptions& o) {
    if (tree.size() > static_cast<std::uint32_t>(o.max_nodes)) {
        throw InvalidInput(fmt::format("grow: the existing tree has {} nodes, but max_nodes is {}",
                                       tree.size(), o.max_nodes));
    }
    for (const NodeId n : nodes(tree)) check_position(tree.position(n), o.step, "node", n.index());
}

void check_input(const GrowInput& input, float step) {
    if (input.roots.empty() && !input.tree)
        throw InvalidInput("grow: there is no root to grow from; specify at least one");
    if (input.attractors.size() >= kNoIndex) {
        throw InvalidInput(fmt::format("grow: {} attractors are too many; use fewer than 2^32 - 1",
                                       input.attractors.size()));
    }
    for (std::size_t i = 0; i < input.attractors.size(); ++i)
        check_position(input.attractors[i], step, "attractor", i);
    for (std::size_t i = 0; i < input.roots.size(); ++i) {
        const Root& root = input.roots[i];
        check_position(root.position, step, "root", i);
        if (!is_finite(root.direction))
            throw InvalidInput(fmt::format("grow: root {} has no finite direction", i));
        if (input.guard && !input.guard->allows(root.position)) {
            throw InvalidInput(
                fmt::format("grow: root {} is in a region that the guard excludes; move it", i));
        }
    }
}

/// Input and options of the growth.
struct Task {
    const GrowInput& input;
    const GrowOptions& options;
    CounterRandom random;
    Vec3d tropism;
};

/// The nodes created so far, in the order of creation.
struct Nodes {
    Buffer<Vec3> position;
    Buffer<std::uint32_t> parent, children;
    Buffer<std::uint32_t> rank;  ///< number of nodes along the axis from its start
    Buffer<Pull> pull;
    NodeGrid grid;

    std::uint32_t size() const { return static_cast<std::uint32_t>(position.size()); }
};

/// The action of a node in an iteration: nothing, growth, or removal of its target.
struct Plan {
    std::optional<Vec3> child;
    std::uint32_t target = kNoIndex;  ///< the only attractor to which a stalled node grows
    bool done = false;                ///< the node has no bud left
};

struct Growth {
    Task task;
    AttractorSet attractors;
    Nodes nodes;
    std::vector<std::uint32_t> active;  ///< nodes with attractors, sorted
    std::vector<Plan> plans;            ///< of the active nodes
    std::uint32_t stalls = 0, dropped = 0;
    bool full = false;  ///< max_nodes is reached

    /// Returns the number of nodes of the existing tree; they are first, followed by the roots.
    std::uint32_t old_nodes() const { return task.input.tree ? task.input.tree->size() : 0; }
};

/// Adds a node unless max_nodes is reached. A crowded node does not block others, because another node there
/// does.
bool add_node(Growth& g, Vec3 p, std::uint32_t parent, bool crowded = false) {
    Nodes& nodes = g.nodes;
    if (nodes.size() >= static_cast<std::size_t>(g.task.options.max_nodes)) {
        g.full = true;
        return false;
    }
    std::uint32_t rank = 0;
    // A lateral starts a new axis.
    if (parent != kNoIndex) rank = nodes.children[parent]++ == 0 ? nodes.rank[parent] + 1 : 1;
    nodes.position.push_back(p);
    nodes.parent.push_back(parent);
    nodes.children.push_back(0);
    nodes.rank.push_back(rank);
    nodes.pull.push_back({.changed = 1});
    nodes.grid.insert(nodes.position, crowded);
    return true;
}

/// Returns the direction specified for a root; 0 for all other nodes.
Vec3d given_direction(const Growth& g, std::uint32_t node) {
    const std::uint32_t old = g.old_nodes();
    if (node < old || node - old >= g.task.input.roots.size()) return {};
    return normalized(Vec3d(g.task.input.roots[node - old].direction), {});
}

/// Returns the direction of the segment that ends at a node; 0 at roots without a direction.
Vec3d incoming_direction(const Growth& g, std::uint32_t node) {
    const Nodes& nodes = g.nodes;
    if (nodes.parent[node] == kNoIndex) return given_direction(g, node);
    return normalized(Vec3d(nodes.position[node]) - Vec3d(nodes.position[nodes.parent[node]]));
}

/// Returns the direction, or the closest one that turns by at most max_turn.
Vec3d within_turn(Vec3d direction, Vec3d incoming, float max_turn) {
    if (incoming == Vec3d{} || std::acos(std::clamp(dot(direction, incoming), -1.0, 1.0)) <= max_turn)
        return direction;
    const Vec3d side = normalized(direction - incoming * dot(direction, incoming), perpendicular(incoming));
    return incoming * std::cos(max_turn) + side * std::sin(max_turn);
}

/// Returns the end of the next step, limited by the turn and the guard.
std::optional<Vec3> step_from(const Growth& g, std::uint32_t node, Vec3d direction) {
    const GrowOptions& options = g.task.options;
    const Vec3d way = within_turn(direction, incoming_direction(g, node), options.max_turn);
    const Vec3 from = g.nodes.position[node];
    if (g.task.input.guard) return g.task.input.guard->step(from, Vec3(way), options.step);
    return Vec3(Vec3d(from) + way * options.step);
}

Vec3d direction_to(const Growth& g, std::uint32_t node, std::uint32_t place) {
    return normalized(Vec3d(g.attractors.position(place)) - Vec3d(g.nodes.position[node]));
}

/// Returns the end of the next step if it approaches an attractor by half a step; then `target` is set to
/// that attractor.
std::optional<Vec3> nearer_step(const Growth& g, std::uint32_t node, Vec3d direction,
                                AttractorSet::Target& target) {
    const std::optional<Vec3> next = step_from(g, node, direction);
    if (!next) return std::nullopt;
    const AttractorSet::Target nearest = g.attractors.nearest(*next);
    const float gain = std::sqrt(target.distance_squared) - std::sqrt(nearest.distance_squared);
    if (gain < 0.5f * g.task.options.step) return std::nullopt;
    target = nearest;
    return next;
}

/// Grows straight on, as long as that approaches the attractors at least half as fast as the direct path.
void grow_trunk(Growth& g, std::uint32_t root, const Context& ctx) {
    Vec3d given = given_direction(g, root);
    std::uint32_t node = root;
    AttractorSet::Target target = g.attractors.nearest(g.nodes.position[node]);
    while (std::sqrt(target.distance_squared) > g.task.options.influence_radius) {
        ctx.throw_if_cancelled();
        std::optional<Vec3> next;
        if (given != Vec3d{}) next = nearer_step(g, node, given, target);
        if (!next) {
            given = {};  // not used again after the first deviation, because the trunk would zigzag
            next = nearer_step(g, node, direction_to(g, node, target.place), target);
        }
        if (!next || g.nodes.grid.any_near(*next, g.nodes.position, 0) || !add_node(g, *next, node)) return;
        node = g.nodes.size() - 1;
        g.nodes.pull[node].attracted = 1;
    }
}

/// Adds the nodes from `first` on to the attractors, and updates the active nodes.
void assign_attractors(Growth& g, std::uint32_t first, const Context& ctx) {
    g.attractors.add_nodes(g.nodes.position, first, g.nodes.pull, ctx);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < g.active.size(); ++i) {
        if (!g.plans[i].done && g.nodes.pull[g.active[i]].count > 0) g.active[kept++] = g.active[i];
    }
    g.active.resize(kept);
    for (std::uint32_t n = first; n < g.nodes.size(); ++n) {
        if (g.nodes.pull[n].count > 0) g.active.push_back(n);
    }
}

/// Adds the nodes of the existing tree.
void take_tree(Growth& g, const Skeleton& tree) {
    for (const NodeId n : nodes(tree)) {
        const NodeId parent = tree.parent(n);
        const bool crowded = g.nodes.grid.any_near(tree.position(n), g.nodes.position, 0);
        add_node(g, tree.position(n), parent ? parent.index() : kNoIndex, crowded);
        // At an existing fork the leader continues the axis, not the first child.
        const bool leads = parent && tree.leader(parent) == n;
        g.nodes.rank[n.index()] = !parent ? 0 : leads ? g.nodes.rank[parent.index()] + 1 : 1;
    }
}

/// Returns the existing node nearest to an attractor.
std::uint32_t node_nearest_to_attractors(const Growth& g, const Context& ctx) {
    std::uint32_t nearest = 0;
    float least = std::numeric_limits<float>::infinity();
    for (std::uint32_t n = 0; n < g.old_nodes(); ++n) {
        if (n % kGrowGrain == 0) ctx.throw_if_cancelled();
        const float d = g.attractors.nearest(g.nodes.position[n]).distance_squared;
        if (d < least) nearest = n;
        least = std::min(least, d);
    }
    return nearest;
}

void start(Growth& g, const Context& ctx) {
    if (g.task.input.tree) take_tree(g, *g.task.input.tree);
    const std::uint32_t first_root = g.nodes.size();
    for (const Root& root : g.task.input.roots) {
        if (!add_node(g, root.position, kNoIndex)) break;
    }
    const std::uint32_t roots = g.nodes.size();
    if (g.task.options.trunk && g.attractors.size() > 0) {
        if (first_root > 0) grow_trunk(g, node_nearest_to_attractors(g, ctx), ctx);
        for (std::uint32_t root = first_root; root < roots && !g.full; ++root) grow_trunk(g, root, ctx);
    }
    assign_attractors(g, 0, ctx);
}

bool has_bud(const Growth& g, std::uint32_t node) {
    const GrowOptions& options = g.task.options;
    const std::uint32_t children = g.nodes.children[node];
    if (children == 0) return true;
    if (options.max_children > 0 && children >= static_cast<std::uint32_t>(options.max_children))
        return false;
    return g.nodes.rank[node] % static_cast<std::uint32_t>(options.bud_interval) == 0;
}

Vec3d random_direction(const Growth& g, std::uint32_t node) {
    const std::uint64_t index = (std::uint64_t{node} << 24) + 3ull * g.nodes.children[node];
    const auto draw = [&](std::uint64_t i) { return g.task.random.uniform(index + i, -1, 1); };
    return normalized(Vec3d{draw(0), draw(1), draw(2)});
}

/// Returns the direction in which a node is pulled, unless the contributions cancel.
std::optional<Vec3d> pull_direction(const Growth& g, std::uint32_t node) {
    const Pull& pull = g.nodes.pull[node];
    const Vec3d sum =
        Vec3d(static_cast<double>(pull.x), static_cast<double>(pull.y), static_cast<double>(pull.z)) *
        0x1p-30;
    if (length(sum) < kMinPull * pull.count) return std::nullopt;
    Vec3d direction = normalized(sum) + g.task.tropism;
    if (g.task.options.jitter > 0) direction += random_direction(g, node) * g.task.options.jitter;
    if (length(direction) < kMinPull) return std::nullopt;
    return normalized(direction);
}

Plan make_plan(const Growth& g, std::uint32_t node) {
    const Nodes& nodes = g.nodes;
    if (!has_bud(g, node)) return {.done = true};
    if (nodes.pull[node].changed != 0) {
        if (const auto direction = pull_direction(g, node)) {
            const auto child = step_from(g, node, *direction);
            if (child && !nodes.grid.any_near(*child, nodes.position, 0)) return {.child = child};
        }
    }
    const AttractorSet::Target target = g.attractors.find_nearest(node, nodes.position[node]);
    auto child = step_from(g, node, direction_to(g, node, target.place));
    const bool nearer =
        child && length_squared(g.attractors.position(target.place) - *child) < target.distance_squared;
    if (!nearer || nodes.grid.any_near(*child, nodes.position, 0)) child.reset();
    return {.child = child, .target = target.place};
}

/// Nodes from `first` on were created in the same iteration.
void apply_plan(Growth& g, std::uint32_t node, const Plan& plan, std::uint32_t first) {
    if (plan.done) return;
    g.nodes.pull[node].changed = 0;
    if (plan.target != kNoIndex) ++g.stalls;
    if (!plan.child) {
        g.attractors.drop(plan.target, g.nodes.pull);
        ++g.dropped;
    } else if (!g.nodes.grid.any_near(*plan.child, g.nodes.position, first)) {
        add_node(g, *plan.child, node);
    }
}

void iterate(Growth& g, const Context& ctx) {
    g.plans.assign(g.active.size(), {});
    const std::size_t grain = g.task.input.guard ? kGuardedGrain : kGrowGrain;
    parallel_for(ctx, g.active.size(), grain, [&](std::size_t i) { g.plans[i] = make_plan(g, g.active[i]); });
    const std::uint32_t first = g.nodes.size();
    for (std::size_t i = 0; i < g.active.size() && !g.full; ++i)
        apply_plan(g, g.active[i], g.plans[i], first);
    assign_attractors(g, first, ctx);
}

/// Returns the ids of the existing nodes, followed by larger ids for the new ones; empty if the existing tree
/// has no ids.
std::vector<StableId> stable_ids(const Growth& g, std::size_t count) {
    if (!g.task.input.tree || g.task.input.tree->stable_ids().empty()) return {};
    const auto old = g.task.input.tree->stable_ids();
    std::vector<StableId> ids(old.begin(), old.end());
    std::uint32_t next = 0;
    for (const StableId id : ids) next = std::max(next, id.index() + 1);
    while (ids.size() < count) ids.emplace_back(next++);
    return ids;
}

/// Omits the new tips that were never nearest to an attractor.
Skeleton make_skeleton(const Growth& g) {
    const Nodes& nodes = g.nodes;
    const std::uint32_t old = g.old_nodes();
    std::vector<NodeId> image(nodes.size()), parents;
    std::vector<Vec3> positions;
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
        const bool root = nodes.parent[n] == kNoIndex;
        if (n >= old && !root && nodes.children[n] == 0 && nodes.pull[n].attracted == 0) continue;
        image[n] = NodeId(static_cast<std::uint32_t>(parents.size()));
        parents.push_back(root ? NodeId::none() : image[nodes.parent[n]]);
        positions.push_back(nodes.position[n]);
    }
    std::vector<float> radii(parents.size(), 0.1f * g.task.options.step);
    const Skeleton* tree = g.task.input.tree;
    if (tree) std::ranges::copy(tree->radii(), radii.begin());
    std::vector<StableId> ids = stable_ids(g, parents.size());
    return Skeleton(std::move(parents), std::move(positions), std::move(radii),
                    tree ? tree->origin() : g.task.input.origin, std::move(ids));
}

Growth begin_growth(const GrowInput& input, const GrowOptions& o, const Context& ctx) {
    const Vec3d tropism = normalized(Vec3d{o.tropism_x, o.tropism_y, o.tropism_z}) * o.tropism_weight;
    return {.task = {input, o, CounterRandom(static_cast<std::uint64_t>(o.seed), 0), tropism},
            .attractors = AttractorSet(input.attractors, o.influence_radius, o.kill_radius, ctx),
            .nodes = {.grid = NodeGrid(o.min_spacing * o.step)}};
}

}  // namespace

GrowResult grow(const GrowInput& input, const GrowOptions& options, const Context& ctx) {
    check_options(options);
    check_input(input, options.step);
    if (input.tree) check_tree(*input.tree, options);
    Growth g = begin_growth(input, options, ctx);
    start(g, ctx);
    StopReason stop = StopReason::no_progress;
    int iteration = 0;
    for (; g.attractors.spent() < g.attractors.size() && !g.active.empty(); ++iteration) {
        if (g.full || iteration == options.max_iterations) {
            stop = g.full ? StopReason::node_limit : StopReason::iteration_limit;
            break;
        }
        check_in(ctx, g.attractors.spent(), g.attractors.size());
        iterate(g, ctx);
        if (!input.watch) continue;
        input.watch(
            {.nodes = g.nodes.size(), .rounds = iteration + 1, .limit = "max_iterations", .skeleton = [&g] {
                 return make_skeleton(g);
             }});
    }
    if (g.full) stop = StopReason::node_limit;
    if (g.attractors.spent() == g.attractors.size()) stop = StopReason::attractors_spent;
    ctx.report(1);
    return {make_skeleton(g), stop, iteration, g.stalls, g.dropped, g.attractors.remaining()};
}

void list_fields(GrowOptions& o, FieldList& list) {
    list.add(Field{"influence_radius", "Distance within which attractors pull.", Unit::metre, 1e-6, 1e6},
             o.influence_radius);
    list.add(Field{"kill_radius", "Distance within which attractors are spent.", Unit::metre, 1e-6, 1e6},
             o.kill_radius);
    list.add(Field{"step", "Length of new segments.", Unit::metre, 1e-6, 1e4}, o.step);
    list.add(Field{"tropism_x", "Preferred direction of branches, x component.", Unit::none, -1, 1},
             o.tropism_x);
    list.add(Field{"tropism_y", "Preferred direction of branches, y component.", Unit::none, -1, 1},
             o.tropism_y);
    list.add(Field{"tropism_z", "Preferred direction of branches, z component.", Unit::none, -1, 1},
             o.tropism_z);
    list.add(Field{"tropism_weight", "Weight of the preferred direction relative to the attractors.",
                   Unit::none, 0, 10},
             o.tropism_weight);
    list.add(Field{"jitter", "Weight of a random direction relative to the attractors.", Unit::none, 0, 10},
             o.jitter);
    list.add(Field{"min_spacing", "Minimum distance between nodes in steps.", Unit::none, 0.01, 0.9},
             o.min_spacing);
    list.add(
        Field{"max_turn", "Maximum angle between a segment and the previous one.", Unit::radian, 0.05, 3.15},
        o.max_turn);
    list.add(Field{"max_children", "Maximum number of segments that start at a node; 0 means unlimited.",
                   Unit::none, 0, 1000},
             o.max_children);
    list.add(Field{"bud_interval",
                   "Interval of the nodes along an axis at which laterals may start; 1 uses every node.",
                   Unit::none, 1, 10'000},
             o.bud_interval);
    list.add(Field{"trunk", "Let roots out of reach of the attractors grow towards the nearest one."},
             o.trunk);
    list.add(Field{"max_nodes", "Number of nodes at which growth stops.", Unit::none, 1, 1e8}, o.max_nodes);
    list.add(Field{"max_iterations", "Number of iterations at which growth stops.", Unit::none, 0, 1e9},
             o.max_iterations);
    list.add(Field{"seed", "Seed of the random directions.", Unit::none, 0, 2147483647}, o.seed);
}

}  // namespace coppice
