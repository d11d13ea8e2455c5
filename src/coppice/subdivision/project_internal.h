#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/subdivision/catmull_clark.h"

// Shared by what moves vertices onto a field: project.cpp and untangle.cpp.
namespace coppice {

constexpr std::size_t kFieldBatch = 256;  // points per call of the field

// (x^(2/5) - 1) over its derivative, for x >= 0 and clamped to where that is finite. Bits of such numbers are
// ordered as integers, and x^(-2/5) comes from a guess by the exponent and Newton's rule without division:
// plain vector code.
inline void newton_rises(std::span<const float> ratios, float* rises) {
    constexpr auto kLow = std::bit_cast<std::int32_t>(1e-12f);
    constexpr auto kHigh = std::bit_cast<std::int32_t>(1e12f);
    const std::size_t count = ratios.size();
    const float* in = ratios.data();
    for (std::size_t k = 0; k < count; ++k) {
        auto bits = std::bit_cast<std::int32_t>(in[k]);
        bits = std::max(bits, kLow);
        bits = std::min(bits, kHigh);
        const auto x = std::bit_cast<float>(bits);
        const float square = x * x;
        const auto newton = [square](float y) { return y * (1.2f - 0.2f * square * (y * y) * (y * y) * y); };
        const auto guess =
            std::bit_cast<float>(0x58dd8000 - static_cast<std::int32_t>(0.4f * static_cast<float>(bits)));
        rises[k] = 2.5f * x * (1 - newton(newton(newton(guess))));
    }
}

// What the field says at a point, in units of its level; numbers that are not finite count as far outside.
struct Reading {
    float ratio = 0;
    float rise = 0;  // ratio^(2/5) - 1 over its derivative by ratio: Newton's step is -rise / slope of ratio
    Vec3 gradient;
};

// The field's answers for a batch.
struct Readings {
    std::array<float, kFieldBatch> ratio, rise;

    void interpret(std::span<const FieldSample> samples, float per_level) {
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const FieldSample& s = samples[k];
            // Zero times anything finite is zero: one test for all four numbers.
            const float finite = 0 * s.value + 0 * s.gradient.x + 0 * s.gradient.y + 0 * s.gradient.z;
            const float value = finite == 0 ? s.value * per_level : 0.0f;
            ratio[k] = value > 0 ? value : 0.0f;
        }
        newton_rises(std::span(ratio).first(samples.size()), rise.data());
    }
    Reading at(std::size_t k, const FieldSample& sample, float per_level) const {
        if (!(ratio[k] > 0)) return {};
        return {ratio[k], rise[k], sample.gradient * per_level};
    }
};

// Newton's step along the gradient on value^(2/5). `slope_squared` is that of the gradient, and not zero.
inline Vec3 newton_step(const Reading& here, float slope_squared, float damping) {
    return here.gradient * (-damping * (here.rise / slope_squared));
}

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
