#include "coppice/sketch/banded_internal.h"

namespace coppice::sketch_internal {
namespace {

/// Returns m L^-T, computed by rows: Eigen unrolls this for vectors of a fixed size, but processes a matrix
/// in blocks.
Eigen::Matrix3d divided(const Eigen::Matrix3d& m, const Eigen::LLT<Eigen::Matrix3d>& l) {
    Eigen::Matrix3d out;
    for (int row = 0; row < 3; ++row) {
        const Eigen::Vector3d right = m.row(row).transpose();
        out.row(row) = l.matrixL().solve(right).transpose();
    }
    return out;
}

}  // namespace

// Forward elimination of blocks: A = L L^T, where L has the bandwidth of A. Inverses of the blocks would be
// as fast, but are inaccurate if short and long segments are adjacent.
void BandedSystem::solve(double damping, std::vector<Eigen::Vector3d>& x) {
    const std::size_t n = size();
    x = right_;
    for (std::size_t i = 0; i < n; ++i) {
        Eigen::Matrix3d d = diagonal_[i], b = next_[i];
        d.diagonal().array() += damping * d.trace();
        if (i >= 1) {
            const Column& one = columns_[i - 1];
            d.noalias() -= one.below * one.below.transpose();
            b.noalias() -= one.second * one.below.transpose();
            x[i].noalias() -= one.below * x[i - 1];
        }
        if (i >= 2) {
            const Column& two = columns_[i - 2];
            d.noalias() -= two.second * two.second.transpose();
            x[i].noalias() -= two.second * x[i - 2];
        }
        Column& here = columns_[i];
        here.l.compute(d);
        here.below = divided(b, here.l);
        here.second = divided(after_next_[i], here.l);
        here.l.matrixL().solveInPlace(x[i]);
    }
    for (std::size_t i = n; i-- > 0;) {
        const Column& here = columns_[i];
        if (i + 1 < n) x[i].noalias() -= here.below.transpose() * x[i + 1];
        if (i + 2 < n) x[i].noalias() -= here.second.transpose() * x[i + 2];
        here.l.matrixU().solveInPlace(x[i]);
    }
}

}  // namespace coppice::sketch_internal
