#include "coppice/render/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/render/trace/scale_bar_internal.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

PolygonMesh cube(float half, Vec3d origin = {}) {
    PolygonMesh m;
    for (int i = 0; i < 8; ++i) {
        m.positions.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half});
    }
    const std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : faces) m.add_face(f);
    m.origin = origin;
    return m;
}

Skeleton fork() {
    return Skeleton({NodeId{}, NodeId(0), NodeId(1), NodeId(1), NodeId{}},
                    {{0, 0, 0}, {0, 0, 1}, {0.5f, 0, 1.6f}, {-0.5f, 0, 1.6f}, {1, 0, 0.2f}},
                    {0.1f, 0.08f, 0.05f, 0.05f, 0.2f});
}

RenderOptions small() {
    RenderOptions o;
    o.camera.width = o.camera.height = 64;
    o.samples = 4;
    o.camera.azimuth = 0;
    o.camera.elevation = 0;
    o.ground = false;
    o.transparent = true;
    return o;
}

/// Returns the columns and rows that the object touches.
struct Extent {
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};
Extent extent(const Image& image) {
    Extent e;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (image.at(x, y)[3] == 0) continue;
            e.left = std::min(e.left, x), e.right = std::max(e.right, x);
            e.top = std::min(e.top, y), e.bottom = std::max(e.bottom, y);
        }
    }
    return e;
}

int opaque_pixels(const Image& image) {
    int count = 0;
    for (const auto& p : image.pixels) count += p[3] == 255 ? 1 : 0;
    return count;
}

TEST(Render, ObjectFillsTheImageUpToTheMargin) {
    const PolygonMesh mesh = cube(2);
    RenderOptions o = small();
    o.camera.margin = 0.125f;  // 8 of 64 pixels on each side
    // Viewed along the normal, the front face of the cube fills the image.
    const Extent e = extent(render({.mesh = &mesh}, o));
    EXPECT_NEAR(e.left, 8, 1);
    EXPECT_NEAR(e.right, 55, 1);
    EXPECT_NEAR(e.top, 8, 1);
    EXPECT_NEAR(e.bottom, 55, 1);
}

TEST(Render, ObjectFitsFromEveryDirection) {
    const Skeleton skeleton = fork();
    RenderOptions o = small();
    o.camera.width = 96;
    o.samples = 1;
    for (const float azimuth : {-2.0f, 0.0f, 1.0f, kPi}) {
        for (const float elevation : {-1.57f, -0.3f, 0.4f, 1.57f}) {
            o.camera.azimuth = azimuth;
            o.camera.elevation = elevation;
            const Extent e = extent(render({.skeleton = &skeleton}, o));
            EXPECT_GE(e.left, 2);
            EXPECT_LE(e.right, 93);
            EXPECT_GE(e.top, 1);
            EXPECT_LE(e.bottom, 62);
            EXPECT_TRUE(e.right - e.left > 78 || e.bottom - e.top > 50);
        }
    }
}

TEST(Render, IsIndependentOfSizeAndPosition) {
    RenderOptions o = small();
    o.camera.azimuth = 0.7f;
    o.camera.elevation = 0.5f;
    const PolygonMesh reference = cube(1);
    const int expected = opaque_pixels(render({.mesh = &reference}, o));
    for (const float half : {1e-3f, 1e6f, 1e14f}) {
        const PolygonMesh mesh = cube(half, {5e6, -3e6, 100});
        EXPECT_NEAR(opaque_pixels(render({.mesh = &mesh}, o)), expected, 4) << half;
    }
}

TEST(Render, MeshAndSkeletonShareOneSpace) {
    // The ball of the skeleton touches the faces of the cube from inside if both origins are taken into
    // account.
    const PolygonMesh mesh = cube(1, {1000, 0, 0});
    const Skeleton inside({NodeId{}}, {{0, 0, 0}}, {0.9f}, {1000, 0, 0});
    const Extent e = extent(render({.mesh = &mesh, .skeleton = &inside}, small()));
    EXPECT_NEAR(e.left, 2.5, 1);
    EXPECT_NEAR(e.right, 60.5, 1);
}

