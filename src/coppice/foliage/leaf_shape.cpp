#include "coppice/foliage/leaf_shape.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/foliage/flat_leaf_internal.h"

namespace coppice {
namespace {

using namespace foliage_internal;

void list_outline(LeafShape& o, FieldList& list) {
    list.add(common_field("parts", "Division of the leaf into leaflets or needles."), o.parts);
    list.add(common_field("outline", "Outline of a blade without its lobes and teeth."), o.outline);
    list.add(Field{"lobes", "Arrangement of the lobes of a blade."}, o.lobes);
    list.add(Field{"margin", "Teeth of a blade."}, o.margin);
    list.add(
        common_field("length", "Length of a blade or needle without the petiole.", Unit::metre, 1e-3, 10),
        o.length);
    list.add(common_field("width", "Width of a blade or needle.", Unit::metre, 1e-4, 10), o.width);
    list.add(Field{"base_exponent",
                   "Exponent of the half-width at the base: a small value makes it round, 1 straight, a "
                   "larger one hollow; 0 is that of the outline.",
                   Unit::none, 0, 4},
             o.base_exponent);
    list.add(
        Field{"tip_exponent", "The same exponent at the tip; 0 is that of the outline.", Unit::none, 0, 4},
        o.tip_exponent);
    list.add(
        Field{"leaflets", "Number of leaflets of a leaf, or of needles of a bundle.", Unit::none, 1, 301},
        o.leaflets);
    list.add(Field{"leaflet_angle", "Angle between leaflets, or of needles to the axis of their bundle.",
                   Unit::radian, 0, 1.6},
             o.leaflet_angle);
    list.add(Field{"leaflet_spacing", "Distance between pairs of leaflets per width of a leaflet.",
                   Unit::none, 0.1, 10},
             o.leaflet_spacing);
    list.add(Field{"leaflet_taper", "Share by which pairs of leaflets are shorter at the tip of the leaf.",
                   Unit::none, 0, 1},
             o.leaflet_taper);
    list.add(Field{"lobe_count", "Number of lobes on each side; of palmate leaves, of all lobes.", Unit::none,
                   1, 15},
             o.lobe_count);
    list.add(Field{"lobe_depth", "Depth of the sinuses between lobes per half-width of the blade.",
                   Unit::none, 0, 0.95},
             o.lobe_depth);
    list.add(Field{"teeth", "Number of teeth on each side of a blade.", Unit::none, 1, 200}, o.teeth);
    list.add(Field{"tooth_depth", "Height of the teeth per length of the blade.", Unit::none, 0, 0.2},
             o.tooth_depth);
}

void list_form(LeafShape& o, FieldList& list) {
    list.add(Field{"veins", "Number of pairs of secondary veins.", Unit::none, 0, 60}, o.veins);
    list.add(
        Field{"vein_angle", "Angle between the secondary veins and the midrib.", Unit::radian, 0.3, 1.57},
        o.vein_angle);
    list.add(Field{"fold", "Angle by which each half of a blade is raised at the midrib.", Unit::radian, -1.5,
                   1.5},
             o.fold);
    list.add(
        Field{"cup", "Angle by which each half of a blade bends up towards the margin.", Unit::radian, -3, 3},
        o.cup);
    list.add(Field{"curl", "Angle by which a blade bends down towards its tip.", Unit::radian, -3, 3},
             o.curl);
    list.add(Field{"arch", "Angle by which a whole leaf bends down towards its tip, with all leaflets.",
                   Unit::radian, -3, 3},
             o.arch);
    list.add(Field{"wave", "Height of the waves of the margin per length of the blade.", Unit::none, 0, 0.2},
             o.wave);
    list.add(Field{"petiole_length", "Length of the petiole, or of the sheath of a bundle of needles.",
                   Unit::metre, 0, 2},
             o.petiole_length);
    list.add(Field{"petiole_width", "Width of the petiole.", Unit::metre, 1e-4, 0.1}, o.petiole_width);
    list.add(Field{"blade_angle", "Angle by which the blade bends down at the end of the petiole.",
                   Unit::radian, -1.6, 1.6},
             o.blade_angle);
    list.add(Field{"rows", "Number of rows of faces along a blade or a needle.", Unit::none, 2, 200}, o.rows);
    list.add(Field{"columns", "Number of faces across each half of a blade.", Unit::none, 1, 16}, o.columns);
}

std::string choose_name(const LeafShape& shape) {
    if (shape.parts == LeafParts::needles) return "needles";
    return fmt::format("leaf_{}", name_of(shape.outline));
}

TexturePoint find_texture_point(const FlatBox& box, Point2 p) {
    return {std::clamp((p.x - box.low.x) / (box.high.x - box.low.x), 0.0f, 1.0f),
            std::clamp((p.y - box.low.y) / (box.high.y - box.low.y), 0.0f, 1.0f)};
}

}  // namespace

void list_fields(LeafShape& o, FieldList& list) {
    list_outline(o, list);
    list_form(o, list);
}

LeafModel make_leaf(const LeafShape& shape) {
    check_fields(shape, "leaf");
    const FlatLeaf leaf = make_flat_leaf(shape);
    LeafModel out{.prototype = {.name = choose_name(shape), .mesh = {}, .texture = {}}, .area = leaf.area};
    TriMesh& mesh = out.prototype.mesh;
    mesh.positions.assign(leaf.positions.begin(), leaf.positions.end());
    const FlatBox box = find_image_box(make_fine_leaf(shape));
    for (const FlatTriangle& triangle : leaf.triangles) {
        Triangle vertices{};
        for (std::size_t k = 0; k < 3; ++k) {
            vertices[k] = triangle[k].vertex;
            out.prototype.texture.push_back(find_texture_point(box, triangle[k].flat));
        }
        mesh.triangles.push_back(vertices);
    }
    return out;
}

std::vector<LeafModel> make_leaves(const LeafShape& shape, int count, int seed) {
    constexpr int kMaxCount = 1000;
    if (count < 1 || count > kMaxCount)
        throw InvalidInput(
            fmt::format("leaf: the number of models must be between 1 and {}, but is {}", kMaxCount, count));
    const CounterRandom random(static_cast<std::uint64_t>(seed), 0x1eaf);
    std::vector<LeafModel> out;
    for (int i = 0; i < count; ++i) {
        LeafShape varied = shape;
        std::uint64_t draw = static_cast<std::uint64_t>(i) * 8;
        for (float* value : {&varied.fold, &varied.cup, &varied.curl, &varied.wave, &varied.blade_angle})
            *value *= i == 0 ? 1 : static_cast<float>(random.uniform(draw++, 0.67, 1.33));
        varied.fold = std::clamp(varied.fold, -1.5f, 1.5f);
        varied.cup = std::clamp(varied.cup, -3.0f, 3.0f);
        varied.curl = std::clamp(varied.curl, -3.0f, 3.0f);
        varied.wave = std::min(varied.wave, 0.2f);
        varied.blade_angle = std::clamp(varied.blade_angle, -1.6f, 1.6f);
        out.push_back(make_leaf(varied));
        if (count > 1) out.back().prototype.name += fmt::format("_{}", i + 1);
    }
    return out;
}

LeafModel make_leaf_card(const LeafShape& shape) {
    check_fields(shape, "leaf");
    const FlatLeaf leaf = make_flat_leaf(shape);
    const FlatBox box = find_image_box(make_fine_leaf(shape));
    LeafModel out{.prototype = {.name = choose_name(shape) + "_card", .mesh = {}, .texture = {}},
                  .area = leaf.area};
    TriMesh& mesh = out.prototype.mesh;
    for (const Point2 p : {box.low, Point2{box.high.x, box.low.y}, box.high, Point2{box.low.x, box.high.y}})
        mesh.positions.emplace_back(p.x, p.y, 0.0f);
    mesh.triangles = {Triangle{0, 1, 2}, Triangle{0, 2, 3}};
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle)
            out.prototype.texture.push_back(
                find_texture_point(box, {mesh.positions[v].x, mesh.positions[v].y}));
    }
    return out;
}

}  // namespace coppice
