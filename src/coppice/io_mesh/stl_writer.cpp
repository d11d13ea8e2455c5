#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "coppice/base/box.h"
#include "coppice/base/sort.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 14;

/// STL stores 32-bit floats and no origin: refuses meshes that rounding would visibly damage.
void check_stl_rounding(const MeshView& mesh) {
    if (!mesh.has_origin()) return;
    Box3 box;
    for (const Vec3 p : mesh.positions) box.extend(p);
    const double reach = length(mesh.origin) + box.diagonal();
    if (reach * std::numeric_limits<float>::epsilon() > 1e-5 * box.diagonal()) {
        throw Unsupported(
            "STL has too few digits for coordinates that far from zero; write PLY or OBJ instead");
    }
}

auto in_order(Vec3 p) { return std::tuple(p.x, p.y, p.z); }

/// Positions of the vertices including the origin, in single precision. Because readers merge equal positions
/// into one vertex, different positions must remain different: if rounding makes them equal, all except one
/// are moved to the next free position along x.
class StlPlaces {
  public:
    StlPlaces(const MeshView& mesh, const Context& ctx) : mesh_(mesh) {
        if (!mesh.has_origin()) return;  // no rounding
        place_.resize(mesh.positions.size());
        parallel_for(ctx, place_.size(), kGrain, [&](std::size_t v) { place_[v] = rounded(v); });
        sort(ctx);
        for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
            for (end = begin; end < order_.size() && order_[end].key == order_[begin].key;) ++end;
            if (end - begin > 1) separate(std::span(order_).subspan(begin, end - begin));
        }
        for (const auto& [v, place] : moves_) place_[v] = place;
    }

    Vec3 operator[](std::uint32_t v) const { return place_.empty() ? rounded(v) : place_[v]; }

  private:
    struct Entry {
        std::uint64_t key;  ///< equal for equal positions
        std::uint32_t vertex;
    };
    static constexpr unsigned kKeyBits = 44;

    /// Returns the rounded position; never -0, which readers treat as 0.
    Vec3 rounded(std::size_t v) const { return Vec3(mesh_.origin + Vec3d(mesh_.positions[v])); }

    static std::uint64_t make_key(Vec3 place) {
        std::uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis)
            key = (key ^ std::bit_cast<std::uint32_t>(place[axis])) * 0x9e3779b97f4a7c15ull;
        return key >> (64 - kKeyBits);
    }

    void sort(const Context& ctx) {
        order_.resize(place_.size());
        parallel_for(ctx, place_.size(), kGrain, [&](std::size_t v) {
            order_[v] = {make_key(place_[v]), static_cast<std::uint32_t>(v)};
        });
        ctx.throw_if_cancelled();
        radix_sort(ctx, order_, kKeyBits, [](const Entry& e) { return e.key; });
        ctx.throw_if_cancelled();
    }

    /// Separates vertices with the same key, which mostly have the same position.
    void separate(std::span<Entry> same) {
        const auto at = [&](const Entry& e) {
            return std::tuple_cat(in_order(place_[e.vertex]), in_order(mesh_.positions[e.vertex]));
        };
        std::sort(same.begin(), same.end(), [&](const Entry& a, const Entry& b) {
            return std::tuple_cat(at(a), std::tuple(a.vertex)) < std::tuple_cat(at(b), std::tuple(b.vertex));
        });
        for (std::size_t i = 1; i < same.size(); ++i) {
            const std::uint32_t before = same[i - 1].vertex, v = same[i].vertex;
            if (place_[v] != place_[before]) continue;
            if (mesh_.positions[v] != mesh_.positions[before]) {
                moves_.emplace_back(v, free_place(place_[v]));
            } else if (!moves_.empty() && moves_.back().first == before) {
                moves_.emplace_back(v, moves_.back().second);  // equal vertices remain equal
            }
        }
    }

    Vec3 free_place(Vec3 place) {
        do {
            place.x = std::nextafter(place.x, std::numeric_limits<float>::max());
        } while (is_taken(place) || !given_.insert(in_order(place)).second);
        return place;
    }

    bool is_taken(Vec3 place) const {
        const std::uint64_t key = make_key(place);
        auto e = std::ranges::lower_bound(order_, key, {}, &Entry::key);
        for (; e != order_.end() && e->key == key; ++e) {
            if (place_[e->vertex] == place) return true;
        }
        return false;
    }

    const MeshView& mesh_;
    Buffer<Vec3> place_;
    Buffer<Entry> order_;  ///< sorted by key, so that equal positions are adjacent
    std::vector<std::pair<std::uint32_t, Vec3>> moves_;  ///< moved vertices and their new positions
    std::set<std::tuple<float, float, float>> given_;    ///< positions occupied by moved vertices
};

}  // namespace

void write_stl(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    if (mesh.triangle_count() > std::numeric_limits<std::uint32_t>::max()) {
        throw Unsupported("STL supports at most 4294967295 triangles; write PLY or OBJ instead");
    }
    check_stl_rounding(mesh);
    const StlPlaces place(mesh, ctx);
    Chunk head;
    head.reserve(84);
    head.put(fmt::format("{:<80}", "Coppice, metres, Z up"));
    head.put_raw(static_cast<std::uint32_t>(mesh.triangle_count()));
    file.write(head.view());
    write_items(file, mesh.face_count, {}, ctx, [&](std::size_t f, Chunk& chunk) {
        chunk.reserve(50 * (mesh.face(f).size() - 2));
        for_each_triangle(mesh, f, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            const std::array<Vec3, 3> p{place[a], place[b], place[c]};
            chunk.put_raw(normalized(cross(p[1] - p[0], p[2] - p[0]), {}));
            chunk.put_raw(p);
            chunk.put_raw(std::uint16_t{0});
        });
    });
}

}  // namespace coppice::io_internal
