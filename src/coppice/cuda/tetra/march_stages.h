#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/cuda/tetra/march_kernel.h"
#include "coppice/cuda/tetra/snapping_kernel.h"

// The stages of march() of coppice/tetra on an executor, for any field that kernels can sample.

namespace coppice::cuda {

/// Copies samples to an executor, but for the heights, which are there.
template <class Exec>
tetra_kernel::SamplesView upload_samples(Exec& exec, const tetra_kernel::SamplesView& s,
                                         std::span<const float> height) {
    return {height,
            {exec.upload(s.inside.words)},
            {exec.upload(s.on.words)},
            {exec.upload(s.held.words)},
            {exec.upload(s.moved.words)},
            {exec.upload(s.placed.words), exec.upload(s.placed.before)},
            exec.upload(s.place),
            exec.upload(s.way),
            exec.upload(s.weak)};
}

/// The stages of marching on an executor. What comes out has the same bits as from march() where the field
/// gives the same samples. Memory of the executor: 24 bytes per fine vertex, 4 per fine edge and fine
/// tetrahedron, 160 per coarse one; it is not reset.
template <class Exec, class Field>
class FieldStages : public MarchStages {
  public:
    /// The field is `level` on its surface; its arrays lie on the executor.
    FieldStages(Exec& exec, const Field& field, float level) : exec_(exec), field_(field), profile_(level) {}

    SampledVertices sample(const TetraRefinement& refinement, float snap,
                           tetra_kernel::BitsView held) override {
        refinement_ = upload_refinement(exec_, refinement);
        const std::uint32_t count = refinement_.ordered_count;
        height_ = exec_.template array<float>(refinement_.vertex_count);
        const auto above = clear_bits(refinement_.vertex_count);
        const auto target = exec_.template array<Vec3>(count);
        const auto first = exec_.template array<std::uint64_t>(count + std::size_t{1});
        exec_.each("field", count,
                   SampleFine<Field>{refinement_,
                                     field_,
                                     profile_,
                                     snap,
                                     {exec_.upload(held.words)},
                                     height_,
                                     above,
                                     target,
                                     first});
        const std::uint64_t found = place_counts(exec_, first);
        const auto near = exec_.template array<std::uint32_t>(static_cast<std::uint32_t>(found));
        const auto shallow = exec_.template array<ShallowVertex>(found >> 32);
        exec_.each("list near", count, ListFound{refinement_, first, height_, near, shallow});
        const std::span<const MovedVertex> moved = find_places(near, target, snap);
        SampledVertices out;
        out.above = downloaded(std::span<const std::uint64_t>(above));
        out.found.push_back({downloaded(moved), downloaded(std::span<const ShallowVertex>(shallow))});
        std::ranges::stable_sort(out.found.back().shallow, {}, &ShallowVertex::region);
        return out;
    }

    std::vector<std::uint32_t> find_folds(const tetra_kernel::SamplesView& samples) override {
        const auto marks = clear_bits(refinement_.vertex_count);
        samples_ = upload_samples(exec_, samples, height_);
        exec_.each("folds", refinement_.tetra_count, FindFold{refinement_, samples_, marks});
        const std::vector<std::uint64_t> words = downloaded(std::span<const std::uint64_t>(marks));
        std::vector<std::uint32_t> out;
        for (std::uint32_t w = 0; w < words.size(); ++w) {
            for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1)
                out.push_back(64 * w + static_cast<std::uint32_t>(std::countr_zero(rest)));
        }
        return out;
    }

    std::vector<tetra_kernel::Fan> find_fans(const tetra_kernel::SamplesView& samples) override {
        upload_signs(samples);
        const std::size_t count = samples.place.size();
        const auto size = exec_.template array<std::uint32_t>(count);
        const auto fans = exec_.template array<tetra_kernel::ListedFan>(count);
        const auto judged = exec_.template array<tetra_kernel::Fan>(count);
        exec_.clear(size);
        exec_.each("list fans", refinement_.tetra_count, ListFans{crossings(), size, fans});
        exec_.each("judge fans", count, JudgeFan{size, fans, judged});
        return downloaded(std::span<const tetra_kernel::Fan>(judged));
    }

