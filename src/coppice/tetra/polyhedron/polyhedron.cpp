#include "coppice/tetra/polyhedron/polyhedron.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/tetra/lattice/cone_internal.h"
#include "coppice/tetra/polyhedron/near_internal.h"
#include "coppice/tetra/polyhedron/sections_internal.h"

namespace coppice {

namespace {

using namespace tetra_internal;

constexpr std::size_t kPolyhedronGrain = 256, kFewCones = 8;
constexpr double kMinRadius = 16;  ///< [grid] minimum radius of a segment
constexpr int kGridBits = 24;      ///< bits of a coordinate, so that grid points are exact floats
/// Maximum number of rounds, and number of first rounds in which squares are inserted. Tetrahedra that are
/// still too wide or too flat after the last round remain.
constexpr int kMaxRounds = 12, kMaxAdding = 5;
/// Minimum flatness of tetrahedra in the rounds that insert squares; a quarter of it is enough in later
/// rounds.
constexpr double kMinFlatness = 1.0 / 8;
constexpr double kRoom = 0.2;  ///< [half edges of squares] minimum distance between corners
constexpr double kMove = 0.2;  ///< [shortest edges] maximum displacement of a corner of a flat tetrahedron
/// [radii] maximum distance of a corner of a tetrahedron at the bark from the axis,
constexpr double kMaxWidth = 4.5;
constexpr double kBetweenAdded = 1.5;  ///< [radii] distance between inserted squares
constexpr double kNearCorner = 2.6;    ///< [radii] unless a corner is closer than this
constexpr float kClearance = 0.05f;    ///< see TetraMesh::clearance
constexpr double kAxis = 1e-3;  ///< [radii] thickness of an axis, so that rounding loses no tetrahedron

/// The box of all balls and the corners around them, enlarged by its size on every side.
struct Frame {
    std::array<double, 3> low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double unit = 1;

    explicit Frame(std::span<const Segment> axes, const PolyhedronOptions& options) {
        double thinnest = HUGE_VAL;
        std::size_t which = 0;
        for (std::size_t i = 0; i < axes.size(); ++i) {
            const double reach = 2 * options.section;
            extend(Vec3d(axes[i].a), reach * axes[i].radius_a);
            extend(Vec3d(axes[i].b), reach * axes[i].radius_b);
            const double r = std::min(axes[i].radius_a, axes[i].radius_b);
            if (r < thinnest) which = i;
            thinnest = std::min(thinnest, r);
        }
        double size = 0, farthest = 0;
        for (std::size_t k = 0; k < 3; ++k) size = std::max(size, high[k] - low[k]);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] -= size;
            high[k] += size;
            farthest = std::max({farthest, -low[k], high[k]});
        }
        // Also rejects units below the smallest positive float and boxes beyond the largest float.
        unit = std::exp2(std::ceil(std::log2(farthest)) - kGridBits);
        if (!(thinnest >= kMinRadius * unit) || unit < 0x1p-120 || farthest > 0x1p120) {
            throw InvalidInput(
                fmt::format("polyhedron: segment {} has a radius of {:.3g} m, too thin for coordinates of "
                            "{:.3g} m; make it thicker, or move the skeleton to the origin",
                            which, thinnest, farthest));
        }
    }

  private:
    void extend(Vec3d p, double reach) {
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            low[i] = std::min(low[i], p[k] - reach);
            high[i] = std::max(high[i], p[k] + reach);
        }
    }
};

Filling empty_box(const Frame& frame) {
    GridPlace low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = static_cast<std::int32_t>(std::floor(frame.low[k] / frame.unit));
        high[k] = static_cast<std::int32_t>(std::ceil(frame.high[k] / frame.unit));
    }
    return {RegularTriangulation(low, high), frame.unit};
}

Filling fill(const Frame& frame, std::span<const SectionCorner> corners, const Context& ctx) {
    Filling filling = empty_box(frame);
    std::vector<WeightedPlace> points;
    points.reserve(corners.size());
    const GridPlace low = filling.cells.vertex(0).at, high = filling.cells.vertex(7).at;
    for (const SectionCorner& c : corners) {
        WeightedPlace p{filling.place(c.at),
                        static_cast<std::int64_t>(c.weight / (filling.unit * filling.unit)),
                        kRoom * c.half / filling.unit};
        for (std::size_t k = 0; k < 3; ++k) p.at[k] = std::clamp(p.at[k], low[k] + 1, high[k] - 1);
        points.push_back(p);
    }
    filling.cells.insert(points, ctx);
    return filling;
}

