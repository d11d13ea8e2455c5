#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/kernel/gradient_kernel.h"

// Shared by what moves vertices onto a field: project.cpp and untangle.cpp.
namespace coppice {

constexpr std::size_t kFieldBatch = 256;  // points per call of the field

// The field's answers for a batch.
struct Readings {
    std::array<float, kFieldBatch> ratio, rise;

    void interpret(std::span<const FieldSample> samples, float per_level) {
        for (std::size_t k = 0; k < samples.size(); ++k) ratio[k] = read_ratio(samples[k], per_level);
        // A loop of its own: plain vector code.
        for (std::size_t k = 0; k < samples.size(); ++k) rise[k] = kernel::newton_rise(ratio[k]);
    }
    Reading at(std::size_t k, const FieldSample& sample, float per_level) const {
        if (!(ratio[k] > 0)) return {};
        return {ratio[k], rise[k], sample.gradient * per_level};
    }
};

// To what region of the field the cage quads belong, and which of them fill a flat end.
struct Regions {
    std::span<const std::uint32_t> of_face;
    std::span<const ClipPlane> clips;
};

// Throws InvalidInput, on behalf of `stage`, when sizes do not match, a clip plane is not one, or the field
// has no level above 0.
void check_projection(std::string_view stage, std::size_t positions, std::size_t anchors,
                      const PatchRefinement& patches, const Regions& regions, FieldRef field);

}  // namespace coppice
