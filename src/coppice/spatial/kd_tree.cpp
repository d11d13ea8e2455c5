#include "coppice/spatial/kd_tree.h"

#include <nanoflann.hpp>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr std::size_t kLeaf = 16;       // maximum number of points of a leaf
constexpr std::size_t kLook = 1 << 16;  // number of queries between two checks for cancellation

/// Interface of the index to the points. The index does not check for cancellation itself; during its
/// construction a query may throw.
struct Points {
    std::span<const Vec3> points;
    const Context* ctx;  ///< null after the construction: threads then query concurrently
    mutable std::size_t query_count = 0;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const {
        if (ctx != nullptr && ++query_count % kLook == 0) ctx->throw_if_cancelled();
        return points[i][static_cast<int>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3>;

}  // namespace

struct KdTree::Tree {
    Tree(std::span<const Vec3> all, const Context& ctx) : points{all, &ctx}, index(3, points, {kLeaf}) {
        points.ctx = nullptr;
    }
    Points points;
    Index index;
};

KdTree::KdTree(std::span<const Vec3> points, const Context& ctx) {
    COPPICE_ASSERT(!points.empty());
    tree_ = std::make_unique<Tree>(points, ctx);
}
KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;

KdTree::Nearest KdTree::nearest(Vec3 p) const {
    Nearest found;
    nearest(p, {&found.index, 1}, {&found.squared, 1});
    return found;
}

void KdTree::nearest(Vec3 p, std::span<std::uint32_t> index, std::span<double> squared) const {
    COPPICE_ASSERT(index.size() == squared.size() && index.size() <= tree_->points.points.size());
    const Vec3d query(p);
    tree_->index.knnSearch(&query.x, index.size(), index.data(), squared.data());
}

}  // namespace coppice