/// Returns the minimum distance of two parallel planes with a tetrahedron between them, divided by its
/// shortest edge.
double flatness(const std::array<Vec3d, 4>& p, double& shortest) {
    const Vec3d a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
    const double volume = std::abs(dot(cross(a, b), c));
    double largest = 0;
    shortest = HUGE_VAL;
    for (const Vec3d normal : {cross(a, b), cross(b, c), cross(c, a), cross(b - a, c - a), cross(a, c - b),
                               cross(b, c - a), cross(c, b - a)})
        largest = std::max(largest, length(normal));
    for (const Vec3d edge : {a, b, c, b - a, c - a, c - b}) shortest = std::min(shortest, length(edge));
    return volume / (largest * shortest);
}

/// Returns the transposed rows: for each cell the cones near it, ascending.
CompressedRows<std::uint32_t> turned_round(const CompressedRows<std::uint32_t>& rows, std::size_t items) {
    return compress_rows<std::uint32_t>(items, [&](const auto& put) {
        for (std::uint32_t i = 0; i < rows.size(); ++i) {
            for (const std::uint32_t item : rows[i]) put(item, i);
        }
    });
}

/// Finds where tetrahedra are too wide for the branch of the bark that they contain.
class WideCells {
  public:
    WideCells(const Filling& filling, std::span<const RoundCone> cones,
              const CompressedRows<std::uint32_t>& cells, const CompressedRows<std::uint32_t>& cones_of)
        : filling_(filling), cones_(cones), cells_(cells), cones_of_(cones_of) {}

    /// Returns the parameters of a cone at which squares should be inserted.
    std::vector<double> find(std::uint32_t cone) const {
        std::vector<double> out;
        const RoundCone& c = cones_[cone];
        const double l = length(c.axis);
        const Vec3d along = normalized(c.axis), side = perpendicular(along), across = cross(along, side);
        double least = 0;
        for (double s = 0; s <= l;) {
            const double t = l > 0 ? s / l : 0, r = c.radius(t);
            const Vec3d center = c.point(t);
            const Vec3d ways[4] = {side, across, -side, -across};
            const bool wide = std::ranges::any_of(
                ways, [&](Vec3d way) { return is_wide(cone, center, center + way * r, along, r); });
            if (wide && s >= least) {
                out.push_back(t);
                least = s + kBetweenAdded * r;
            }
            s += std::max(2 * r, 1e-3 * l);
        }
        return out;
    }

  private:
    bool is_wide(std::uint32_t cone, Vec3d center, Vec3d bark, Vec3d along, double r) const {
        const std::uint32_t cell = filling_.cells.locate(filling_.place(bark), cells_[cone].front());
        double widest = 0;
        for (const Vec3d p : filling_.corners(cell)) {
            const Vec3d w = p - center;
            if (length(w) < kNearCorner * r) return false;
            widest = std::max(widest, length(w - along * dot(w, along)));
        }
        return widest > kMaxWidth * r && std::ranges::none_of(cones_of_[cell], [&](std::uint32_t other) {
                   return other != cone && cones_[other].closest_point(bark).relative_squared() < 0.9;
               });
    }

    const Filling& filling_;
    std::span<const RoundCone> cones_;
    const CompressedRows<std::uint32_t>& cells_;
    const CompressedRows<std::uint32_t>& cones_of_;
};

}  // namespace

std::vector<Segment> segment_axes(const Skeleton& skeleton) {
    std::vector<Segment> out;
    for (const NodeId n : nodes(skeleton)) {
        const float r = skeleton.radius(n);
        if (!skeleton.is_root(n)) {
            out.push_back(skeleton.segment(n));
        } else if (skeleton.is_tip(n)) {
            out.push_back({skeleton.position(n), skeleton.position(n), r, r});
        }
    }
    return out;
}

struct Polyhedron::State {
    Frame frame;
    PolyhedronOptions options;
    std::vector<RoundCone> cones;
    std::vector<Vec3d> side;                  ///< per cone: orientation of squares across it
    std::vector<std::vector<double>> put_in;  ///< per cone: parameters of inserted squares
    std::vector<SectionCorner> corners;
    PolyhedronReport report;
    Filling filling;
    CompressedRows<std::uint32_t> near, cones_of;  ///< cells per cone, and cones per cell, ascending
    std::vector<std::uint32_t> owner;              ///< per cell in use: the cone that owns its region
    TetraMesh mesh;
    std::vector<std::uint32_t> cell;  ///< per tetrahedron of the mesh
    CompressedRows<std::uint32_t> passing;

