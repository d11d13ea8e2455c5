#include "coppice/extract/mesh/cholesky_internal.h"

#include <Eigen/OrderingMethods>

#include <cmath>

namespace coppice::extract_internal {

/// Returns the upper triangle of the reordered matrix.
SparseCholesky::Matrix SparseCholesky::permuted(const Matrix& a) const {
    Matrix out(a.rows(), a.cols());
    out.selfadjointView<Eigen::Upper>() = a.selfadjointView<Eigen::Lower>().twistedBy(order_);
    return out;
}

void SparseCholesky::analyze(const Matrix& a) {
    Eigen::PermutationMatrix<Eigen::Dynamic> inverse;
    Eigen::AMDOrdering<int>()(Matrix(a.selfadjointView<Eigen::Lower>()), inverse);
    order_ = inverse.inverse();
    const Matrix upper = permuted(a);
    const Index n = a.rows();
    parent_.assign(static_cast<std::size_t>(n), -1);
    std::vector<Index> mark(parent_.size(), -1);
    first_.assign(parent_.size() + 1, 0);
    for (Index k = 0; k < n; ++k) {
        mark[static_cast<std::size_t>(k)] = k;
        ++first_[static_cast<std::size_t>(k) + 1];
        for (Matrix::InnerIterator it(upper, k); it; ++it) {
            for (auto i = static_cast<std::size_t>(it.index()); mark[i] != k && it.index() < k;
                 i = static_cast<std::size_t>(parent_[i])) {
                if (parent_[i] == -1) parent_[i] = k;
                ++first_[i + 1];
                mark[i] = k;
            }
        }
    }
    for (std::size_t k = 0; k + 1 < first_.size(); ++k) first_[k + 1] += first_[k];
    row_.resize(static_cast<std::size_t>(first_.back()));
    value_.resize(row_.size());
}

bool SparseCholesky::factorize(const Matrix& a, const Context& ctx) {
    const Matrix upper = permuted(a);
    const std::size_t n = parent_.size();
    std::vector<double> y(n, 0);  // row k of L before the forward substitution
    std::vector<std::size_t> pattern(n),
        end(n);  // column indices of row k; end of the entries of each column so far
    std::vector<Index> mark(n, -1);
    for (std::size_t k = 0; k < n; ++k) {
        ctx.throw_if_cancelled();
        end[k] = static_cast<std::size_t>(first_[k]);
        std::size_t top = n;
        mark[k] = static_cast<Index>(k);
        for (Matrix::InnerIterator it(upper, static_cast<Index>(k)); it; ++it) {
            auto i = static_cast<std::size_t>(it.index());
            if (i > k) continue;
            y[i] += it.value();
            std::size_t count = 0;
            for (; mark[i] != static_cast<Index>(k); i = static_cast<std::size_t>(parent_[i])) {
                pattern[count++] = i;
                mark[i] = static_cast<Index>(k);
            }
            while (count > 0) pattern[--top] = pattern[--count];
        }
        double diagonal = y[k];
        y[k] = 0;
        for (; top < n; ++top) {
            const std::size_t i = pattern[top];
            const auto start = static_cast<std::size_t>(first_[i]);
            const double x = y[i] / value_[start];
            y[i] = 0;
            for (std::size_t p = start + 1; p < end[i]; ++p)
                y[static_cast<std::size_t>(row_[p])] -= value_[p] * x;
            diagonal -= x * x;
            row_[end[i]] = static_cast<int>(k);
            value_[end[i]++] = x;
        }
        if (!(diagonal > 0)) return false;
        row_[end[k]] = static_cast<int>(k);
        value_[end[k]++] = std::sqrt(diagonal);
    }
    return true;
}

SparseCholesky::Columns SparseCholesky::solve(const Columns& right) const {
    Columns x = order_ * right;
    const std::size_t n = parent_.size();
    for (Index column = 0; column < x.cols(); ++column) {
        double* const y = x.col(column).data();
        for (std::size_t k = 0; k < n; ++k) {
            y[k] /= value_[static_cast<std::size_t>(first_[k])];
            for (Index p = first_[k] + 1; p < first_[k + 1]; ++p)
                y[row_[static_cast<std::size_t>(p)]] -= value_[static_cast<std::size_t>(p)] * y[k];
        }
        for (std::size_t k = n; k-- > 0;) {
            for (Index p = first_[k] + 1; p < first_[k + 1]; ++p)
                y[k] -= value_[static_cast<std::size_t>(p)] * y[row_[static_cast<std::size_t>(p)]];
            y[k] /= value_[static_cast<std::size_t>(first_[k])];
        }
    }
    return order_.inverse() * x;
}

}  // namespace coppice::extract_internal
