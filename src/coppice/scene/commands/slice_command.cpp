#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/implicit/solid/field_values.h"
#include "coppice/points/sampling/remaining_density.h"
#include "coppice/render/height_map.h"
#include "coppice/render/png.h"
#include "coppice/scene/commands/density_internal.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

using namespace table;

constexpr double kMargin = 0.04;      // [size of the box] margin on each side
constexpr double kMaxIsolines = 200;  // more lines would be indistinguishable
constexpr double kBytesOfPixel = 64;

/// A rectangle in space represented as an image with square pixels.
class Plane {
  public:
    Plane(const SceneCall& call, const Box3& box) : normal_(direction(call.point("normal"))) {
        at_ = call.has("at") ? Vec3d(call.point("at")) : Vec3d(box.center());
        // The image is upright if possible; seen from above, north is up.
        const Vec3d up{0, 0, 1}, tilted = up - normal_ * dot(up, normal_);
        up_ = length(tilted) > 1e-6 ? tilted / length(tilted) : Vec3d{0, 1, 0};
        right_ = cross(up_, normal_);
        fit(box, call.number("extent"), call.number("pixels"));
    }

    int width() const { return width_; }
    int height() const { return height_; }
    double pixel() const { return pixel_; }  ///< [m] size of a pixel
    Vec3d normal() const { return normal_; }
    Vec3d at() const { return at_; }

    Vec3 place(int x, int y) const {
        return Vec3(at_ + right_ * ((x + 0.5 - 0.5 * width_) * pixel_) +
                    up_ * ((0.5 * height_ - y - 0.5) * pixel_));
    }
    /// Returns the position [pixels] from the left and the top, and the distance [m] from the plane.
    Vec3d seen(Vec3d p) const {
        const Vec3d d = p - at_;
        return {0.5 * width_ + dot(d, right_) / pixel_, 0.5 * height_ - dot(d, up_) / pixel_,
                dot(d, normal_)};
    }

  private:
    static Vec3d direction(Vec3 v) {
        const double l = length(Vec3d(v));
        if (!(l > 1e-12)) throw InvalidInput("normal= must not be 0,0,0");
        return Vec3d(v) / l;
    }

    void fit(const Box3& box, double extent, double pixels) {
        double half_width = 0, half_height = 0;
        for (int i = 0; i < 8; ++i) {
            const Vec3d corner{i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                               i & 4 ? box.high.z : box.low.z};
            half_width = std::max(half_width, std::abs(dot(corner - at_, right_)));
            half_height = std::max(half_height, std::abs(dot(corner - at_, up_)));
        }
        const double longest = 2 * std::max(half_width, half_height);
        if (!(longest > 0)) throw InvalidInput("there is nothing to slice: the field is 0 everywhere");
        pixel_ = (extent > 0 ? extent : longest * (1 + 2 * kMargin)) / pixels;
        const auto count = [&](double half) {
            return std::max(1, static_cast<int>(std::lround(pixels * 2 * half / longest)));
        };
        width_ = count(half_width);
        height_ = count(half_height);
    }

    Vec3d at_, normal_, right_, up_;
    double pixel_ = 1;
    int width_ = 1, height_ = 1;
};

std::vector<Vec3> find_places(const Plane& plane) {
    std::vector<Vec3> out;
    for (int y = 0; y < plane.height(); ++y)
        for (int x = 0; x < plane.width(); ++x) out.push_back(plane.place(x, y));
    return out;
}

/// Returns the requested isolines, or isolines at regular intervals.
std::vector<double> compute_isolines(const SceneCall& call, double low, double high, bool of_field) {
    std::vector<double> out;
    for (const ArgumentValue& v : call.values("isoline")) out.push_back(v.numbers.at(0));
    double every = call.number("every");
    if (every <= 0 && out.empty() && of_field) every = 0.1;
    if (every <= 0) return out;
    if ((high - low) / every > kMaxIsolines)
        throw InvalidInput(fmt::format(
            "every={} would draw {:.0f} isolines, but at most {:.0f} are allowed; use a larger step", every,
            (high - low) / every, kMaxIsolines));
    for (double k = std::floor(low / every) + 1; k * every < high; ++k) out.push_back(k * every);
    return out;
}

/// The values of a slice and their properties.
struct Slice {
    std::vector<double> values;
    bool of_field = true;
    double level = 0;  ///< iso value of the surface
};

HeightMapOptions make_map_options(const SceneCall& call, const Slice& slice) {
    const auto [least, largest] = std::ranges::minmax(slice.values);
    HeightMapOptions out;
    out.low = call.number("low");
    out.high = call.has("high") ? call.number("high") : std::max(largest, out.low + 1e-6);
    if (!(out.high > out.low)) throw InvalidInput("high= must be above low=");
    if (!call.has("high") && out.low > largest)
        throw InvalidInput(fmt::format(
            "low={} is above all values in the image, the maximum of which is {:.4g}", out.low, largest));
    out.isolines = compute_isolines(call, least, largest, slice.of_field);
    if (slice.of_field) out.outlines = {slice.level};
    return out;
}

void draw_points(Image& image, const PointSet& points, const Plane& plane, double reach) {
    const double radius = std::max(1.5, 0.005 * std::max(image.width, image.height));
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d p = plane.seen(points.world(i));
        if (std::abs(p.z) <= reach) draw_dot(image, p.x, p.y, radius);
    }
}

