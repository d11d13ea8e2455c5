#include "coppice/cuda/batch/quad_tile_internal.h"

#include <algorithm>

#include "coppice/base/id.h"

namespace coppice::cuda {
namespace {

// Copies values to the start of `to`.
void put_row(std::span<const Vec3> row, std::span<Vec3> to) { std::copy(row.begin(), row.end(), to.begin()); }

}  // namespace

QuadTile::QuadTile(const QuadJob& whole, IndexRange own)
    : whole_(whole),
      own_(own),
      faces_(faces_around()),
      vertices_(vertices_of_faces()),
      edges_(edges_of_faces()),
      job_(whole) {
    take_faces();
    take_vertices();
    take_edges();
    for (ClipPlane clip : whole.clips) {
        if (!faces_.has(clip.first_quad)) continue;
        clip.first_quad = faces_.place(clip.first_quad);
        arrays_.clips.push_back(clip);
    }
    arrays_.lend(job_);
}

ChosenNumbers QuadTile::faces_around() const {
    NumberSet chosen(whole_.cage.face_count());
    std::vector<std::uint32_t> faces;
    const auto add = [&](std::uint32_t f) {
        if (chosen.add(f)) faces.push_back(f);
    };
    for (auto f = static_cast<std::uint32_t>(own_.begin); f < own_.end; ++f) add(f);
    std::size_t begin = 0;
    for (int ring = 0; ring <= whole_.project.relax_passes; ++ring) {
        for (const std::size_t end = faces.size(); begin < end; ++begin) {
            const Quad quad = whole_.cage.quads[faces[begin]];
            for (const std::uint32_t v : quad) {
                for (const std::uint32_t half : whole_.cage.fan(v)) add(half >> 2);
            }
        }
        for (const ClipPlane& clip : whole_.clips) {
            bool is_touched = false;
            for (std::uint32_t k = 0; k < clip.quad_count; ++k)
                is_touched = is_touched || chosen.contains(clip.first_quad + k);
            for (std::uint32_t k = 0; is_touched && k < clip.quad_count; ++k) add(clip.first_quad + k);
        }
    }
    return ChosenNumbers(std::move(chosen));
}

ChosenNumbers QuadTile::vertices_of_faces() const {
    NumberSet chosen(whole_.cage.vertex_count());
    for (const std::uint32_t f : faces_) {
        for (const std::uint32_t v : whole_.cage.quads[f]) chosen.add(v);
    }
    // Vertices without quads belong to the first tile.
    for (std::uint32_t v = 0; own_.begin == 0 && v < whole_.cage.vertex_count(); ++v) {
        if (whole_.cage.fan(v).empty()) chosen.add(v);
    }
    return ChosenNumbers(std::move(chosen));
}

ChosenNumbers QuadTile::edges_of_faces() const {
    NumberSet chosen(whole_.cage.edge_count());
    for (const std::uint32_t f : faces_) {
        for (const std::uint32_t side : whole_.cage.side.subspan(4 * f, 4)) chosen.add(side >> 1);
    }
    return ChosenNumbers(std::move(chosen));
}

void QuadTile::take_faces() {
    const auto vertex = [&](std::uint32_t v) { return vertices_.place(v); };
    const auto side = [&](std::uint32_t s) { return 2 * edges_.place(s >> 1) + (s & 1); };
    for (const std::uint32_t f : faces_) {
        const Quad& q = whole_.cage.quads[f];
        arrays_.quads.push_back({vertex(q[0]), vertex(q[1]), vertex(q[2]), vertex(q[3])});
        for (const std::uint32_t s : whole_.cage.side.subspan(4 * f, 4)) arrays_.side.push_back(side(s));
        arrays_.region.push_back(whole_.region[f]);
        arrays_.part.push_back(owns(4 * f) ? 0 : 1);
    }
}

std::uint32_t QuadTile::local_half(std::uint32_t half) const {
    return half == kNoIndex || !faces_.has(half >> 2) ? kNoIndex : 4 * faces_.place(half >> 2) + (half & 3);
}

void QuadTile::take_vertices() {
    for (const std::uint32_t v : vertices_) {
        arrays_.positions.push_back(whole_.positions[v]);
        arrays_.anchors.push_back(whole_.anchors[v]);
        arrays_.fan_first.push_back(static_cast<std::uint32_t>(arrays_.fan_half.size()));
        for (const std::uint32_t half : whole_.cage.fan(v)) {
            if (const std::uint32_t here = local_half(half); here != kNoIndex)
                arrays_.fan_half.push_back(here);
        }
    }
    arrays_.fan_first.push_back(static_cast<std::uint32_t>(arrays_.fan_half.size()));
}

// Edges with a missing quad are on the boundary.
void QuadTile::take_edges() {
    arrays_.on_boundary.resize(vertices_.size(), 0);
    for (const std::uint32_t e : edges_) {
        const std::uint32_t forward = local_half(whole_.cage.edge_half[e][0]);
        const std::uint32_t backward = local_half(whole_.cage.edge_half[e][1]);
        arrays_.edge_half.push_back({forward, backward});
        if (forward != kNoIndex && backward != kNoIndex) continue;
        const std::uint32_t half = forward != kNoIndex ? forward : backward;
        const Quad& quad = arrays_.quads[half >> 2];
        arrays_.on_boundary[quad[half & 3]] = arrays_.on_boundary[quad[(half + 1) & 3]] = 1;
    }
}

void QuadTile::put(std::span<const Vec3> of_tile, std::span<Vec3> of_whole) const {
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
        const auto fan = whole_.cage.fan(vertices_[v]);
        if (fan.empty() || owns(fan[0])) of_whole[vertices_[v]] = of_tile[v];
    }
    const std::size_t inside = (std::size_t{1} << whole_.levels) - 1;
    of_tile = of_tile.subspan(vertices_.size());
    of_whole = of_whole.subspan(whole_.cage.vertex_count());
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const auto [forward, backward] = whole_.cage.edge_half[edges_[e]];
        if (!owns(std::min(forward, backward))) continue;
        put_row(of_tile.subspan(inside * e, inside), of_whole.subspan(inside * edges_[e]));
    }
    of_tile = of_tile.subspan(inside * edges_.size());
    of_whole = of_whole.subspan(inside * whole_.cage.edge_count());
    const std::size_t of_quad = inside * inside;
    const std::size_t first = faces_.place(static_cast<std::uint32_t>(own_.begin));
    put_row(of_tile.subspan(of_quad * first, of_quad * own_.size()), of_whole.subspan(of_quad * own_.begin));
}

std::size_t QuadTile::cut(std::span<const ClipPlane> clips, IndexRange quads, std::size_t wanted) {
    wanted = std::clamp(wanted, quads.begin + 1, quads.end);
    for (const ClipPlane& clip : clips) {
        const std::size_t first = clip.first_quad, last = first + clip.quad_count;
        if (wanted <= first || wanted >= last) continue;
        return std::min(first > quads.begin ? first : last, quads.end);
    }
    return wanted;
}

}  // namespace coppice::cuda
