#include "coppice/implicit/polygonize/polygonize.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"
#include "coppice/implicit/polygonize/block_lattice_internal.h"

namespace coppice {
namespace {

constexpr float kRanged = 0.1f;  // progress after the search for blocks that may contain the surface
constexpr std::size_t kMaxBlocks = 2000000;
constexpr std::size_t kMaxSparseBlocks = 64000000;  // most of them are not sampled
constexpr std::uint32_t kCells = BlockLattice::kCells;
constexpr std::uint32_t kNodes = BlockLattice::kNodes;
constexpr std::size_t kBlockNodes = BlockLattice::kBlockNodes;
constexpr std::uint32_t kEmpty = kNoIndex - 1;
/// Minimum distance of vertices from the ends of an edge, relative to its length, so that no triangle is
/// degenerate.
constexpr float kEndShare = 0.01f;

/// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2); an edge goes from a node in direction 1 to 7, with
/// the same encoding. Its key in a block is 8 node + direction.
std::uint32_t local_node(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x + kNodes * (y + kNodes * z);
}
std::uint32_t step_to(std::uint32_t corner) { return local_node(corner & 1, corner >> 1 & 1, corner >> 2); }

/// Paths of edges from corner 0 to corner 7, one for each order of the axes, positively oriented.
constexpr std::array<std::array<std::uint32_t, 4>, 6> kTetrahedra{
    {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 5, 1, 7}}};

/// Even permutations of the corners of a tetrahedron, indexed by the inside mask: the smaller group is first
/// (for two: the inner corners).
constexpr std::array<std::array<std::uint32_t, 4>, 16> kOrder{{{0, 1, 2, 3},
                                                               {0, 1, 2, 3},
                                                               {1, 0, 3, 2},
                                                               {0, 1, 2, 3},
                                                               {2, 0, 1, 3},
                                                               {0, 2, 3, 1},
                                                               {1, 2, 0, 3},
                                                               {3, 0, 2, 1},
                                                               {3, 0, 2, 1},
                                                               {0, 3, 1, 2},
                                                               {1, 3, 2, 0},
                                                               {2, 0, 1, 3},
                                                               {2, 3, 0, 1},
                                                               {1, 0, 3, 2},
                                                               {0, 1, 2, 3},
                                                               {0, 1, 2, 3}}};

/// The surface in one block. Edges on its sides are shared with other blocks.
struct BlockSurface {
    std::size_t block = 0;
    std::vector<std::uint32_t> keys;                      ///< of intersected edges, sorted
    std::vector<Vec3> positions;                          ///< by key
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of `keys`
    std::vector<std::uint32_t> ids;                       ///< vertices of the whole surface, by key
    std::uint32_t owned = 0;
};

/// Evaluates the values of a field in one of its regions.
using RegionValues = std::function<void(std::uint32_t, std::span<const Vec3>, std::span<float>)>;

/// The field to polygonize and the parameters.
struct Cut {
    const BlockLattice& lattice;
    const RegionValues& field;
    float level;
    Box3 box;  ///< the solid is clipped to it
    int refinements;
};

class BlockCutter {
  public:
    explicit BlockCutter(const Cut& cut)
        : lattice_(cut.lattice),
          field_(cut.field),
          level_(cut.level),
          box_(cut.box),
          refinements_(cut.refinements) {}

    BlockSurface cut(std::size_t block, std::uint32_t region) {
        BlockSurface out;
        out.block = block;
        region_ = region;
        sample_nodes(block);
        find_edges(out);
        if (out.keys.empty()) return out;
        place_vertices(out);
        for (std::uint32_t z = 0; z < kCells; ++z) {
            for (std::uint32_t y = 0; y < kCells; ++y) {
                for (std::uint32_t x = 0; x < kCells; ++x) cut_cell(local_node(x, y, z), out);
            }
        }
        return out;
    }

  private:
    /// The interval of an edge, from its node, that the surface crosses, and the values at its ends.
    struct Bracket {
        float low, high;
        float at_low, at_high;  ///< minus the iso value
        int last = 0;           ///< the end moved by the latest step: -1 low, 1 high
    };

    bool inside(std::uint32_t node) const { return values_[node] > level_; }