    void build(const Context& ctx);
    bool add_squares(int round, const Context& ctx);
    bool may_be_used(std::uint32_t cell) const;
    bool move_flat_ones(int round);
    void choose(const Context& ctx);
    std::uint32_t nearest_axis(std::uint32_t cell) const;
    void gather(const Context& ctx);
};

/// Builds the triangulation repeatedly until no tetrahedron is too wide or too flat.
void Polyhedron::State::build(const Context& ctx) {
    for (int round = 0;; ++round) {
        filling = fill(frame, corners, ctx);
        near = cells_near(filling, cones, options.outside, ctx);
        cones_of = turned_round(near, filling.cells.cells().size());
        if (round == kMaxRounds) return;
        const bool added = round < kMaxAdding && add_squares(round, ctx);
        if (!move_flat_ones(round) && !added) return;
    }
}

bool Polyhedron::State::add_squares(int round, const Context& ctx) {
    const WideCells wide(filling, cones, near, cones_of);
    std::vector<std::vector<double>> found(cones.size());
    parallel_for(ctx, cones.size(), kFewCones,
                 [&](std::size_t i) { found[i] = wide.find(static_cast<std::uint32_t>(i)); });
    const std::size_t before = corners.size();
    for (std::size_t i = 0; i < cones.size(); ++i) {
        const Vec3d normal = normalized(cones[i].axis);
        const Vec3d across = side[i] - normal * dot(normal, side[i]);
        for (const double t : found[i]) {
            const double room = kBetweenAdded * cones[i].radius(t) / length(cones[i].axis);
            const auto near_by = [&](double other) { return std::abs(other - t) < room; };
            if (std::ranges::any_of(put_in[i], near_by)) continue;  // inserted earlier without effect
            put_in[i].push_back(t);
            add_corners(corners,
                        {cones[i].point(t), normal, normalized(across, perpendicular(normal)),
                         cones[i].radius(t), round % 2 == 0},
                        options);
            ++report.added;
        }
    }
    return corners.size() > before;
}

/// Returns whether a cell is in use, or adjacent to one that is and may therefore be added later.
bool Polyhedron::State::may_be_used(std::uint32_t c) const {
    const auto& own = filling.cells.cells()[c];
    return !own.is_dead() && (!cones_of[c].empty() || std::ranges::any_of(own.next, [&](std::uint32_t next) {
        return next != kNoIndex && !cones_of[next].empty();
    }));
}

/// Moves one corner of each tetrahedron that is too flat by a random displacement.
bool Polyhedron::State::move_flat_ones(int round) {
    const CounterRandom random(static_cast<std::uint64_t>(round), 0xf1a7);
    const double least = round < kMaxAdding ? kMinFlatness : kMinFlatness / 4;
    bool moved = false;
    for (std::uint32_t c = 0; c < cones_of.size(); ++c) {
        if (!may_be_used(c)) continue;
        double shortest = 0;
        if (flatness(filling.corners(c), shortest) > least) continue;
        std::uint32_t point = kNoIndex;
        for (const std::uint32_t v : filling.cells.cells()[c].vertex)
            point = std::min(point, filling.cells.point(v));
        if (point == kNoIndex) continue;
        const auto draw = [&](std::uint64_t axis) {
            return kMove * shortest * random.uniform(3 * std::uint64_t{point} + axis, -1, 1);
        };
        corners[point].at += Vec3d{draw(0), draw(1), draw(2)};
        moved = true;
    }
    return moved;
}

std::uint32_t Polyhedron::State::nearest_axis(std::uint32_t c) const {
    if (cones_of[c].empty()) return kNoIndex;
    const auto p = filling.corners(c);
    const Vec3d middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    std::uint32_t out = kNoIndex;
    double least = HUGE_VAL;
    for (const std::uint32_t cone : cones_of[c]) {
        const double square = cones[cone].closest_point(middle).relative_squared();
        if (square < least) {
            least = square;
            out = cone;
        }
    }
    return out;
}

