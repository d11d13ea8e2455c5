#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/field/weights/nnls.h"

namespace coppice {

/// A matrix by columns, each of length 1 or 0; `length` is the original length.
struct ScaledColumns {
    std::size_t rows = 0;
    std::vector<std::uint64_t> first;
    Buffer<std::uint32_t> row;
    Buffer<double> value;
    std::vector<double> length;

    std::size_t columns() const { return length.size(); }
};

/// G z = h with G = A^T A and h = A^T b, for any subset of the unknowns.
class NormalEquations {
  public:
    virtual ~NormalEquations() = default;

    /// Solves for the passive unknowns while the others are 0; `gradient` = G z - h, 0 where passive. Returns
    /// false if rounding prevents it.
    virtual bool solve(std::span<const std::uint8_t> passive, std::span<double> z,
                       std::span<double> gradient) = 0;
};

/// Returns null if the factors would need too much memory or time. `rows` has the same entries as `columns`,
/// without scaling.
std::unique_ptr<NormalEquations> normal_equations(const SparseRows& rows, const ScaledColumns& columns,
                                                  std::span<const double> b, const Context& ctx);

}  // namespace coppice