TEST(Render, SkeletonIsVisibleThroughTheMesh) {
    const PolygonMesh mesh = cube(1);
    const Skeleton inside({NodeId{}}, {{0, 0, 0}}, {0.9f});
    const auto plain = render({.mesh = &mesh}, small()).at(32, 32);
    const auto both = render({.mesh = &mesh, .skeleton = &inside}, small()).at(32, 32);
    EXPECT_GT(both[0], both[2] + 60);
    EXPECT_LT(plain[0], plain[2] + 60);
}

bool is_magenta(const Image::Pixel& p) { return p[0] > p[1] + 60 && p[2] > p[1] + 40; }

TEST(Render, MarkedFacesAreVisibleEvenIfHidden) {
    const PolygonMesh mesh = cube(1);
    const Image plain = render({.mesh = &mesh}, small());
    EXPECT_FALSE(is_magenta(plain.at(32, 32)));
    // The camera is on +x: the last face of the cube is in front, the fifth one behind.
    for (const std::uint32_t face : {5u, 4u}) {
        const std::vector<std::uint32_t> marked{face};
        const Image image = render({.mesh = &mesh, .marked_faces = marked}, small());
        EXPECT_TRUE(is_magenta(image.at(32, 32))) << face;
        EXPECT_EQ(is_magenta(image.at(5, 32)), face == 5) << "the more distant part looks smaller";
        EXPECT_EQ(render({.mesh = &mesh, .marked_faces = marked}, small(), {.threads = 3}), image);
    }
    const std::vector<std::uint32_t> none{6};
    EXPECT_THROW(render({.mesh = &mesh, .marked_faces = none}, small()), InvalidInput);
    const Skeleton skeleton = fork();
    EXPECT_THROW(render({.skeleton = &skeleton, .marked_faces = none}, small()), InvalidInput);
}

TEST(Render, MarkedTrianglesAndPolygonsAreDrawnWhole) {
    PolygonMesh mesh;  // a square perpendicular to the view, as one quad with a triangle below and five above
    mesh.positions.assign(
        {{0, -1, -1}, {0, 1, -1}, {0, 1, 0}, {0, -1, 0}, {0, -1, 1}, {0, 0, 1.1f}, {0, 1, 1}});
    mesh.add_face(std::vector<std::uint32_t>{0, 1, 2});
    mesh.add_face(std::vector<std::uint32_t>{0, 2, 3});
    mesh.add_face(std::vector<std::uint32_t>{3, 2, 6, 5, 4});
    const auto count_pixels = [&](std::uint32_t face) {
        const std::vector<std::uint32_t> marked{face};
        const Image image = render({.mesh = &mesh, .marked_faces = marked}, small());
        int count = 0;
        for (const Image::Pixel& p : image.pixels) count += is_magenta(p) ? 1 : 0;
        return count;
    };
    EXPECT_NEAR(count_pixels(0), count_pixels(1), 60);
    EXPECT_NEAR(count_pixels(2), 2.1 * count_pixels(0), 120);  // areas 1 and 2.1
}

TEST(Render, CoarseFacesAreShadedSmoothly) {
    // At grazing light, a face must not be entirely black up to its edge.
    RenderOptions o = small();
    o.samples = 64;
    const PolygonMesh coarse = shapes::tube(12, 1, 1, 8), fine = shapes::tube(192, 1, 1, 8);
    for (const float azimuth : {0.0f, 1.0f, 2.0f, 3.5f}) {
        o.camera.azimuth = azimuth;
        const Image a = render({.mesh = &coarse}, o), b = render({.mesh = &fine}, o);
        int largest = 0;
        for (int x = 22; x < 42; ++x) {
            int sum_a = 0, sum_b = 0;
            for (int y = 20; y < 44; ++y) {
                sum_a += a.at(x, y)[1];
                sum_b += b.at(x, y)[1];
            }
            largest = std::max(largest, std::abs(sum_a - sum_b) / 24);
        }
        EXPECT_LT(largest, 20) << azimuth;
    }
}

