#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coppice/io/mesh/writer.h"
#include "coppice/measure/axes.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "options.h"
#include "run.h"

namespace coppice::cli {

/// Writes the mesh of a surface, whichever method made it.
void write_surface(const std::filesystem::path& path, const MeshResult& result,
                   const MeshWriteOptions& options, const Context& ctx);

/// The options of MeshWriteOptions but the format.
void add_mesh_write_options(OptionList& options, MeshWriteOptions& write);
/// Throws UsageError where one of them would do nothing for any of the files.
void check_mesh_write_options(const MeshWriteOptions& write, std::span<const std::filesystem::path> outputs);

/// Puts what the surface was computed on into the report, and says why that is not what was asked for.
void tell_device(Run& run, const MeshResult& result);
/// Puts the figures of a surface into the report; returns what to say of it.
std::string count_surface(Run& run, const MeshResult& result);

/// What a surface lacks of the axes of its skeleton: a sentence for severed branches, and one for short tips.
std::vector<std::string> faults_of(const AxesReport& axes);

/// What is to be said of a surface in view of its skeleton.
struct Verdict {
    bool is_good = true;
    std::string said;  ///< for the summary
};
/// Holds a surface against its skeleton, puts the figures into the report, and warns of what it lacks.
/// Nothing is said of surfaces that judge_surface() does not judge. `ends` has to be what it was made with.
Verdict judge(Run& run, const MeshResult& result, const Skeleton& skeleton, const ControlOptions& ends);

/// Makes and writes the surface of --then-mesh; returns what is said of it after the rest, with a semicolon
/// before it. Nothing where `path` is empty.
std::string then_mesh(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                      const MeshOptions& options);

}  // namespace coppice::cli
