#include "coppice/skeleton/random_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/random.h"
#include "coppice/skeleton/pipe_model.h"

namespace coppice {
namespace {

constexpr double kTipRadius = 0.01;
constexpr double kPipeExponent = 2.2;
constexpr double kClearance = 1.25;  // multiple of the sum of radii below which branches overlap
constexpr int kTries = 20;

enum Stage : std::uint64_t { kTopology, kAzimuth, kShape };

/// A sequence of random numbers, for structures that are built in a fixed order.
class Draws {
  public:
    Draws(std::uint64_t seed, Stage stage) : random_(seed, stage) {}
    double uniform(double low = 0, double high = 1) { return random_.uniform(next_++, low, high); }

  private:
    CounterRandom random_;
    std::uint64_t next_ = 0;
};

struct Topology {
    std::vector<std::uint32_t> parent{0};
    std::vector<bool> lateral{false};  // whether it is the first node of a lateral
    std::uint32_t left = 0;            // number of remaining segments

    std::uint32_t size() const { return static_cast<std::uint32_t>(parent.size()); }
    std::uint32_t add(std::uint32_t parent_index, bool first_of_lateral) {
        parent.push_back(parent_index);
        lateral.push_back(first_of_lateral);
        --left;
        return size() - 1;
    }
};

/// An axis with the nodes base, first, first + 1, ..., first + length - 1.
struct Axis {
    std::uint32_t base, first, length;
    int order;
    std::uint32_t node(std::uint32_t k) const { return k == 0 ? base : first + k - 1; }
};

Axis add_axis(Topology& t, std::uint32_t base, std::uint32_t length, int order) {
    const std::uint32_t first = t.size();
    std::uint32_t end = t.add(base, order > 0);
    for (std::uint32_t k = 1; k < length; ++k) end = t.add(end, false);
    return {base, first, length, order};
}

int laterals_at(Draws& draws, int order, bool hard) {
    if (draws.uniform() > (order < 3 ? 0.85 : 0.6)) return 0;
    const int count = draws.uniform() < 0.12 ? 2 : 1;
    if (!hard || draws.uniform() >= 0.08) return count;
    return 5 + static_cast<int>(draws.uniform(0, 3));
}

Topology branch_out(std::uint32_t segments, std::uint32_t trunk_length, std::uint64_t seed, bool hard) {
    Draws draws(seed, kTopology);
    Topology t;
    t.left = segments;
    std::vector<Axis> axes{add_axis(t, 0, std::min(trunk_length, segments), 0)};
    for (std::size_t a = 0; a < axes.size() && t.left > 1; ++a) {
        const Axis axis = axes[a];
        for (std::uint32_t k = axis.order == 0 ? 3 : 1; k < axis.length && t.left > 1; ++k) {
            for (int count = laterals_at(draws, axis.order, hard); count > 0 && t.left > 1; --count) {
                const double target = (axis.length - k) * draws.uniform(0.55, 0.95);
                const auto length = std::clamp(static_cast<std::uint32_t>(std::lround(target)), 2u, t.left);
                axes.push_back(add_axis(t, axis.node(k), length, axis.order + 1));
            }
        }
    }
    return t;
}

/// Lengthens the trunk until its branches use all segments; a last single segment is added to the last axis.
Topology make_topology(std::uint32_t segments, std::uint64_t seed, bool hard) {
    std::uint32_t trunk_length = 8;
    Topology t = branch_out(segments, trunk_length, seed, hard);
    while (t.left > 1) t = branch_out(segments, ++trunk_length, seed, hard);
    if (t.left == 1) t.add(t.size() - 1, false);
    return t;
}

std::vector<NodeId> find_parents(const Topology& t) {
    std::vector<NodeId> parents(t.size());
    for (std::uint32_t i = 1; i < t.size(); ++i) parents[i] = NodeId(t.parent[i]);
    return parents;
}

/// Finds the placed segments near a new one. Segments are split into sections a few radii long and stored in
/// one grid for each power of two of their radius, so that every section intersects at most eight cells,
/// however long and thin its segment is.
class SegmentHash {
  public:
    explicit SegmentHash(std::uint32_t size) : seen_(size, 0) {}

    void insert(std::uint32_t node, Vec3d a, Vec3d b, double radius) {
        const int level = choose_level(radius);
        if (level >= levels_) levels_ = level + 1;
        for_each_chunk(a, b, radius, [&](const Range& box) {
            for_each_cell(box, level, [&](std::uint64_t key) {
                const auto [cell, is_new] = head_.try_emplace(key, kEnd);
                entries_.push_back({node, cell->second});
                cell->second = static_cast<std::uint32_t>(entries_.size() - 1);
            });
        });
    }