TEST(Render, RingsAreDrawnAroundMarks) {
    const PolygonMesh mesh = cube(1, {100, 0, 0});
    // A ring about the centre, as wide as the cube at that depth; one too small to be visible is drawn
    // larger.
    const std::vector<RenderMark> wide{{{100, 0, 0}, 0.5}}, tiny{{{100, 0, 0}, 0}};
    const auto columns = [&](std::span<const RenderMark> marks) {
        const Image image = render({.mesh = &mesh, .marks = marks}, small());
        std::vector<int> found;
        for (int x = 0; x < 64; ++x) {
            if (is_magenta(image.at(x, 32))) found.push_back(x);
        }
        return found;
    };
    const auto ring = columns(wide);
    ASSERT_GE(ring.size(), 2u);
    EXPECT_EQ(ring.front(), 63 - ring.back());  // about the centre
    EXPECT_GT(ring.back() - ring.front(), 20);
    EXPECT_LT(ring.back() - ring.front(), 40);
    EXPECT_FALSE(columns(tiny).empty());
    EXPECT_TRUE(columns({}).empty());
    // One behind the camera, and one outside the image.
    const std::vector<RenderMark> outside{{{1e6, 0, 0}, 1}, {{100, 1e6, 0}, 1}};
    EXPECT_TRUE(columns(outside).empty());
}

TEST(Render, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton skeleton = fork();
    RenderOptions o = small();
    o.ground = true;
    const Image one = render({.skeleton = &skeleton}, o, {.threads = 1});
    EXPECT_EQ(one, render({.skeleton = &skeleton}, o, {.threads = 2}));
    EXPECT_EQ(one, render({.skeleton = &skeleton}, o, {.threads = 7}));
}

TEST(Render, WiresFollowTheEdgesOfQuadsAndNotTheirDiagonals) {
    const PolygonMesh mesh = cube(1);
    RenderOptions o = small();
    o.samples = 16;
    o.camera.margin = 0;
    o.flat = true;
    const Image plain = render({.mesh = &mesh}, o);
    o.wireframe = true;
    o.wire_width = 4;
    const Image wired = render({.mesh = &mesh}, o);
    EXPECT_LT(wired.at(1, 32)[0] + 40, plain.at(1, 32)[0]) << "the left edge is dark";
    EXPECT_LT(wired.at(32, 62)[0] + 40, plain.at(32, 62)[0]) << "so is the lower one";
    for (const int i : {20, 28, 32, 44}) {
        EXPECT_EQ(wired.at(i, i), plain.at(i, i)) << "neither diagonal is drawn";
        EXPECT_EQ(wired.at(i, 63 - i), plain.at(i, 63 - i));
    }
}

TEST(Render, PolygonsHaveNoInnerEdges) {
    PolygonMesh mesh;  // a hexagon perpendicular to the view along -x
    std::uint32_t ring[6];
    for (std::uint32_t i = 0; i < 6; ++i) {
        const float a = kPi / 3 * static_cast<float>(i);
        mesh.positions.push_back({0, std::cos(a), std::sin(a)});
        ring[i] = i;
    }
    mesh.add_face(ring);
    RenderOptions o = small();
    const Image plain = render({.mesh = &mesh}, o);
    o.wireframe = true;
    const Image wired = render({.mesh = &mesh}, o);
    for (int x = 12; x < 52; ++x) EXPECT_EQ(wired.at(x, 32), plain.at(x, 32)) << x;
    EXPECT_NE(wired.at(32, extent(plain).top + 1), plain.at(32, extent(plain).top + 1));
}

TEST(Render, InsideIsBlueAndOutsideRed) {
    const PolygonMesh mesh = cube(1);
    RenderOptions o = small();
    o.color = RenderColor::deviation;
    const auto middle = [&](float deviation) {
        const std::vector<float> values(8, deviation);
        return render({.mesh = &mesh, .deviation = values}, o).at(20, 32);
    };
    EXPECT_GT(middle(0.1f)[0], middle(0.1f)[2] + 40);
    EXPECT_GT(middle(-0.1f)[2], middle(-0.1f)[0] + 40);
    EXPECT_NEAR(middle(0.0f)[0], middle(0.0f)[2], 30);
    EXPECT_EQ(middle(0.5f), middle(0.1f)) << "the colours end at the range";
    // Unknown values are drawn in a different grey than 0.
    const auto unknown = middle(std::numeric_limits<float>::quiet_NaN());
    EXPECT_NE(unknown, middle(0.0f));
    EXPECT_NEAR(unknown[0], unknown[2], 30);
}

