#include "coppice/studio/show/slice_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/scene/scene.h"

namespace coppice {
namespace {

const Solid& make_solid(const Scene& scene) {
    return std::get<Solid>(scene.state().objects.at({ObjectKind::solid, "a"})->value);
}

Json header(const std::string& blob) {
    std::uint32_t length = 0;
    std::memcpy(&length, blob.data() + 4, 4);
    return Json::parse(blob.substr(8, length));
}

std::vector<float> values(const std::string& blob) {
    std::uint32_t length = 0;
    std::memcpy(&length, blob.data() + 4, 4);
    std::vector<float> out((blob.size() - 8 - length) / sizeof(float));
    std::memcpy(out.data(), blob.data() + 8 + length, out.size() * sizeof(float));
    return out;
}

Vec3d read_vector(const Json& numbers) {
    return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

TEST(StudioSlice, ContainsTheFieldValuesAtCellCentres) {
    Scene scene;
    scene.run("box a low=-1,-2,0 high=1,2,6 radius=0.5");
    const SolidField field(make_solid(scene));
    for (const SliceAxis axis : {SliceAxis::x, SliceAxis::y, SliceAxis::z}) {
        const std::string blob =
            encode_slice(make_solid(scene), {.axis = axis, .at = 0.5, .size = 40}, {}, {});
        const Json head = header(blob);
        const int width = head["width"], height = head["height"];
        EXPECT_EQ(std::max(width, height), 40);
        const Vec3d corner = read_vector(head["corner"]), along = read_vector(head["along"]),
                    up = read_vector(head["up"]);
        // Cells are square, as far as whole numbers permit.
        EXPECT_NEAR(length(along) / width, length(up) / height, 0.05 * length(up) / height);
        const std::vector<float> found = values(blob);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        float low = found[0], high = found[0];
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const Vec3 p(corner + along * ((x + 0.5) / width) + up * ((y + 0.5) / height));
                float expected = 0;
                field.values({&p, 1}, {&expected, 1});
                const float value = found[static_cast<std::size_t>(y * width + x)];
                EXPECT_EQ(value, expected);
                low = std::min(low, value);
                high = std::max(high, value);
            }
        }
        EXPECT_EQ(head["low"].get<float>(), low);
        EXPECT_EQ(head["high"].get<float>(), high);
        EXPECT_GT(high, head["level"].get<float>());
    }
}

TEST(StudioSlice, RejectsInvalidPositionsAndSizes) {
    Scene scene;
    scene.run("sphere a");
    for (const double at : {std::numeric_limits<double>::infinity(), std::nan("")})
        EXPECT_THROW(encode_slice(make_solid(scene), {.at = at}, {}, {}), InvalidInput);
    for (const int size : {-1, 0, 1, 1025})
        EXPECT_THROW(encode_slice(make_solid(scene), {.size = size}, {}, {}), InvalidInput);
    // Outside the field its value is 0.
    const std::string blob = encode_slice(make_solid(scene), {.at = 1000}, {}, {});
    EXPECT_EQ(header(blob)["high"], 0);
}

}  // namespace
}  // namespace coppice