    void sample_nodes(std::size_t block) {
        lattice_.find_nodes(block, nodes_);
        field_(region_, nodes_, values_);
        for (std::size_t i = 0; i < kBlockNodes; ++i) {
            const Vec3 p = nodes_[i];
            const bool in_box = p.x >= box_.low.x && p.y >= box_.low.y && p.z >= box_.low.z &&
                                p.x <= box_.high.x && p.y <= box_.high.y && p.z <= box_.high.z;
            if (!in_box || !std::isfinite(values_[i])) values_[i] = level_ - 1;
        }
    }

    void find_edges(BlockSurface& out) {
        vertex_.fill(kNoIndex);
        for (std::uint32_t z = 0; z < kNodes; ++z) {
            for (std::uint32_t y = 0; y < kNodes; ++y) {
                for (std::uint32_t x = 0; x < kNodes; ++x) find_edges_at(x, y, z, out);
            }
        }
    }

    void find_edges_at(std::uint32_t x, std::uint32_t y, std::uint32_t z, BlockSurface& out) {
        const std::uint32_t node = local_node(x, y, z);
        for (std::uint32_t way = 1; way < 8; ++way) {
            if (x + (way & 1) > kCells || y + (way >> 1 & 1) > kCells || z + (way >> 2) > kCells) continue;
            if (inside(node) == inside(node + step_to(way))) continue;
            vertex_[8 * node + way] = static_cast<std::uint32_t>(out.keys.size());
            out.keys.push_back(8 * node + way);
        }
    }

    void place_vertices(BlockSurface& out) {
        const std::size_t count = out.keys.size();
        std::vector<Bracket> brackets(count);
        std::vector<float> share(count), value(count);
        out.positions.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t node = out.keys[i] / 8;
            brackets[i] = {0, 1, values_[node] - level_, values_[node + step_to(out.keys[i] % 8)] - level_};
        }
        for (int round = 0; round <= refinements_; ++round) {
            for (std::size_t i = 0; i < count; ++i) {
                const Bracket& b = brackets[i];
                const auto t = static_cast<float>(b.at_low / (double(b.at_low) - b.at_high));
                share[i] = b.low + (b.high - b.low) * std::clamp(t, 0.0f, 1.0f);
                share[i] = std::clamp(share[i], kEndShare, 1 - kEndShare);
                const std::uint32_t node = out.keys[i] / 8;
                out.positions[i] = lerp(nodes_[node], nodes_[node + step_to(out.keys[i] % 8)], share[i]);
            }
            if (round == refinements_) break;
            field_(region_, out.positions, value);
            for (std::size_t i = 0; i < count; ++i) narrow(brackets[i], share[i], value[i]);
        }
    }

    /// Regula falsi; an end that is kept a second time loses half its weight (the Illinois rule).
    void narrow(Bracket& b, float share, float value) const {
        if (!std::isfinite(value)) return;
        const bool moves_low = (value > level_) == (b.at_low > 0);
        const int end = moves_low ? -1 : 1;
        if (b.last == end) (moves_low ? b.at_high : b.at_low) *= 0.5f;
        (moves_low ? b.low : b.high) = share;
        (moves_low ? b.at_low : b.at_high) = value - level_;
        b.last = end;
    }

    void cut_cell(std::uint32_t node, BlockSurface& out) {
        const bool first = inside(node);
        bool mixed = false;
        for (std::uint32_t c = 1; c < 8; ++c) mixed |= inside(node + step_to(c)) != first;
        if (!mixed) return;
        for (const auto& tetrahedron : kTetrahedra) cut_tetrahedron(node, tetrahedron, out);
    }

    void cut_tetrahedron(std::uint32_t node, const std::array<std::uint32_t, 4>& corners, BlockSurface& out) {
        std::uint32_t mask = 0, count = 0;
        for (std::uint32_t i = 0; i < 4; ++i) {
            if (!inside(node + step_to(corners[i]))) continue;
            mask |= 1u << i;
            ++count;
        }
        if (count == 0 || count == 4) return;
        std::array<std::uint32_t, 4> c;
        for (std::size_t i = 0; i < 4; ++i) c[i] = corners[kOrder[mask][i]];
        const auto vertex = [&](std::size_t i, std::size_t j) {
            // The bits of one corner are a subset of the other's; the edge starts at the smaller one.
            const std::uint32_t low = std::min(c[i], c[j]), way = c[i] ^ c[j];
            return vertex_[8 * (node + step_to(low)) + way];
        };
        if (count == 2) {
            add_quad(vertex(0, 2), vertex(0, 3), vertex(1, 3), vertex(1, 2), out);
        } else if (count == 1) {
            out.triangles.push_back({vertex(0, 1), vertex(0, 2), vertex(0, 3)});
        } else {
            out.triangles.push_back({vertex(0, 1), vertex(0, 3), vertex(0, 2)});
        }
    }

