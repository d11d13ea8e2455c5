// The second set of bark coordinates of tubes.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "coppice/pipeline/texture/tube_texture_internal.h"

namespace coppice::pipeline_internal {
namespace {

// Continues a curve by a straight line.
void add_line(std::vector<TexturePoint>& curve, TexturePoint end, std::uint32_t steps) {
    const TexturePoint begin = curve.back();
    for (std::uint32_t i = 1; i <= steps; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(steps);
        curve.push_back({std::lerp(begin.u, end.u, t), std::lerp(begin.v, end.v, t)});
    }
}

}  // namespace

TextureBlend TubeTexture::blend(std::uint32_t zone, TexturePoint first) const {
    return zone == kNoIndex ? TextureBlend{first, 0} : zones_[zone].at(first);
}

// Begins a zone at the beginning of a tube, which the next tubes of the branch continue.
void TubeTexture::begin_zone(NodeId tube, std::uint32_t wraps_before) {
    if (!options_.blend) return;
    Tube& own = at(tube);
    if (own.zone != kNoIndex) zones_[own.zone].end_at(own.begin);
    own.zone = static_cast<std::uint32_t>(zones_.size());
    zones_.emplace_back(own.begin, static_cast<float>(own.wraps), static_cast<float>(wraps_before));
}

// Continues the coordinates of the stem at a node into a lateral that begins there.
void TubeTexture::set_rim(NodeId node, NodeId lateral, std::span<const Collar> collars) {
    const Tube& own = at(lateral);
    if (own.zone == kNoIndex || own.axis == at(node).axis) return;
    std::vector<TexturePoint> rim = find_rim(node, lateral, collars);
    if (rim.empty()) return;
    zones_[own.zone].set_rim(patch_[find_base(lateral, 0, collars)].v[0], std::move(rim));
}

// Returns the coordinates of the stem around the rim of a lateral, from column 0 to itself. Sides at which it
// meets other laterals are straight lines between the others. Empty if no side is on a quad of the stem, or
// if the rim runs around the stem.
std::vector<TexturePoint> TubeTexture::find_rim(NodeId node, NodeId lateral,
                                                std::span<const Collar> collars) const {
    if (build_.tubes.is_root(node) || !build_.tubes.leader(node)) return {};
    const std::uint32_t count = faces_[lateral.index()].side.count;
    std::vector<std::optional<Side>> sides(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        const Quad& q = cage_.quads[find_base(lateral, k, collars)];
        sides[(at(lateral).column + k) % count] = find_side_of_stem(node, q[1], q[0]);
    }
    std::uint32_t first = 0;
    while (first < count && !sides[first]) ++first;
    if (first == count) return {};
    std::vector<TexturePoint> out{point_on_side(*sides[first], size_)};
    std::uint32_t gap = 0;  // number of steps without coordinates
    for (std::uint32_t k = 0; k <= count; ++k) {
        const std::optional<Side>& side = sides[(first + k) % count];
        if (!side) {
            gap += size_;
            continue;
        }
        const TexturePoint begin = point_on_side(*side, size_);
        const float whole = std::round(begin.u - out.back().u);
        add_line(out, {begin.u - whole, begin.v}, std::exchange(gap, 0));
        for (std::uint32_t i = 1; i <= size_ && k < count; ++i) {
            const TexturePoint p = point_on_side(*side, size_ - i);
            out.push_back({p.u - whole, p.v});
        }
    }
    if (std::abs(out.back().u - out.front().u) > 0.5f) return {};
    out.pop_back();
    std::rotate(out.begin(), out.end() - std::ptrdiff_t{first} * size_, out.end());
    out.push_back(out.front());
    for (TexturePoint& p : out) p.u *= static_cast<float>(at(node).wraps);
    return out;
}

// Returns the first cage quad of a lateral along one of its sides: of its collar, or without one of its tube.
std::uint32_t TubeTexture::find_base(NodeId lateral, std::uint32_t side,
                                     std::span<const Collar> collars) const {
    for (const Collar& c : collars) {
        if (c.lateral == lateral && c.edge == side) return c.cage_quad;
    }
    return faces_[lateral.index()].side.first + side;
}

// Returns the side between two cage vertices of a quad of the stem around a node.
std::optional<TubeTexture::Side> TubeTexture::find_side_of_stem(NodeId node, std::uint32_t from,
                                                                std::uint32_t to) const {
    const NodeId owner = tube_rows_.fork_tube(node);
    const CageRun fork = faces_[owner.index()].fork[owner == node ? 1 : 0];
    for (const CageRun& run :
         {fork, faces_[node.index()].side, faces_[build_.tubes.leader(node).index()].side}) {
        for (std::uint32_t f = run.first; f < run.first + run.count; ++f) {
            if (patch_[f].axis != at(node).axis) continue;
            const std::uint32_t k = find_edge(cage_.quads[f], from, to);
            if (k != kNoIndex) return Side{f, k};
        }
    }
    return std::nullopt;
}

// Returns the turns and v at a step along a side, from 0 to size().
TexturePoint TubeTexture::point_on_side(const Side& side, std::uint32_t step) const {
    const TexturePatch& p = patch_[side.cage_quad];
    const std::uint32_t back = size_ - step;
    const std::array<std::uint32_t, 4> column{step, size_, back, 0}, row{0, step, size_, back};
    return {turns(p, column[side.k]), v(p, column[side.k], row[side.k])};
}

}  // namespace coppice::pipeline_internal
