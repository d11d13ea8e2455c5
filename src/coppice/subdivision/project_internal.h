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

// Shared by project.cpp and untangle.cpp, which move vertices onto a field.
namespace coppice {

constexpr std::size_t kFieldBatch = 256;  // points per call of the field

// The values of the field for a batch.
struct Readings {
    std::array<float, kFieldBatch> ratio, rise;

    void interpret(std::span<const FieldSample> samples, float per_level) {
        for (std::size_t k = 0; k < samples.size(); ++k) ratio[k] = read_ratio(samples[k], per_level);
        // A separate loop that is vectorised.
        for (std::size_t k = 0; k < samples.size(); ++k) rise[k] = kernel::newton_rise(ratio[k]);
    }
    Reading at(std::size_t k, const FieldSample& sample, float per_level) const {
        if (!(ratio[k] > 0)) return {};
        return {ratio[k], rise[k], sample.gradient * per_level};
    }
};

// The regions of the field for the cage quads, and the cage quads that form flat ends.
struct Regions {
    std::span<const std::uint32_t> of_face;
    std::span<const ClipPlane> clips;
};

// Throws InvalidInput, with the name of `stage`, if sizes do not match, a clip plane is invalid, or the field
// has no level above 0.
void check_projection(std::string_view stage, std::size_t positions, std::size_t anchors,
                      const PatchRefinement& patches, const Regions& regions, FieldRef field);

}  // namespace coppice
