#include "extract_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/scan.h"
#include "coppice/skeleton/measure.h"
#include "damage.h"
#include "scenes.h"

namespace coppice::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr float kCloudNoise = 0.001f;  // [m]

PolygonMesh closed_mesh(const Skeleton& truth, int levels, const Context& ctx) {
    MeshOptions options;
    options.levels = levels;
    return to_polygons(mesh_skeleton(truth, options, ctx).quads().mesh);
}

PointSet sample_cloud(const Skeleton& truth, ScanPattern pattern, const Context& ctx) {
    const SkeletonMeasures m = measure(truth);
    const ScanOptions options{.pattern = pattern,
                              .points = m.segments < 10'000 ? 100'000 : 500'000,
                              .positions = 6,
                              .distance = 2 * m.bounds.diagonal(),
                              .noise = kCloudNoise,
                              .seed = static_cast<int>(kSeed)};
    return scan(closed_mesh(truth, 2, ctx), options, ctx);
}

using Make = std::variant<PolygonMesh, PointSet> (*)(const Skeleton&, const Context&);
struct Kind {
    std::string_view name;
    Make make;
};

constexpr std::array<Kind, 7> kKinds{{
    {"mesh",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return closed_mesh(s, 2, ctx);
     }},
    {"coarse",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return closed_mesh(s, 1, ctx);
     }},
    {"noise",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return roughened(closed_mesh(s, 2, ctx), 0.1 * measure(s).min_radius, kSeed);
     }},
    {"holes",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return with_holes(closed_mesh(s, 2, ctx), s.size() / 50 + 1, 5 * measure(s).min_radius, kSeed);
     }},
    {"decimated",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return decimated(closed_mesh(s, 2, ctx), 1.0 / 3, kSeed);
     }},
    {"cloud",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return sample_cloud(s, ScanPattern::uniform, ctx);
     }},
    {"scan",
     [](const Skeleton& s, const Context& ctx) -> decltype(TruthScene::input) {
         return sample_cloud(s, ScanPattern::scanner, ctx);
     }},
}};

}  // namespace

std::size_t TruthScene::input_size() const {
    if (is_cloud()) return std::get<PointSet>(input).size();
    const auto& mesh = std::get<PolygonMesh>(input);
    std::vector<char> used(mesh.positions.size());
    for (const std::uint32_t v : mesh.corners) used[v] = 1;
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
}

std::vector<std::string> default_truth_scenes() {
    std::vector<std::string> names;
    for (const char* tree : {"tree300", "tree3k"}) {
        for (const char* kind : {"mesh", "coarse", "noise", "holes", "decimated"})
            names.push_back(fmt::format("{}:{}", tree, kind));
    }
    for (const char* tree : {"tree3k", "tree30k"}) {
        for (const char* kind : {"cloud", "scan"}) names.push_back(fmt::format("{}:{}", tree, kind));
    }
    return names;
}

std::vector<std::string_view> truth_kinds() {
    std::vector<std::string_view> names;
    for (const Kind& kind : kKinds) names.push_back(kind.name);
    return names;
}

TruthScene make_truth_scene(const std::string& name, const Context& ctx) {
    const std::size_t colon = name.rfind(':');
    const std::string tree = name.substr(0, colon), kind = colon < name.size() ? name.substr(colon + 1) : "";
    const auto found = std::ranges::find(kKinds, kind, &Kind::name);
    if (found == kKinds.end()) {
        throw InvalidInput(fmt::format("'{}' is not a scene; write TREE:KIND, where KIND is one of {}", name,
                                       fmt::join(truth_kinds(), ", ")));
    }
    Scene scene = make_scene(tree);
    auto input = found->make(scene.skeleton, ctx);
    return {fmt::format("{}:{}", scene.name, kind), std::move(scene.skeleton), std::move(input)};
}

}  // namespace coppice::bench