    static void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                         BlockSurface& out) {
        const auto& p = out.positions;
        if (length_squared(p[a] - p[c]) <= length_squared(p[b] - p[d])) {
            out.triangles.push_back({a, b, c});
            out.triangles.push_back({a, c, d});
        } else {
            out.triangles.push_back({a, b, d});
            out.triangles.push_back({b, c, d});
        }
    }

    const BlockLattice& lattice_;
    const RegionValues& field_;
    float level_;
    Box3 box_;
    int refinements_;
    std::uint32_t region_ = 0;
    std::array<Vec3, kBlockNodes> nodes_;
    std::array<float, kBlockNodes> values_;
    std::array<std::uint32_t, 8 * kBlockNodes> vertex_;
};

/// Joins the surfaces of the blocks. Every vertex is owned by the first of the blocks around its edge.
class Joiner {
  public:
    /// `sampled` lists all sampled blocks, `blocks` those that contain a portion of the surface.
    Joiner(const BlockLattice& lattice, std::span<const std::size_t> sampled,
           std::vector<BlockSurface>& blocks, const Context& ctx)
        : lattice_(lattice), blocks_(blocks), ctx_(ctx), index_(lattice.block_count(), kNoIndex) {
        for (const std::size_t block : sampled) index_[block] = kEmpty;
        for (std::size_t i = 0; i < blocks.size(); ++i)
            index_[blocks[i].block] = static_cast<std::uint32_t>(i);
    }

    TriMesh join() {
        check_sides();
        parallel_for(ctx_, blocks_.size(), 16, [&](std::size_t i) { count_owned(i); });
        std::vector<std::size_t> first_vertex, first_triangle;
        for (const BlockSurface& b : blocks_) {
            first_vertex.push_back(b.owned);
            first_triangle.push_back(b.triangles.size());
        }
        TriMesh out;
        const std::size_t vertices = exclusive_scan(std::span(first_vertex));
        if (vertices >= kEmpty) throw InvalidInput("polygonize: more than 2^32 vertices; increase cell");
        out.positions.resize(vertices);
        out.triangles.resize(exclusive_scan(std::span(first_triangle)));
        parallel_for(ctx_, blocks_.size(), 16, [&](std::size_t i) { number_owned(i, first_vertex[i], out); });
        parallel_for(ctx_, blocks_.size(), 16,
                     [&](std::size_t i) { number_rest(i, first_triangle[i], out); });
        return out;
    }

  private:
    struct Owner {
        std::uint32_t block;  ///< index of blocks_
        std::uint32_t key;    ///< of the edge in that block
    };
    /// An edge as seen from a block.
    struct Edge {
        std::array<std::uint32_t, 3> block, node;
        std::uint32_t way;

        std::uint32_t key() const { return 8 * local_node(node[0], node[1], node[2]) + way; }
        bool runs_along(std::uint32_t axis) const { return way >> axis & 1; }
    };

    Edge find_edge(std::uint32_t i, std::uint32_t key) const {
        const std::uint32_t node = key / 8;
        return {lattice_.place(blocks_[i].block),
                {node % kNodes, node / kNodes % kNodes, node / kNodes / kNodes},
                key % 8};
    }
    std::uint32_t index_of(const Edge& e) const {
        return index_[lattice_.block_at(e.block[0], e.block[1], e.block[2])];
    }

    /// Blocks that share an edge have both sampled its ends, and must agree there: otherwise the surface
    /// would have a crack. Throws InvalidInput if the field has returned two values for one point.
    void check_sides() const {
        const int differing = parallel_reduce(
            ctx_, blocks_.size(), 16, 0,
            [&](IndexRange range) {
                bool agree = true;
                for (std::size_t i = range.begin; i < range.end; ++i)
                    agree = agree && sides_agree(static_cast<std::uint32_t>(i));
                return agree ? 0 : 1;
            },
            [](int a, int b) { return a | b; });
        if (differing == 0) return;
        throw InvalidInput(
            "polygonize: the field returns different values for the same point in different calls; its "
            "values must depend on the point only");
    }

