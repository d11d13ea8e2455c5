#include "plot_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/render/scan.h"
#include "coppice/skeleton/random_tree.h"
#include "draws.h"
#include "face_at.h"
#include "leafy_tree.h"

namespace coppice::bench {
namespace {

constexpr double kRoom = 16;   // [m2] for each tree
constexpr double kMargin = 4;  // [m] of ground around them
constexpr double kApart = 2;   // [m] minimum distance between stems
constexpr int kBushesPerTree = 1;
constexpr double kBreast = 1.3;

/// [m] Returns the height of the ground.
double ground(double x, double y) {
    return 0.14 * x + 0.4 * std::sin(0.45 * x + 1) * std::cos(0.38 * y) +
           0.08 * std::sin(2.3 * x) * std::sin(1.9 * y);
}

/// A tree in a forest: a synthetic tree, stretched to be slender, turned and leaning.
struct Shape {
    double wide, tall, thick, turn, lean;
};

struct Parts {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
};

void add_stem(Parts& parts, std::uint32_t segments, std::uint64_t seed, const Shape& shape, NodeId onto) {
    const Skeleton tree = random_tree(segments, seed);
    const auto first = static_cast<std::uint32_t>(parts.parent.size());
    const double c = std::cos(shape.turn), s = std::sin(shape.turn);
    const Vec3d base = onto ? Vec3d(parts.position[onto.index()]) : Vec3d();
    for (const NodeId n : nodes(tree)) {
        if (onto && tree.is_root(n)) continue;
        const Vec3d p(tree.position(n));
        const double x = shape.wide * (c * p.x - s * p.y), y = shape.wide * (s * p.x + c * p.y);
        const double z = shape.tall * p.z;
        parts.position.push_back(Vec3(base + Vec3d{x + shape.lean * z * c, y + shape.lean * z * s, z}));
        parts.radius.push_back(static_cast<float>(shape.thick * double{tree.radius(n)}));
        if (tree.is_root(n)) {
            parts.parent.push_back(NodeId());
        } else if (onto) {
            const NodeId above = tree.parent(n);
            parts.parent.push_back(tree.is_root(above) ? onto : NodeId(first + above.index() - 1));
        } else {
            parts.parent.push_back(NodeId(first + tree.parent(n).index()));
        }
    }
}

Skeleton make_tree(std::uint32_t index, Draws& draws) {
    const auto segments = static_cast<std::uint32_t>(draws.uniform(900, 3600));
    Shape shape{draws.uniform(1.3, 1.8), draws.uniform(1.3, 1.8), draws.uniform(0.4, 0.65),
                draws.uniform(0, 2 * std::numbers::pi), index % 5 == 4 ? draws.uniform(0.1, 0.25) : 0.0};
    Parts parts;
    if (index % 12 != 11) {
        add_stem(parts, segments, 100 + index, shape, NodeId());
    } else {
        // Forked: half a metre of stem, and two stems leaning apart.
        const float radius = static_cast<float>(
            shape.thick * double{random_tree(segments / 2, 100 + index).radius(NodeId(0))});
        parts = {{NodeId(), NodeId(0)}, {{0, 0, 0}, {0, 0, 0.5f}}, {1.3f * radius, 1.2f * radius}};
        shape.lean = 0.2;
        add_stem(parts, segments / 2, 100 + index, shape, NodeId(1));
        shape.turn += std::numbers::pi;
        add_stem(parts, segments / 2, 500 + index, shape, NodeId(1));
    }
    return Skeleton(std::move(parts.parent), std::move(parts.position), std::move(parts.radius));
}

/// Computes the position and the diameter of the thickest stem at breast height.
void measure_breast(TrueTree& tree) {
    const Skeleton& s = tree.skeleton;
    double most = 0;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Segment g = s.segment(n);
        const double z = tree.foot.z + kBreast;
        if (double{g.a.z} > z || double{g.b.z} <= z) continue;
        const double t = (z - double{g.a.z}) / double{g.b.z - g.a.z};
        const double radius = std::lerp(double{g.radius_a}, double{g.radius_b}, t);
        if (radius <= most) continue;
        most = radius;
        tree.at_breast = lerp(Vec3d(g.a), Vec3d(g.b), t);
    }
    tree.dbh = 2 * most;
}

Skeleton moved(const Skeleton& s, Vec3d by) {
    std::vector<Vec3> positions;
    for (const Vec3 p : s.positions()) positions.push_back(Vec3(Vec3d(p) + by));
    return Skeleton({s.parents().begin(), s.parents().end()}, std::move(positions),
                    {s.radii().begin(), s.radii().end()});
}

/// Adds a tube for every segment; polygons of rings have the area of their circles.
void add_tubes(PolygonMesh& mesh, const Skeleton& s) {
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Segment g = s.segment(n);
        const Vec3d a(g.a), b(g.b), axis = normalized(b - a);
        if (!(distance(a, b) > 0)) continue;
        const double thick = std::max(g.radius_a, g.radius_b);
        const std::uint32_t sides = thick > 0.05 ? 24 : thick > 0.015 ? 10 : 6;
        const double step = 2 * std::numbers::pi / sides;
        // factor for a polygon with the area of the circle
        const double wider = std::sqrt(step / std::sin(step));
        const Vec3d u = perpendicular(axis), v = cross(axis, u);
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (std::uint32_t i = 0; i < sides; ++i) {
            const Vec3d out = u * (wider * std::cos(step * i)) + v * (wider * std::sin(step * i));
            mesh.positions.push_back(Vec3(a + out * double{g.radius_a}));
            mesh.positions.push_back(Vec3(b + out * double{g.radius_b}));
        }
        for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t j = (i + 1) % sides;
            mesh.add_face(std::array{first + 2 * i, first + 2 * j, first + 2 * j + 1, first + 2 * i + 1});
        }
    }
}