    /// Calls visit(node) once for every segment with sections that share a cell with those of this one.
    template <class Visit>
    void for_each_near(Vec3d a, Vec3d b, double radius, const Visit& visit) {
        ++stamp_;
        for_each_chunk(a, b, radius, [&](const Range& box) {
            for (int level = 0; level < levels_; ++level) {
                for_each_cell(box, level, [&](std::uint64_t key) {
                    const auto cell = head_.find(key);
                    if (cell == head_.end()) return;
                    for (std::uint32_t e = cell->second; e != kEnd; e = entries_[e].next) {
                        const std::uint32_t node = entries_[e].node;
                        if (std::exchange(seen_[node], stamp_) != stamp_) visit(node);
                    }
                });
            }
        });
    }

  private:
    static constexpr std::uint32_t kEnd = 0xffffffffu;
    struct Entry {
        std::uint32_t node, next;
    };
    struct Range {
        Vec3d low, high;
    };

    static int choose_level(double radius) {
        return std::max(0, static_cast<int>(std::ceil(std::log2(radius / kTipRadius))));
    }

    template <class Visit>
    static void for_each_chunk(Vec3d a, Vec3d b, double radius, const Visit& visit) {
        const int pieces = 1 + static_cast<int>(distance(a, b) / (4 * radius));
        const double reach = kClearance * radius;
        for (int i = 0; i < pieces; ++i) {
            const Vec3d p = lerp(a, b, static_cast<double>(i) / pieces);
            const Vec3d q = lerp(a, b, static_cast<double>(i + 1) / pieces);
            visit(
                Range{{std::min(p.x, q.x) - reach, std::min(p.y, q.y) - reach, std::min(p.z, q.z) - reach},
                      {std::max(p.x, q.x) + reach, std::max(p.y, q.y) + reach, std::max(p.z, q.z) + reach}});
        }
    }

    template <class Visit>
    static void for_each_cell(const Range& box, int level, const Visit& visit) {
        const double per_cell = 1 / (8 * kTipRadius * std::ldexp(1.0, level));
        const auto cell = [&](double x) { return static_cast<std::int64_t>(std::floor(x * per_cell)); };
        for (std::int64_t x = cell(box.low.x); x <= cell(box.high.x); ++x) {
            for (std::int64_t y = cell(box.low.y); y <= cell(box.high.y); ++y) {
                for (std::int64_t z = cell(box.low.z); z <= cell(box.high.z); ++z) {
                    const auto bits = [](std::int64_t c) { return static_cast<std::uint64_t>(c) & 0xfffffu; };
                    visit(bits(x) | bits(y) << 20 | bits(z) << 40 | static_cast<std::uint64_t>(level) << 60);
                }
            }
        }
    }

    std::unordered_map<std::uint64_t, std::uint32_t> head_;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> seen_;
    std::uint32_t stamp_ = 0;
    int levels_ = 0;
};

struct Frame {
    Vec3d direction;
    Vec3d end;
};

/// Places the nodes in order of decreasing radius.
class Placer {
  public:
    Placer(const Topology& topology, const std::vector<double>& radius, std::uint64_t seed, bool hard)
        : topology_(topology),
          radius_(radius),
          shape_(seed, kShape),
          hard_(hard),
          placed_(topology.size(), Frame{{0, 0, 1}, {0, 0, 0}}),
          azimuth_(topology.size()),
          hash_(topology.size()) {
        const CounterRandom azimuth(seed, kAzimuth);
        for (std::uint32_t i = 0; i < topology.size(); ++i) {
            azimuth_[i] = azimuth.uniform(i, 0, 2 * std::numbers::pi);
        }
    }

    std::vector<Frame> place() {
        // A child is never thicker than its parent, so this order places parents first; ties are resolved by
        // index.
        std::vector<std::uint32_t> order(topology_.size() - 1);
        for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i + 1;
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return radius_[a] > radius_[b]; });
        for (const std::uint32_t i : order) place_node(i);
        return std::move(placed_);
    }

  private:
    double draw(std::uint32_t node, int attempt, int which, double low, double high) const {
        return shape_.uniform((std::uint64_t{node} << 8) + static_cast<std::uint64_t>(attempt * 8 + which),
                              low, high);
    }

    void place_node(std::uint32_t i) {
        if (topology_.lateral[i]) azimuth_[topology_.parent[i]] += kGoldenAngle;
        const Vec3d base = placed_[topology_.parent[i]].end;
        int fewest = 0;
        for (int attempt = 0; attempt < (hard_ ? 1 : kTries); ++attempt) {
            const Frame f = topology_.lateral[i] ? lateral(i, attempt) : continuation(i, attempt);
            const int count = hard_ ? 0 : overlaps(i, base, f.end);
            if (attempt == 0 || count < fewest) {
                fewest = count;
                placed_[i] = f;
            }
            if (fewest == 0) break;
        }
        if (!hard_) hash_.insert(i, base, placed_[i].end, segment_radius(i));
    }

