#include "coppice_c.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace {

struct DeleteTask {
    void operator()(coppice_task* task) const { coppice_task_free(task); }
};
struct DeleteObject {
    void operator()(coppice_object* object) const { coppice_object_free(object); }
};
using Task = std::unique_ptr<coppice_task, DeleteTask>;
using Object = std::unique_ptr<coppice_object, DeleteObject>;

// A fork of three segments.
constexpr std::array<double, 12> kPositions{0, 0, 0, 0, 0, 2, 0.7, 0, 3, -0.7, 0, 3};
constexpr std::array<double, 4> kRadii{0.1, 0.08, 0.05, 0.05};
constexpr std::array<std::int64_t, 4> kParents{-1, 0, 1, 1};

coppice_nodes fork_nodes() {
    return {kRadii.size(), kPositions.data(), kRadii.data(), nullptr, kParents.data()};
}

coppice_status run(const Task& task, const std::vector<const char*>& words) {
    return coppice_task_run(task.get(), words.size(), words.data());
}

Object make_fork(const Task& task) {
    const coppice_nodes nodes = fork_nodes();
    coppice_object* made = nullptr;
    EXPECT_EQ(coppice_skeleton_create(task.get(), &nodes, &made), COPPICE_OK);
    return Object(made);
}

/// Returns the surface of the fork.
Object mesh_fork(const Task& task, const char* levels) {
    const Object fork = make_fork(task);
    EXPECT_EQ(coppice_task_put(task.get(), "memory:fork.json", fork.get()), COPPICE_OK);
    EXPECT_EQ(run(task, {"mesh", "memory:fork.json", "-o", "memory:fork.glb", "--levels", levels}),
              COPPICE_OK)
        << coppice_task_message(task.get());
    return Object(coppice_task_take(task.get(), "memory:fork.glb"));
}

coppice_surface_arrays arrays_of(const Object& surface) {
    coppice_surface_arrays arrays{};
    EXPECT_EQ(coppice_surface_get(surface.get(), &arrays), COPPICE_OK);
    return arrays;
}

TEST(CInterface, MeshesArraysToArrays) {
    const Task task(coppice_task_create());
    const Object surface = mesh_fork(task, "2");
    ASSERT_NE(surface, nullptr);
    EXPECT_EQ(coppice_object_kind(surface.get()), COPPICE_SURFACE);
    const coppice_surface_arrays arrays = arrays_of(surface);
    EXPECT_EQ(arrays.face_size, 4u);
    EXPECT_EQ(arrays.corner_count, 4 * arrays.face_count);
    // A sphere of quads has twice as many edges as faces: V - 2 F + F = 2.
    EXPECT_EQ(arrays.vertex_count, arrays.face_count + 2);
    for (std::size_t i = 0; i < arrays.corner_count; ++i) ASSERT_LT(arrays.corners[i], arrays.vertex_count);
    std::vector<float> normals(3 * arrays.vertex_count);
    ASSERT_EQ(coppice_surface_normals(surface.get(), normals.data()), COPPICE_OK);
    for (std::size_t v = 0; v < arrays.vertex_count; ++v)
        ASSERT_NEAR(std::hypot(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]), 1, 1e-5);
    EXPECT_NE(std::string(coppice_task_report(task.get())).find("\"vertices\""), std::string::npos);
}

TEST(CInterface, ReturnsTheNodes) {
    const Task task(coppice_task_create());
    const Object fork = make_fork(task);
    coppice_skeleton_arrays arrays{};
    ASSERT_EQ(coppice_skeleton_get(fork.get(), &arrays), COPPICE_OK);
    ASSERT_EQ(arrays.count, 4u);
    EXPECT_STREQ(arrays.units, "m");
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(arrays.parents[i], kParents[i]);
        EXPECT_EQ(arrays.radii[i], static_cast<float>(kRadii[i]));
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_EQ(arrays.positions[3 * i + axis], static_cast<float>(kPositions[3 * i + axis]));
    }
    coppice_surface_arrays surface{};
    EXPECT_EQ(coppice_surface_get(fork.get(), &surface), COPPICE_WRONG_USAGE);
}