    StagedSurface extract(const tetra_kernel::SamplesView& samples, std::span<const std::uint32_t> placed,
                          std::uint32_t placed_count, int refinements) override {
        upload_signs(samples);
        const auto number = exec_.template array<std::uint32_t>(refinement_.edge_count + std::size_t{1});
        exec_.each("mark cuts", refinement_.edge_count, MarkCuts{refinement_, samples_, number});
        const std::uint32_t cut_count = place_counts(exec_, number);
        const auto cuts = list_marked("list cuts", number, cut_count);
        const auto position = exec_.template array<Vec3>(placed_count + cut_count);
        const auto placed_number = exec_.upload(placed);
        exec_.each("place moved", placed.size(), PlaceMoved{placed_number, samples_.place, position});
        exec_.each("place cuts", cut_count,
                   PlaceCut<Field>{refinement_, field_, profile_, samples_, refinements, cuts,
                                   position.subspan(placed_count)});

        const auto marked = exec_.template array<std::uint32_t>(refinement_.tetra_count + std::size_t{1});
        exec_.each("mark crossed", refinement_.tetra_count, MarkCrossed{crossings(), marked});
        StagedSurface out;
        const std::uint32_t crossed_count = place_counts(exec_, marked);
        out.crossed = crossed_count;
        const auto crossed = list_marked("list crossed", marked, crossed_count);
        const auto first = exec_.template array<std::uint32_t>(crossed_count + std::size_t{1});
        exec_.each("count triangles", crossed_count, CountTriangles{crossings(), crossed, first});
        const std::uint32_t triangle_count = place_counts(exec_, first);
        const auto triangles = exec_.template array<Triangle>(triangle_count);
        exec_.each("triangles", crossed_count,
                   WriteTriangles{crossings(), crossed, first, number, placed_number, placed_count, position,
                                  triangles});
        out.mesh.positions.resize(position.size());
        exec_.download(std::span<const Vec3>(position), std::span(out.mesh.positions));
        out.mesh.triangles.resize(triangle_count);
        exec_.download(std::span<const Triangle>(triangles), std::span(out.mesh.triangles));
        return out;
    }

  private:
    std::span<std::uint64_t> clear_bits(std::size_t count) {
        const auto words = exec_.template array<std::uint64_t>(count / 64 + 1);
        exec_.clear(words);
        return words;
    }
    template <class T>
    std::vector<T> downloaded(std::span<const T> from) {
        std::vector<T> out(from.size());
        exec_.download(from, std::span(out));
        return out;
    }

    /// Vertices were put back since the samples came here.
    void upload_signs(const tetra_kernel::SamplesView& samples) {
        samples_.inside.words = exec_.upload(samples.inside.words);
        samples_.on.words = exec_.upload(samples.on.words);
        samples_.moved.words = exec_.upload(samples.moved.words);
    }
    FineCrossings crossings() {
        if (table_.empty()) table_ = exec_.upload(std::span<const tetra_kernel::Cut>(tetra_kernel::kCuts));
        return {refinement_, samples_, table_};
    }
    std::span<const std::uint32_t> list_marked(const char* name, std::span<const std::uint32_t> first,
                                               std::uint32_t count) {
        const auto list = exec_.template array<std::uint32_t>(count);
        exec_.each(name, first.size() - 1, ListMarked{first, list});
        return list;
    }

    std::span<const MovedVertex> find_places(std::span<const std::uint32_t> near,
                                             std::span<const Vec3> target, float snap) {
        const auto place = exec_.template array<MovedVertex>(near.size());
        const auto first = exec_.template array<std::uint32_t>(near.size() + 1);
        exec_.each("second step", near.size(),
                   FindPlace<Field>{refinement_, field_, profile_, snap, near, target, place, first});
        const std::uint32_t count = place_counts(exec_, first);
        const auto moved = exec_.template array<MovedVertex>(count);
        exec_.each("list moved", near.size(), ListMoved{first, place, moved});
        return moved;
    }

    Exec& exec_;
    Field field_;
    tetra_kernel::Profile profile_;
    DeviceRefinement refinement_;
    std::span<float> height_;
    tetra_kernel::SamplesView samples_;
    std::span<const tetra_kernel::Cut> table_;
};

}  // namespace coppice::cuda
