// coppice_bench: measures from skeleton to quads, beside OpenSubdiv, and prints Markdown; see
// docs/user/benchmarks.md.

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "coppice/io/file.h"
#include "machine.h"
#include "report.h"
#include "scene_bench.h"
#include "scenes.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;

struct Flags {
    std::vector<std::string> scenes = bench::default_scenes();
    bench::BenchOptions options;
    unsigned threads = 2;
    fs::path json, csv, markdown;
};

// A folder of its own below the system's folder for temporary files, removed at the end.
class TemporaryFolder {
  public:
    TemporaryFolder() : path_(fs::temp_directory_path() / fmt::format("coppice_bench_{}", getpid())) {
        fs::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_option("scenes", flags.scenes,
                   "made-up trees by name (tree30k, tree3khard, ...) or skeleton files");
    app.add_option("--threads", flags.threads, "threads to use; 0 takes all")->capture_default_str();
    app.add_option("--levels", flags.options.levels, "levels of subdivision")->capture_default_str();
    app.add_option("--repeat", flags.options.repeat, "timed runs per scene")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--seconds", flags.options.seconds,
                   "for the timed runs of a scene; at least three are made")
        ->capture_default_str();
    app.add_option("--samples", flags.options.samples, "rays per pixel of the picture")
        ->capture_default_str();
    app.add_option("--largest-output", flags.options.largest_output,
                   "larger meshes, in quads, are not written or drawn")
        ->capture_default_str();
    app.add_option("--json", flags.json, "write all samples to this file");
    app.add_option("--csv", flags.csv, "write a line per scene and measure to this file");
    app.add_option("--markdown", flags.markdown, "write the tables to this file as well");
}

void write_text(const fs::path& path, const std::string& text) {
    if (path.empty()) return;
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

void run(Flags& flags) {
    const TemporaryFolder folder;
    flags.options.folder = folder.path();
    const Context ctx{.threads = flags.threads, .stop = {}, .progress = {}};
    std::vector<bench::SceneResult> results;
    for (const std::string& scene : flags.scenes) {
        fmt::print(stderr, "{} ...\n", scene);
        results.push_back(bench::bench_scene(bench::make_scene(scene), flags.options, ctx));
    }
    const unsigned threads = flags.threads == 0 ? std::thread::hardware_concurrency() : flags.threads;
    const bench::RunInfo info{bench::machine_description(), threads, flags.options.levels};
    const std::string tables = bench::markdown_report(info, results);
    fmt::print("{}", tables);
    write_text(flags.markdown, tables);
    write_text(flags.json, bench::json_report(info, results));
    write_text(flags.csv, bench::csv_report(info, results));
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures Coppice from skeleton to quads, beside OpenSubdiv");
    add_flags(app, flags);
    CLI11_PARSE(app, argc, argv);
    try {
        run(flags);
    } catch (const std::exception& error) {
        fmt::print(stderr, "coppice_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
