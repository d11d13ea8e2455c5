#include <algorithm>
#include <atomic>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/growth/attractor_set_internal.h"

namespace coppice {
namespace {

// About half a millisecond; a second thread is not worthwhile for less.
constexpr std::size_t kNodeGrain = 256;
constexpr std::size_t kGroupGrain = 1 << 11;
constexpr double kUnit = 1 << 30;  // the sum of 2^32 unit vectors does not overflow 64 bits

std::vector<Box3> compute_boxes(std::span<const Vec3> points) {
    std::vector<Box3> boxes;
    boxes.reserve(points.size());
    for (const Vec3 p : points) boxes.push_back({p, p});
    return boxes;
}

template <class T>
T load(const T& value) {
    return std::atomic_ref<T>(const_cast<T&>(value)).load(std::memory_order_relaxed);
}

template <class T>
void store(T& value, T to) {
    std::atomic_ref<T>(value).store(to, std::memory_order_relaxed);
}

template <class T>
void add(T& value, T much) {
    std::atomic_ref<T>(value).fetch_add(much, std::memory_order_relaxed);
}

void add_pull(Pull& pull, std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t count) {
    add(pull.x, x);
    add(pull.y, y);
    add(pull.z, z);
    add(pull.count, count);
    store(pull.changed, std::uint16_t{1});
}

}  // namespace

AttractorSet::AttractorSet(std::span<const Vec3> attractors, float influence, float kill, const Context& ctx)
    : link_(attractors.size()), kill_squared_(kill * kill) {
    const float reach = influence * influence;
    const BoxTree tree(compute_boxes(attractors), ctx);
    number_.resize(tree.size());
    points_.resize(tree.group_count());
    parallel_for(ctx, points_.size(), kGroupGrain, [&](std::size_t group) {
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            const auto place = static_cast<std::uint32_t>(kWidth * group + i);
            const bool taken = place < tree.size();
            if (taken) number_[place] = tree.item(place);
            const Vec3 p = taken ? attractors[number_[place]] : Vec3{};
            points_[group].x[i] = p.x;
            points_[group].y[i] = p.y;
            points_[group].z[i] = p.z;
            points_[group].key[i] = taken ? make_key(reach, kNoIndex) : kSpent;
            if (taken) link_[place] = {kNoIndex, 0, 0, 0};
        }
    });
    copy_boxes(tree, reach);
}

void AttractorSet::copy_boxes(const BoxTree& tree, float reach) {
    for (std::uint32_t l = 1; l < tree.level_count(); ++l) {
        const std::span<const Box3> from = tree.level(l);
        Buffer<Boxes>& to = boxes_.emplace_back((from.size() + kWidth - 1) / kWidth);
        for (std::size_t i = 0; i < kWidth * to.size(); ++i) {
            Boxes& boxes = to[i / kWidth];
            const std::size_t k = i % kWidth;
            const Box3 box = i < from.size() ? from[i] : Box3{{}, {}};
            boxes.low_x[k] = box.low.x;
            boxes.low_y[k] = box.low.y;
            boxes.low_z[k] = box.low.z;
            boxes.high_x[k] = box.high.x;
            boxes.high_y[k] = box.high.y;
            boxes.high_z[k] = box.high.z;
            boxes.reach[k] = i < from.size() ? reach : -1;
        }
    }
}

float AttractorSet::offer_to_points(std::uint32_t group, const NewNode& n, Places& changed) {
    Points& points = points_[group];
    const Floats d = points.distances_squared(n.position);
    float reach = -1;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
        const Key offer = make_key(d[i], n.node);
        Key key = load(points.key[i]);
        while (offer < key) {
            const std::uint32_t before = get_node(key);
            if (!std::atomic_ref(points.key[i])
                     .compare_exchange_weak(key, offer, std::memory_order_relaxed)) {
                continue;
            }
            // The key of an earlier batch is replaced once, by one of the threads.
            if (before < n.first || before == kNoIndex) changed.push_back(kWidth * group + i);
            key = offer;
        }
        if (key != kSpent) reach = std::max(reach, compute_distance_squared(key));
    }
    return reach;
}

/// Returns the reach of the group. Threads may overwrite each other's reach with an older value, which is
/// only greater than necessary.
float AttractorSet::offer_below(std::uint32_t level, std::uint32_t group, const NewNode& n, Places& changed) {
    Boxes& boxes = boxes_[level][group];
    const Floats d = boxes.min_distances_squared(n.position);
    float widest = -1;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
        float reach = load(boxes.reach[i]);
        if (d[i] <= reach) {
            const std::uint32_t below = kWidth * group + i;
            reach =
                level == 0 ? offer_to_points(below, n, changed) : offer_below(level - 1, below, n, changed);
            store(boxes.reach[i], reach);
        }
        widest = std::max(widest, reach);
    }
    return widest;
}

