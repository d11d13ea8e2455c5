#include "coppice/scene/keyframes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace coppice {
namespace {

// A trunk with one branch of two segments along x.
Skeleton fork() {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
            {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}, {1, 0, 2}, {2, 0, 2}},
            {0.2f, 0.2f, 0.15f, 0.1f, 0.1f}};
}

std::string error_of(std::string_view text) {
    try {
        const Keyframes keys(fork(), text, "k.txt");
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return "none";
}

// Returns the azimuth [degrees] of the end of the branch.
double azimuth(const Pose& p) {
    return std::atan2(double{p.positions[4].y}, double{p.positions[4].x}) * 180 / std::numbers::pi;
}

TEST(Keyframes, InterpolateAnglesAndPreserveLengths) {
    const Keyframes keys(fork(), "0: rotate 3 -60\n2 linear: rotate 3 60\n", "k.txt");
    EXPECT_EQ(keys.end(), 2);
    EXPECT_NEAR(azimuth(keys.at(0)), -60, 1e-3);
    EXPECT_NEAR(azimuth(keys.at(0.5)), -30, 1e-3);
    EXPECT_NEAR(azimuth(keys.at(1)), 0, 1e-3);
    EXPECT_NEAR(azimuth(keys.at(2)), 60, 1e-3);
    EXPECT_NEAR(azimuth(keys.at(9)), 60, 1e-3);
    for (double t = 0; t < 2; t += 0.1) {
        const Pose p = keys.at(t);
        EXPECT_NEAR(double{distance(p.positions[3], p.positions[4])}, 1, 1e-5);
    }
}

TEST(Keyframes, ContainRollsAboutTheOwnAxis) {
    const Keyframes keys(fork(), "1: rotate 3 90 about=own\n", "k.txt");
    const Pose p = keys.at(1);
    EXPECT_LT(distance(p.positions[4], {2, 0, 2}), 1e-5f);
    const Vec3d up = p.turns[4](Vec3d{0, 0, 1});
    EXPECT_NEAR(up.z, 0, 1e-6);
    EXPECT_NEAR(std::abs(up.y), 1, 1e-6);
    EXPECT_EQ(p.turns[2], Rotation{});
}

TEST(Keyframes, UseTheGivenEasing) {
    const Keyframes keys(fork(), "0: rest\n1: rotate 3 40\n2 hold: rest\n3s in: rotate 3 40", "k.txt");
    EXPECT_NEAR(azimuth(keys.at(0.25)), 40 * (0.0625 * 2.5), 1e-3);
    EXPECT_NEAR(azimuth(keys.at(1.9)), 40, 1e-3);
    EXPECT_NEAR(azimuth(keys.at(2)), 0, 1e-3);
    EXPECT_NEAR(azimuth(keys.at(2.5)), 10, 1e-3);
}

TEST(Keyframes, StartFromTheRestPose) {
    const Keyframes keys(fork(), "2 linear: translate roots 4 0 0", "k.txt");
    EXPECT_NEAR(double{keys.at(1).positions[0].x}, 2, 1e-6);
}

TEST(Keyframes, InterpolateScalesGeometricallyAndMovesLinearly) {
    const Keyframes keys(fork(), "0: rest\n2 linear: scale 3 4; move 2 to=1,0,4", "k.txt");
    const Pose half = keys.at(1);
    EXPECT_NEAR(double{half.positions[3].x}, 2, 1e-5);
    EXPECT_NEAR(double{half.radii[4]}, 0.2, 1e-5);
    EXPECT_NEAR(double{half.positions[2].x}, 0.5, 1e-5);
}

TEST(Keyframes, InterpolateOtherEditsLinearly) {
    const Keyframes keys(fork(), "0: rest\n2 linear: radius 4 0.4", "k.txt");
    EXPECT_NEAR(double{keys.at(1).radii[4]}, 0.2, 1e-5);
}

TEST(Keyframes, EvaluateSelectionsInTheRestPose) {
    // The second edit finds the branch at its position before the first edit, and reverses that edit.
    const Keyframes keys(fork(), "1: rotate 3 90; rotate near(1,0,2) -90", "k.txt");
    EXPECT_LT(distance(keys.at(1).positions[3], {1, 0, 2}), 1e-5f);
}

TEST(Keyframes, ReportErrors) {
    EXPECT_EQ(error_of("2: rest\n1: rest"), "k.txt:2: the key at 1 s does not come after the one at 2 s");
    EXPECT_EQ(error_of("1 bouncy: rest"),
              "k.txt:1: there is no easing 'bouncy'; use one of smooth, linear, in, out, hold");
    EXPECT_NE(error_of("1: rotate 99 5").find("k.txt:1: there is no node 99"), std::string::npos)
        << error_of("1: rotate 99 5");
    EXPECT_NE(error_of("1: delete 3").find("delete adds or removes nodes or changes their parents"),
              std::string::npos);
    EXPECT_NE(error_of("1: sphere s 1").find("'sphere' is not an edit"), std::string::npos);
    EXPECT_NE(error_of("x: rest").find("'x' is not a number of seconds from 0 to 3600"), std::string::npos);
    EXPECT_NE(error_of("rotate 3 5").find("k.txt:1: a key is seconds, a colon and edits"), std::string::npos);
    EXPECT_EQ(error_of("# nothing\n"), "k.txt: there is no key");
}

}  // namespace
}  // namespace coppice
