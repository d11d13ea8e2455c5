#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/cuda/quads/fold_kernels_internal.h"

namespace coppice::cuda {

/// Clusters of bad quads: see FoldClusters. Vertices and faces are sorted by cluster, and ascending within
/// each.
struct DeviceClusters {
    std::span<const std::uint32_t> count;                     ///< one number: number of clusters
    std::span<const std::uint32_t> first_vertex, first_face;  ///< per cluster, plus the end
    std::span<const std::uint32_t> vertices, faces;           ///< kNoIndex after the last cluster
    std::span<const Quad>
        corners;  ///< by face: indices of its vertices, kNoIndex for those that may not move
};

/// Collects `bad` quads, rings of faces around them, and all faces that touch these. Waits.
template <class Exec>
Surroundings compute_surroundings(Exec& exec, const PatchStars& stars, std::span<const std::uint32_t> bad) {
    constexpr std::uint32_t kRings = 4;  // see FoldClusters
    constexpr std::size_t kUsual = 64, kThreads = std::size_t{1} << 16;
    const auto numbers = [&](std::size_t count) { return exec.template array<std::uint32_t>(count); };
    const std::size_t vertices = stars.vertex_count(), faces = stars.quad_count();
    for (std::size_t room = kUsual * bad.size();; room *= 2) {
        const auto before = exec.mark();
        const auto marks = numbers(vertices / 32 + faces / 32 + 2 + 2 + kRings + 2);
        exec.clear(marks);
        const auto counts = marks.last(kRings + 4), ends = counts.subspan(2);
        const Surroundings around{stars,
                                  marks.first(vertices / 32 + 1),
                                  marks.subspan(vertices / 32 + 1, faces / 32 + 1),
                                  numbers(std::min(vertices, room)),
                                  numbers(std::min(faces, room)),
                                  counts.first(1),
                                  counts.subspan(1, 1)};
        exec.each("collect folds", bad.size(), CollectFaces{around, bad});
        const auto threads = static_cast<std::uint32_t>(std::min(kThreads, around.vertices.size()));
        for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
            exec.each("note ring", 1, NoteRing{around, ends.subspan(ring + 1, 1)});
            exec.each(
                "add ring", threads,
                AddRing{around, ends.subspan(ring, 1), ends.subspan(ring + 1, 1), threads, ring < kRings});
        }
        std::array<std::uint32_t, 2> found{};
        exec.download(std::span<const std::uint32_t>(counts.first(2)), std::span<std::uint32_t>(found));
        if (found[0] <= around.vertices.size() && found[1] <= around.faces.size()) {
            Surroundings all = around;
            all.vertices = around.vertices.first(found[0]);
            all.faces = around.faces.first(found[1]);
            return all;
        }
        exec.rewind(before);
    }
}

/// Sorts numbers below `end`, or kNoIndex, which comes last.
template <class Exec>
void sort_numbers(Exec& exec, std::span<std::uint32_t> numbers, std::uint32_t end) {
    const auto before = exec.mark();
    const auto unused = exec.template array<std::uint32_t>(numbers.size());
    exec.clear(unused);
    exec.sort_pairs(numbers, unused, std::bit_width(end));
    exec.rewind(before);
}

/// Finds the clusters of bad quads, which must be ascending. Waits once. O(n log n) in the number of elements
/// around them, and one bit for each vertex and face.
template <class Exec>
DeviceClusters fold_clusters(Exec& exec, const PatchStars& stars, std::span<const std::uint32_t> bad) {
    const Surroundings around = compute_surroundings(exec, stars, bad);
    const std::span<std::uint32_t> vertices = around.vertices, faces = around.faces;
    const auto numbers = [&](std::size_t count) { return exec.template array<std::uint32_t>(count); };
    const auto most = static_cast<std::uint32_t>(bad.size());  // number of clusters
    const auto count = numbers(1), first_vertex = numbers(most + 1), first_face = numbers(most + 1);
    const auto vertices_out = numbers(vertices.size()), faces_out = numbers(faces.size());
    const auto corners_out = exec.template array<Quad>(faces.size());
    exec.clear(count);
    const auto before = exec.mark();
    exec.each("drop boundary", vertices.size(), DropBoundary{stars, vertices});
    sort_numbers(exec, vertices, stars.vertex_count());
    sort_numbers(exec, faces, stars.quad_count());
    const DeviceSets sets{numbers(vertices.size())};
    const auto corners = exec.template array<Quad>(faces.size());
    exec.each("begin sets", vertices.size(), BeginSets{sets});
    exec.each("join corners", faces.size(), JoinCorners{stars, vertices, faces, corners, sets});
    exec.each("flatten sets", vertices.size(), FlattenSets{sets});
    const auto number = numbers(vertices.size());
    exec.each("mark clusters", vertices.size(), MarkClusters{vertices, sets, number});
    exec.exclusive_scan(std::span<const std::uint32_t>(number), number);
    const auto key = numbers(std::max(vertices.size(), faces.size()));
    const auto entry = numbers(key.size());
    const auto sort_by_cluster = [&](std::size_t size, std::span<std::uint32_t> first) {
        const auto of_sort = exec.mark();
        exec.sort_pairs(key.first(size), entry.first(size), std::bit_width(most));
        exec.rewind(of_sort);
        exec.each("bound rows", size, BoundRows{key.first(size), first, count});
    };
    exec.each("key vertices", vertices.size(), KeyVertices{vertices, sets, number, key, entry});
    sort_by_cluster(vertices.size(), first_vertex);
    const auto place = numbers(vertices.size());
    exec.each("take vertices", vertices.size(), TakeVertices{vertices, entry, vertices_out, place});
    exec.each("key faces", faces.size(), KeyFaces{corners, sets, number, key, entry});
    sort_by_cluster(faces.size(), first_face);
    exec.each("take faces", faces.size(), TakeFaces{faces, entry, corners, place, faces_out, corners_out});
    exec.rewind(before);
    return {count, first_vertex, first_face, vertices_out, faces_out, corners_out};
}

}  // namespace coppice::cuda
