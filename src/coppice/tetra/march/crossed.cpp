#include "coppice/tetra/march/crossed_internal.h"

#include <algorithm>
#include <utility>

namespace coppice::tetra_internal {
namespace {

constexpr std::size_t kRegions = 16;  // regions of one chunk

}  // namespace

CrossedTetra::CrossedTetra(const TetraRefinement& refinement, const Samples& samples, const Context& ctx)
    : refinement_(refinement), samples_(samples) {
    chunks_.resize((refinement.coarse().region_count() + kRegions - 1) / kRegions);
    parallel_for(ctx, chunks_.size(), 1, [&](std::size_t p) { list(p); });
}

IndexRange CrossedTetra::regions(std::size_t chunk) const {
    return {kRegions * chunk,
            std::min<std::size_t>(kRegions * chunk + kRegions, refinement_.coarse().region_count())};
}

std::uint64_t CrossedTetra::count() const {
    std::uint64_t sum = 0;
    for (const Chunk& chunk : chunks_) sum += chunk.crossings.size();
    return sum;
}

void CrossedTetra::update(std::span<const std::uint32_t> tetra, const Context& ctx) {
    std::vector<std::size_t> changed;
    const auto& first = refinement_.coarse().first;
    auto next = tetra.begin();
    for (std::size_t p = 0; p < chunks_.size() && next != tetra.end(); ++p) {
        const std::uint32_t end = first[regions(p).end];
        if (*next >= end) continue;
        changed.push_back(p);
        next = std::lower_bound(next, tetra.end(), end);
    }
    parallel_for(ctx, changed.size(), 1, [&](std::size_t i) { list(changed[i]); });
}

void CrossedTetra::list(std::size_t chunk) {
    Chunk& p = chunks_[chunk];
    p.active.clear();
    p.end.clear();
    p.crossings.clear();
    LocalSigns signs;
    const auto& first = refinement_.coarse().first;
    const IndexRange of_chunk = regions(chunk);
    for (std::uint32_t t = first[of_chunk.begin]; t < first[of_chunk.end]; ++t) {
        if (!signs.gather(refinement_, samples_, t)) continue;
        p.active.push_back(t);
        signs.for_each_cut(refinement_.pattern(t), [&](std::size_t fine, std::uint8_t code) {
            p.crossings.push_back({static_cast<std::uint16_t>(fine), code});
        });
        p.end.push_back(static_cast<std::uint32_t>(p.crossings.size()));
    }
}

CutNumbers::CutNumbers(const TetraRefinement& refinement, const CrossedTetra& crossed, const Context& ctx)
    : refinement_(refinement) {
    first_.assign(
        std::size_t{refinement.edge_count()} + refinement.face_count() + refinement.coarse().tetra.size(), 0);
    parallel_for(ctx, crossed.chunks().size(), 1, [&](std::size_t i) {
        const CrossedTetra::Chunk& chunk = crossed.chunks()[i];
        CutEdges edges;
        for (std::size_t a = 0; a < chunk.active.size(); ++a) {
            const std::uint32_t t = chunk.active[a];
            const TetraPattern& pattern = refinement_.pattern(t);
            edges.assign(pattern, chunk.of(a));
            for_each_holder(t, [&](std::uint32_t group, std::size_t holder) {
                if ((refinement_.owned(t) >> group & 1) == 0) return;
                std::uint32_t cuts = 0;
                edges.for_each(pattern, group, [&](std::uint32_t) { ++cuts; });
                first_[holder] = cuts;
            });
        }
    });
    for (std::uint32_t& first : first_) count_ += std::exchange(first, static_cast<std::uint32_t>(count_));
}

void CutNumbers::number_edges(std::uint32_t t, const CutEdges& edges, std::vector<std::uint32_t>& out) const {
    const TetraPattern& pattern = refinement_.pattern(t);
    out.resize(pattern.edges.size());
    for_each_holder(t, [&](std::uint32_t group, std::size_t holder) {
        std::uint32_t number = first_[holder];
        edges.for_each(pattern, group, [&](std::uint32_t e) { out[e] = number++; });
    });
}

}  // namespace coppice::tetra_internal