TEST(CInterface, PrintsAndChecks) {
    const Task task(coppice_task_create());
    const Object fork = make_fork(task), surface = mesh_fork(task, "2");
    ASSERT_EQ(coppice_task_put(task.get(), "memory:a.glb", surface.get()), COPPICE_OK);
    EXPECT_EQ(run(task, {"check", "memory:a.glb", "--skeleton", "memory:fork.json", "--json"}), COPPICE_OK)
        << coppice_task_message(task.get());
    EXPECT_NE(std::string(coppice_task_output(task.get())).find("\"watertight\": true"), std::string::npos);
    EXPECT_EQ(run(task, {"schema"}), COPPICE_OK);
    EXPECT_EQ(coppice_task_output(task.get())[0], '{');
}

TEST(CInterface, ExplainsErrors) {
    const Task task(coppice_task_create());
    EXPECT_EQ(run(task, {}), COPPICE_WRONG_USAGE);
    EXPECT_EQ(run(task, {"mehs"}), COPPICE_WRONG_USAGE);
    EXPECT_STREQ(coppice_task_message(task.get()), "there is no command 'mehs'; did you mean mesh?");
    EXPECT_EQ(run(task, {"mesh", "memory:a.json", "-o", "memory:a.glb"}), COPPICE_BAD_INPUT);
    EXPECT_STREQ(coppice_task_message(task.get()),
                 "there is no object 'memory:a.json' in memory; store it first");
    EXPECT_EQ(run(task, {"mesh", "/no/such/file.swc", "-o", "memory:a.glb"}), COPPICE_FILE_TROUBLE);
    EXPECT_EQ(coppice_task_take(task.get(), "memory:a.glb"), nullptr);
    const std::array<double, 4> radii{0.1, 0.1, 0.1, 0.1};
    std::array<double, 12> positions = kPositions;
    positions[4] = std::numeric_limits<double>::quiet_NaN();
    const coppice_nodes nodes{4, positions.data(), radii.data(), nullptr, kParents.data()};
    coppice_object* made = nullptr;
    EXPECT_EQ(coppice_skeleton_create(task.get(), &nodes, &made), COPPICE_BAD_INPUT);
    EXPECT_STREQ(coppice_task_message(task.get()),
                 "node 1 has the coordinate nan; use finite numbers from -1e15 to 1e15");
    EXPECT_EQ(made, nullptr);
}

TEST(CInterface, RefusesFacesWithoutVertices) {
    const Task task(coppice_task_create());
    const std::array<double, 9> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::array<std::int64_t, 3> corners{0, 1, 3};
    const coppice_faces faces{3, positions.data(), 1, 3, corners.data()};
    coppice_object* made = nullptr;
    EXPECT_EQ(coppice_surface_create(task.get(), &faces, &made), COPPICE_BAD_INPUT);
    EXPECT_STREQ(coppice_task_message(task.get()), "face 0 has the vertex 3; there are vertices from 0 to 2");
}

TEST(CInterface, CancelsByProgressAndContinues) {
    const Task task(coppice_task_create());
    int calls = 0;
    coppice_task_set_progress(
        task.get(),
        [](void* user, const char*, double) {
            ++*static_cast<int*>(user);
            return 1;
        },
        &calls);
    const Object fork = make_fork(task);
    ASSERT_EQ(coppice_task_put(task.get(), "memory:fork.json", fork.get()), COPPICE_OK);
    EXPECT_EQ(run(task, {"mesh", "memory:fork.json", "-o", "memory:fork.glb"}), COPPICE_INTERRUPTED);
    EXPECT_GT(calls, 0);
    coppice_task_set_progress(task.get(), nullptr, nullptr);
    EXPECT_EQ(run(task, {"mesh", "memory:fork.json", "-o", "memory:fork.glb"}), COPPICE_OK);
    coppice_task_cancel(task.get());
    EXPECT_EQ(run(task, {"mesh", "memory:fork.json", "-o", "memory:fork.glb"}), COPPICE_INTERRUPTED);
}

TEST(CInterface, ThreadsWorkAtTheSameTime) {
    const Task alone(coppice_task_create());
    const Object expected = mesh_fork(alone, "3");
    const coppice_surface_arrays a = arrays_of(expected);
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t) {
        threads.emplace_back([&] {
            const Task task(coppice_task_create());
            const Object surface = mesh_fork(task, "3");
            const coppice_surface_arrays b = arrays_of(surface);
            ASSERT_EQ(a.vertex_count, b.vertex_count);
            EXPECT_EQ(std::memcmp(a.positions, b.positions, 3 * sizeof(float) * a.vertex_count), 0);
        });
    }
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
