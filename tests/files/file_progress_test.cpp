#include "coppice/system/file_progress.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "coppice/io_mesh/reader.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

/// A text large enough for many steps, for files of every kind that is read line by line or row by row.
struct Sample {
    std::string name;
    std::string bytes;
    void (*read)(const std::string& bytes, const Context& ctx);
};

void read_point_bytes(const std::string& bytes, const Context& ctx) { parse_points(bytes, "p", ctx); }

template <MeshFormat format>
void read_mesh_bytes(const std::string& bytes, const Context& ctx) {
    parse_mesh(bytes, format, "m", ctx);
}

template <SkeletonFormat format>
void read_skeleton_bytes(const std::string& bytes, const Context& ctx) {
    parse_skeleton(bytes, "s", {.format = format}, ctx);
}

std::string repeated(const std::string& head, const std::string& row, int count) {
    std::string text = head;
    for (int i = 0; i < count; ++i) text += row;
    return text;
}

std::vector<Sample> samples() {
    constexpr int kRows = 3000;
    const Skeleton tree = random_tree(kRows, 1);
    const auto as = [&](SkeletonFormat format) { return encode_skeleton(tree, {.format = format}); };
    const std::string count = std::to_string(kRows);
    return {
        {"xyz", repeated("", "1 2 3\n", kRows), read_point_bytes},
        {"ply points",
         repeated("ply\nformat ascii 1.0\nelement vertex " + count +
                      "\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
                  "1 2 3\n", kRows),
         read_point_bytes},
        {"pcd",
         repeated("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS " + count +
                      "\nDATA ascii\n",
                  "1 2 3\n", kRows),
         read_point_bytes},
        {"obj", repeated("", "v 1 2 3\n", kRows) + "f 1 2 3\n", read_mesh_bytes<MeshFormat::obj>},
        {"off", repeated("OFF\n" + count + " 1 0\n", "1 2 3\n", kRows) + "3 0 1 2\n",
         read_mesh_bytes<MeshFormat::off>},
        {"stl",
         repeated("solid x\n",
                  "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                  "endloop\nendfacet\n",
                  kRows) +
             "endsolid x\n",
         read_mesh_bytes<MeshFormat::stl>},
        {"swc", as(SkeletonFormat::swc), read_skeleton_bytes<SkeletonFormat::swc>},
        {"cylinders", as(SkeletonFormat::cylinders), read_skeleton_bytes<SkeletonFormat::cylinders>},
        {"edge ply", as(SkeletonFormat::ply), read_skeleton_bytes<SkeletonFormat::ply>},
        {"lines", as(SkeletonFormat::obj), read_skeleton_bytes<SkeletonFormat::obj>},
        {"json", as(SkeletonFormat::json), read_skeleton_bytes<SkeletonFormat::json>},
    };
}

TEST(FileProgress, EveryReaderStopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    for (const Sample& sample : samples()) {
        EXPECT_NO_THROW(sample.read(sample.bytes, {})) << sample.name;
        EXPECT_THROW(sample.read(sample.bytes, {.stop = source.get_token()}), Cancelled) << sample.name;
    }
}

TEST(FileProgress, ReadersStopInTheMiddleAndProgressNeverDecreases) {
    for (const Sample& sample : samples()) {
        if (sample.name == "json") continue;  // its size is unknown until the end
        std::stop_source source;
        float last = 0;
        const auto watch = [&](float fraction) {
            EXPECT_GE(fraction, last) << sample.name;
            last = fraction;
            if (fraction > 0.4f) source.request_stop();
        };
        EXPECT_THROW(sample.read(sample.bytes, {.stop = source.get_token(), .progress = watch}), Cancelled)
            << sample.name;
        EXPECT_LT(last, 0.5f) << sample.name;
    }
}

TEST(FileProgress, ReadOfAnEmptyPipeStopsWhenCancelled) {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe(ends.data()), 0);
    std::stop_source source;
    std::jthread asks([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        source.request_stop();
    });
    const std::string path = "/dev/fd/" + std::to_string(ends[0]);
    EXPECT_THROW(read_file(path, kLargestFile, {.stop = source.get_token()}), Cancelled);
    close(ends[0]);
    close(ends[1]);
}

TEST(FileProgress, EveryWriterStopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    const Skeleton tree = random_tree(100, 1);
    for (const auto format : {SkeletonFormat::swc, SkeletonFormat::cylinders, SkeletonFormat::ply,
                              SkeletonFormat::obj, SkeletonFormat::json}) {
        EXPECT_THROW(encode_skeleton(tree, {.format = format}, {}, {.stop = source.get_token()}), Cancelled);
    }
}

}  // namespace
}  // namespace coppice
