#pragma once

#include <vector>

#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/cuda/quads/quad_stages_internal.h"
#include "coppice/field/kernel/kernel_constants.h"

namespace coppice::cuda {

/// The stages that sample a field, for any kernel: see QuadStages.
/// @{
template <class Exec>
void project(QuadStages<Exec>& stages, const KernelConstants& kernel, const FieldArrays& field) {
    with_formula(kernel, [&](const auto& formula) { stages.project(FieldView(formula, field)); });
}

template <class Exec>
std::vector<UntangleReport> unfold(QuadStages<Exec>& stages,
                                   const typename QuadStages<Exec>::FoldSearch& search,
                                   const KernelConstants& kernel, const FieldArrays& field) {
    std::vector<UntangleReport> reports;
    with_formula(kernel,
                 [&](const auto& formula) { reports = stages.unfold(search, FieldView(formula, field)); });
    return reports;
}

template <class Exec>
UntangleReport untangle(QuadStages<Exec>& stages, const KernelConstants& kernel, const FieldArrays& field) {
    return unfold(stages, stages.find_folds(), kernel, field).front();
}
/// @}

}  // namespace coppice::cuda