TEST(Render, MeasuredNodesAreBlueAndInferredOnesRed) {
    // A pole along x: its far half was measured.
    const Skeleton pole({NodeId{}, NodeId(0), NodeId(1)}, {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}},
                        {0.3f, 0.3f, 0.3f});
    const std::vector<float> evidence{0, 0, 1};
    const PolygonMesh mesh = cube(0.5f);
    RenderOptions o = small();
    o.color = RenderColor::evidence;
    o.samples = 16;
    for (const PolygonMesh* around : {static_cast<const PolygonMesh*>(nullptr), &mesh}) {
        const Image image = render({.mesh = around, .skeleton = &pole, .evidence = evidence}, o);
        EXPECT_GT(image.at(20, 32)[0], image.at(20, 32)[2] + 40) << (around != nullptr);
        EXPECT_GT(image.at(44, 32)[2], image.at(44, 32)[0] + 40) << (around != nullptr);
    }
}

TEST(Render, TheSignalColourIsMagenta) {
    const PolygonMesh mesh = cube(1);
    RenderOptions o = small();
    o.color = RenderColor::signal;
    const auto pixel = render({.mesh = &mesh}, o).at(20, 32);
    EXPECT_GT(pixel[0], pixel[1] + 60);
    EXPECT_GT(pixel[2], pixel[1] + 40);
}

TEST(Render, DeviationHasAScaleBar) {
    const PolygonMesh mesh = cube(1);
    RenderOptions o = small();
    o.camera.width = 400;
    o.camera.height = 200;  // the cube leaves both sides free
    o.color = RenderColor::deviation;
    const std::vector<float> values(8, 0.0f);
    const Image image = render({.mesh = &mesh, .deviation = values}, o);
    bool red = false, blue = false;
    for (int x = 320; x < 400; ++x) {
        for (int y = 0; y < 200; ++y) {
            const auto p = image.at(x, y);
            red = red || (p[3] == 255 && y < 100 && p[0] > p[2] + 100);
            blue = blue || (p[3] == 255 && y > 100 && p[2] > p[0] + 100);
        }
    }
    EXPECT_TRUE(red);
    EXPECT_TRUE(blue);
}

TEST(Render, DistanceFromAnotherMeshIsMeasuredPerPixel) {
    // The faces are large: the values at their corners do not determine those in the middle.
    const PolygonMesh drawn = cube(1);
    RenderOptions o = small();
    o.color = RenderColor::distance;
    o.distance_range = 0.1f;
    const auto middle = [&](const PolygonMesh& other) {
        const SurfaceTree surface(other);
        return render({.mesh = &drawn, .distance_to = &surface}, o).at(20, 32);
    };
    EXPECT_GT(middle(cube(0.9f))[0], middle(cube(0.9f))[2] + 40) << "outside of a smaller one";
    EXPECT_GT(middle(cube(1.1f))[2], middle(cube(1.1f))[0] + 40) << "inside of a larger one";
    EXPECT_NEAR(middle(cube(1))[0], middle(cube(1))[2], 30);
    EXPECT_EQ(middle(cube(0.5f)), middle(cube(0.9f))) << "the colours end at the range";
    // A slab that contains the middle of the visible face, and none of its corners.
    PolygonMesh slab = cube(1.05f);
    for (Vec3& p : slab.positions) p.z *= 0.2f;
    EXPECT_GT(middle(slab)[2], middle(slab)[0] + 20);
    const SurfaceTree surface(drawn);
    EXPECT_THROW(render({.distance_to = &surface}, o), InvalidInput);
    EXPECT_THROW(render({.mesh = &drawn}, o), InvalidInput);
    const PolygonMesh nothing;
    const SurfaceTree empty(nothing);
    EXPECT_THROW(render({.mesh = &drawn, .distance_to = &empty}, o), InvalidInput);
}

