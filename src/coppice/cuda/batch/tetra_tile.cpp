#include "coppice/cuda/batch/tetra_tile_internal.h"

#include <algorithm>
#include <utility>

namespace coppice::cuda {

int TetraTile::rings_for(int rounds, int levels) {
    const int edges_of_ring = std::max(1, (1 << levels) / 2);
    return 2 + (rounds + 1) / edges_of_ring;
}

TetraTile::TetraTile(const TetraRefinement& whole, IndexRange regions, int rings)
    : tetra_(tetra_around(whole, {whole.coarse().first[regions.begin], whole.coarse().first[regions.end]},
                          rings)) {
    const TetraMesh& mesh = whole.coarse();
    take_mesh(mesh);
    const std::uint32_t begin = tetra_.place(mesh.first[regions.begin]);
    own_ = {begin, begin + (mesh.first[regions.end] - mesh.first[regions.begin])};
}

ChosenNumbers TetraTile::tetra_around(const TetraRefinement& whole, IndexRange own, int rings) {
    const TetraMesh& mesh = whole.coarse();
    NumberSet chosen(mesh.tetra.size()), vertices(mesh.positions.size());
    std::vector<std::uint32_t> tetra;
    const auto add = [&](std::uint32_t t) {
        if (chosen.add(t)) tetra.push_back(t);
    };
    for (auto t = static_cast<std::uint32_t>(own.begin); t < own.end; ++t) add(t);
    std::size_t begin = 0;
    for (int ring = 0; ring < rings && begin < tetra.size(); ++ring) {
        for (const std::size_t end = tetra.size(); begin < end; ++begin) {
            const Tetra corners = mesh.tetra[tetra[begin]];
            for (const std::uint32_t v : corners) {
                if (vertices.add(v)) std::ranges::for_each(whole.around(TetraElementKind::vertex, v), add);
            }
        }
    }
    is_closed_ = begin == tetra.size();
    return ChosenNumbers(std::move(chosen));
}

void TetraTile::take_mesh(const TetraMesh& whole) {
    NumberSet chosen(whole.positions.size());
    for (const std::uint32_t t : tetra_) {
        for (const std::uint32_t v : whole.tetra[t]) chosen.add(v);
    }
    const ChosenNumbers vertices(std::move(chosen));
    mesh_.clearance = whole.clearance;
    mesh_.positions.reserve(vertices.size());
    for (const std::uint32_t v : vertices) mesh_.positions.push_back(whole.positions[v]);
    mesh_.tetra.reserve(tetra_.size());
    for (const std::uint32_t t : tetra_) {
        const auto region =
            static_cast<std::uint32_t>(std::ranges::upper_bound(whole.first, t) - whole.first.begin() - 1);
        if (regions_.empty() || regions_.back() != region) {
            regions_.push_back(region);
            mesh_.first.back() = static_cast<std::uint32_t>(mesh_.tetra.size());
            mesh_.first.push_back(0);
        }
        Tetra corners = whole.tetra[t];
        for (std::uint32_t& v : corners) v = vertices.place(v);
        mesh_.tetra.push_back(corners);
    }
    mesh_.first.back() = static_cast<std::uint32_t>(mesh_.tetra.size());
}

CompressedRows<std::uint32_t> TetraTile::rows(const CompressedRows<std::uint32_t>& of_whole) const {
    if (of_whole.size() == 0) return {};
    CompressedRows<std::uint32_t> out;
    for (const std::uint32_t r : regions_) {
        const auto row = of_whole[r];
        out.items.insert(out.items.end(), row.begin(), row.end());
        out.first.push_back(static_cast<std::uint32_t>(out.items.size()));
    }
    return out;
}

}  // namespace coppice::cuda
