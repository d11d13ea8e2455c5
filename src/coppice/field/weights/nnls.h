#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"

namespace coppice {

/// A matrix by rows: row j has the entries [first[j], first[j + 1]) of `column` and `value`, each in a
/// different column. A dense matrix stores all its entries.
struct SparseRows {
    std::uint32_t columns = 0;            ///< number of unknowns
    std::vector<std::uint64_t> first{0};  ///< number of rows + 1 offsets
    Buffer<std::uint32_t> column;         ///< < columns
    Buffer<double> value;                 ///< finite

    std::size_t rows() const { return first.size() - 1; }  ///< number of equations
    std::size_t entries() const { return value.size(); }   ///< number of stored values
};

/// Returns A x. O(entries).
std::vector<double> product(const SparseRows& a, std::span<const double> x, const Context& ctx = {});

/// Termination criteria of nnls().
struct NnlsOptions {
    int max_pivots = 200;  ///< maximum number of exchanges before coordinate descent; 0: descent only
    int max_sweeps = 500;  ///< maximum number of sweeps of coordinate descent
};

/// Lists the members for front ends.
void list_fields(NnlsOptions& o, FieldList& list);

/// A solution and its quality.
struct NnlsResult {
    std::vector<double> x;   ///< >= 0, converged or not
    int pivots = 0;          ///< number of solved systems
    int sweeps = 0;          ///< number of sweeps of the descent; 0 if pivoting converged
    bool converged = false;  ///< violation <= 1e-8
    /// Distance of x from the optimum: the maximum, over columns a, of |cos| of the angle between a and the
    /// residual A x - b where x > 0, or of -cos where x = 0, times |A x - b| / |b|. 0 at the optimum.
    double violation = 0;
};

/// Minimizes |A x - b| subject to x >= 0 [Lawson1974]: at the optimum the gradient A^T (A x - b) is 0 if
/// x > 0, and >= 0 if x = 0.
///
/// Block principal pivoting on the normal equations [Portugal1994] [Kim2011]: all unknowns that violate a
/// condition change sets at once, and only one of them if that does not help for several steps. Uses a dense
/// Cholesky factorization if most pairs of columns share a row, otherwise a sparse one in minimum-degree
/// order. Columns that are linearly dependent to about 1e-5 share their contribution: of all solutions nearly
/// the shortest in units of the columns' lengths is returned. A zero column gets 0. If pivoting does not
/// converge, or the factors would be too large (more than 2^26 numbers or 2^32 products), coordinate descent
/// is used, which needs little memory but may stop before the optimum: see `converged`. It always terminates.
///
/// 300 unknowns and 1,548 dense rows take 20 ms of one core; 30,000 unknowns of a tree a few tenths of a
/// second. The result does not depend on the number of threads (bit-identical). Throws InvalidInput if b does
/// not have one number per row, or a number is not finite.
NnlsResult nnls(const SparseRows& a, std::span<const double> b, const NnlsOptions& options = {},
                const Context& ctx = {});

}  // namespace coppice
