// coppice_studio_bench: drags branches of trees and a part of a crown as the studio's page does, without the
// page, and prints as Markdown the time of the engine for each frame of the drag and for its end.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/options/json.h"
#include "coppice/studio/session.h"
#include "machine.h"
#include "program.h"

namespace {

using namespace coppice;

struct Flags {
    bench::ProgramFlags program;
    std::vector<std::string> trees;
    int frames = 60;
};

struct Costs {
    std::string what;
    std::vector<double> frame;  ///< [s] of each preview
    double bytes = 0;           ///< of each frame
    double end = 0;             ///< [s] the command, and the display of its result
    double undo = 0;            ///< [s] the same for undoing it
};

/// A studio that counts the bytes that it sends.
class Studio {
  public:
    Studio(const std::filesystem::path& folder, const Context& ctx)
        : ctx_(ctx),
          session_(options_in(folder), blobs_, [this](const std::string&, const StudioBytes& frame) {
              bytes_ += static_cast<double>(frame->size());
          }) {}

    Json ask(const Json& request) {
        Json reply = session_.answer("bench", request, ctx_);
        if (!reply["ok"].get<bool>()) throw InvalidInput(reply["error"].get<std::string>());
        return reply;
    }
    void run(const std::string& line) { ask({{"type", "run"}, {"line", line}}); }
    double bytes() const { return bytes_; }
    std::size_t fetch(const Json& key) {
        return key.is_null() ? 0 : blobs_.get(key.get<std::string>())->size();
    }

  private:
    static StudioOptions options_in(const std::filesystem::path& folder) {
        StudioOptions options;
        options.scene.folder = folder;
        return options;
    }

    Context ctx_;
    BlobStore blobs_;
    double bytes_ = 0;
    StudioSession session_;
};

/// Returns nodes with about this number of descendants.
std::uint32_t node_with(const Skeleton& tree, std::size_t wanted) {
    std::vector<std::size_t> sizes(tree.size(), 1);
    for (std::uint32_t i = tree.size(); i-- > 1;) {
        if (const NodeId parent = tree.parent(NodeId(i))) sizes[parent.index()] += sizes[i];
    }
    const auto off = [&](std::size_t size) { return size > wanted ? size - wanted : wanted - size; };
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < tree.size(); ++i) {
        if (off(sizes[i]) < off(sizes[best])) best = i;
    }
    return best;
}

Costs drag_branch(const std::string& file, std::size_t nodes, bool surface, const Flags& flags) {
    const std::filesystem::path path = file;
    Studio studio(path.parent_path(), flags.program.context());
    studio.run(fmt::format("loadtree t \"{}\"", path.filename().string()));
    const Skeleton tree = read_skeleton(path).skeleton;
    const std::uint32_t node = node_with(tree, nodes);
    const Json about{{"kind", "skeleton"}, {"name", "t"}};
    Json show{{"type", "show"}, {"kind", "skeleton"}, {"name", "t"}, {"form", surface ? "surface" : "axes"}};
    Json shown = studio.ask(show);
    Costs costs{.what = fmt::format("{}, {} nodes dragged{}", path.stem().string(), nodes,
                                    surface ? "" : ", axes only")};
    const auto line = [&](int i) {
        return fmt::format("edit rotate t {} {:.3f}", node, 10 * std::sin(0.2 * i));
    };
    const double bytes = studio.bytes();
    for (int i = 1; i <= flags.frames; ++i) {
        Json request{{"type", "preview"}, {"seq", i}, {"line", line(i)}, {"about", about}};
        if (surface) {
            request["surface"] = Json::object();
            // States of the only surface are counted, one for every preview.
            request["have"] = shown["number"].get<int>() + i - 1;
        }
        const bench::Clock clock;
        studio.ask(request);
        costs.frame.push_back(clock.seconds());
    }
    costs.bytes = (studio.bytes() - bytes) / flags.frames;
    const auto change = [&](const Json& request, int number) {
        if (surface) show["have"] = shown["number"].get<int>() + number;
        const bench::Clock clock;
        studio.ask(request);
        studio.fetch(studio.ask(show)["key"]);
        return clock.seconds();
    };
    costs.end = change({{"type", "run"}, {"line", line(flags.frames)}, {"about", about}}, flags.frames);
    costs.undo = change({{"type", "undo"}}, flags.frames);
    return costs;
}

