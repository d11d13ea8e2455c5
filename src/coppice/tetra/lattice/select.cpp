#include "coppice/tetra/lattice/select_internal.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kSelectGrain = 1 << 10;
constexpr std::uint32_t kOutside = kNoIndex,
                        /// other values: the segment that contains a vertex deep inside
    kShell = kNoIndex - 1;

class Selection {
  public:
    Selection(const LatticeCells& cells, const LeafSegments& of_leaves, std::span<const RoundCone> cones,
              const LatticeCube& cube, const LatticeOptions& options, const Context& ctx)
        : cells_(cells),
          segments_(of_leaves),
          cones_(cones),
          options_(options),
          unit_(cube.side / Octree::kSide),
          state_(cells.vertex_count()) {
        parallel_for(ctx, cells.leaf_count(), kSelectGrain, [&](std::size_t leaf) {
            cells_.visit_vertices(static_cast<std::uint32_t>(leaf), [&](std::uint32_t vertex, auto place) {
                state_[vertex] = state(at(place), segments(static_cast<std::uint32_t>(leaf)));
            });
        });
    }

    std::uint64_t slots(std::uint32_t leaf, std::vector<std::uint32_t>& scratch) const {
        std::uint64_t mask = 0;
        const bool near = !segments(leaf).empty();
        const auto want = [&](std::uint32_t other) { return near || !segments(other).empty(); };
        cells_.visit_faces(leaf, want, [&](const LatticeFace& face) {
            mask |= std::uint64_t{places(face, scratch)} << (8 * face.direction);
        });
        return mask;
    }

  private:
    std::span<const std::uint32_t> segments(std::uint32_t leaf) const { return segments_.of_leaf(leaf); }

    Vec3d at(const std::array<std::uint32_t, 3>& place) const {
        return {place[0] * unit_, place[1] * unit_, place[2] * unit_};
    }

    std::uint32_t state(Vec3d p, std::span<const std::uint32_t> segments) const {
        const double outside = double(options_.outside) * options_.outside;
        const double inside = double(options_.inside) * options_.inside;
        double least = outside;
        std::uint32_t deepest = kShell;
        for (const std::uint32_t s : segments) {
            const double square = cones_[s].closest_point(p).relative_squared();
            if (square < least) {
                least = square;
                deepest = s;
            }
        }
        return least < inside ? deepest : least < outside ? kShell : kOutside;
    }

    /// The two centers, then the points of the border.
    using Points = std::array<Vec3d, 10>;

    /// Returns the border indices of the tetrahedra of a face that the surface may cross or an axis passes
    /// through.
    unsigned places(const LatticeFace& face, std::vector<std::uint32_t>& near) const {
        unsigned out = 0;
        bool probed = false;
        Points points;
        std::array<std::uint32_t, 4> t{};
        for (unsigned place = 0; place < 8; ++place) {
            if (!cells_.tetra(face, place, t)) continue;
            const std::array<std::uint32_t, 4> state{state_[t[0]], state_[t[1]], state_[t[2]], state_[t[3]]};
            const bool outside = std::ranges::all_of(state, [](auto s) { return s == kOutside; });
            const bool inside = std::ranges::all_of(state, [](auto s) { return s < kShell; });
            if (outside || inside) {
                if (!probed) probe(face, points, near);
                probed = true;
                const std::array<Vec3d, 4> corners{points[0], points[1], points[2 + place],
                                                   points[2 + LatticeCells::next_place(face, place)]};
                if (outside ? beyond_all(near, options_.outside, corners)
                            : within_one(state, corners) && beyond_all(near, 0, corners))
                    continue;
            }
            out |= 1u << place;
        }
        return out;
    }

    /// Computes the points of the tetrahedra of a face, and the segments that may intersect their hull;
    /// usually there are no such segments.
    void probe(const LatticeFace& face, Points& points, std::vector<std::uint32_t>& near) const {
        const Octree::Cell cell = cells_.octree().cell(face.leaf);
        const auto square = LatticeCells::square(face, cell);
        points[0] = at(LatticeCells::middle(cell));
        points[1] = at(LatticeCells::middle(cells_.octree().cell(face.other)));
        for (std::size_t j = 0; j < 4; ++j) {
            points[2 + 2 * j] = at(square[j]);
            points[3 + 2 * j] = 0.5 * (at(square[j]) + at(square[(j + 1) % 4]));
        }
        const std::array<Vec3d, 6> hull{points[0], points[1], points[2], points[4], points[6], points[8]};
        const Vec3d middle = 0.5 * (points[2] + points[6]);
        near.clear();
        const auto add = [&](std::span<const std::uint32_t> segments) {
            for (const std::uint32_t s : segments) {
                if (!apart(s, options_.outside, middle, hull)) near.push_back(s);
            }
        };
        add(segments(face.leaf));
        if (!segments_.same(face.leaf, face.other)) add(segments(face.other));
    }

