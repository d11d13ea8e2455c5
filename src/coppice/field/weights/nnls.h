#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"

namespace coppice {

/// A matrix by rows: row j has the entries [first[j], first[j + 1]) of `column` and `value`, none of a row in
/// the same column. A dense matrix is one with all its entries.
struct SparseRows {
    std::uint32_t columns = 0;            ///< unknowns
    std::vector<std::uint64_t> first{0};  ///< one more than there are rows
    Buffer<std::uint32_t> column;         ///< < columns
    Buffer<double> value;                 ///< finite

    std::size_t rows() const { return first.size() - 1; }  ///< equations
    std::size_t entries() const { return value.size(); }   ///< numbers stored
};

/// A x, row by row. O(entries).
std::vector<double> product(const SparseRows& a, std::span<const double> x, const Context& ctx = {});

/// When to stop.
struct NnlsOptions {
    int most_pivots = 200;  ///< exchanges of sets before descent takes over; 0: descent alone
    int most_sweeps = 500;  ///< of the descent
};

template <class Self, class Visitor>
requires SameOptions<Self, NnlsOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"most_pivots", "exchanges of sets before descent takes over", Unit::none, 0, 1e6},
          o.most_pivots);
    visit(Field{"most_sweeps", "of the descent", Unit::none, 0, 1e6}, o.most_sweeps);
}

/// A solution, and how good it is.
struct NnlsResult {
    std::vector<double> x;   ///< >= 0, whether converged or not
    int pivots = 0;          ///< systems solved
    int sweeps = 0;          ///< of the descent; 0 where pivoting settled
    bool converged = false;  ///< violation <= 1e-8
    /// How far x is from optimal: the greatest, over columns a, of |cos| of the angle between a and the
    /// residual A x - b where x > 0, or of -cos where x = 0, times |A x - b| / |b|. 0 at the optimum.
    double violation = 0;
};

/// Least squares |A x - b| with x >= 0 [Lawson1974]: at the optimum the gradient A^T (A x - b) is 0 where
/// x > 0, and >= 0 where x = 0.
///
/// Block principal pivoting on the normal equations [Portugal1994] [Kim2011]: all unknowns that break a
/// condition change sides at once, and only one when that does not help for a while. A dense Cholesky
/// factorization where most pairs of columns share a row, else a sparse one in minimum-degree order. Columns
/// that depend on each other to about 1e-5 share what is theirs: of all solutions nearly the shortest in
/// units of the columns' lengths. A zero column gets 0. Where pivoting has not settled, and where the
/// factors would be too large (more than 2^26 numbers or 2^32 products), coordinate descent takes over, which
/// needs no memory to speak of but may stop before the optimum: see `converged`. It always ends.
///
/// 300 unknowns and 1,548 dense rows take 20 ms of one core; 30,000 unknowns of a tree a few tenths of a
/// second. The same bits for any number of threads. Throws InvalidInput when b has not one number per row, or
/// anything is not finite.
NnlsResult nnls(const SparseRows& a, std::span<const double> b, const NnlsOptions& options = {},
                const Context& ctx = {});

}  // namespace coppice