Costs drag_solid(int parts, const Flags& flags) {
    Studio studio(std::filesystem::temp_directory_path(), flags.program.context());
    std::string names;
    for (int i = 0; i < parts; ++i) {
        const double angle = 2.4 * i;
        studio.run(fmt::format("sphere part{} radius=1 center={:.3f},{:.3f},{:.3f}", i, std::cos(angle),
                               std::sin(angle), 0.3 * i));
        names += fmt::format(" part{}", i);
    }
    studio.run("blend" + names + " crown");
    const Json about{{"kind", "solid"}, {"name", "part7"}};
    Costs costs{.what = fmt::format("a part of a crown of {}", parts)};
    const double bytes = studio.bytes();
    for (int i = 1; i <= flags.frames; ++i) {
        const bench::Clock clock;
        studio.ask({{"type", "preview"},
                    {"seq", i},
                    {"line", fmt::format("translate part7 {:.3f} 0 0", 0.02 * i)},
                    {"about", about}});
        costs.frame.push_back(clock.seconds());
    }
    costs.bytes = (studio.bytes() - bytes) / flags.frames;
    const auto change = [&](const Json& request) {
        const bench::Clock clock;
        studio.ask(request);
        for (const char* name : {"part7", "crown"})
            studio.fetch(
                studio.ask({{"type", "show"}, {"kind", "solid"}, {"name", name}, {"form", "fine"}})["key"]);
        return clock.seconds();
    };
    costs.end = change({{"type", "run"}, {"line", "translate part7 1 0 0"}, {"about", about}});
    costs.undo = change({{"type", "undo"}});
    return costs;
}

void run(const Flags& flags) {
    std::vector<Costs> all;
    for (const std::string& tree : flags.trees) {
        const std::size_t size = read_skeleton(tree).skeleton.size();
        for (const std::size_t part : {std::size_t{20}, size / 30, size / 6})
            all.push_back(drag_branch(tree, part, true, flags));
        all.push_back(drag_branch(tree, size / 6, false, flags));
    }
    all.push_back(drag_solid(20, flags));
    std::string out = fmt::format(
        "{}\n\n| dragged | median ms per frame | slowest ms | KB per frame | ms at the end | ms to undo |\n| "
        "--- | --: | --: | --: | --: | --: |\n",
        bench::machine_description());
    Json json = Json::array();
    for (Costs& c : all) {
        const double slowest = *std::ranges::max_element(c.frame), middle = median(c.frame);
        out += fmt::format("| {} | {:.2f} | {:.2f} | {:.0f} | {:.1f} | {:.1f} |\n", c.what, 1e3 * middle,
                           1e3 * slowest, c.bytes / 1024, 1e3 * c.end, 1e3 * c.undo);
        json.push_back({{"dragged", c.what},
                        {"median_s", middle},
                        {"slowest_s", slowest},
                        {"bytes", c.bytes},
                        {"end_s", c.end},
                        {"undo_s", c.undo}});
    }
    bench::publish({.markdown = out, .json = json.dump(1), .csv = {}}, flags.program);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Drags branches and solids as the studio does, and measures every frame."};
    Flags flags;
    app.add_option("--threads", flags.program.threads, "Number of threads; 0 uses all.")
        ->capture_default_str();
    app.add_option("--frames", flags.frames, "Number of frames of every drag.")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--json", flags.program.json, "Write the figures to this file.");
    app.add_option("--markdown", flags.program.markdown, "Also write the table to this file.");
    app.add_option("--tree", flags.trees, "Skeletons with branches to drag.");
    return bench::run_program(app, argc, argv, [&] { run(flags); });
}
