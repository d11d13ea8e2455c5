#include "scenes.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "coppice/io_skeleton/reader.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::bench {
namespace {

struct MadeUp {
    std::string_view name;
    std::uint32_t segments;
};

constexpr std::array<MadeUp, 4> kMadeUp{
    {{"tree300", 300}, {"tree3k", 3000}, {"tree30k", 30000}, {"tree300k", 300000}}};
constexpr std::uint64_t kSeed = 1;

}  // namespace

std::vector<std::string> default_scenes() {
    return {"tree300", "tree300hard", "tree3k", "tree3khard", "tree30k", "tree300k"};
}

Scene make_scene(const std::string& name_or_file) {
    for (const MadeUp& tree : kMadeUp) {
        const std::string name(tree.name);
        if (name_or_file == name) return {name, random_tree(tree.segments, kSeed)};
        if (name_or_file == name + "hard") return {name_or_file, random_tree(tree.segments, kSeed, true)};
    }
    return {std::filesystem::path(name_or_file).stem().string(), read_skeleton(name_or_file).skeleton};
}

}  // namespace coppice::bench
