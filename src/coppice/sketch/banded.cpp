#include "coppice/sketch/banded_internal.h"

namespace coppice::sketch_internal {

// Blocks are eliminated from the first on: A = L L^T, where L has the bands of A.
std::vector<Eigen::Vector3d> BandedSystem::solve(double damping) const {
    const std::size_t n = size();
    std::vector<Eigen::LLT<Eigen::Matrix3d>> l(n);
    std::vector<Eigen::Matrix3d> below(n), second(n);  // rows i + 1 and i + 2 of column i of L
    std::vector<Eigen::Vector3d> x = right_;
    for (std::size_t i = 0; i < n; ++i) {
        Eigen::Matrix3d d = diagonal_[i];
        d.diagonal().array() += damping * d.trace();
        if (i >= 1) d -= below[i - 1] * below[i - 1].transpose();
        if (i >= 2) d -= second[i - 2] * second[i - 2].transpose();
        l[i].compute(d);
        Eigen::Matrix3d b = next_[i];
        if (i >= 1) b -= second[i - 1] * below[i - 1].transpose();
        below[i] = l[i].matrixL().solve(b.transpose()).transpose();
        second[i] = l[i].matrixL().solve(after_next_[i].transpose()).transpose();
        if (i >= 1) x[i] -= below[i - 1] * x[i - 1];
        if (i >= 2) x[i] -= second[i - 2] * x[i - 2];
        x[i] = l[i].matrixL().solve(x[i]);
    }
    for (std::size_t i = n; i-- > 0;) {
        if (i + 1 < n) x[i] -= below[i].transpose() * x[i + 1];
        if (i + 2 < n) x[i] -= second[i].transpose() * x[i + 2];
        x[i] = l[i].matrixL().transpose().solve(x[i]);
    }
    return x;
}

}  // namespace coppice::sketch_internal
