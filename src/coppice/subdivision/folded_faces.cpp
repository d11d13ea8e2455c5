#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <memory>

#include "coppice/base/parallel.h"
#include "coppice/subdivision/folded_faces_internal.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice {
namespace {

constexpr std::size_t kPointsPerBlock = 512;  // small enough for the first-level cache
constexpr std::size_t kFacesPerRange = 1 << 15;

// Points of some cage quads, one array per coordinate: quad (i, j) of a patch has the corners k, k + 1, k + N
// + 2, k + N + 1 with k = j (N + 1) + i. No quad begins in the last row or column.
template <int N>
class Block {
  public:
    static constexpr std::size_t kRow = N + 1;
    static constexpr std::size_t kPatch = kRow * kRow;
    static constexpr std::size_t kPatches = std::max<std::size_t>(1, kPointsPerBlock / kPatch);

    explicit Block(FaceLimits limits) : limits_(limits) {}

    void add(const FoldedFaces& mesh, const typename PatchIndex<N>::Grid& grid) {
        const std::size_t begin = patches_++ * kPatch;
        const Vec3 origin = mesh.positions[grid[0][0]];
        const float reach = std::max({extent(mesh.positions[grid[0][N]] - origin),
                                      extent(mesh.positions[grid[N][N]] - origin),
                                      extent(mesh.positions[grid[N][0]] - origin)});
        const float scale = compute_scale(reach);
        std::size_t k = begin;
        for (const auto& row : grid) {
            for (const std::uint32_t v : row) {
                const Vec3 p = mesh.positions[v];
                const Vec3 a = mesh.anchors[v];
                x_[k] = p.x;
                y_[k] = p.y;
                z_[k] = p.z;
                u_[k] = p.x - a.x;
                v_[k] = p.y - a.y;
                w_[k] = p.z - a.z;
                ++k;
            }
        }
        for (float* column : {x_.data(), y_.data(), z_.data(), u_.data(), v_.data(), w_.data()}) {
            for (std::size_t i = begin; i < begin + kPatch; ++i) column[i] *= scale;
        }
    }
    bool full() const { return patches_ == kPatches; }

    // Appends the bad faces; the first patch is that of cage quad `first`.
    void test(std::uint32_t first, std::vector<std::uint32_t>& bad) {
        const std::size_t count = patches_ * kPatch - (patches_ > 0 ? kRow + 1 : 0);
        patches_ = 0;
        const FaceColumns columns{x_.data(), y_.data(), z_.data(), u_.data(), v_.data(), w_.data(), kRow};
        if (!mark_bad_faces(columns, count, limits_, kStartsQuad.data(), bad_.data())) return;
        for (std::size_t k = 0; k < count; ++k) {
            if (bad_[k] == 0) continue;
            const std::size_t inside = k % kPatch;
            const std::size_t face = (first + k / kPatch) * N * N + inside / kRow * N + inside % kRow;
            bad.push_back(static_cast<std::uint32_t>(face));
        }
    }

  private:
    using Numbers = std::array<float, kPatches * kPatch>;
    using Marks = std::array<std::int32_t, kPatches * kPatch>;

    static constexpr Marks kStartsQuad = [] {
        Marks marks{};
        for (std::size_t k = 0; k < marks.size(); ++k) {
            marks[k] = k % kRow < N && k % kPatch / kRow < N ? 1 : 0;
        }
        return marks;
    }();

    FaceLimits limits_;
    std::size_t patches_ = 0;
    Numbers x_, y_, z_, u_, v_, w_;
    Marks bad_;
};

template <int N>
void test_patches(const FoldedFaces& mesh, const PatchIndex<N>& index, IndexRange patches, FaceLimits limits,
                  std::vector<std::uint32_t>& bad) {
    const auto block = std::make_unique<Block<N>>(limits);
    typename PatchIndex<N>::Grid grid;
    auto first = static_cast<std::uint32_t>(patches.begin);
    for (auto f = first; f < patches.end; ++f) {
        index.grid(f, grid);
        block->add(mesh, grid);
        if (!block->full()) continue;
        block->test(first, bad);
        first = f + 1;
    }
    block->test(first, bad);
}

}  // namespace

std::vector<std::uint32_t> FoldedFaces::all(const PatchRefinement& patches, const Context& ctx) const {
    const std::size_t count = patches.cage().face_count();
    const std::size_t grain = std::max<std::size_t>(1, kFacesPerRange >> (2 * patches.levels()));
    std::vector<std::vector<std::uint32_t>> parts((count + grain - 1) / grain);
    with_grid_size(patches.levels(), [&]<int N>() {
        const PatchIndex<N> index(patches.cage());
        parallel_for_ranges(ctx, count, grain, [&](IndexRange range) {
            test_patches<N>(*this, index, range, FaceLimits(quality), parts[range.begin / grain]);
        });
    });
    std::vector<std::uint32_t> bad;
    for (const auto& part : parts) bad.insert(bad.end(), part.begin(), part.end());
    return bad;
}

bool FoldedFaces::is_bad(const Quad& face) const {
    return is_bad_face(face, positions, anchors, FaceLimits(quality));
}

}  // namespace coppice