void add_ground(PolygonMesh& mesh, double wide) {
    constexpr double kCell = 0.2;  // [m]
    const auto count = static_cast<std::uint32_t>((wide + 2 * kMargin) / kCell) + 1;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t j = 0; j < count; ++j) {
        for (std::uint32_t i = 0; i < count; ++i) {
            const double x = i * kCell - kMargin, y = j * kCell - kMargin;
            mesh.positions.push_back(Vec3(Vec3d{x, y, ground(x, y)}));
        }
    }
    for (std::uint32_t j = 0; j + 1 < count; ++j) {
        for (std::uint32_t i = 0; i + 1 < count; ++i) {
            const std::uint32_t at = first + j * count + i;
            mesh.add_face(std::array{at, at + 1, at + count + 1, at + count});
        }
    }
}

/// Returns positions of stems with a minimum distance.
std::vector<Vec3d> find_places(std::uint32_t count, double wide, Draws& draws) {
    std::vector<Vec3d> places;
    for (int tries = 0; places.size() < count && tries < 100'000; ++tries) {
        const double x = draws.uniform(0, wide), y = draws.uniform(0, wide);
        const Vec3d p{x, y, ground(x, y)};
        if (std::ranges::all_of(places, [&](Vec3d q) { return std::hypot(p.x - q.x, p.y - q.y) > kApart; }))
            places.push_back(p);
    }
    return places;
}

/// Scans from the middle and from four positions around it.
PointSet scan_plot(const PolygonMesh& mesh, double wide, int points, const Context& ctx) {
    constexpr int kStations = 5;
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(p);
    const Vec3d middle(box.center());
    PointSet all;
    for (int k = 0; k < kStations; ++k) {
        const double azimuth = k * std::numbers::pi / 2 + 0.5, away = k == 0 ? 0.5 : 0.4 * wide;
        const double x = middle.x + away * std::cos(azimuth), y = middle.y + away * std::sin(azimuth);
        const ScanOptions options{.points = points / kStations,
                                  .positions = 1,
                                  .distance = static_cast<float>(away),
                                  .height = static_cast<float>(ground(x, y) + 1.6 - double{box.low.z}),
                                  .azimuth = static_cast<float>(
                                      azimuth > std::numbers::pi ? azimuth - 2 * std::numbers::pi : azimuth),
                                  .noise = 0.003f,
                                  .seed = k};
        all = merged(all, scan(mesh, options, ctx));
    }
    return all;
}

}  // namespace

PlotScene make_plot(const std::string& name, const Context& ctx) {
    std::uint32_t count = 0;
    int points = 0;
    const std::size_t second =
        std::min(name.find(':', std::min(name.find(':'), name.size() - 1) + 1), name.size());
    const Foliage foliage = second < name.size() ? foliage_named(name.substr(second + 1)) : Foliage{};
    const char *end = name.data() + second, *colon = std::find(name.data(), end, ':');
    const bool is_read = std::from_chars(name.data(), colon, count).ptr == colon && colon != end &&
                         std::from_chars(colon + 1, end, points).ptr == end;
    if (!is_read || count < 1 || count > 1000 || points < 1000)
        throw InvalidInput(fmt::format(
            "'{}' is not a plot; write TREES:POINTS or TREES:POINTS:FOLIAGE, such as 40:4000000", name));
    Draws draws(count, 0x706c6f74);
    const double wide = std::sqrt(kRoom * count);
    PlotScene out{name, {}, {}, {}, {}};
    PolygonMesh mesh;
    std::vector<std::uint32_t> first_face, first_leaf;
    const auto places = find_places(count, wide, draws);
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        TrueTree tree{moved(make_tree(i, draws), places[i]), places[i], {}, 0, 0};
        measure_breast(tree);
        for (const Vec3 p : tree.skeleton.positions())
            tree.height = std::max(tree.height, double{p.z} - places[i].z);
        first_face.push_back(mesh.face_count());
        add_tubes(mesh, tree.skeleton);
        first_leaf.push_back(mesh.face_count());
        add_foliage(mesh, tree.skeleton, foliage);
        out.trees.push_back(std::move(tree));
    }
    const std::uint32_t first_bush = mesh.face_count();
    for (std::uint32_t i = 0; i < count * kBushesPerTree; ++i) {
        const double x = draws.uniform(0, wide), y = draws.uniform(0, wide);
        Parts bush;
        add_stem(bush, 150, 900 + i,
                 {draws.uniform(0.4, 0.7), draws.uniform(0.3, 0.8), 0.15, draws.uniform(0, 6), 0}, NodeId());
        const Skeleton s(std::move(bush.parent), std::move(bush.position), std::move(bush.radius));
        add_tubes(mesh, moved(s, {x, y, ground(x, y)}));
    }
    const std::uint32_t first_ground = mesh.face_count();
    add_ground(mesh, wide);
    out.points = scan_plot(mesh, wide, points, ctx);
    const SurfaceTree surface(mesh, ctx);
    out.owner.resize(out.points.size());
    out.leaf.resize(out.points.size());
    parallel_for(ctx, out.points.size(), 1024, [&](std::size_t i) {
        const std::uint32_t face =
            face_at(surface, Vec3d(out.points.positions[i]) + out.points.origin - mesh.origin);
        const auto after = std::ranges::upper_bound(first_face, face);
        if (face >= first_bush) {
            out.owner[i] = face >= first_ground ? kGroundOwner : kBushOwner;
            return;
        }
        out.owner[i] = static_cast<std::uint32_t>(after - first_face.begin() - 1);
        out.leaf[i] = face >= first_leaf[out.owner[i]];
    });
    return out;
}

}  // namespace coppice::bench
