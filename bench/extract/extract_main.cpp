// coppice_extract_bench: creates meshes and clouds of known skeletons, extracts the skeletons with Coppice or
// another program, and prints the quality as Markdown; see docs/user/comparing.md.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "coppice/io_skeleton/writer.h"
#include "coppice/system/file.h"
#include "extract_bench.h"
#include "machine.h"

namespace {

using namespace coppice;
namespace fs = std::filesystem;

struct Flags {
    std::vector<std::string> scenes = bench::default_truth_scenes();
    std::string command;
    fs::path folder, markdown;
    unsigned threads = 2;
    bool write_only = false;
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_option("scenes", flags.scenes,
                   "Scenes TREE:KIND; TREE is tree300, tree3k, tree30k or a skeleton file, KIND one of mesh, "
                   "coarse, noise, holes, decimated, cloud, scan.");
    app.add_option("--command", flags.command,
                   "Command of another extraction program, with {in} and {out} for the files; without it "
                   "Coppice is measured.");
    CLI::Option* const folder =
        app.add_option("--folder", flags.folder, "Folder for inputs, truths and results of the command.");
    app.get_option("--command")->needs(folder);
    app.add_flag("--write-only", flags.write_only,
                 "Only write inputs and truths to the folder, without measurements.")
        ->needs(folder)
        ->excludes(app.get_option("--command"));
    app.add_option("--threads", flags.threads, "Number of threads for creation and comparison; 0 uses all.")
        ->capture_default_str();
    app.add_option("--markdown", flags.markdown, "Also write the table to this file.");
}

void run(const Flags& flags) {
    if (!flags.folder.empty()) fs::create_directories(flags.folder);
    const Context ctx{.threads = flags.threads, .stop = {}, .progress = {}};
    const auto extract = flags.command.empty() ? bench::own_extractor(ctx)
                                               : bench::program_extractor(flags.command, flags.folder, ctx);
    std::vector<bench::TruthResult> results;
    for (const std::string& name : flags.scenes) {
        fmt::print(stderr, "{} ...\n", name);
        const bench::TruthScene scene = bench::make_truth_scene(name, ctx);
        if (!flags.folder.empty()) {
            fs::path truth = bench::write_input(scene, flags.folder, ctx);
            write_skeleton(truth.replace_extension(".truth.swc"), scene.truth);
        }
        if (flags.write_only) continue;
        results.push_back(bench::bench_extraction(scene, extract, ctx));
    }
    if (flags.write_only) return;
    const unsigned threads = flags.threads == 0 ? std::thread::hardware_concurrency() : flags.threads;
    const std::string table = bench::extract_markdown(results, threads, bench::machine_description());
    fmt::print("{}", table);
    if (flags.markdown.empty()) return;
    write_file(flags.markdown, table);
}

}  // namespace

int main(int argc, char** argv) {
    Flags flags;
    CLI::App app("Measures the quality of skeletons extracted from meshes and clouds of known trees.");
    add_flags(app, flags);
    CLI11_PARSE(app, argc, argv);
    try {
        run(flags);
    } catch (const std::exception& error) {
        fmt::print(stderr, "coppice_extract_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
