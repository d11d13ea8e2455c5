#include "coppice/render/value_colors.h"

#include <algorithm>
#include <cmath>

#include "coppice/render/colors.h"

namespace coppice {
namespace {

bool is_known(float value, ValueScale scale) {
    return std::isfinite(value) && (scale != ValueScale::logarithmic || value > 0);
}

}  // namespace

Rgb value_color(float value, float min, float max, ValueScale scale) {
    constexpr float kMaxNumber = 1 << 24;  // up to which float has all whole numbers
    if (!is_known(value, scale)) return to_srgb(deviation_color(NAN));
    if (scale == ValueScale::numbers)
        return numbered_color(static_cast<std::size_t>(std::clamp(std::round(value), 0.0f, kMaxNumber)));
    const bool is_linear = scale == ValueScale::linear;
    const float range = is_linear ? max - min : std::log(max / min);
    const float above = is_linear ? value - min : std::log(value / min);
    const float t = range > 0 ? 2 * above / range - 1 : 0.0f;
    return to_srgb(deviation_color(std::clamp(t, -1.0f, 1.0f)));
}

ValueColors value_colors(std::span<const float> values, ValueScale scale) {
    ValueColors out;
    bool is_first = true;
    for (const float value : values) {
        if (!is_known(value, scale)) continue;
        out.min = is_first ? value : std::min(out.min, value);
        out.max = is_first ? value : std::max(out.max, value);
        is_first = false;
    }
    out.colors.reserve(values.size());
    for (const float value : values) out.colors.push_back(value_color(value, out.min, out.max, scale));
    return out;
}

}  // namespace coppice
