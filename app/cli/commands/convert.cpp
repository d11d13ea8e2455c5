#include <fmt/format.h>

#include "command.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_points/writer.h"
#include "coppice/io_skeleton/writer.h"
#include "files.h"
#include "options.h"
#include "results.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct ConvertFlags {
    std::filesystem::path input, output;
    ReadSkeletonOptions read;
    ReadPointsOptions read_points;
    WriteSkeletonOptions write;
    MeshWriteOptions mesh;
};

/// Returns the kind of the output, which must equal that of the input.
FileKind agreed_kind(const Run& run, const ConvertFlags& flags) {
    const FileKind from = kind_of_input(run, flags.input, flags.read.format);
    if (from == FileKind::skeleton && flags.write.format != SkeletonFormat::automatic) return from;
    if (from == FileKind::points &&
        (point_format_of_name(flags.output) || !kind_of_output(flags.output, from)))
        return from;
    const FileKind to = kind_to_write(flags.output, from);
    if (from == to || (from == FileKind::points && to == FileKind::mesh)) return from;
    throw UsageError(fmt::format("'{0}' is {1}, and '{2}' the name of {3}; use coppice {4} {0} -o {2}",
                                 flags.input.string(), with_article(from), flags.output.string(),
                                 with_article(to), from == FileKind::skeleton ? "mesh" : "extract"));
}

ExitCode convert(Run& run, const ConvertFlags& flags) {
    if (flags.input.empty() || flags.output.empty())
        throw UsageError("name both files: coppice convert IN -o OUT");
    const FileKind kind = agreed_kind(run, flags);
    if (flags.mesh.normals && kind != FileKind::mesh)
        throw UsageError(fmt::format("--normals requires a mesh, and '{}' is {}", flags.input.string(),
                                     with_article(kind)));
    std::string subject;
    if (kind == FileKind::skeleton) {
        check_output_folder(flags.output);
        const SkeletonFile file = load_skeleton(run, flags.input, flags.read);
        run.stage("write", [&](const Context& ctx) {
            WriteSkeletonOptions write = flags.write;
            write.units = file.units;
            write.up = flags.mesh.up;
            store_skeleton(run, flags.output, file.skeleton, write, file.attributes, ctx);
        });
        subject = grouped(file.skeleton.size()) + " nodes";
    } else if (kind == FileKind::points) {
        check_points_output(flags.output);
        const PointColumns columns = keeps_columns(flags.output) ? PointColumns{} : kNoColumns;
        PointFile file = load_point_file(run, flags.input, columns, flags.read.up, flags.read_points);
        turn_to_file(file.point_cloud.points, flags.mesh.up);
        run.stage("write", [&](const Context& ctx) {
            store_points(run, flags.output, file.point_cloud, file.system, ctx);
        });
        subject =
            fmt::format("{} points{}", grouped(file.point_cloud.points.size()), text_of_rays_left_out(file));
    } else {
        check_mesh_output(flags.output);
        check_mesh_write_options(flags.mesh, {&flags.output, 1});
        const PolygonMesh mesh = load_mesh(run, flags.input, flags.read.up);
        MeshWriteOptions options = flags.mesh;
        if (mesh_format_of_name(flags.output) != MeshFormat::stl) {
            options.texture = mesh.texture;
            options.texture_blends = mesh.texture_blends;
        }
        const auto leaves = find_held_leaves(run, flags.input);
        if (leaves) options.parts = leaves->parts();
        run.stage("write", [&](const Context& ctx) { store_mesh(run, flags.output, mesh, options, ctx); });
        subject = grouped(mesh.face_count()) + " faces";
    }
    run.finish(fmt::format("{}: {}", flags.output.string(), subject));
    return kDone;
}

}  // namespace

Command convert_command() {
    const auto flags = std::make_shared<ConvertFlags>();
    OptionList options;
    options.file("input", "IN", flags->input, "Skeleton, mesh or points to read.");
    options.output("-o,--output", "OUT", flags->output, "File to write; its extension selects the format.");
    options.may_replace("--output", "input");
    options.fields(flags->read, "Reading a skeleton");
    options.fields(flags->read_points, kReadPointsGroup);
    options.fields(flags->write, "Writing a skeleton",
                   {.names = {{"format", "--output-format"}}, .without = {"units", "up"}});
    add_mesh_write_options(options, flags->mesh);
    return {"convert", "Convert a skeleton, mesh or point file to another format of the same kind.", options,
            [flags](Run& run, const GivenOptions&) { return convert(run, *flags); },
            ManyFiles{convert_command, "input", "", {FileKind::skeleton, FileKind::mesh, FileKind::points}}};
}

}  // namespace coppice::cli
