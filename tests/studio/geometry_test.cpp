#include "coppice/studio/show/geometry_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/scene/scene.h"

namespace coppice {
namespace {

struct Decoded {
    Json header;
    std::string body;

    template <class T>
    std::vector<T> array(const std::string& name) const {
        for (const Json& a : header["arrays"]) {
            if (a["name"] != name) continue;
            std::vector<T> out(a["count"].get<std::size_t>() * a["size"].get<std::size_t>());
            std::memcpy(out.data(), body.data() + a["offset"].get<std::size_t>(), out.size() * sizeof(T));
            return out;
        }
        return {};
    }
};

Decoded decoded(const std::string& blob) {
    EXPECT_EQ(blob.substr(0, 4), "CPB1");
    EXPECT_EQ(blob.size() % 4, 0u);
    std::uint32_t length = 0;
    std::memcpy(&length, blob.data() + 4, 4);
    EXPECT_EQ(length % 4, 0u);
    return {Json::parse(blob.substr(8, length)), blob.substr(8 + length)};
}

Scene make_scene(const std::string& text) {
    Scene scene;
    scene.run_text(text, "test");
    return scene;
}

Decoded shown(const Scene& scene, ObjectKind kind, const std::string& name,
              StudioColor color = StudioColor::plain) {
    return decoded(
        encode_object(*scene.state().objects.at({kind, name}), {kind, name, 3, {}}, 24, color, {}));
}

TEST(Geometry, OfASolidIsASurfaceWithOutwardNormals) {
    const Scene scene = make_scene("sphere s radius=2 center=1,0,0\n");
    const Decoded d = shown(scene, ObjectKind::solid, "s");
    EXPECT_EQ(d.header["kind"], "surface");
    EXPECT_EQ(d.header["version"], 3);
    const auto p = d.array<float>("position");
    const auto n = d.array<std::int8_t>("normal");
    ASSERT_GT(p.size(), 300u);
    ASSERT_EQ(n.size() / 4, p.size() / 3);
    for (std::size_t i = 0; i < p.size() / 3; ++i) {
        const float outward = (p[3 * i] - 1) * static_cast<float>(n[4 * i]) +
                              p[3 * i + 1] * static_cast<float>(n[4 * i + 1]) +
                              p[3 * i + 2] * static_cast<float>(n[4 * i + 2]);
        EXPECT_GT(outward, 200) << i;  // of 2 times 127
    }
}

/// Returns the coordinates of the vertices of all faces in order, `size` numbers each.
template <class Number>
std::vector<Number> by_corner(const Decoded& d, const std::string& name, std::size_t size,
                              const std::string& faces) {
    const auto values = d.array<Number>(name);
    std::vector<Number> out;
    for (const std::uint32_t v : d.array<std::uint32_t>(faces)) {
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(size * v);
        out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(size));
    }
    return out;
}

void expect_divided_at_seams(const std::string& options, const std::string& faces) {
    const Scene scene = make_scene(
        "limb t 0,0,0 0,0,1 0,0,2 radius=0.1\nedit draw t 0,0,1 1,0,1.5 radius=0.05\n"
        "material m oak width=16\n"
        "mesh t plain levels=1 uv=bark" +
        options + "\n" + "mesh t barked levels=1 uv=bark material=m" + options + "\n");
    const Decoded plain = shown(scene, ObjectKind::mesh, "plain");
    const Decoded barked = shown(scene, ObjectKind::mesh, "barked");
    EXPECT_TRUE(plain.array<float>("uv").empty());  // there are no images for it
    const auto uv = barked.array<float>("uv");
    EXPECT_EQ(uv.size() / 2, barked.array<float>("position").size() / 3);
    EXPECT_GT(uv.size() / 2, plain.array<float>("position").size() / 3);
    EXPECT_EQ(by_corner<float>(barked, "position", 3, faces), by_corner<float>(plain, "position", 3, faces));
    // Both sides of a seam have the normal of the whole surface; sums in another order may round differently.
    const auto normals = by_corner<std::int8_t>(barked, "normal", 4, faces);
    const auto expected = by_corner<std::int8_t>(plain, "normal", 4, faces);
    ASSERT_EQ(normals.size(), expected.size());
    for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_NEAR(normals[i], expected[i], 1) << i;
}

/// Compares the encoded order of the faces with their slots.
void expect_sorted_by_slot(const std::string& options, const std::string& faces, std::size_t size) {
    const Scene scene = make_scene(
        "limb t 0,0,0 0,0,1 0,0,2 radius=0.1 tip_radius=0.02\nmaterial m oak width=16\n"
        "cutmaterial wood oak size=16\n"
        "mesh t levels=1 uv=bark material=m twig_material=m twig_diameter=0.1 cut_material=wood" +
        options + "\n");
    const Decoded shape = shown(scene, ObjectKind::mesh, "t");
    const auto counts = shape.header["slots"].get<std::vector<std::size_t>>();
    ASSERT_EQ(counts.size(), 3u);
    const auto corners = shape.array<std::uint32_t>(faces);
    EXPECT_EQ(size * (counts[0] + counts[1] + counts[2]), corners.size());
    // Faces of bark are below those of twigs; cuts are at the base, z = 0.
    const auto positions = shape.array<float>("position");
    const auto height = [&](std::size_t corner) { return positions[3 * corners[corner] + 2]; };
    const std::size_t bark = size * counts[0], twigs = bark + size * counts[1];
    ASSERT_GT(counts[2], 0u);
    for (std::size_t i = 0; i < bark; ++i) EXPECT_LT(height(i), 1.5f);
    for (std::size_t i = bark; i < twigs; ++i) EXPECT_GT(height(i), 0.9f);
    for (std::size_t i = twigs; i < corners.size(); ++i) EXPECT_NEAR(height(i), 0, 1e-3f);
}

TEST(Geometry, OfSlotsIsSorted) {
    expect_sorted_by_slot("", "quads", 4);
    expect_sorted_by_slot(" method=tetrahedra tetra_edge=0.2", "triangles", 3);
}

TEST(Geometry, OfQuadsWithAMaterialIsDividedAtSeams) {
    expect_divided_at_seams("", "quads");
    const Scene scene = make_scene(
        "limb t 0,0,0 0,0,2 radius=0.1\nmaterial m oak width=16\n"
        "mesh t levels=0 uv=bark material=m\n");
    const auto& surface = std::get<Surface>(scene.state().objects.at({ObjectKind::mesh, "t"})->value);
    const auto uv = by_corner<float>(shown(scene, ObjectKind::mesh, "t"), "uv", 2, "quads");
    ASSERT_EQ(uv.size(), 2 * surface.texture.size());
    for (std::size_t i = 0; i < surface.texture.size(); ++i) {
        EXPECT_EQ(uv[2 * i], surface.texture[i].u);
        EXPECT_EQ(uv[2 * i + 1], surface.texture[i].v);
    }
}

TEST(Geometry, OfOtherFacesWithAMaterialIsDividedAtSeams) {
    expect_divided_at_seams(" method=cylinders", "triangles");
}

TEST(Geometry, OfASkeletonHasIdsAndOrders) {
    const Scene scene = make_scene("limb t 0,0,0 0,0,1 0,0,2\nedit draw t 0,0,1 1,0,1.5 radius=0.02\n");
    const Decoded d = shown(scene, ObjectKind::skeleton, "t", StudioColor::order);
    const auto parents = d.array<std::uint32_t>("parent");
    const auto orders = d.array<std::uint8_t>("order");
    EXPECT_EQ(parents[0], 0xffffffffu);
    EXPECT_EQ(*std::ranges::max_element(orders), 1);
    EXPECT_EQ(d.header["high"], 1);
    EXPECT_EQ(d.array<float>("value").size(), parents.size());
}

TEST(Geometry, IsColouredByTheEvidenceOfTheFile) {
    const Skeleton tree({NodeId(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                        {0.1f, 0.1f, 0.1f});
    const SceneObject bare{tree, 0};
    const GeometryHead head{ObjectKind::skeleton, "t", 1, {}};
    EXPECT_THROW(encode_object(bare, head, 1, StudioColor::evidence, {}), InvalidInput);
    const SceneObject measured{tree, 0, {{"evidence", {0.2f, 0.5f, 1.0f}}}};
    const Decoded axes = decoded(encode_object(measured, head, 1, StudioColor::evidence, {}));
    EXPECT_EQ(axes.array<float>("value"), (std::vector<float>{0.2f, 0.5f, 1.0f}));
    const LiveSurface surface(tree, {});
    const Decoded skin = decoded(encode_live_surface(surface, measured, head, StudioColor::evidence, {}));
    EXPECT_EQ(skin.array<float>("value").size(), surface.positions().size());
    const Decoded off = decoded(encode_live_surface(surface, measured, head, StudioColor::deviation, {}));
    EXPECT_LT(std::abs(off.header["high"].get<float>()), 0.2f);
}

TEST(Geometry, OtherKindsHaveNoRadiiToColour) {
    const Scene scene = make_scene("sphere s\n");
    EXPECT_THROW(shown(scene, ObjectKind::solid, "s", StudioColor::radius), InvalidInput);
}

TEST(Geometry, PatchesUpdateTheOldSurfaceToTheNewOne) {
    Scene scene = make_scene(
        "limb t 0,0,0 0,0,1 0,0,2 0,0,3 0,0,4 0,0,5 0,0,6\nedit draw t 0,0,1 1,0,1.5 2,0,2 radius=0.02\n");
    const auto tree = [&] {
        return std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "t"})->value);
    };
    const auto object = [&]() -> const SceneObject& {
        return *scene.state().objects.at({ObjectKind::skeleton, "t"});
    };
    MeshOptions options;
    options.levels = 1;
    LiveSurface surface(tree(), options);
    const GeometryHead head{ObjectKind::skeleton, "t", 1, {}};
    auto before = decoded(encode_live_surface(surface, object(), head, StudioColor::plain, {}));
    const Skeleton old = tree();
    scene.run("edit rotate t order(1) 20");
    std::vector<StableId> changed;
    for (const NodeId n : nodes(old)) changed.push_back(old.stable_id(n));
    const SurfaceChange change = surface.update(tree(), changed);
    const Decoded patch = decoded(encode_patch(surface, change, head, 1));
    const Decoded after = decoded(encode_live_surface(surface, object(), head, StudioColor::plain, {}));
    auto position = before.array<float>("position");
    position.resize(3 * patch.header["vertices"].get<std::size_t>());
    const auto part = patch.array<float>("position");
    std::size_t from = 0;
    for (const Json& range : patch.header["ranges"]["vertices"]) {
        const std::size_t count = 3 * range[1].get<std::size_t>();
        std::copy_n(part.begin() + static_cast<std::ptrdiff_t>(from), count,
                    position.begin() + 3 * range[0].get<std::ptrdiff_t>());
        from += count;
    }
    EXPECT_EQ(from, part.size());
    EXPECT_EQ(position, after.array<float>("position"));
}

}  // namespace
}  // namespace coppice
