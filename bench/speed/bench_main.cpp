// coppice_bench: measures the way from skeleton to quads, compared with OpenSubdiv, and prints Markdown; see
// docs/user/benchmarks.md.

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "machine.h"
#include "program.h"
#include "report.h"
#include "scene_bench.h"
#include "scenes.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;

struct Flags {
    std::vector<std::string> scenes = bench::default_scenes();
    bench::BenchOptions options;
    bench::ProgramFlags program;
};

// A new folder in the system's folder for temporary files, removed at the end.
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
                   "Synthetic trees by name (tree30k, tree3khard, ...) or skeleton files.");
    app.add_option("--levels", flags.options.levels, "Levels of subdivision.")->capture_default_str();
    app.add_option("--samples", flags.options.samples, "Rays per pixel of the image.")->capture_default_str();
    app.add_option("--largest-output", flags.options.largest_output,
                   "Maximum number of quads of meshes that are written and drawn.")
        ->capture_default_str();
    bench::add_program_flags(app, flags.program, flags.options.repeat, flags.options.seconds, "scene");
}

void run(Flags& flags) {
    const TemporaryFolder folder;
    flags.options.folder = folder.path();
    const Context ctx = flags.program.context();
    std::vector<bench::SceneResult> results;
    for (const std::string& scene : flags.scenes) {
        fmt::print(stderr, "{} ...\n", scene);
        results.push_back(bench::bench_scene(bench::make_scene(scene), flags.options, ctx));
    }
    const bench::RunInfo info{bench::machine_description(), flags.program.thread_count(),
                              flags.options.levels};
    bench::publish({.markdown = bench::markdown_report(info, results),
                    .json = bench::json_report(info, results),
                    .csv = bench::csv_report(info, results)},
                   flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures Coppice from skeleton to quads, compared with OpenSubdiv.", "coppice_bench");
    add_flags(app, flags);
    return bench::run_program(app, argc, argv, [&] { run(flags); });
}
