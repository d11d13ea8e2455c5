#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/cuda/batch/tetra_tile_internal.h"
#include "coppice/cuda/tetra/extract_stages_internal.h"
#include "coppice/cuda/tetra/march_input_internal.h"
#include "coppice/cuda/tetra/march_stages_internal.h"

// march() on meshes with too many tetrahedra for a GPU: processes tiles in sequence and joins their surfaces.

namespace coppice::cuda {

/// Contribution of a tile to a surface, in host memory. Tetrahedra are numbered as in the tile.
struct TileMarch {
    MarchResult made;                    ///< in the tile's own tetrahedra
    std::vector<SurfacePlace> vertices;  ///< positions of the mesh vertices in the tetrahedra
    std::uint32_t moved = 0;             ///< number of vertices at fine vertices; the others are on edges
    std::vector<Vec3> places;            ///< see DeviceMarch
    int rounds = 0;                      ///< see DeviceMarch
};

/// Divides tetrahedra into tiles, and joins the results to the result of march() on all of them.
class MarchTiles {
  public:
    /// Creates about `count` tiles of at least one region each; the mesh must outlive this object. Throws the
    /// exceptions of TetraRefinement.
    MarchTiles(const TetraMesh& mesh, int levels, std::uint64_t count, const Context& ctx = {});

    /// Returns the next tile to march, valid until the next call; null if all are done. A tile is repeated if
    /// vertices were moved back in more rounds than assumed.
    const TetraTile* next();
    /// Divides the last tile because it is too large; returns false if smaller tiles would consist mainly of
    /// surrounding tetrahedra.
    bool split();
    /// Stores the result of the last tile.
    void put(TileMarch march);
    /// Returns the whole surface. Components without an axis are removed if there are axes. O(n log n).
    MarchResult join(bool about_axes, const Context& ctx = {});

  private:
    struct Tile {
        IndexRange regions;
        int rings = -1;                        // rings of the last march; -1 at first
        bool is_closed = false;                // see TetraTile
        std::vector<std::uint64_t> keys = {};  // of its vertices: see make_key()
        TileMarch march = {};
    };

    int rings() const { return TetraTile::rings_for(rounds_, whole_.levels()); }
    bool is_done(const Tile& tile) const;
    std::size_t compute_middle(IndexRange regions) const;
    std::uint64_t make_key(const SurfacePlace& place, bool is_cut) const;
    TriMesh join_meshes(const Context& ctx);

    TetraRefinement whole_;
    std::vector<Tile> tiles_;  // sorted by region
    int rounds_;               // maximum over all tiles, at least the usual number
    std::size_t at_ = 0;       // index of the last tile
    std::optional<TetraTile> tile_;
};

/// Returns the result of marching a tile, copied to the host. Waits.
template <class Exec>
TileMarch download_march(Exec& exec, const DeviceRefinement& refinement, const DeviceMarch& made) {
    return {downloaded(exec, made), name_vertices(exec, refinement, made.vertices), made.vertices.moved.count,
            made.places, made.rounds};
}

/// Marches in one tile; `boxes` are those of the regions of the whole mesh. Resets the executor. Waits.
template <class Exec>
TileMarch march_tile(Exec& exec, const TetraTile& tile, const MarchInput& in, std::span<const Box3> boxes,
                     const Context& ctx) {
    const CompressedRows<std::uint32_t> passing = tile.rows(in.axes.passing);
    const EndCuts ends{in.field.ends.cuts, tile.rows(in.field.ends.of_region)};
    std::vector<Box3> own_boxes;
    for (const std::uint32_t r : tile.regions()) own_boxes.push_back(boxes[r]);
    exec.reset();
    MarchJob job = upload_march(
        exec, {tile.mesh(), {in.field.field, ends}, {in.axes.segments, passing}, in.options}, ctx);
    job.boxes = exec.upload(std::span<const Box3>(own_boxes));
    job.longest = longest_list(in.mesh.region_count());
    job.coarse.own_begin = static_cast<std::uint32_t>(tile.own().begin);
    job.coarse.own_end = static_cast<std::uint32_t>(tile.own().end);
    TileMarch out;
    const bool done = with_march_field(exec, job, [&](const DeviceRefinement& refinement, const auto& at) {
        out = download_march(exec, refinement,
                             march_own(exec, refinement, job.axes, at, in.options.refinements));
    });
    if (!done) refuse_mesh(tile.mesh(), in.options.levels, ctx);
    return out;
}

/// Executes march() in tiles as large as the memory of the executor allows; the result is bit-identical to
/// that of march(). Throws DeviceFull if this would be slower than the CPU. Resets the executor. Waits.
template <class Exec>
MarchResult march_in_tiles(Exec& exec, const MarchInput& in, const Context& ctx = {}) {
    check(in.options);
    exec.reset();
    const std::uint64_t bytes = bytes_of_march(in.mesh.tetra.size(), in.options.levels);
    const std::uint64_t count = 2 + 2 * bytes / std::max<std::uint64_t>(1, exec.room());
    MarchTiles tiles(in.mesh, in.options.levels, count, ctx);
    const std::vector<Box3> boxes = region_boxes(in.mesh, ctx);
    while (const TetraTile* tile = tiles.next()) {
        ctx.throw_if_cancelled();
        try {
            tiles.put(march_tile(exec, *tile, in, boxes, ctx));
        } catch (const DeviceFull&) {
            if (!tiles.split()) throw;
        }
    }
    return tiles.join(!in.axes.segments.empty(), ctx);
}

}  // namespace coppice::cuda
