#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/extract/cloud/neighbours_internal.h"
#include "coppice/extract/stage_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kGrain = 4096;

/// What the index asks for points. It looks nowhere at a stop token, so while it is built a question may
/// throw.
struct Cloud {
    std::span<const Vec3> points;
    const Context* ctx;  ///< null once the index is built: threads ask then
    mutable std::size_t asked = 0;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const {
        if (ctx != nullptr) poll_stop(*ctx, ++asked);
        return points[i][static_cast<int>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

/// Writes the row of point i without the point itself.
void find_row(const Index& tree, const Cloud& cloud, std::size_t i, std::vector<std::uint32_t>& index,
              std::vector<double>& squared, Neighbours& out) {
    const Vec3d query(cloud.points[i]);
    tree.knnSearch(&query.x, out.count + 1, index.data(), squared.data());
    std::size_t to = i * out.count;
    const std::size_t end = to + out.count;
    for (std::size_t k = 0; k <= out.count && to < end; ++k) {
        if (index[k] == i) continue;
        out.index[to] = index[k];
        out.distance[to++] = static_cast<float>(std::sqrt(squared[k]));
    }
}

}  // namespace

Neighbours nearest_neighbours(std::span<const Vec3> points, std::uint32_t count, const Context& ctx) {
    Neighbours out;
    out.count = static_cast<std::uint32_t>(std::min<std::size_t>(count, points.size() - 1));
    out.index.resize(points.size() * out.count);
    out.distance.resize(points.size() * out.count);
    Cloud cloud{points, &ctx};
    const Index tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    cloud.ctx = nullptr;
    stoppable_for_ranges(ctx, points.size(), kGrain, [&](IndexRange range) {
        std::vector<std::uint32_t> index(out.count + 1);
        std::vector<double> squared(out.count + 1);
        for (std::size_t i = range.begin; i < range.end; ++i) {
            find_row(tree, cloud, i, index, squared, out);
        }
    });
    return out;
}

}  // namespace coppice::extract_internal
