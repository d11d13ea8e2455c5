#include "coppice/edit/animate/growing.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"

namespace coppice {
namespace {

constexpr double kLongestGrowth = 0.03;  // [total time] maximum growth time of a segment with Age::order
constexpr double kShown = 0.02;  // [segment length] minimum visible fraction; shorter ones are omitted
constexpr float kMinTip = 0.4f;  // [minimum radius of the tree] radius of new tips

std::vector<double> compute_lengths(const Skeleton& s) {
    std::vector<double> out(s.size());
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) out[n.index()] = double{distance(s.position(n), s.position(s.parent(n)))};
    }
    return out;
}

// Adds the values of all descendants to each node.
void add_up(const Skeleton& s, std::vector<double>& lengths) {
    for (std::uint32_t i = s.size(); i-- > 0;) {
        if (const NodeId parent = s.parent(NodeId(i))) lengths[parent.index()] += lengths[i];
    }
}

}  // namespace

GrowingTree::GrowingTree(const Skeleton& s, const GrowingOptions& options)
    : skeleton_(s),
      exponent_(double{options.exponent}),
      min_radius_(kMinTip * *std::ranges::min_element(s.radii())),
      start_(s.size()),
      end_(s.size()),
      above_(compute_lengths(s)) {
    check_fields(options, "growing");
    double last = 0;
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        if (s.is_root(n)) continue;
        const double before = end_[s.parent(n).index()];
        end_[i] = options.age == Age::length
                      ? before + above_[i]
                      : std::sqrt(static_cast<double>(i) / static_cast<double>(s.size() - 1));
        last = std::max(last, end_[i]);
    }
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        if (s.is_root(n)) continue;
        if (last > 0) end_[i] /= last;
        start_[i] = end_[s.parent(n).index()];
        if (options.age == Age::order) start_[i] = std::max(start_[i], end_[i] - kLongestGrowth);
    }
    add_up(s, above_);
}

Skeleton GrowingTree::at(double part) const {
    const Skeleton& s = skeleton_;
    if (part >= 1) return s;
    std::vector<double> grown = compute_lengths(s), share(s.size());
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        const double time = end_[i] - start_[i];
        share[i] = s.is_root(n) || part >= end_[i] ? 1
                   : time > 0                      ? std::max(0.0, (part - start_[i]) / time)
                                                   : 0;
        if (!s.is_root(n) && share[i] < 1 && s.is_root(s.parent(n)) && s.leader(s.parent(n)) == n)
            share[i] = std::max(share[i], kShown);
        grown[i] *= share[i];
    }
    add_up(s, grown);
    std::vector<NodeId> new_node(s.size()), parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    std::vector<StableId> ids;
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index();
        const NodeId above = s.parent(n);
        if (share[i] < kShown || (above && (!new_node[above.index()] || share[above.index()] < 1))) continue;
        new_node[i] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(above ? new_node[above.index()] : NodeId::none());
        position.push_back(above ? Vec3(lerp(Vec3d(s.position(above)), Vec3d(s.position(n)), share[i]))
                                 : s.position(n));
        const double of_whole = above_[i] > 0 ? grown[i] / above_[i] : 1;
        const auto thick = static_cast<float>(std::pow(of_whole, 1 / exponent_) * double{s.radius(n)});
        radius.push_back(std::clamp(thick, std::min(min_radius_, s.radius(n)), s.radius(n)));
        ids.push_back(s.stable_id(n));
    }
    return {std::move(parent), std::move(position), std::move(radius), s.origin(), std::move(ids)};
}

void list_fields(GrowingOptions& o, FieldList& list) {
    list.add(
        Field{"age",
              "Quantity that determines when nodes appear: path length from the root, or the order of the "
              "nodes, as in grown trees."},
        o.age);
    list.add(
        Field{"exponent",
              "Exponent of the pipe model by which branches thicken; larger values thicken them earlier.",
              Unit::none, 1, 10},
        o.exponent);
}

}  // namespace coppice
