#include <algorithm>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/subdivision/fold_clusters_internal.h"

namespace coppice {
namespace {

constexpr int kRings = 4;  // of faces around the bad ones: unfolding uses two and may spread by two

// The corners of the bad faces and of the rings around them, and all faces that have such a corner; both
// ascending.
struct Surroundings {
    std::vector<std::uint32_t> vertices, faces;

    Surroundings(std::span<const std::uint32_t> bad, std::size_t vertex_count, const PatchStars& stars) {
        NumberSet seen_vertices(vertex_count), seen_faces(stars.quad_count());
        const auto add_face = [&](std::uint32_t face) {
            const bool is_new = seen_faces.add(face);
            if (is_new) faces.push_back(face);
            return is_new;
        };
        const auto add_corners = [&](std::uint32_t face) {
            if (!add_face(face)) return;
            for (const std::uint32_t v : stars.quad(face)) {
                if (seen_vertices.add(v)) vertices.push_back(v);
            }
        };
        for (const std::uint32_t face : bad) add_corners(face);
        std::size_t begin = 0;
        for (int ring = 0; ring < kRings; ++ring) {
            for (const std::size_t end = vertices.size(); begin < end; ++begin)
                stars.for_each_corner(vertices[begin], [&](QuadCorner c) { add_corners(c.quad); });
        }
        for (; begin < vertices.size(); ++begin)
            stars.for_each_corner(vertices[begin], [&](QuadCorner c) { add_face(c.quad); });
        std::sort(vertices.begin(), vertices.end());
        std::sort(faces.begin(), faces.end());
    }
};

// Rows of values[i] by key, with the index in its row of each.
CompressedRows<std::uint32_t> group_rows(std::span<const std::uint32_t> values,
                                         std::span<const std::uint32_t> keys, std::size_t rows) {
    return compress_rows<std::uint32_t>(rows, [&](const auto& put) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (keys[i] != kNoIndex) put(keys[i], values[i]);
        }
    });
}

void set_places(const CompressedRows<std::uint32_t>& rows, Buffer<std::uint32_t>& place) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto row = rows[r];
        for (std::uint32_t i = 0; i < row.size(); ++i) place[row[i]] = i;
    }
}

}  // namespace

FoldClusters::FoldClusters(std::span<const std::uint32_t> all_bad, std::size_t vertex_count,
                           const PatchStars& stars)
    : movable_(vertex_count), vertex_place_(vertex_count), face_place_(stars.quad_count()) {
    Surroundings around(all_bad, vertex_count, stars);
    std::erase_if(around.vertices, [&](std::uint32_t v) { return stars.on_boundary(v); });
    for (std::uint32_t i = 0; i < around.vertices.size(); ++i) {
        movable_.add(around.vertices[i]);
        vertex_place_[around.vertices[i]] = i;
    }
    // Vertices with a common face belong to one cluster.
    DisjointSets sets(around.vertices.size());
    const auto first_movable = [&](std::uint32_t face) {
        std::uint32_t first = kNoIndex;
        for (const std::uint32_t v : stars.quad(face)) {
            if (!may_move(v)) continue;
            if (first == kNoIndex) first = vertex_place_[v];
            sets.join(first, vertex_place_[v]);
        }
        return first;
    };
    std::vector<std::uint32_t> key_of_face;
    for (const std::uint32_t face : around.faces) key_of_face.push_back(first_movable(face));
    std::vector<std::uint32_t> cluster(around.vertices.size());
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < cluster.size(); ++i)
        cluster[i] = sets.find(i) == i ? count++ : cluster[sets.find(i)];
    const auto to_cluster = [&](std::uint32_t& key) {
        if (key != kNoIndex) key = cluster[key];
    };
    std::ranges::for_each(key_of_face, to_cluster);
    std::vector<std::uint32_t> key_of_bad;
    for (const std::uint32_t face : all_bad) {
        key_of_bad.push_back(first_movable(face));
        to_cluster(key_of_bad.back());
        if (key_of_bad.back() == kNoIndex) fixed.push_back(face);
    }
    vertices = group_rows(around.vertices, cluster, count);
    faces = group_rows(around.faces, key_of_face, count);
    bad = group_rows(all_bad, key_of_bad, count);
    set_places(vertices, vertex_place_);
    set_places(faces, face_place_);
}

}  // namespace coppice
