#include "zoo.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

constexpr int kRoot = -1;
constexpr float kPi = std::numbers::pi_v<float>;

float radians(float degrees) { return degrees * (kPi / 180); }

/// Returns the direction at `angle` degrees from +Z, rotated by `azimuth` degrees about Z from +X.
Vec3 direction(float angle, float azimuth = 0) {
    const float a = radians(angle), z = radians(azimuth);
    return {std::sin(a) * std::cos(z), std::sin(a) * std::sin(z), std::cos(a)};
}

class Builder {
  public:
    int add(int parent, Vec3 position, float radius) {
        parents_.push_back(parent < 0 ? NodeId::none() : NodeId(static_cast<std::uint32_t>(parent)));
        positions_.push_back(position);
        radii_.push_back(radius);
        return static_cast<int>(radii_.size()) - 1;
    }
    /// Adds a node at distance `length` from its parent.
    int grow(int parent, Vec3 along, float length, float radius) {
        return add(parent, positions_[static_cast<std::size_t>(parent)] + length * along, radius);
    }
    Skeleton scaled(float scale) const {
        std::vector<Vec3> positions = positions_;
        std::vector<float> radii = radii_;
        for (Vec3& p : positions) p *= scale;
        for (float& r : radii) r *= scale;
        return Skeleton(parents_, positions, radii);
    }
    Skeleton build() const { return scaled(1); }

  private:
    std::vector<NodeId> parents_;
    std::vector<Vec3> positions_;
    std::vector<float> radii_;
};

struct Ball {
    Vec3 position;
    float radius;
};

Skeleton chain(const std::vector<Ball>& balls) {
    Builder b;
    int last = kRoot;
    for (const Ball& ball : balls) last = b.add(last, ball.position, ball.radius);
    return b.build();
}

/// A trunk along +Z with three segments and laterals in the given directions at its second node.
/// `lateral_length` is in trunk radii, which are 1.
Skeleton trunk_with(const std::vector<Vec3>& laterals, float radius, float lateral_length, float step = 4) {
    Builder b;
    int n = b.add(kRoot, {0, 0, 0}, 1);
    const int node = n = b.grow(n, {0, 0, 1}, step, 1);
    n = b.grow(n, {0, 0, 1}, step, 1);
    b.grow(n, {0, 0, 1}, step, 1);
    for (const Vec3 d : laterals) b.grow(b.grow(node, d, lateral_length, radius), d, 4 * radius, radius);
    return b.build();
}

/// A stem along +Z that ends in a node with children in the given directions.
Builder fork(const std::vector<Vec3>& children, float radius, float child_length = 4) {
    Builder b;
    const int node = b.grow(b.add(kRoot, {0, 0, 0}, 1), {0, 0, 1}, 4, 1);
    for (const Vec3 d : children) b.grow(b.grow(node, d, child_length, radius), d, child_length, radius);
    return b;
}

std::vector<Vec3> whorl(int count, float angle) {
    std::vector<Vec3> d;
    for (int i = 0; i < count; ++i)
        d.push_back(direction(angle, 360.0f * static_cast<float>(i) / static_cast<float>(count)));
    return d;
}

/// The twelve corners of an icosahedron.
std::vector<Vec3> all_around() {
    std::vector<Vec3> d;
    const float g = std::numbers::phi_v<float>;
    for (const float a : {-1.0f, 1.0f}) {
        for (const float b : {-g, g}) {
            d.push_back(normalized(Vec3{0, a, b}));
            d.push_back(normalized(Vec3{a, b, 0}));
            d.push_back(normalized(Vec3{b, 0, a}));
        }
    }
    return d;
}

Skeleton soma() {
    Builder b;
    const int center = b.add(kRoot, {0, 0, 0}, 1);
    for (const Vec3 d : all_around()) b.grow(b.grow(center, d, 5, 1), d, 4, 1);
    return b.build();
}

/// A soma in the form used by NeuroMorpho: a root and two tips next to it, all of the same radius, and thin
/// neurites that start at the root.
Skeleton soma_of_three_points() {
    const NodeId root(0);
    return {{NodeId::none(), root, root, root, NodeId(3), root, NodeId(5), root, NodeId(7), root, NodeId(9)},
            {{0, 0, 0},
             {0, -5, 0},
             {0, 5, 0},
             {6, 0, 0},
             {30, 0, 0},
             {-6, 0, 0},
             {-30, 0, 0},
             {0, 0, 6},
             {0, 3, 30},
             {0, 0, -6},
             {0, -4, -30}},
            {5, 5, 5, 0.5f, 0.4f, 0.5f, 0.4f, 0.5f, 0.4f, 0.5f, 0.4f}};
}

