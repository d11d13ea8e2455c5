#include <fmt/format.h>

#include "command.h"
#include "coppice/extract/cloud/from_cloud.h"
#include "coppice/extract/mesh/from_mesh.h"
#include "coppice/io/skeleton/reader.h"
#include "coppice/io/skeleton/writer.h"
#include "coppice/measure/skeleton_match.h"
#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/json.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/restore.h"
#include "coppice/render/render.h"
#include "coppice/render/scan.h"
#include "coppice/scene/reference.h"

namespace coppice::cli {
namespace {

struct SchemaFlags {};

ExitCode schema(Run& run) {
    const Json all{{"mesh", schema_of<MeshOptions>()},
                   {"restore", schema_of<RestoreOptions>()},
                   {"extract_mesh", schema_of<FromMeshOptions>()},
                   {"extract_cloud", schema_of<CloudOptions>()},
                   {"check", schema_of<CheckOptions>()},
                   {"compare", schema_of<CompareOptions>()},
                   {"render", schema_of<RenderOptions>()},
                   {"scan", schema_of<ScanOptions>()},
                   {"read_skeleton", schema_of<ReadSkeletonOptions>()},
                   {"write_skeleton", schema_of<WriteSkeletonOptions>()},
                   {"scene", scene_schema()}};
    fmt::print("{}\n", all.dump(2));
    run.finish("schema printed");
    return kDone;
}

}  // namespace

Command schema_command(CLI::App& app) {
    auto command = new_command<SchemaFlags>(app, "schema",
                                            "Print every option with type, unit, range and default as JSON")
                       .first;
    command.run = schema;
    return command;
}

}  // namespace coppice::cli