    template <std::size_t N>
    bool apart(std::uint32_t segment, double times, Vec3d middle, const std::array<Vec3d, N>& corners) const {
        return separated(cones_[segment], times, middle, [&](Vec3d n, double) {
            double least = dot(n, corners[0]);
            for (std::size_t i = 1; i < N; ++i) least = std::min(least, dot(n, corners[i]));
            return least;
        });
    }

    /// Returns whether all near segments, with radii multiplied by `times`, are separated from the
    /// tetrahedron.
    bool beyond_all(std::span<const std::uint32_t> near, double times,
                    const std::array<Vec3d, 4>& corners) const {
        const Vec3d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
        return std::ranges::all_of(near, [&](std::uint32_t s) { return apart(s, times, middle, corners); });
    }

    /// A cone is convex: it contains the tetrahedron if it contains the corners.
    bool within_one(const std::array<std::uint32_t, 4>& state, const std::array<Vec3d, 4>& corners) const {
        return std::ranges::any_of(state, [&](std::uint32_t s) {
            return std::ranges::all_of(corners,
                                       [&](Vec3d p) { return holds_ball(cones_[s], options_.inside, p, 0); });
        });
    }

    const LatticeCells& cells_;
    const LeafSegments& segments_;
    std::span<const RoundCone> cones_;
    const LatticeOptions& options_;
    double unit_;
    Buffer<std::uint32_t> state_;  ///< per vertex
};

}  // namespace

SlotMasks select_tetra(const LatticeCells& cells, const LeafSegments& segments,
                       std::span<const RoundCone> cones, const LatticeCube& cube,
                       const LatticeOptions& options, const Context& ctx) {
    const Selection selection(cells, segments, cones, cube, options, ctx);
    SlotMasks masks(cells.leaf_count());
    parallel_for_ranges(ctx, masks.size(), kSelectGrain, [&](IndexRange range) {
        std::vector<std::uint32_t> scratch;
        for (std::size_t leaf = range.begin; leaf < range.end; ++leaf)
            masks[leaf] = selection.slots(static_cast<std::uint32_t>(leaf), scratch);
    });
    return masks;
}

SlotMasks all_tetra(const LatticeCells& cells, const Context& ctx) {
    SlotMasks masks(cells.leaf_count());
    parallel_for(ctx, masks.size(), kSelectGrain, [&](std::size_t leaf) {
        masks[leaf] = 0;
        const auto want = [](std::uint32_t) { return true; };
        cells.visit_faces(static_cast<std::uint32_t>(leaf), want, [&](const LatticeFace& face) {
            for (unsigned place = 0; place < 8; ++place) {
                if (face.border[place] != kNoIndex)
                    masks[leaf] |= std::uint64_t{1} << (8 * face.direction + place);
            }
        });
    });
    return masks;
}

LatticeMesh gather_tetra(const LatticeCells& cells, const SlotMasks& masks, const LatticeCube& cube,
                         const Context& ctx) {
    LatticeMesh out;
    std::uint32_t total = 0;
    for (std::uint32_t leaf = 0; leaf < masks.size(); ++leaf) {
        if (masks[leaf] == 0) continue;
        total += static_cast<std::uint32_t>(std::popcount(masks[leaf]));
        out.region_leaf.push_back(leaf);
        out.mesh.first.push_back(total);
    }
    Buffer<Tetra>& tetra = out.mesh.tetra;
    tetra.resize(total);
    // Every thread that uses a vertex writes the same number.
    Buffer<std::uint32_t> number(cells.vertex_count() + std::size_t{1});
    parallel_for(ctx, number.size(), kSelectGrain, [&](std::size_t v) { number[v] = 0; });
    parallel_for(ctx, out.region_leaf.size(), kSelectGrain, [&](std::size_t region) {
        const std::uint32_t leaf = out.region_leaf[region];
        std::uint32_t next = out.mesh.first[region];
        LatticeFace face;
        unsigned direction = 6;
        for (std::uint64_t rest = masks[leaf]; rest != 0; rest &= rest - 1) {
            const auto slot = static_cast<unsigned>(std::countr_zero(rest));
            if (slot / 8 != direction) face = cells.face(leaf, direction = slot / 8);
            cells.tetra(face, slot % 8, tetra[next]);
            for (const std::uint32_t v : tetra[next])
                std::atomic_ref(number[v]).store(1, std::memory_order_relaxed);
            ++next;
        }
    });
    out.mesh.positions.resize(exclusive_scan<std::uint32_t>(number));
    parallel_for(ctx, total, 4 * kSelectGrain, [&](std::size_t t) {
        for (std::uint32_t& v : tetra[t]) v = number[v];
    });
    parallel_for(ctx, cells.leaf_count(), kSelectGrain, [&](std::size_t leaf) {
        cells.visit_vertices(static_cast<std::uint32_t>(leaf), [&](std::uint32_t v, auto place) {
            if (number[v] != number[v + 1]) out.mesh.positions[number[v]] = Vec3(cube.at(place));
        });
    });
    return out;
}

}  // namespace coppice
