#include <array>
#include <cstdint>
#include <nanoflann.hpp>

#include "coppice/base/error.h"
#include "coppice/points/nearest_internal.h"

namespace coppice::points_internal {
namespace {

struct Cloud {
    std::span<const Vec3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

template <std::size_t N>
struct Found {
    std::array<std::uint32_t, N> index{};
    std::array<double, N> squared{};
};

}  // namespace

struct NearestPoint::Tree {
    explicit Tree(std::span<const Vec3> points) : cloud{points}, index(3, cloud) {}
    template <std::size_t N>
    Found<N> find(Vec3 p) const {
        Found<N> found;
        const Vec3d q(p);
        index.knnSearch(&q.x, N, found.index.data(), found.squared.data());
        return found;
    }
    Cloud cloud;
    Index index;
};

NearestPoint::NearestPoint(std::span<const Vec3> points) {
    COPPICE_ASSERT(!points.empty());
    tree_ = std::make_unique<Tree>(points);
}
NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;

std::size_t NearestPoint::index(Vec3 p) const { return tree_->find<1>(p).index[0]; }

double NearestPoint::squared_distance(Vec3 p) const { return tree_->find<1>(p).squared[0]; }

double NearestPoint::squared_distance_to_other(std::size_t i) const {
    return tree_->find<2>(tree_->cloud.points[i]).squared[1];
}

}  // namespace coppice::points_internal
