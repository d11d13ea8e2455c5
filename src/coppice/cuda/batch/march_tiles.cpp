#include "coppice/cuda/batch/march_tiles_internal.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "coppice/base/sort.h"
#include "coppice/tetra/march/closed_components.h"

namespace coppice::cuda {
namespace {

// Maximum number of rounds that move vertices back, as observed on difficult trees.
constexpr int kUsualRounds = 6;
constexpr unsigned kKeyBits = 51;

/// A vertex of the surface of several tiles.
struct KeyedVertex {
    std::uint64_t key;
    Vec3 position;
};

}  // namespace

MarchTiles::MarchTiles(const TetraMesh& mesh, int levels, std::uint64_t count, const Context& ctx)
    : whole_(mesh, levels, ctx), rounds_(kUsualRounds) {
    const auto first_from = [&](std::uint64_t tetra) {
        return static_cast<std::size_t>(std::ranges::lower_bound(mesh.first, tetra) - mesh.first.begin());
    };
    count = std::clamp<std::uint64_t>(count, 1, std::max(1u, mesh.region_count()));
    std::size_t begin = 0;
    for (std::uint64_t i = 1; i <= count; ++i) {
        const std::size_t end = i == count ? mesh.region_count() : first_from(mesh.tetra.size() * i / count);
        if (end > begin) tiles_.push_back({{begin, end}});
        begin = std::max(begin, end);
    }
}

bool MarchTiles::is_done(const Tile& tile) const {
    return tile.rings >= rings() || (tile.rings >= 0 && tile.is_closed);
}

const TetraTile* MarchTiles::next() {
    const auto found = std::ranges::find_if(tiles_, [&](const Tile& p) { return !is_done(p); });
    tile_.reset();
    if (found == tiles_.end()) return nullptr;
    at_ = static_cast<std::size_t>(found - tiles_.begin());
    tile_.emplace(whole_, found->regions, rings());
    return &*tile_;
}

std::size_t MarchTiles::compute_middle(IndexRange regions) const {
    const auto& first = whole_.coarse().first;
    const std::uint32_t middle = first[regions.begin] + (first[regions.end] - first[regions.begin]) / 2;
    const auto begin = first.begin() + static_cast<std::ptrdiff_t>(regions.begin);
    const auto end = first.begin() + static_cast<std::ptrdiff_t>(regions.end);
    return static_cast<std::size_t>(std::upper_bound(begin + 1, end, middle) - first.begin()) - 1;
}

bool MarchTiles::split() {
    // A GPU is about ten times as fast as the CPU.
    constexpr std::size_t kMaxAround = 10;
    const IndexRange regions = tiles_[at_].regions;
    if (regions.size() < 2 || tile_->mesh().tetra.size() > kMaxAround * tile_->own().size()) return false;
    const std::size_t middle = std::clamp(compute_middle(regions), regions.begin + 1, regions.end - 1);
    tiles_[at_] = {{regions.begin, middle}};
    tiles_.insert(tiles_.begin() + static_cast<std::ptrdiff_t>(at_) + 1, Tile{{middle, regions.end}});
    return true;
}

// Keys follow the order in which march() numbers the vertices: those at fine vertices first, then by the
// coarse element that contains them.
std::uint64_t MarchTiles::make_key(const SurfacePlace& place, bool is_cut) const {
    constexpr unsigned kIndexBits = 16, kPartBits = 32, kKindBits = 2;
    static_assert(kIndexBits + kPartBits + kKindBits + 1 == kKeyBits);
    const std::uint32_t t = tile_->tetra(place.tetra);
    const std::uint32_t part = place.group == TetraPattern::kInside ? t : whole_.elements(t)[place.group];
    std::uint64_t key = is_cut ? 1 : 0;
    key = key << kKindBits | element_kind(place.group);
    key = key << kPartBits | part;
    return key << kIndexBits | place.index;
}

void MarchTiles::put(TileMarch march) {
    Tile& tile = tiles_[at_];
    tile.rings = rings();
    tile.is_closed = tile_->is_closed();
    tile.keys.clear();
    tile.keys.reserve(march.vertices.size());
    for (std::uint32_t v = 0; v < march.vertices.size(); ++v)
        tile.keys.push_back(make_key(march.vertices[v], v >= march.moved));
    march.vertices = {};
    for (TetraFace& face : march.made.open) face.tetra = tile_->tetra(face.tetra);
    rounds_ = std::max(rounds_, march.rounds);
    tile.march = std::move(march);
}

TriMesh MarchTiles::join_meshes(const Context& ctx) {
    Buffer<KeyedVertex> all;
    std::size_t triangles = 0;
    for (const Tile& tile : tiles_) {
        for (std::size_t v = 0; v < tile.keys.size(); ++v)
            all.push_back({tile.keys[v], tile.march.made.mesh.positions[v]});
        triangles += tile.march.made.mesh.triangles.size();
    }
    if (std::max(all.size(), triangles) >= std::numeric_limits<std::uint32_t>::max())
        throw DeviceError("there are more than 2^32 triangles");
    radix_sort(ctx, all, kKeyBits, [](const KeyedVertex& v) { return v.key; });
    const auto same = [](const KeyedVertex& a, const KeyedVertex& b) { return a.key == b.key; };
    all.erase(std::unique(all.begin(), all.end(), same), all.end());
    TriMesh out;
    out.positions.reserve(all.size());
    for (const KeyedVertex& v : all) out.positions.push_back(v.position);
    out.triangles.reserve(triangles);
    for (Tile& tile : tiles_) {
        std::vector<std::uint32_t> number(tile.keys.size());
        parallel_for(ctx, number.size(), 4096, [&](std::size_t v) {
            const auto found = std::ranges::lower_bound(all, tile.keys[v], {}, &KeyedVertex::key);
            number[v] = static_cast<std::uint32_t>(found - all.begin());
        });
        for (const Triangle& t : tile.march.made.mesh.triangles)
            out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
        tile.keys = {};
        tile.march.made.mesh = {};
    }
    return out;
}

MarchResult MarchTiles::join(bool about_axes, const Context& ctx) {
    MarchResult out;
    std::vector<Vec3> places;
    for (const Tile& tile : tiles_) {
        const MarchReport& report = tile.march.made.report;
        const std::vector<TetraFace>& open = tile.march.made.open;
        out.report.inside += report.inside;
        out.report.crossed += report.crossed;
        out.report.snapped += report.snapped;
        out.report.freed += report.freed;
        out.open.insert(out.open.end(), open.begin(), open.end());
        places.insert(places.end(), tile.march.places.begin(), tile.march.places.end());
    }
    // The report is empty where the surface leaves the tetrahedra.
    if (!out.open.empty()) out.report = {.inside = out.report.inside};
    out.report.tetra = whole_.tetra_count();
    out.report.vertices = whole_.vertex_count();
    if (!out.open.empty()) return out;
    out.mesh = join_meshes(ctx);
    if (about_axes) out.report.dropped = drop_parts(out.mesh, places, true, ctx).count;
    return out;
}

}  // namespace coppice::cuda
