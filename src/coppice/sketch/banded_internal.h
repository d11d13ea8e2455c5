#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace coppice::sketch_internal {

/// A symmetric positive definite block system for a sequence of points, each coupled with the next two.
/// Factorization and solution are O(points).
class BandedSystem {
  public:
    /// Sets the system to zero for a number of points; keeps the allocated memory.
    void reset(std::size_t points) {
        diagonal_.assign(points, Eigen::Matrix3d::Zero());
        next_.assign(points, Eigen::Matrix3d::Zero());
        after_next_.assign(points, Eigen::Matrix3d::Zero());
        right_.assign(points, Eigen::Vector3d::Zero());
        columns_.resize(points);
    }

    std::size_t size() const { return diagonal_.size(); }
    Eigen::Matrix3d& diagonal(std::size_t i) { return diagonal_[i]; }      ///< block of point i
    Eigen::Matrix3d& next(std::size_t i) { return next_[i]; }              ///< block in row i + 1, column i
    Eigen::Matrix3d& after_next(std::size_t i) { return after_next_[i]; }  ///< block in row i + 2, column i
    Eigen::Vector3d& right(std::size_t i) { return right_[i]; }            ///< right-hand side

    /// Solves the system with `damping` times its trace added to the diagonal of every block. The system is
    /// unchanged.
    void solve(double damping, std::vector<Eigen::Vector3d>& x);

  private:
    /// Column i of L: the diagonal block, and rows i + 1 and i + 2.
    struct Column {
        Eigen::LLT<Eigen::Matrix3d> l;
        Eigen::Matrix3d below, second;
    };

    std::vector<Eigen::Matrix3d> diagonal_, next_, after_next_;
    std::vector<Eigen::Vector3d> right_;
    std::vector<Column> columns_;
};

}  // namespace coppice::sketch_internal
