#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "command.h"
#include "coppice/compose/compose.h"
#include "coppice/edit/animate/animate_options.h"
#include "coppice/edit/animate/growing.h"
#include "coppice/edit/animate/wind.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/extract/plot/plot.h"
#include "coppice/foliage/placement.h"
#include "coppice/growth/sprout.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/measure/match/cloud_distance.h"
#include "coppice/measure/match/skeleton_match.h"
#include "coppice/measure/surface_report.h"
#include "coppice/options/json.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/restore.h"
#include "coppice/render/render.h"
#include "coppice/render/scan.h"
#include "coppice/scene/reference.h"
#include "coppice/sketch/draw.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/texture/bark.h"
#include "coppice/view/view_options.h"

namespace coppice::cli {
namespace {

template <OptionStruct Options>
Json described() {
    Options defaults;
    return make_schema(option_fields(defaults));
}

/// Adds the description of the value of an option; files have only a type.
struct DescribeTarget {
    Json& entry;
    const Option& option;

    void operator()(std::filesystem::path*) const { entry["type"] = "file"; }
    void operator()(std::vector<std::filesystem::path>*) const { entry["type"] = "files"; }
    template <class Value>
    void operator()(const Value& value) const {
        describe_value(entry, {{option.name, option.help, option.unit, option.low, option.high}, value});
    }
};

/// Describes the options of a command by their names on the command line.
Json list_options(const Command& command) {
    Json out = Json::array();
    for (const Option& option : command.options.all()) {
        Json entry{{"name", option.name},
                   {"help", option.help},
                   {"text", help_text(option)},
                   {"common", option.common}};
        if (!option.type.empty()) entry["value_name"] = option.type;
        if (!option.letter.empty()) entry["letter"] = option.letter;
        if (!option.field.empty()) entry["field"] = option.field;
        if (!option.group.empty()) entry["group"] = option.group;
        if (option.is_output) entry["output"] = true;
        std::visit(DescribeTarget{entry, option}, option.target);
        out.push_back(std::move(entry));
    }
    return out;
}

ExitCode schema(Run& run, std::vector<Command> list) {
    CommonFlags common;
    Json commands = Json::object();
    for (const Command& command : with_common_options(std::move(list), common))
        commands[command.name] = {{"help", command.help}, {"options", list_options(command)}};
    const Json all{{"mesh", described<MeshOptions>()},
                   {"restore", described<RestoreOptions>()},
                   {"extract_mesh", described<FromMeshOptions>()},
                   {"extract_cloud", described<CloudOptions>()},
                   {"extract_plot", described<PlotOptions>()},
                   {"sprout", described<SproutOptions>()},
                   {"sketch", described<SketchOptions>()},
                   {"draw_sketch", described<DrawSketchOptions>()},
                   {"compose", described<ComposeOptions>()},
                   {"check", described<CheckOptions>()},
                   {"check_cloud", described<CloudDistanceOptions>()},
                   {"compare", described<CompareOptions>()},
                   {"animate", described<AnimateOptions>()},
                   {"growing", described<GrowingOptions>()},
                   {"wind", described<WindOptions>()},
                   {"render", described<RenderOptions>()},
                   {"view", described<ViewOptions>()},
                   {"scan", described<ScanOptions>()},
                   {"bark", described<BarkOptions>()},
                   {"leaf", described<LeafShape>()},
                   {"leaves", described<LeafRules>()},
                   {"organs", described<OrganOptions>()},
                   {"read_skeleton", described<ReadSkeletonOptions>()},
                   {"write_skeleton", described<WriteSkeletonOptions>()},
                   {"scene", scene_schema()},
                   {"commands", std::move(commands)}};
    run.print(all.dump(2) + "\n");
    run.finish("schema printed");
    return kDone;
}

}  // namespace

Command schema_command(std::function<std::vector<Command>()> list) {
    return {"schema",
            "Print every option with its type, unit, range and default as JSON.",
            {},
            [list = std::move(list)](Run& run, const GivenOptions&) { return schema(run, list()); }};
}

}  // namespace coppice::cli
