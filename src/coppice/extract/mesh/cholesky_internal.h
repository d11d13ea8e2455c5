#pragma once

#include <Eigen/SparseCore>

#include <vector>

#include "coppice/base/context.h"

namespace coppice::extract_internal {

/// Factors sparse symmetric positive definite matrices of one pattern, A = L L^T, so that a stop is heeded
/// between the rows of L: `Eigen::SimplicialLLT` looks at no token for as long as a factorisation takes.
class SparseCholesky {
  public:
    using Matrix = Eigen::SparseMatrix<double>;
    using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

    /// Orders the rows for little fill (approximate minimum degree) and finds the pattern of L.
    void analyze(const Matrix& a);
    /// Up-looking, row by row; `a` has the pattern that was analyzed, and both halves. False where it is not
    /// positive definite. Throws Cancelled.
    bool factorize(const Matrix& a, const Context& ctx);
    Columns solve(const Columns& right) const;

  private:
    using Index = Eigen::Index;
    Matrix permuted(const Matrix& a) const;

    Eigen::PermutationMatrix<Eigen::Dynamic> order_;  // row of `a` to row of L
    std::vector<Index> parent_;                       // elimination tree; -1 for a root
    std::vector<Index> first_;                        // of each column of L; its diagonal entry
    std::vector<int> row_;
    std::vector<double> value_;
};

}  // namespace coppice::extract_internal