TEST(Render, DistancesRespectTheOrigins) {
    const PolygonMesh drawn = cube(1, {100, 0, 0}), other = cube(1.1f, {100, 0, 0});
    const SurfaceTree surface(other);
    RenderOptions o = small();
    o.color = RenderColor::distance;
    o.distance_range = 0.1f;
    const auto p = render({.mesh = &drawn, .distance_to = &surface}, o).at(20, 32);
    EXPECT_GT(p[2], p[0] + 40);
}

TEST(Render, DefaultRangeOfDistancesFollowsTheVertices) {
    // All corners are 0.1 outside per axis of the smaller cube: sqrt(3) / 10 away. Faces are 0.1 away.
    const PolygonMesh drawn = cube(1), other = cube(0.9f);
    const SurfaceTree surface(other);
    RenderOptions o = small();
    o.color = RenderColor::distance;
    const Image chosen = render({.mesh = &drawn, .distance_to = &surface}, o);
    o.distance_range = 0.1f * std::sqrt(3.0f);
    const Image given = render({.mesh = &drawn, .distance_to = &surface}, o);
    EXPECT_NEAR(chosen.at(20, 32)[0], given.at(20, 32)[0], 1);
    EXPECT_NEAR(chosen.at(20, 32)[2], given.at(20, 32)[2], 1);
    o.distance_range = 0.1f;
    EXPECT_LT(render({.mesh = &drawn, .distance_to = &surface}, o).at(20, 32)[2], given.at(20, 32)[2]);
}

TEST(Render, LengthsOfTheScaleHaveThreeDigits) {
    EXPECT_EQ(length_text(1.254e-3), "1.25 mm");
    EXPECT_EQ(length_text(0.0999), "99.9 mm");
    EXPECT_EQ(length_text(0.09997), "100 mm");
    EXPECT_EQ(length_text(0.9996), "1.00 m");
    EXPECT_EQ(length_text(9.996), "10.0 m");
    EXPECT_EQ(length_text(3.2e-7), "320 nm");
    EXPECT_EQ(length_text(1e6), "1000 km");
    EXPECT_EQ(length_text(1e-9), "1.00 nm");
}

/// One point in the middle of the image, one on each side.
PointCloud three_points() {
    PointCloud out;
    out.points.positions = {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}};
    return out;
}