/// Two stems of the same radius that leave the root in exactly opposite directions, each with a fork.
Skeleton opposite_stems() {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(0), NodeId(4), NodeId(4)},
            {{0, 0, 0}, {0, 5, 0}, {-5, 5, 0}, {6, 5, 0}, {0, -4, 0}, {6, -4, 0}, {-5, -4, 0}},
            {1, 1, 1, 1, 1, 1, 1}};
}

Skeleton root_with_children() {
    Builder b;
    const int root = b.add(kRoot, {0, 0, 0}, 1);
    for (const Vec3 d : whorl(4, 50)) b.grow(b.grow(root, d, 4, 0.7f), d, 4, 0.5f);
    return b.build();
}

Skeleton forest() {
    Builder b;
    for (int tree = 0; tree < 3; ++tree) {
        const int root = b.add(kRoot, {20.0f * static_cast<float>(tree), 0, 0}, 1);
        const int node = b.grow(root, {0, 0, 1}, 5, 0.9f);
        for (int i = 0; i < tree; ++i) b.grow(node, direction(40, 180.0f * static_cast<float>(i)), 4, 0.6f);
    }
    return b.build();
}

/// Branch nodes with distances less than their radius, and short tips.
Skeleton tip_cluster() {
    Builder b;
    int n = b.grow(b.add(kRoot, {0, 0, 0}, 1), {0, 0, 1}, 5, 0.9f);
    for (int i = 0; i < 4; ++i) {
        b.grow(n, direction(60, 137.5f * static_cast<float>(i)), 1.5f, 0.5f);
        n = b.grow(n, direction(8, 90.0f * static_cast<float>(i)), 0.4f,
                   0.8f - 0.05f * static_cast<float>(i));
    }
    b.grow(n, {0, 0, 1}, 0.3f, 0.3f);
    return b.build();
}

/// A trunk with segments of `step` radii, and a lateral at every second node.
Skeleton short_segments(float step) {
    Builder b;
    int n = b.add(kRoot, {0, 0, 0}, 1);
    for (int i = 0; i < 12; ++i) {
        n = b.grow(n, direction(3, 70.0f * static_cast<float>(i)), step, 1 - 0.02f * static_cast<float>(i));
        if (i % 2 == 0) b.grow(n, direction(60, 137.5f * static_cast<float>(i)), 3, 0.3f);
    }
    return b.build();
}

Skeleton helix() {
    Builder b;
    int n = b.add(kRoot, {3, 0, 0}, 1);
    for (int i = 1; i <= 40; ++i) {
        const float t = 0.35f * static_cast<float>(i);
        n = b.add(n, {3 * std::cos(t), 3 * std::sin(t), 0.5f * t}, 1 - 0.015f * static_cast<float>(i));
    }
    return b.build();
}

Skeleton zigzag() {
    Builder b;
    int n = b.add(kRoot, {0, 0, 0}, 0.5f);
    for (int i = 0; i < 8; ++i) n = b.grow(n, direction(i % 2 == 0 ? 70.0f : -70.0f), 2, 0.5f);
    return b.build();
}

using Zoo = std::vector<std::pair<std::string, Skeleton>>;

void add_chains(Zoo& zoo) {
    zoo.emplace_back("single_node", chain({{{1, 2, 3}, 0.5f}}));
    zoo.emplace_back("one_segment", chain({{{0, 0, 0}, 0.5f}, {{1, 2, 3}, 0.4f}}));
    zoo.emplace_back("straight_chain",
                     chain({{{0, 0, 0}, 1}, {{0, 0, 4}, 0.9f}, {{0, 0, 8}, 0.8f}, {{0, 0, 12}, 0.7f}}));
    zoo.emplace_back("almost_coincident", chain({{{0, 0, 0}, 1}, {{0, 0, 1e-5f}, 1}}));
    zoo.emplace_back("coincident",
                     chain({{{0, 0, 0}, 1}, {{0, 0, 0}, 0.5f}, {{0, 0, 3}, 0.5f}, {{0, 0, 3}, 0.5f}}));
    zoo.emplace_back("right_angle_bend", chain({{{0, 0, 0}, 1}, {{0, 0, 5}, 1}, {{5, 0, 5}, 1}}));
    zoo.emplace_back("u_turn", chain({{{0, 0, 0}, 1}, {{0, 0, 5}, 1}, {{0, 0, 1}, 0.8f}}));
    zoo.emplace_back(
        "hairpin", chain({{{0, 0, 0}, 0.5f}, {{0, 0, 5}, 0.5f}, {{0.6f, 0, 5}, 0.5f}, {{0.6f, 0, 0}, 0.5f}}));
    zoo.emplace_back("helix", helix());
    zoo.emplace_back("zigzag", zigzag());
    zoo.emplace_back("long_thin", chain({{{0, 0, 0}, 0.01f}, {{0, 0, 10}, 0.01f}, {{7, 0, 17}, 0.01f}}));
    zoo.emplace_back("steep_taper", chain({{{0, 0, 0}, 1}, {{0, 0, 10}, 0.01f}}));
    zoo.emplace_back("steep_flare", chain({{{0, 0, 0}, 0.01f}, {{0, 0, 10}, 1}}));
    zoo.emplace_back("radius_jump",
                     chain({{{0, 0, 0}, 0.5f}, {{0, 0, 20}, 0.5f}, {{0, 0, 20.1f}, 13}, {{0, 0, 60}, 13}}));
    zoo.emplace_back("ball_in_ball", chain({{{0, 0, 0}, 5}, {{0, 0, 1}, 1}, {{0, 0, 2}, 0.5f}}));
}