/// Moves the contribution of an attractor from its old node to its new one. Returns whether it is spent.
bool AttractorSet::reassign(std::uint32_t place, std::span<const Vec3> nodes, std::span<Pull> pulls) {
    Link& link = link_[place];
    if (link.node != kNoIndex) add_pull(pulls[link.node], -link.x, -link.y, -link.z, ~std::uint32_t{0});
    const Key key = this->key(place);
    const std::uint32_t node = get_node(key);
    store(pulls[node].attracted, std::uint16_t{1});
    if (compute_distance_squared(key) <= kill_squared_) {
        this->key(place) = kSpent;
        link.node = kNoIndex;
        return true;
    }
    const Vec3d way = normalized(Vec3d(position(place)) - Vec3d(nodes[node])) * kUnit;
    link = {node, static_cast<std::int32_t>(way.x), static_cast<std::int32_t>(way.y),
            static_cast<std::int32_t>(way.z)};
    add_pull(pulls[node], link.x, link.y, link.z, 1);
    return false;
}

void AttractorSet::add_nodes(std::span<const Vec3> nodes, std::uint32_t first, std::span<Pull> pulls,
                             const Context& ctx) {
    const std::size_t count = nodes.size() - first;
    if (size() == 0 || count == 0) return;
    std::vector<Places> changed((count + kNodeGrain - 1) / kNodeGrain);
    const auto top = static_cast<std::uint32_t>(boxes_.size() - 1);
    parallel_for_ranges(ctx, count, kNodeGrain, [&](IndexRange range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const auto node = static_cast<std::uint32_t>(first + i);
            offer_below(top, 0, {nodes[node], node, first}, changed[range.begin / kNodeGrain]);
        }
    });
    spent_ += parallel_reduce(
        ctx, changed.size(), 1, 0u,
        [&](IndexRange range) {
            std::uint32_t spent = 0;
            for (const std::uint32_t place : changed[range.begin]) spent += reassign(place, nodes, pulls);
            return spent;
        },
        [](std::uint32_t a, std::uint32_t b) { return a + b; });
}

void AttractorSet::nearest_below(std::uint32_t level, std::uint32_t group, std::uint32_t node, Vec3 at,
                                 Target& best) const {
    const Boxes& boxes = boxes_[level][group];
    const Floats bound = boxes.min_distances_squared(at);
    for (std::uint32_t i = 0; i < kWidth; ++i) {
        // The attractors of a node are within reach; unused boxes contain no attractors.
        const float reach = load(boxes.reach[i]);
        if (node == kNoIndex ? reach < 0 : bound[i] > reach) continue;
        if (best.place != kNoIndex && bound[i] >= best.distance_squared) continue;
        const std::uint32_t below = kWidth * group + i;
        if (level > 0) {
            nearest_below(level - 1, below, node, at, best);
            continue;
        }
        const Floats d = points_[below].distances_squared(at);
        for (std::uint32_t k = 0; k < kWidth; ++k) {
            const std::uint32_t place = kWidth * below + k;
            if (points_[below].key[k] == kSpent || (node != kNoIndex && link_[place].node != node)) continue;
            if (best.place == kNoIndex || d[k] < best.distance_squared) best = {place, d[k]};
        }
    }
}

AttractorSet::Target AttractorSet::find_nearest(std::uint32_t node, Vec3 at) const {
    Target best;
    if (size() > 0) nearest_below(static_cast<std::uint32_t>(boxes_.size() - 1), 0, node, at, best);
    return best;
}

AttractorSet::Target AttractorSet::nearest(Vec3 at) const { return find_nearest(kNoIndex, at); }

void AttractorSet::drop(std::uint32_t place, std::span<Pull> pulls) {
    Link& link = link_[place];
    add_pull(pulls[link.node], -link.x, -link.y, -link.z, ~std::uint32_t{0});
    link.node = kNoIndex;
}

std::vector<std::uint32_t> AttractorSet::remaining() const {
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t place = 0; place < size(); ++place) {
        if (key(place) != kSpent) numbers.push_back(number_[place]);
    }
    std::ranges::sort(numbers);
    return numbers;
}

}  // namespace coppice