TEST(Render, PointsAreBalls) {
    PointCloud cloud = three_points();
    for (const Vec3d origin : {Vec3d{}, Vec3d{500'000, 5e6, 100}}) {
        cloud.points.origin = origin;
        const Image image = render({.cloud = &cloud, .point_radius = 0.1f}, small());
        // The image is 2.2 m wide and 64 pixels except for the margins: 27 pixels per metre.
        EXPECT_EQ(image.at(32, 32)[3], 255);
        EXPECT_EQ(image.at(32, 32 + 5)[3], 0);
        EXPECT_EQ(image.at(32 + 13, 32)[3], 0);
        EXPECT_EQ(image.at(32 + 27, 32)[3], 255);
    }
}

TEST(Render, PointsHaveTheirColours) {
    PointCloud cloud = three_points();
    cloud.colors = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
    const Image image = render({.cloud = &cloud, .point_radius = 0.1f}, small());
    // Seen from +x, +y is to the right.
    EXPECT_GT(image.at(5, 32)[0], image.at(5, 32)[2] + 60);
    EXPECT_GT(image.at(32, 32)[1], image.at(32, 32)[0] + 60);
    EXPECT_GT(image.at(59, 32)[2], image.at(59, 32)[0] + 60);
}

TEST(Render, PointsAreColouredByDistanceOverAPaleMesh) {
    // Points 0.1 inside, on and 0.1 outside the visible face of a cube.
    const PolygonMesh mesh = cube(1);
    const SurfaceTree surface(mesh);
    PointCloud cloud;
    cloud.points.positions = {{1.1f, 0.9f, 0}, {1, 0, 0}, {0.9f, -1.05f, 0}};
    RenderOptions o = small();
    o.color = RenderColor::distance;
    o.distance_range = 0.05f;
    const RenderScene scene{.mesh = &mesh, .cloud = &cloud, .point_radius = 0.1f, .distance_to = &surface};
    const Image image = render(scene, o);
    EXPECT_GT(image.at(58, 32)[0], image.at(58, 32)[2] + 40);   // outside
    EXPECT_NEAR(image.at(32, 32)[0], image.at(32, 32)[2], 30);  // on it
    EXPECT_NEAR(image.at(45, 45)[0], image.at(45, 45)[2], 30);  // the mesh
    // Own distances have priority over those from the mesh, and their range is the 98 % quantile.
    cloud.distances = {-0.3f, 0.3f, 0.3f};
    o.distance_range = 0;
    const Image own = render(scene, o);
    EXPECT_GT(own.at(58, 32)[2], own.at(58, 32)[0] + 40);
    EXPECT_GT(own.at(32, 32)[0], own.at(32, 32)[2] + 40);
}

TEST(Render, RejectsInvalidPoints) {
    PointCloud cloud;
    const auto drawn = [&](float radius = 0.1f) {
        render({.cloud = &cloud, .point_radius = radius}, small());
    };
    EXPECT_THROW(drawn(), InvalidInput);  // none
    cloud = three_points();
    EXPECT_NO_THROW(drawn());
    EXPECT_THROW(drawn(0), InvalidInput);
    cloud.colors.resize(2);
    EXPECT_THROW(drawn(), InvalidInput);
    cloud = three_points();
    cloud.points.positions[1].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(drawn(), InvalidInput);
    cloud = three_points();
    RenderOptions o = small();
    o.color = RenderColor::distance;  // there is no other surface
    EXPECT_THROW(render({.cloud = &cloud, .point_radius = 0.1f}, o), InvalidInput);
}

TEST(Render, TheGroundReceivesAShadow) {
    const PolygonMesh mesh = cube(1);
    RenderOptions o = small();
    o.camera.elevation = 0.5f;
    o.camera.margin = 0.3f;
    const auto covered = [](const Image& image) {
        int count = 0;
        for (const auto& p : image.pixels) count += p[3] > 0 ? 1 : 0;
        return count;
    };
    const int without = covered(render({.mesh = &mesh}, o));
    o.ground = true;
    EXPECT_GT(covered(render({.mesh = &mesh}, o)), without + 50);
    o.camera.elevation = -0.5f;
    const int from_below = covered(render({.mesh = &mesh}, o));
    o.ground = false;
    EXPECT_EQ(from_below, covered(render({.mesh = &mesh}, o))) << "from below there is no ground to see";
}

TEST(Render, APlainBackgroundIsOpaque) {
    const PolygonMesh mesh = cube(1);
    RenderOptions o = small();
    o.transparent = false;
    EXPECT_EQ(opaque_pixels(render({.mesh = &mesh}, o)), 64 * 64);
}

TEST(Render, DegenerateSkeletonsAreDrawn) {
    // A zero-length segment, a ball inside another, and single nodes.
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId{}},
                     {{0, 0, 0}, {0, 0, 0}, {0, 0, 0.1f}, {2, 0, 0}}, {0.5f, 0.5f, 0.1f, 0.3f});
    EXPECT_GT(opaque_pixels(render({.skeleton = &s}, small())), 100);
    const Skeleton dot({NodeId{}}, {{3, 4, 5}}, {1e-4f});
    EXPECT_GT(opaque_pixels(render({.skeleton = &dot}, small())), 1000);
}

TEST(Render, GivenViewIsTheCameraForAnyOrigin) {
    // A ball, and a distant one, not hidden by the first, that changes the size and centre of the scene.
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const Skeleton balls({NodeId{}, NodeId{}}, {{1, 2, 3}, {1, 9, 4}}, {0.1f, 0.2f}, {1000, 0, 0});
        SketchView view =
            drawing_view(DrawingSide::front, projection == Projection::perspective ? 200 : 20, {32, 32});
        view.projection = projection;
        view.t = {-1001, 3, 8};  // 10 m before the first
        RenderOptions o = small();
        o.camera.width = o.camera.height = 64;
        o.ground = false;
        o.transparent = true;
        const Image image = render({.skeleton = &balls, .view = &view}, o);
        for (const Vec3d ball : {Vec3d{1001, 2, 3}, Vec3d{1001, 9, 4}}) {
            const PicturePoint at = project(view, ball);
            EXPECT_EQ(image.at(static_cast<int>(at.x), static_cast<int>(at.y))[3], 255);
        }
        // Discs of 2 and 200 * 0.2 / 17 = 2.4 pixels, or 2 and 4.
        const double area = std::numbers::pi * (projection == Projection::perspective ? 4 + 5.5 : 4 + 16);
        EXPECT_NEAR(opaque_pixels(image), area, 0.6 * area);
    }
    SketchView mirror = drawing_view(DrawingSide::front, 1, {});
    mirror.r[0] = {-1, 0, 0};
    const Skeleton dot({NodeId{}}, {{0, 0, 0}}, {1});
    EXPECT_THROW(render({.skeleton = &dot, .view = &mirror}, small()), InvalidInput);
}