void add_forks(Zoo& zoo) {
    for (const int degrees : {10, 30, 60, 120, 180}) {
        const float half = 0.5f * static_cast<float>(degrees);
        zoo.emplace_back("fork_" + std::to_string(degrees),
                         fork({direction(half), direction(half, 180)}, 1, 8).build());
    }
    zoo.emplace_back("collinear_children", fork({direction(30), direction(30)}, 0.7f).build());
    zoo.emplace_back(
        "planar_cross",
        fork({direction(90), direction(90, 180), direction(30), direction(30, 180)}, 0.6f).build());
    for (const int count : {3, 5, 8}) {
        zoo.emplace_back("whorl_" + std::to_string(count), fork(whorl(count, 45), 0.5f).build());
    }
    zoo.emplace_back("flat_whorl_8", fork(whorl(8, 90), 0.4f).build());
    zoo.emplace_back("soma", soma());
    zoo.emplace_back("soma_of_three_points", soma_of_three_points());
    zoo.emplace_back("opposite_stems", opposite_stems());
    zoo.emplace_back("root_with_children", root_with_children());
    zoo.emplace_back("forest", forest());
    zoo.emplace_back("tip_cluster", tip_cluster());
}

void add_laterals(Zoo& zoo) {
    zoo.emplace_back("thin_lateral_90", trunk_with({direction(90)}, 0.05f, 1.5f));
    zoo.emplace_back("thin_lateral_15", trunk_with({direction(15)}, 0.05f, 6));
    zoo.emplace_back("inner_lateral", trunk_with({direction(70)}, 0.3f, 0.5f));
    zoo.emplace_back("opposite_laterals", trunk_with({direction(60), direction(60, 180)}, 0.5f, 3));
    zoo.emplace_back("backward_lateral", trunk_with({direction(150)}, 0.4f, 3));
    zoo.emplace_back("thick_lateral", trunk_with({direction(50)}, 1.4f, 5));
    zoo.emplace_back("whorl_on_short_trunk", trunk_with(whorl(6, 60), 0.4f, 3, 0.45f));
    zoo.emplace_back("short_segments_045", short_segments(0.45f));
    zoo.emplace_back("short_segments_010", short_segments(0.1f));
}

void add_scales_and_trees(Zoo& zoo) {
    const std::vector<Vec3> children{direction(10), direction(50, 180)};
    zoo.emplace_back("tiny_fork", fork(children, 0.7f).scaled(1e-6f));
    zoo.emplace_back("huge_fork", fork(children, 0.7f).scaled(1e6f));
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        zoo.emplace_back("random_" + std::to_string(seed), random_tree(60, seed, false));
        zoo.emplace_back("random_hard_" + std::to_string(seed), random_tree(60, seed, true));
    }
    zoo.emplace_back("random_large", random_tree(600, 7, false));
    zoo.emplace_back("random_large_hard", random_tree(600, 7, true));
}

}  // namespace

std::vector<std::pair<std::string, Skeleton>> skeleton_zoo() {
    Zoo zoo;
    add_chains(zoo);
    add_forks(zoo);
    add_laterals(zoo);
    add_scales_and_trees(zoo);
    return zoo;
}

Skeleton zoo_skeleton(const std::string& name) {
    for (auto& [key, skeleton] : skeleton_zoo()) {
        if (key == name) return std::move(skeleton);
    }
    throw std::out_of_range("the zoo has no skeleton named " + name);
}

}  // namespace coppice