/// Selects the cells near a cone.
void Polyhedron::State::choose(const Context& ctx) {
    owner.assign(filling.cells.cells().size(), kNoIndex);
    parallel_for(ctx, owner.size(), kPolyhedronGrain,
                 [&](std::size_t c) { owner[c] = nearest_axis(static_cast<std::uint32_t>(c)); });
}

void Polyhedron::State::gather(const Context& ctx) {
    const auto by_axis = group_by(owner, cones.size());
    mesh = {};
    mesh.clearance = kClearance;
    cell.assign(by_axis.items.begin(), by_axis.items.end());
    mesh.tetra.resize(cell.size());
    std::vector<std::uint32_t> number(filling.cells.vertex_count(), kNoIndex);
    for (std::size_t t = 0; t < cell.size(); ++t) {
        for (std::size_t i = 0; i < 4; ++i) {
            const std::uint32_t v = filling.cells.cells()[cell[t]].vertex[i];
            if (number[v] == kNoIndex) {
                number[v] = static_cast<std::uint32_t>(mesh.positions.size());
                mesh.positions.push_back(Vec3(filling.at(v)));
            }
            mesh.tetra[t][i] = number[v];
        }
    }
    std::vector<std::uint32_t> axis_of;
    for (std::uint32_t axis = 0; axis < by_axis.size(); ++axis) {
        if (by_axis[axis].empty()) continue;
        mesh.first.push_back(mesh.first.back() + static_cast<std::uint32_t>(by_axis[axis].size()));
        axis_of.push_back(axis);
    }
    std::vector<std::vector<std::uint32_t>> rows(axis_of.size());
    parallel_for(ctx, rows.size(), kFewCones, [&](std::size_t r) {
        for (const std::uint32_t c : by_axis[axis_of[r]]) {
            for (const std::uint32_t cone : cones_of[c]) {
                if (!parted(cones[cone], kAxis, filling.corners(c))) rows[r].push_back(cone);
            }
        }
        sort_unique(rows[r]);
    });
    passing = compress_rows<std::uint32_t>(rows.size(), [&](const auto& put) {
        for (std::size_t r = 0; r < rows.size(); ++r) {
            for (const std::uint32_t axis : rows[r]) put(r, axis);
        }
    });
    report.tetra = static_cast<std::uint32_t>(mesh.tetra.size());
}

Polyhedron::Polyhedron(const Skeleton& skeleton, std::span<const Segment> axes,
                       const PolyhedronOptions& options, const Context& ctx) {
    check_fields(options, "polyhedron");
    std::vector<RoundCone> cones;
    for (const Segment& s : axes) cones.push_back(growing_cone(s, {}));
    Sections sections = find_sections(skeleton, options);
    std::vector<Vec3d> side;
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n) || skeleton.is_tip(n)) side.push_back(sections.side[n.index()]);
    }
    const Frame frame(axes, options);
    state_ = std::make_unique<State>(State{frame, options, std::move(cones), std::move(side),
                                           std::vector<std::vector<double>>(axes.size()),
                                           std::move(sections.corners), sections.report, empty_box(frame)});
    state_->build(ctx);
    state_->choose(ctx);
    state_->gather(ctx);
}

Polyhedron::~Polyhedron() = default;
Polyhedron::Polyhedron(Polyhedron&&) noexcept = default;
Polyhedron& Polyhedron::operator=(Polyhedron&&) noexcept = default;

const TetraMesh& Polyhedron::mesh() const { return state_->mesh; }
const PolyhedronReport& Polyhedron::report() const { return state_->report; }
const CompressedRows<std::uint32_t>& Polyhedron::passing() const { return state_->passing; }

bool Polyhedron::grow(std::span<const TetraFace> faces, const Context& ctx) {
    State& s = *state_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const TetraFace& f : faces) {
        const std::uint32_t own = s.cell[f.tetra], next = s.filling.cells.cells()[own].next[f.opposite];
        if (next != kNoIndex && s.owner[next] == kNoIndex) found.emplace_back(next, s.owner[own]);
    }
    for (const auto& [cell, axis] : found) s.owner[cell] = std::min(s.owner[cell], axis);
    if (!found.empty()) s.gather(ctx);
    return !found.empty();
}

void list_fields(PolyhedronOptions& o, FieldList& list) {
    list.add(Field{"section", "Edge length of the square cross-sections.", Unit::radius, 2, 8}, o.section);
    list.add(Field{"outside", "Distance from every axis beyond which all points count as outside.",
                   Unit::radius, 1.01, 4},
             o.outside);
}

}  // namespace coppice
