#include <fmt/format.h>

#include <algorithm>

#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/render/png.h"
#include "coppice/render/render.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/scene/drawing.h"
#include "coppice/scene/reference.h"
#include "coppice/scene/save.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

using namespace table;

SceneCommand in_group(std::string name, std::string help, std::string example) {
    SceneCommand c =
        new_command(std::move(name), "Looking, saving and taking back", std::move(help), std::move(example));
    c.records = false;
    return c;
}

SceneCommand save_command() {
    SceneCommand c =
        in_group("save", "Write an object to a file, in the format of its extension.", "save tree tree.swc");
    c.arguments = {any_object("name", "Object to write."),
                   file("file", ArgumentType::output_file,
                        "File: .swc, .json or .csv for skeletons, .obj, .ply, .glb, .stl or .usda for "
                        "meshes, .xyz or .ply for points."),
                   choice_of_kind()};
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("file");
        const std::string& kind = call.text("kind");
        const ObjectPtr object = kind.empty() ? object_for_file(call.state(), call.text("name"), path)
                                              : call.any(call.text("name"), kind);
        check_file_name(*object, path);
        if (call.settings().outputs) save_object(*object, path, call.context());
        return SceneOutcome{};
    };
    return c;
}

/// Returns the object written by `save pointset`: the last created points, unless an object is called
/// pointset.
ObjectPtr last_points(const SceneState& state, const std::filesystem::path& path) {
    const auto called = [](const auto& object) { return object.first.second == "pointset"; };
    if (std::ranges::any_of(state.objects, called)) return object_for_file(state, "pointset", path);
    for (auto made = state.made.rbegin(); made != state.made.rend(); ++made) {
        const auto found = state.objects.find(*made);
        if (made->first == ObjectKind::points && found != state.objects.end()) return found->second;
    }
    throw InvalidInput("there are no points yet; create some with: pointset generate SOLID");
}

SceneCommand save_pointset_command() {
    SceneCommand c = in_group("save pointset", "Write the last created points.", "save pointset last.xyz");
    c.arguments = {file("file", ArgumentType::output_file,
                        "Point file: .las, .ply, .xyz, .txt, .csv or .asc; the last word.")};
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("file");
        const ObjectPtr object = last_points(call.state(), path);
        check_file_name(*object, path);
        if (call.settings().outputs) save_object(*object, path, call.context());
        return SceneOutcome{};
    };
    return c;
}

SceneCommand save_recipe_command() {
    SceneCommand c =
        in_group("save recipe", "Write a scene that creates the same objects again, with all options.",
                 "save recipe again.coppice");
    c.arguments = {file("file", ArgumentType::output_file, "Scene to write (.coppice).")};
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("file");
        if (path.extension() != ".coppice")
            throw InvalidInput(
                fmt::format("'{}' is not a valid file name for a scene; use .coppice", path.string()));
        if (call.settings().outputs) write_file(path, make_recipe(call.state()));
        return SceneOutcome{};
    };
    return c;
}

SceneCommand render_command() {
    SceneCommand c = in_group("render", "Render objects to a PNG image.",
                              "render tree tree.png kind=skeleton width=64 height=64 samples=1");
    c.arguments = {any_object("objects", "Objects to render.", true),
                   file("file", ArgumentType::output_file, "Image (.png), the last word."), choice_of_kind()};
    add_options(c.arguments, RenderOptions{}, "render", {"color", "deviation_range"});
    c.arguments.push_back(number("point_radius", "0", 0, 1e6, Unit::metre,
                                 "Radius of the balls that represent points; 0 uses 1/250 of the size."));
    c.run = [](const SceneCall& call) {
        const std::filesystem::path path = call.output("file");
        if (path.extension() != ".png")
            throw InvalidInput(
                fmt::format("'{}' is not a valid file name for an image; use .png", path.string()));
        const auto options = call.options<RenderOptions>("render");
        constexpr double kBytesOfPixel = 16;
        call.reserve(kBytesOfPixel * options.camera.width * options.camera.height);
        std::vector<ObjectPtr> objects;
        for (const ArgumentValue& v : call.values("objects"))
            objects.push_back(call.any(v.text, call.text("kind")));
        if (!call.settings().outputs) return SceneOutcome{};
        const Drawing drawing(objects, static_cast<float>(call.number("point_radius")), call);
        const Image image = render(drawing.scene(), options, call.context());
        write_file(path, encode_png(image));
        return SceneOutcome{};
    };
    return c;
}

SceneCommand list_command() {
    SceneCommand c = in_group("list", "List all objects by kind.", "list");
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        for (int k = 0; k < static_cast<int>(EnumNames<ObjectKind>::names.size()); ++k) {
            std::vector<std::string> names;
            for (const auto& [key, object] : call.state().objects) {
                if (key.first == static_cast<ObjectKind>(k)) names.push_back(key.second);
            }
            if (!names.empty())
                out.text +=
                    fmt::format("{:<9}  {}\n", EnumNames<ObjectKind>::names[static_cast<std::size_t>(k)],
                                fmt::join(names, " "));
        }
        return out;
    };
    return c;
}

SceneCommand describe_command() {
    SceneCommand c = in_group("describe", "Print the figures of all objects of a name.", "describe tree");
    c.arguments = {any_object("name", "Object to describe.")};
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        for (const auto& [key, object] : call.state().objects) {
            if (key.second == call.text("name")) out.text += describe_object(*object);
        }
        return out;
    };
    return c;
}

SceneCommand delete_command() {
    SceneCommand c = in_group("delete", "Delete objects; objects made from them are kept.", "delete s2");
    c.records = true;
    c.arguments = {any_object("names", "Objects to delete.", true), choice_of_kind()};
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        for (const ArgumentValue& v : call.values("names"))
            out.changes.push_back({call.any(v.text, call.text("kind"))->kind(), v.text, nullptr});
        return out;
    };
    return c;
}

SceneCommand undo_command() {
    SceneCommand c = in_group("undo", "Undo the last commands that changed objects.", "undo 1");
    Argument count =
        positional(number("count", "1", 1, 1000, Unit::none, "Number of commands to undo."), false);
    count.type = ArgumentType::whole;
    c.arguments = {std::move(count)};
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        out.undo = static_cast<int>(call.number("count"));
        return out;
    };
    return c;
}

SceneCommand seed_command() {
    SceneCommand c =
        in_group("set seed", "Set the seed of all following commands without one.", "set seed 7");
    Argument seed = positional(number("value", "", 0, 2147483647, Unit::none, "New seed."));
    seed.type = ArgumentType::whole;
    c.arguments = {std::move(seed)};
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        out.seed = static_cast<int>(call.number("value"));
        return out;
    };
    return c;
}

SceneCommand help_command() {
    SceneCommand c = in_group("help", "List the commands, or explain one.", "help pointset thin");
    Argument words = positional(repeated(Argument{.name = "command", .help = "Command to explain."}), false);
    c.arguments = {std::move(words)};
    c.run = [](const SceneCall& call) {
        SceneOutcome out;
        std::vector<SceneWord> words_of_name;
        for (const ArgumentValue& v : call.values("command")) words_of_name.push_back({{}, v.text});
        out.text = words_of_name.empty() ? help_overview() : format_help(words_of_name);
        return out;
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> session_commands() {
    return {save_command(),  save_pointset_command(), save_recipe_command(), render_command(),
            slice_command(), list_command(),          describe_command(),    delete_command(),
            undo_command(),  seed_command(),          help_command()};
}

}  // namespace coppice