TEST(Render, LookAtIsTheCentreAndZoomEnlarges) {
    const Skeleton balls({NodeId{}, NodeId{}}, {{-4, 0, 0}, {4, 0, 3}}, {0.2f, 0.2f}, {1000, 0, 0});
    RenderOptions o = small();
    o.camera.width = o.camera.height = 64;
    o.ground = false;
    o.transparent = true;
    const auto alpha_in_the_middle = [&] { return render({.skeleton = &balls}, o).at(32, 32)[3]; };
    EXPECT_EQ(alpha_in_the_middle(), 0);
    for (const Vec3d place : {Vec3d{996, 0, 0}, Vec3d{1004, 0, 3}}) {
        o.look_at = place;
        o.zoom = 1;
        EXPECT_EQ(alpha_in_the_middle(), 255);
        const int before = opaque_pixels(render({.skeleton = &balls}, o));
        o.zoom = 6;
        const int after = opaque_pixels(render({.skeleton = &balls}, o));
        EXPECT_NEAR(after, 36 * before, 12 * before) << "one of two balls may have left the picture";
    }
    o.camera.azimuth = 0;
    o.look_at = Vec3d{1e6, 0, 0};
    EXPECT_THROW(render({.skeleton = &balls}, o), InvalidInput) << "behind the camera";
}

TEST(Render, AcceptsADegenerateMesh) {
    PolygonMesh mesh;
    mesh.positions.assign(3, Vec3{1, 2, 3});
    const std::uint32_t face[3] = {0, 1, 2};
    mesh.add_face(face);
    EXPECT_EQ(opaque_pixels(render({.mesh = &mesh}, small())), 0);
}

TEST(Render, RejectsInvalidInput) {
    PolygonMesh mesh = cube(1);
    EXPECT_THROW(render({}, small()), InvalidInput);
    const PolygonMesh empty;
    EXPECT_THROW(render({.mesh = &empty}, small()), InvalidInput);
    RenderOptions o = small();
    o.samples = 0;
    EXPECT_THROW(render({.mesh = &mesh}, o), InvalidInput);
    o = small();
    o.camera.width = o.camera.height = 16384;
    EXPECT_THROW(render({.mesh = &mesh}, o), InvalidInput) << "too much memory";
    o = small();
    o.color = RenderColor::deviation;
    EXPECT_THROW(render({.mesh = &mesh}, o), InvalidInput) << "no deviations";
    o.color = RenderColor::evidence;
    const Skeleton tree = fork();
    EXPECT_THROW(render({.skeleton = &tree}, o), InvalidInput) << "no evidence";
    mesh.positions[3].y = std::numeric_limits<float>::infinity();
    EXPECT_THROW(render({.mesh = &mesh}, small()), InvalidInput);
}

TEST(Render, StopsWhenCancelled) {
    const PolygonMesh mesh = cube(1);
    std::stop_source source;
    Context ctx;
    ctx.stop = source.get_token();
    ctx.progress = [&](float) { source.request_stop(); };
    EXPECT_THROW(render({.mesh = &mesh}, small(), ctx), Cancelled);
}

TEST(Render, ProgressIncreasesToOne) {
    const PolygonMesh mesh = cube(1);
    float last = -1;
    Context ctx;
    ctx.progress = [&](float f) {
        EXPECT_GE(f, last);
        last = f;
    };
    render({.mesh = &mesh}, small(), ctx);
    EXPECT_FLOAT_EQ(last, 1);
}

}  // namespace
}  // namespace coppice