    Frame lateral(std::uint32_t i, int attempt) const {
        const std::uint32_t p = topology_.parent[i];
        const bool acute = hard_ && draw(i, attempt, 0, 0, 1) < 0.5;
        const double angle = acute ? draw(i, attempt, 1, 0.21, 0.436) : draw(i, attempt, 1, 0.66, 1.31);
        const double around = azimuth_[p] + draw(i, attempt, 2, -0.4, 0.4) + 0.8 * attempt;
        double l = std::max(3.2 * radius_[i], 4 * kTipRadius) * draw(i, attempt, 3, 0.9, 1.2);
        l = std::max(l, 1.15 * radius_[p] / std::max(0.35, std::sin(angle)) + 1.6 * radius_[i]);
        if (hard_ && draw(i, attempt, 4, 0, 1) < 0.3) l = 0.6 * radius_[p];
        return from(p, tilted(placed_[p].direction, angle, around), l);
    }

    Frame continuation(std::uint32_t i, int attempt) const {
        const std::uint32_t p = topology_.parent[i];
        const double angle = draw(i, attempt, 1, 0, 0.19) + 0.05 * attempt;
        Vec3d d = tilted(placed_[p].direction, angle, draw(i, attempt, 2, 0, 2 * std::numbers::pi));
        d = normalized(d + Vec3d{0, 0, 0.05});
        double l = std::max(3.2 * radius_[p], 4 * kTipRadius) * draw(i, attempt, 3, 0.8, 1.25);
        if (hard_ && draw(i, attempt, 4, 0, 1) < 0.15) l = 0.45 * radius_[p];
        return from(p, d, l);
    }

    static Vec3d tilted(Vec3d axis, double angle, double around) {
        const Vec3d u = perpendicular(axis);
        const Vec3d v = cross(axis, u);
        const Vec3d side = u * std::cos(around) + v * std::sin(around);
        return normalized(axis * std::cos(angle) + side * std::sin(angle));
    }

    Frame from(std::uint32_t parent, Vec3d direction, double l) const {
        return {direction, placed_[parent].end + direction * l};
    }

    double segment_radius(std::uint32_t i) const {
        return topology_.lateral[i] ? radius_[i] : radius_[topology_.parent[i]];
    }

    int overlaps(std::uint32_t i, Vec3d a, Vec3d b) {
        const std::uint32_t p = topology_.parent[i];
        const std::uint32_t pp = topology_.parent[p];
        int count = 0;
        hash_.for_each_near(a, b, segment_radius(i), [&](std::uint32_t j) {
            const std::uint32_t pj = topology_.parent[j];
            const bool neighbour = j == p || pj == p || (p != 0 && (pj == pp || j == pp));
            if (neighbour) return;
            const double room = kClearance * (segment_radius(i) + segment_radius(j));
            if (segment_distance(a, b, placed_[pj].end, placed_[j].end) < room) ++count;
        });
        return count;
    }

    static constexpr double kGoldenAngle = std::numbers::pi * (3 - 2.2360679774997896);
    const Topology& topology_;
    const std::vector<double>& radius_;
    CounterRandom shape_;
    bool hard_;
    std::vector<Frame> placed_;
    std::vector<double> azimuth_;
    SegmentHash hash_;
};

}  // namespace

Skeleton random_tree(std::uint32_t segments, std::uint64_t seed, bool hard) {
    constexpr std::uint32_t kMax = 100'000'000;
    if (segments == 0 || segments > kMax) {
        throw InvalidInput(fmt::format("a random tree needs 1 to {} segments, not {}", kMax, segments));
    }
    const Topology topology = make_topology(segments, seed, hard);
    std::vector<NodeId> parents = find_parents(topology);
    // Every segment has a few leaves, so that unbranched axes taper too.
    const std::vector<double> radius = pipe_radii(parents, kTipRadius, kPipeExponent, 0.08);
    const std::vector<Frame> placed = Placer(topology, radius, seed, hard).place();
    std::vector<Vec3> positions(topology.size());
    std::vector<float> radii(topology.size());
    for (std::uint32_t i = 0; i < topology.size(); ++i) {
        positions[i] = Vec3(placed[i].end);
        radii[i] = static_cast<float>(radius[i]);
    }
    return Skeleton(std::move(parents), std::move(positions), std::move(radii));
}

}  // namespace coppice
