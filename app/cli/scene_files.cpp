#include "scene_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "coppice/base/quote.h"
#include "coppice/options/spelling.h"
#include "coppice/system/file.h"
#include "files.h"

namespace coppice::cli {
namespace {

/// Returns the command of a line, which names its stage.
std::string stage_name(const std::string& line) {
    try {
        const auto words = scene_words(line);
        return words.empty() ? "nothing" : words.front().text;
    } catch (const InvalidInput&) {
        return "nothing";  // the scene reports the error and its line
    }
}

/// Returns the lines of the scenes that can be parsed; running the others reports their errors.
std::vector<SceneLine> collect_lines(std::span<const SceneFile> scenes) {
    std::vector<SceneLine> all;
    for (const SceneFile& scene : scenes) {
        try {
            std::ranges::move(scene_lines(scene.text, scene.path.string()), std::back_inserter(all));
        } catch (const InvalidInput&) {
            continue;
        }
    }
    return all;
}

void check_known(const std::string& name, const std::vector<std::string>& known) {
    if (std::ranges::find(known, name) != known.end()) return;
    std::string hint = did_you_mean(name, known);
    if (hint.empty() && known.size() > 8) hint = "; the variables of a scene are defined by let";
    if (hint.empty()) {
        hint = known.empty() ? "; it has none (they are defined by let)"
                             : fmt::format("; it has {}", fmt::join(known, ", "));
    }
    throw UsageError(fmt::format("--set: the scene has no variable {}{}", quote(name), hint));
}

/// Returns the text of a scene file or of a text in memory.
std::string read_scene(const Run& run, const std::filesystem::path& path) {
    if (const auto text = find_held_text(run, path)) return *text;
    return read_commands(path, "a scene");
}

}  // namespace

void add_scene_options(OptionList& options, SceneFlags& flags) {
    options.value({common_field("set",
                                "Value of a variable of the scene as NAME=VALUE, which replaces its first "
                                "let; may be repeated."),
                   &flags.set});
    options.value({common_field("seed", "Seed of all random numbers of the scene, up to its first set seed.",
                                Unit::none, 0, 2147483647),
                   &flags.seed});
}

std::string read_commands(const std::filesystem::path& path, std::string_view subject) {
    const auto kind = kind_of_file(path);
    const bool may_be_text = path.extension() == ".txt" && kind == FileKind::points;
    if (kind && !may_be_text) throw UsageError(remedy_for(path, *kind, subject));
    return read_file(path, kLargestScene);
}

std::vector<SceneFile> read_scenes(Run& run, std::span<const std::filesystem::path> paths) {
    return run.stage("read", [&](const Context&) {
        std::vector<SceneFile> scenes;
        for (const auto& path : paths) scenes.push_back({path, read_scene(run, path)});
        return scenes;
    });
}

SceneSettings scene_settings(Run& run, const SceneFlags& flags, std::span<const SceneFile> scenes) {
    SceneSettings settings{.max_memory = run.max_memory(SceneSettings{}.max_memory), .seed = flags.seed};
    if (flags.set.empty()) return settings;
    const std::vector<std::string> known = find_variables(collect_lines(scenes));
    for (const std::string& word : flags.set) {
        const std::size_t sign = word.find('=');
        if (sign == word.npos || sign == 0)
            throw UsageError(fmt::format("--set takes NAME=VALUE, not {}", quote(word)));
        const std::string name = word.substr(0, sign);
        check_known(name, known);
        settings.variables[name] = word.substr(sign + 1);
    }
    return settings;
}

void run_scene(Run& run, Scene& scene, const SceneFile& file) {
    const std::string source = file.path.string();
    scene.set_folder(file.path.parent_path());
    const std::vector<SceneLine> lines = scene_lines(file.text, source);
    for (const auto step : scene_steps(lines, source)) {
        const std::string output = run.stage(stage_name(step.front().text), [&](const Context& ctx) {
            std::string all;
            for (const SceneLine& line : step)
                all += scene.run(line.text, fmt::format("{}:{}", source, line.number), ctx);
            return all;
        });
        run.print(output);
    }
}

std::optional<std::vector<const SceneCommand*>> commands_of_scenes(std::span<const SceneFile> scenes) {
    std::vector<const SceneCommand*> all;
    try {
        for (const SceneFile& scene : scenes) {
            const auto commands = find_commands(scene_lines(scene.text, scene.path.string()));
            if (!commands) return std::nullopt;
            all.insert(all.end(), commands->begin(), commands->end());
        }
    } catch (const InvalidInput&) {
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
    const std::filesystem::path path(file);
    run_scene(run, scene, read_scenes(run, {&path, 1}).front());
    if (name.empty()) {
        for (const auto& [kind, made] : scene.state().made) {
            if (kind == ObjectKind::solid) name = made;
        }
    }
    const auto found = scene.state().objects.find({ObjectKind::solid, name});
    if (found == scene.state().objects.end()) {
        throw InvalidInput(name.empty() ? fmt::format("{}: the scene makes no solid", file)
                                        : fmt::format("{}: the scene makes no solid {}", file, quote(name)));
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
