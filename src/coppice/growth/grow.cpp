#include "coppice/growth/grow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/growth/attractor_set_internal.h"
#include "coppice/growth/node_grid_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 1024;       // nodes whose plans are worth a thread of their own
constexpr std::size_t kGuardedGrain = 64;  // the same where each samples a field
constexpr std::uint32_t kNone = AttractorSet::kNone;
constexpr double kLeastPull = 1e-6;  // of the number of attractors: below, their directions cancel

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

void check_position(Vec3 p, float step, const char* what, std::size_t number) {
    if (!is_finite(p)) throw InvalidInput(fmt::format("grow: {} {} has no finite position", what, number));
    const float far = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    // A step is then at least 16 times the distance of neighbouring numbers.
    if (far * 0x1p-19f <= step) return;
    throw InvalidInput(
        fmt::format("grow: a step of {} is too small at {} {}, {} from the origin; move the scene "
                    "nearer to it or lengthen the step",
                    step, what, number, far));
}

void check_input(const GrowInput& input, float step) {
    if (input.roots.empty()) throw InvalidInput("grow: there is no root to grow from; give at least one");
    if (input.attractors.size() >= kNone) {
        throw InvalidInput(fmt::format("grow: {} attractors are too many; give fewer than 2^32 - 1",
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
            throw InvalidInput(fmt::format("grow: root {} lies where the guard bars growth; move it", i));
        }
    }
}

class Grower {
  public:
    Grower(const GrowInput& input, const GrowOptions& options, const Context& ctx)
        : input_(input),
          options_(options),
          ctx_(ctx),
          attractors_(input.attractors, options.influence_radius, options.kill_radius, ctx),
          grid_(options.min_spacing * options.step),
          random_(static_cast<std::uint64_t>(options.seed), 0),
          tropism_(normalized(Vec3d{options.tropism_x, options.tropism_y, options.tropism_z}) *
                   options.tropism_weight) {}

    GrowResult run() {
        plant();
        StopReason stop = StopReason::no_progress;
        int iteration = 0;
        for (; attractors_.spent() < attractors_.size() && !live_.empty(); ++iteration) {
            if (full_ || iteration == options_.max_iterations) {
                stop = full_ ? StopReason::node_limit : StopReason::iteration_limit;
                break;
            }
            ctx_.throw_if_cancelled();
            ctx_.report(static_cast<float>(attractors_.spent()) / static_cast<float>(attractors_.size()));
            iterate();
        }
        if (full_) stop = StopReason::node_limit;
        if (attractors_.spent() == attractors_.size()) stop = StopReason::attractors_spent;
        ctx_.report(1);
        return {harvest(), stop, iteration, stalls_, dropped_, attractors_.left()};
    }

  private:
    /// What a node does in an iteration: nothing, grow, or give its target up.
    struct Plan {
        std::optional<Vec3> child;
        std::uint32_t target = kNone;  ///< the attractor that a stalled node goes for
        bool done = false;             ///< the node has no bud left
    };

    std::uint32_t node_count() const { return static_cast<std::uint32_t>(position_.size()); }

    bool add_node(Vec3 p, std::uint32_t parent) {
        if (position_.size() >= static_cast<std::size_t>(options_.max_nodes)) {
            full_ = true;
            return false;
        }
        std::uint32_t rank = 0;
        // A lateral starts an axis of its own.
        if (parent != kNone) rank = children_[parent]++ == 0 ? rank_[parent] + 1 : 1;
        position_.push_back(p);
        parent_.push_back(parent);
        children_.push_back(0);
        rank_.push_back(rank);
        pull_.push_back({.changed = 1});
        grid_.insert(position_);
        return true;
    }

    void plant() {
        for (const Root& root : input_.roots) {
            if (!add_node(root.position, kNone)) break;
        }
        const std::uint32_t roots = node_count();
        if (options_.trunk && attractors_.size() > 0) {
            for (std::uint32_t root = 0; root < roots && !full_; ++root) grow_trunk(root);
        }
        settle_from(0);
    }

    /// Straight on, as long as that leads at least half as fast to the attractors as the straight way.
    void grow_trunk(std::uint32_t root) {
        Vec3d given = normalized(Vec3d(input_.roots[root].direction), {});
        std::uint32_t node = root;
        AttractorSet::Target target = attractors_.nearest(position_[node]);
        while (std::sqrt(target.distance_squared) > options_.influence_radius) {
            ctx_.throw_if_cancelled();
            std::optional<Vec3> next;
            if (given != Vec3d{}) next = nearer_step(node, given, target);
            if (!next) {
                given = {};  // once left, it is not taken up again: the trunk would zigzag
                next = nearer_step(node, toward(node, target.place), target);
            }
            if (!next || grid_.any_near(*next, position_, 0) || !add_node(*next, node)) return;
            node = node_count() - 1;
            pull_[node].served = 1;
        }
    }

    /// One step on, where that comes nearer to an attractor by half a step; then `target` is that.
    std::optional<Vec3> nearer_step(std::uint32_t node, Vec3d direction, AttractorSet::Target& target) const {
        const std::optional<Vec3> next = advanced(node, direction);
        if (!next) return std::nullopt;
        const AttractorSet::Target nearest = attractors_.nearest(*next);
        const float gain = std::sqrt(target.distance_squared) - std::sqrt(nearest.distance_squared);
        if (gain < 0.5f * options_.step) return std::nullopt;
        target = nearest;
        return next;
    }

    void iterate() {
        plans_.assign(live_.size(), {});
        const std::size_t grain = input_.guard ? kGuardedGrain : kGrain;
        parallel_for(ctx_, live_.size(), grain, [&](std::size_t i) { plans_[i] = plan(live_[i]); });
        const std::uint32_t first = node_count();
        for (std::size_t i = 0; i < live_.size() && !full_; ++i) carry_out(live_[i], plans_[i], first);
        settle_from(first);
    }

    /// Makes new nodes known to the attractors, and finds who goes on.
    void settle_from(std::uint32_t first) {
        attractors_.add_nodes(position_, first, pull_, ctx_);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < live_.size(); ++i) {
            if (!plans_[i].done && pull_[live_[i]].count > 0) live_[kept++] = live_[i];
        }
        live_.resize(kept);
        for (std::uint32_t n = first; n < node_count(); ++n) {
            if (pull_[n].count > 0) live_.push_back(n);
        }
    }

    Plan plan(std::uint32_t node) const {
        if (!has_bud(node)) return {.done = true};
        if (pull_[node].changed != 0) {
            if (const auto direction = pulled(node)) {
                const auto child = advanced(node, *direction);
                if (child && !grid_.any_near(*child, position_, 0)) return {.child = child};
            }
        }
        const AttractorSet::Target target = attractors_.nearest_of(node, position_[node]);
        auto child = advanced(node, toward(node, target.place));
        const bool nearer =
            child && length_squared(attractors_.position(target.place) - *child) < target.distance_squared;
        if (!nearer || grid_.any_near(*child, position_, 0)) child.reset();
        return {.child = child, .target = target.place};
    }

    void carry_out(std::uint32_t node, const Plan& plan, std::uint32_t first) {
        if (plan.done) return;
        pull_[node].changed = 0;
        if (plan.target != kNone) ++stalls_;
        if (!plan.child) {
            attractors_.drop(plan.target, pull_);
            ++dropped_;
        } else if (!grid_.any_near(*plan.child, position_, first)) {
            add_node(*plan.child, node);
        }
    }

    bool has_bud(std::uint32_t node) const {
        const std::uint32_t children = children_[node];
        if (children == 0) return true;
        if (options_.max_children > 0 && children >= static_cast<std::uint32_t>(options_.max_children))
            return false;
        return rank_[node] % static_cast<std::uint32_t>(options_.bud_interval) == 0;
    }

    /// The direction a node is drawn to, unless everything cancels.
    std::optional<Vec3d> pulled(std::uint32_t node) const {
        const Pull& pull = pull_[node];
        const Vec3d sum =
            Vec3d(static_cast<double>(pull.x), static_cast<double>(pull.y), static_cast<double>(pull.z)) *
            0x1p-30;
        if (length(sum) < kLeastPull * pull.count) return std::nullopt;
        Vec3d direction = normalized(sum) + tropism_;
        if (options_.jitter > 0) direction += random_direction(node) * options_.jitter;
        if (length(direction) < kLeastPull) return std::nullopt;
        return normalized(direction);
    }

    Vec3d random_direction(std::uint32_t node) const {
        const std::uint64_t index = (std::uint64_t{node} << 24) + 3ull * children_[node];
        const auto draw = [&](std::uint64_t i) { return random_.uniform(index + i, -1, 1); };
        return normalized(Vec3d{draw(0), draw(1), draw(2)});
    }

    Vec3d toward(std::uint32_t node, std::uint32_t place) const {
        return normalized(Vec3d(attractors_.position(place)) - Vec3d(position_[node]));
    }

    /// The direction of the segment that ends at a node; 0 at roots that have none.
    Vec3d incoming(std::uint32_t node) const {
        if (parent_[node] == kNone) return normalized(Vec3d(input_.roots[node].direction), {});
        return normalized(Vec3d(position_[node]) - Vec3d(position_[parent_[node]]));
    }

    Vec3d limited(Vec3d direction, Vec3d in) const {
        if (in == Vec3d{} || std::acos(std::clamp(dot(direction, in), -1.0, 1.0)) <= options_.max_turn)
            return direction;
        const Vec3d side = normalized(direction - in * dot(direction, in), perpendicular(in));
        return in * std::cos(options_.max_turn) + side * std::sin(options_.max_turn);
    }

    /// One step on, within the turn and past the guard.
    std::optional<Vec3> advanced(std::uint32_t node, Vec3d direction) const {
        const Vec3d way = limited(direction, incoming(node));
        if (input_.guard) return input_.guard->step(position_[node], Vec3(way), options_.step);
        return Vec3(Vec3d(position_[node]) + way * options_.step);
    }

    Skeleton harvest() const {
        std::vector<NodeId> image(node_count()), parents;
        std::vector<Vec3> positions;
        for (std::uint32_t n = 0; n < node_count(); ++n) {
            const bool root = parent_[n] == kNone;
            if (!root && children_[n] == 0 && pull_[n].served == 0) continue;
            image[n] = NodeId(static_cast<std::uint32_t>(parents.size()));
            parents.push_back(root ? NodeId::none() : image[parent_[n]]);
            positions.push_back(position_[n]);
        }
        std::vector<float> radii(parents.size(), 0.1f * options_.step);
        return Skeleton(std::move(parents), std::move(positions), std::move(radii), input_.origin);
    }

    const GrowInput& input_;
    const GrowOptions& options_;
    const Context& ctx_;
    AttractorSet attractors_;
    NodeGrid grid_;
    CounterRandom random_;
    Vec3d tropism_;

    Buffer<Vec3> position_;
    Buffer<std::uint32_t> parent_, children_;
    Buffer<std::uint32_t> rank_;  // nodes along the axis from its start
    Buffer<Pull> pull_;
    std::vector<std::uint32_t> live_;  // nodes with attractors, rising
    std::vector<Plan> plans_;          // of the live nodes
    std::uint32_t stalls_ = 0, dropped_ = 0;
    bool full_ = false;
};

}  // namespace

GrowResult grow(const GrowInput& input, const GrowOptions& options, const Context& ctx) {
    check_options(options);
    check_input(input, options.step);
    return Grower(input, options, ctx).run();
}

}  // namespace coppice