Slice make_slice(const SceneCall& call, const SolidField& field, const PointRegion& region,
                 std::span<const Vec3> places) {
    if (call.text("of") == "field") {
        const std::vector<float> values = values_at(field, places, call.context());
        return {{values.begin(), values.end()}, true, field.level()};
    }
    const PointSet none;
    const bool acted = call.has("points") && call.has("kernel");
    return {remaining_density(region, acted ? make_kernel(call) : RadialKernel(),
                              acted ? call.point_set(call.text("points")) : none, places,
                              DartThrowingOptions{}.max_factor, call.context()),
            false, 0};
}

void check(const SceneCall& call) {
    const bool of_field = call.text("of") == "field", dots = call.number("dots") > 0;
    if (of_field && (call.has("kernel") || call.has("curve")))
        throw InvalidInput("kernel= and curve= apply only to densities; add of=density");
    if (call.has("kernel") && !call.has("points"))
        throw InvalidInput("kernel= defines the effect of points on the density; add points=");
    if (call.has("points") && !call.has("kernel") && !dots)
        throw InvalidInput(
            "points= has no effect alone; add kernel= for the density that they leave, or dots= to draw "
            "them");
    if (dots && !call.has("points")) throw InvalidInput("dots= draws points; add points=");
}

SceneOutcome run_slice(const SceneCall& call) {
    const std::filesystem::path path = call.output("file");
    if (path.extension() != ".png")
        throw InvalidInput(
            fmt::format("'{}' is not a valid file name for an image; use .png", path.string()));
    check(call);
    call.reserve(kBytesOfPixel * call.number("pixels") * call.number("pixels"));
    const auto options = call.options<GenerateOptions>("generate");
    const SolidField field = call.field(call.text("solid"));
    const bool of_field = call.text("of") == "field";
    const PointRegion region{FieldRef(field), density_box(call, options, field),
                             compute_density(call, options, field.level())};
    const Plane plane(call, of_field ? field.bounds() : region.box);
    if (!call.settings().outputs) return {};
    const Slice slice = make_slice(call, field, region, find_places(plane));
    const HeightMapOptions colors = make_map_options(call, slice);
    Image image = height_map(slice.values, plane.width(), colors, call.context());
    if (call.number("dots") > 0)
        draw_points(image, call.point_set(call.text("points")), plane, call.number("dots"));
    write_file(path, encode_png(image));
    const auto [least, largest] = std::ranges::minmax(slice.values);
    SceneOutcome out;
    out.text = fmt::format(
        "{} {:.4g} to {:.4g}, drawn from {:.4g} to {:.4g}; {} isolines; a pixel is {:.4g} m\n",
        call.text("of"), least, largest, colors.low, colors.high, colors.isolines.size(), plane.pixel());
    return out;
}

std::vector<Argument> look_arguments() {
    Argument dots = number("dots", "0", 0, 1e6, Unit::metre,
                           "Maximum distance from the plane of points that are drawn; 0 draws none.");
    Argument pixels = number("pixels", "512", 16, 8192, Unit::none, "Number of pixels of the longer side.");
    pixels.type = ArgumentType::whole;
    return {
        object_option("points", ObjectKind::points, "Points that change the density."),
        kernel_argument("DISTANCE,FACTOR: a point of the curve by which these points change a density, as in "
                        "pointset generate."),
        std::move(dots),
        tuple("normal", "0,-1,0", "Normal of the plane, towards the viewer.", {3}, Unit::none),
        tuple("at", "", "Point of the plane at the centre of the image; by default the centre of the solid."),
        number("extent", "0", 0, 1e6, Unit::metre, "Length of the longer side; 0 shows the whole field."),
        std::move(pixels),
        repeated(number("isoline", "", 0, 0, Unit::none, "Value along which a line is drawn.")),
        number("every", "0", 0, 1e6, Unit::none,
               "Step between isolines; 0 uses 0.1 for a field without isoline=, and draws none otherwise."),
        number("low", "0", -1e9, 1e9, Unit::none, "Value that is drawn in dark blue."),
        number("high", "", -1e9, 1e9, Unit::none,
               "Value that is drawn in pale yellow; by default the maximum in the image.")};
}

}  // namespace

SceneCommand slice_command() {
    SceneCommand c{.name = "slice", .group = "Looking, saving and taking back"};
    c.help = "Draw the values of a field, or a density of points, in a plane to a PNG image.";
    c.example = "slice s field.png pixels=64";
    c.records = false;
    Argument of{.name = "of",
                .help = "Quantity to draw: the field of the solid, or a density computed from it."};
    of.type = ArgumentType::choice;
    of.choices = {"field", "density"};
    of.initial = "field";
    c.arguments = {object("solid", ObjectKind::solid, "Solid to slice."),
                   file("file", ArgumentType::output_file, "Image (.png), the last word."), std::move(of)};
    add_options(c.arguments, GenerateOptions{}, "generate",
                {"pattern", "count", "distance", "spacing", "cluster_reach", "cluster_gain", "resolution",
                 "seed", "max_memory"});
    c.arguments.push_back(curve_argument());
    std::ranges::move(look_arguments(), std::back_inserter(c.arguments));
    c.run = run_slice;
    return c;
}

}  // namespace coppice
