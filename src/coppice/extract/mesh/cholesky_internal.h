#pragma once

#include <Eigen/SparseCore>

#include <vector>

#include "coppice/base/context.h"

namespace coppice::extract_internal {

/// Factorizes sparse symmetric positive definite matrices of one pattern, A = L L^T. Checks for cancellation
/// between the rows of L, which `Eigen::SimplicialLLT` does not do during a factorization.
class SparseCholesky {
  public:
    using Matrix = Eigen::SparseMatrix<double>;
    using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

    /// Orders the rows for low fill-in (approximate minimum degree) and computes the pattern of L.
    void analyze(const Matrix& a);
    /// Computes L by the up-looking algorithm, row by row. `a` has the pattern passed to `analyze` and
    /// contains both triangles. Returns false if it is not positive definite. Throws Cancelled.
    bool factorize(const Matrix& a, const Context& ctx);
    Columns solve(const Columns& right) const;

  private:
    using Index = Eigen::Index;
    Matrix permuted(const Matrix& a) const;

    Eigen::PermutationMatrix<Eigen::Dynamic> order_;  // maps rows of `a` to rows of L
    std::vector<Index> parent_;                       // elimination tree; -1 for a root
    std::vector<Index> first_;                        // index of the diagonal entry of each column of L
    std::vector<int> row_;
    std::vector<double> value_;
};

}  // namespace coppice::extract_internal
