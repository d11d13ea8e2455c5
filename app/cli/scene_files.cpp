#include "scene_files.h"

#include <fmt/format.h>

#include <array>

#include "coppice/io/file.h"

namespace coppice::cli {
namespace {

/// The command of a line, to call its stage by.
std::string stage_name(const std::string& line) {
    const auto words = scene_words(line);
    return words.empty() ? "nothing" : words.front().text;
}

}  // namespace

void run_scene_file(Run& run, Scene& scene, const std::filesystem::path& path) {
    const std::string text =
        run.stage("read", [&](const Context&) { return read_file(path, kLargestScene); });
    scene.set_folder(path.parent_path());
    for (const SceneLine& line : scene_lines(text, path.string())) {
        const std::string place = fmt::format("{}:{}", path.string(), line.number);
        std::string stage;
        try {
            stage = stage_name(line.text);
        } catch (const InvalidInput&) {
            stage = "nothing";  // the scene says what is wrong, and where
        }
        const std::string said =
            run.stage(stage, [&](const Context& ctx) { return scene.run(line.text, place, ctx); });
        fmt::print("{}", said);
    }
}

std::optional<std::vector<const SceneCommand*>> commands_of_files(
    std::span<const std::filesystem::path> scenes) {
    std::vector<const SceneCommand*> all;
    try {
        for (const auto& path : scenes) {
            const auto commands = commands_of(scene_lines(read_file(path, kLargestScene), path.string()));
            if (!commands) return std::nullopt;
            all.insert(all.end(), commands->begin(), commands->end());
        }
    } catch (const Error&) {
        return std::nullopt;
    }
    return all;
}

Solid solid_of_scene(Run& run, const std::string& named) {
    std::string file = named, name;
    std::error_code ignored;
    if (const std::size_t colon = named.rfind(':');
        colon != std::string::npos && !std::filesystem::exists(named, ignored)) {
        file = named.substr(0, colon);
        name = named.substr(colon + 1);
    }
    Scene scene({.max_memory = run.max_memory(SceneSettings{}.max_memory), .outputs = false});
    run_scene_file(run, scene, file);
    if (name.empty()) {
        for (const auto& [kind, made] : scene.state().made) {
            if (kind == ObjectKind::solid) name = made;
        }
    }
    const auto found = scene.state().objects.find({ObjectKind::solid, name});
    if (found == scene.state().objects.end()) {
        throw InvalidInput(name.empty() ? fmt::format("{}: the scene makes no solid", file)
                                        : fmt::format("{}: the scene makes no solid '{}'", file, name));
    }
    return std::get<Solid>(found->second->value);
}

void count_objects(Run& run, const Scene& scene) {
    std::array<std::size_t, EnumNames<ObjectKind>::names.size()> counts{};
    for (const auto& [key, object] : scene.state().objects) ++counts[static_cast<std::size_t>(key.first)];
    for (std::size_t kind = 0; kind < counts.size(); ++kind)
        run.counts()[EnumNames<ObjectKind>::names[kind]] = counts[kind];
}

}  // namespace coppice::cli