    bool sides_agree(std::uint32_t i) const {
        for (const std::uint32_t key : blocks_[i].keys) {
            const Edge edge = find_edge(i, key);
            for (std::uint32_t axis = 0; axis < 3; ++axis) {
                if (edge.runs_along(axis)) continue;
                Edge there = edge;
                if (edge.node[axis] == 0 && edge.block[axis] > 0) {
                    --there.block[axis];
                    there.node[axis] = kCells;
                } else if (edge.node[axis] == kCells && edge.block[axis] + 1 < lattice_.blocks[axis]) {
                    ++there.block[axis];
                    there.node[axis] = 0;
                } else {
                    continue;
                }
                if (!holds(index_of(there), there.key())) return false;
            }
        }
        return true;
    }

    /// Returns whether a block has found an edge; true for a block that was not sampled.
    bool holds(std::uint32_t block, std::uint32_t key) const {
        if (block == kNoIndex) return true;
        return block != kEmpty && std::ranges::binary_search(blocks_[block].keys, key);
    }

    /// An edge on a side of a block is also in the neighbouring blocks across that side. All of them have
    /// found it; the lowest one owns it.
    Owner owner(std::uint32_t i, std::uint32_t key) const {
        Edge edge = find_edge(i, key);
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            if (edge.runs_along(axis) || edge.node[axis] > 0 || edge.block[axis] == 0) continue;
            --edge.block[axis];
            edge.node[axis] = kCells;
        }
        const std::uint32_t block = index_of(edge);
        if (block >= kEmpty) return {i, key};  // only if a shape is steeper than its steepness()
        return {block, edge.key()};
    }

    void count_owned(std::size_t i) {
        const auto self = static_cast<std::uint32_t>(i);
        BlockSurface& b = blocks_[i];
        for (const std::uint32_t key : b.keys) b.owned += owner(self, key).block == self;
    }

    void number_owned(std::size_t i, std::size_t first, TriMesh& out) {
        const auto self = static_cast<std::uint32_t>(i);
        BlockSurface& b = blocks_[i];
        b.ids.assign(b.keys.size(), kNoIndex);
        auto id = static_cast<std::uint32_t>(first);
        for (std::size_t k = 0; k < b.keys.size(); ++k) {
            if (owner(self, b.keys[k]).block != self) continue;
            out.positions[id] = b.positions[k];
            b.ids[k] = id++;
        }
    }

    std::uint32_t get_id(std::uint32_t i, std::uint32_t place) const {
        const BlockSurface& b = blocks_[i];
        if (b.ids[place] != kNoIndex) return b.ids[place];
        const Owner o = owner(i, b.keys[place]);
        const BlockSurface& other = blocks_[o.block];
        const auto found = std::ranges::lower_bound(other.keys, o.key);
        return other.ids[static_cast<std::size_t>(found - other.keys.begin())];
    }

    void number_rest(std::size_t i, std::size_t first, TriMesh& out) const {
        for (const auto& t : blocks_[i].triangles) {
            const auto self = static_cast<std::uint32_t>(i);
            out.triangles[first++] = {get_id(self, t[0]), get_id(self, t[1]), get_id(self, t[2])};
        }
    }

    const BlockLattice& lattice_;
    std::vector<BlockSurface>& blocks_;
    const Context& ctx_;
    /// By block of the lattice: index of blocks_, kEmpty, or kNoIndex: not sampled.
    std::vector<std::uint32_t> index_;
};

/// Polygonizes the given blocks, each with its index as region, and joins the results.
TriMesh cut_blocks(const Cut& cut, std::span<const std::size_t> candidates, const Context& ctx) {
    constexpr std::size_t kGrain = 8;
    std::vector<std::vector<BlockSurface>> found((candidates.size() + kGrain - 1) / kGrain);
    parallel_with_progress(ctx, candidates.size(), kGrain, [&](IndexRange r) {
        const auto cutter = std::make_unique<BlockCutter>(cut);
        for (std::size_t i = r.begin; i < r.end; ++i) {
            ctx.throw_if_cancelled();
            BlockSurface surface = cutter->cut(candidates[i], static_cast<std::uint32_t>(i));
            if (!surface.keys.empty()) found[r.begin / kGrain].push_back(std::move(surface));
        }
    });
    std::vector<BlockSurface> blocks;
    for (auto& group : found) {
        for (BlockSurface& b : group) blocks.push_back(std::move(b));
    }
    return Joiner(cut.lattice, candidates, blocks, ctx).join();
}

}  // namespace

