#include <fmt/format.h>

#include <algorithm>

#include "coppice/io_sketch/sketch_file.h"
#include "coppice/options/quantity.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

using namespace table;

const std::string kSketch = "sketch";

constexpr double kBytesOfByte = 64;  // per byte of the file: text, JSON, and matched points

Sketch read(const SceneCall& call) {
    const std::filesystem::path path = call.input("file");
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (!error) call.reserve(kBytesOfByte * static_cast<double>(size));
    const FolderSandbox* sandbox = call.sandbox();
    return sandbox ? parse_sketch(read_file(path, kLargestFile, call.context()), call.text("file"), *sandbox)
                   : read_sketch(path, call.context());
}

SceneOutcome outcome(const SceneCall& call, SketchResult result) {
    const auto refused = [](const BranchFit& fit) { return !fit.refused.empty(); };
    const std::size_t found =
        result.branches.size() - static_cast<std::size_t>(std::ranges::count_if(result.branches, refused));
    const std::size_t nodes = result.skeleton.size();
    SceneOutcome out = makes_tree(call.text("tree"), std::move(result.skeleton));
    out.text = fmt::format("{} nodes of {} {}\n", grouped(nodes), grouped(found),
                           found == 1 ? "branch" : "branches");
    for (const BranchFit& fit : result.branches) {
        if (refused(fit)) out.text += fmt::format("left out: {}\n", fit.refused);
    }
    return out;
}

}  // namespace

SceneCommand sketch_command() {
    SceneCommand c{.name = "sketch",
                   .group = "Trees",
                   .help = "Reconstruct a skeleton from strokes drawn over at least two images of a tree."};
    c.example = "sketch fork fork.sketch.json";
    c.makes = ObjectKind::skeleton;
    c.arguments = {new_name("tree", "Name of the new skeleton."),
                   file("file", ArgumentType::input_file, "Sketch file (.sketch.json).")};
    add_options(c.arguments, SketchOptions{}, kSketch);
    c.run = [](const SceneCall& call) {
        const Sketch drawn = read(call);
        return outcome(call, reconstruct(drawn, call.options<SketchOptions>(kSketch), call.text("file"),
                                         call.context()));
    };
    return c;
}

}  // namespace coppice
