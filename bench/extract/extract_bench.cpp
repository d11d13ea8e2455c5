#include "extract_bench.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>

#include "clock.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/reader.h"
#include "machine.h"

namespace coppice::bench {
namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
        text.replace(at, from.size(), to);
}

std::string quoted(const std::filesystem::path& path) {
    std::string text = path.string();
    replace_all(text, "'", "'\\''");
    return "'" + text + "'";
}

/// Runs a shell command; returns the maximum memory of it or one of its children.
std::uint64_t run_command(const std::string& command) {
    const pid_t child = fork();
    if (child < 0) throw IoError("cannot start a process for the command");
    if (child == 0) {
        dup2(STDERR_FILENO, STDOUT_FILENO);  // standard output is used for the table
        execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) != child) throw IoError("lost track of the command");
    if (WIFSIGNALED(status))
        throw InvalidInput(fmt::format("the command was terminated by signal {}", WTERMSIG(status)));
    if (WEXITSTATUS(status) != 0)
        throw InvalidInput(fmt::format("the command exited with code {}", WEXITSTATUS(status)));
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string file_name(const TruthScene& scene) {
    std::string name = scene.name;
    std::ranges::replace(name, ':', '_');
    return name;
}

void add_row(std::string& out, const std::vector<std::string>& cells) {
    fmt::format_to(std::back_inserter(out), "| {} |\n", fmt::join(cells, " | "));
}

std::string share(double percent) { return fmt::format("{:.1f}", percent); }

}  // namespace

std::filesystem::path write_input(const TruthScene& scene, const std::filesystem::path& folder,
                                  const Context& ctx) {
    std::filesystem::path file = folder / (file_name(scene) + ".ply");
    if (scene.is_cloud()) {
        write_points(file, std::get<PointSet>(scene.input), ctx);
    } else {
        write_mesh(file, std::get<PolygonMesh>(scene.input), {}, ctx);
    }
    return file;
}

Extractor program_extractor(const std::string& command, const std::filesystem::path& folder,
                            const Context& ctx) {
    return [=](const TruthScene& scene) -> Extraction {
        const std::filesystem::path in = write_input(scene, folder, ctx);
        const std::filesystem::path out = folder / (file_name(scene) + "_found.swc");
        std::string line = command;
        replace_all(line, "{in}", quoted(in));
        replace_all(line, "{out}", quoted(out));
        const Clock clock;
        const std::uint64_t peak = run_command(line);
        const double seconds = clock.seconds();
        return {read_skeleton(out).skeleton, seconds, peak};
    };
}

Extractor own_extractor(const Context& ctx) {
    return [=](const TruthScene& scene) -> Extraction {
        reset_peak();
        const std::size_t before = resident_bytes();
        const Clock clock;
        ExtractResult found = [&]() -> ExtractResult {
            if (scene.is_cloud()) return extract_from_cloud(std::get<PointSet>(scene.input), {}, ctx);
            return extract_from_mesh(std::get<PolygonMesh>(scene.input), {}, ctx);
        }();
        const double seconds = clock.seconds();
        const std::size_t peak = peak_resident_bytes();
        return {std::move(found.skeleton), seconds, peak > before ? peak - before : 0};
    };
}

TruthResult bench_extraction(const TruthScene& scene, const Extractor& extract, const Context& ctx) {
    TruthResult result{.scene = scene.name, .input_size = scene.input_size(), .cloud = scene.is_cloud()};
    try {
        const Extraction found = extract(scene);
        result.nodes = found.skeleton.size();
        result.seconds = found.seconds;
        result.peak_bytes = found.peak_bytes;
        result.match = compare(scene.truth, found.skeleton, {}, ctx);
    } catch (const Error& error) {
        result.failure = error.what();
    }
    return result;
}

std::string extract_markdown(const std::vector<TruthResult>& results, unsigned threads,
                             const std::string& machine) {
    std::string out = fmt::format("Machine: {}. Threads: {}.\n\n", machine, threads);
    const std::vector<std::string> head{"scene",
                                        "input",
                                        "s",
                                        "peak MiB",
                                        "nodes",
                                        "length",
                                        "volume",
                                        "covered %",
                                        "true %",
                                        "off-axis, r",
                                        "tips in 2 r, %",
                                        "tips matched %",
                                        "junctions %",
                                        "radius error, median %",
                                        "mean %",
                                        "p95 %"};
    add_row(out, head);
    add_row(out, std::vector<std::string>(head.size(), "---"));
    for (const TruthResult& r : results) {
        const std::string input = fmt::format("{} {}", r.input_size, r.cloud ? "points" : "V");
        if (!r.failure.empty()) {
            add_row(out, {r.scene, input, r.failure});
            continue;
        }
        const SkeletonMatch& m = r.match;
        add_row(out, {r.scene, input, fmt::format("{:.2f}", r.seconds), fmt::to_string(r.peak_bytes >> 20),
                      fmt::to_string(r.nodes), fmt::format("{:.3f}", m.length.ratio()),
                      fmt::format("{:.3f}", m.volume.ratio()), share(m.covered_percent),
                      share(m.true_percent), fmt::format("{:.2f}", m.off_axis), share(m.tips_reached),
                      share(m.tips.percent()), share(m.junctions.percent()), share(100 * m.radius_error.p50),
                      share(100 * m.radius_error.mean), share(100 * m.radius_error.p95)});
    }
    return out;
}

}  // namespace coppice::bench