TriMesh polygonize(FieldRef field, const Box3& box, const PolygonizeOptions& options, const Context& ctx) {
    check_fields(options, "polygonize");
    const BlockLattice lattice = cover(box, options.cell, "polygonize", kMaxBlocks);
    std::vector<std::size_t> all(lattice.block_count());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const RegionValues values = [&, of = to_value_function(field)](std::uint32_t, auto points, auto out) {
        of(points, out);
    };
    return cut_blocks({lattice, values, field.level(), box, options.refinements}, all, ctx);
}

PolygonizeRegions regions_touching(const Box3& box, std::span<const Box3> near,
                                   const PolygonizeOptions& options, const Context& ctx) {
    check_fields(options, "polygonize");
    const BlockLattice lattice = cover(box, options.cell, "polygonize", kMaxSparseBlocks);
    std::vector<std::uint8_t> touched(lattice.block_count(), 0);
    for (const Box3& b : near) {
        const auto [low, high] = lattice.blocks_touching(b);
        for (std::uint32_t z = low[2]; z < high[2]; ++z) {
            for (std::uint32_t y = low[1]; y < high[1]; ++y) {
                for (std::uint32_t x = low[0]; x < high[0]; ++x) touched[lattice.block_at(x, y, z)] = 1;
            }
        }
    }
    PolygonizeRegions out;
    for (std::size_t b = 0; b < touched.size(); ++b) {
        if (touched[b] != 0) out.block.push_back(b);
    }
    out.box.resize(out.block.size());
    parallel_for(ctx, out.box.size(), 1024, [&](std::size_t i) { out.box[i] = lattice.box(out.block[i]); });
    return out;
}

TriMesh polygonize(FieldRef field, const Box3& box, const PolygonizeRegions& regions,
                   const PolygonizeOptions& options, const Context& ctx) {
    check_fields(options, "polygonize");
    const BlockLattice lattice = cover(box, options.cell, "polygonize", kMaxSparseBlocks);
    if (!regions.block.empty() && regions.block.back() >= lattice.block_count()) {
        throw InvalidInput("polygonize: the regions must belong to the same box and cell");
    }
    const RegionValues values = [&](std::uint32_t region, auto points, auto out) {
        to_value_function(field, region)(points, out);
    };
    return cut_blocks({lattice, values, field.level(), box, options.refinements}, regions.block, ctx);
}

TriMesh polygonize(const SolidField& field, const PolygonizeOptions& options, const Context& ctx) {
    check_fields(options, "polygonize");
    const BlockLattice lattice = cover(field.surface_bounds(), options.cell, "polygonize", kMaxBlocks);
    const auto ranges = block_ranges(lattice, field, ctx);
    std::vector<std::size_t> near;
    for (std::size_t b = 0; b < ranges.size(); ++b) {
        if (ranges[b].low <= field.level() && ranges[b].high >= field.level()) near.push_back(b);
    }
    const RegionValues values = [&](std::uint32_t, auto points, auto out) { field.values(points, out); };
    const Box3 everywhere{-Vec3{Box3::kInfinity, Box3::kInfinity, Box3::kInfinity},
                          {Box3::kInfinity, Box3::kInfinity, Box3::kInfinity}};
    return cut_blocks({lattice, values, field.level(), everywhere, options.refinements}, near,
                      narrow_progress(ctx, kRanged, 1));
}

void list_fields(PolygonizeOptions& o, FieldList& list) {
    list.add(Field{"cell", "Side of a cell of the polygonizer; 0 uses 1/64 of the longest side.", Unit::metre,
                   0, 1e6},
             o.cell);
    list.add(
        Field{"refinements", "Number of times that a vertex is moved along its edge towards the surface.",
              Unit::none, 0, 20},
        o.refinements);
}

}  // namespace coppice
