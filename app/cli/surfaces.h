#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coppice/io_mesh/writer.h"
#include "coppice/measure/axes.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/surface_verdict.h"
#include "options.h"
#include "run.h"

namespace coppice::cli {

/// Help of --material.
inline constexpr const char* kMaterialHelp =
    "Give the surface the material of the images PREFIX_color.png and, where they exist, PREFIX_normal.png, "
    "PREFIX_roughness.png and PREFIX_occlusion.png, as made by coppice texture.";

/// Help of --twig-material.
inline constexpr const char* kTwigMaterialHelp =
    "Give twigs the material of the images of another PREFIX, as --material does for the whole surface.";
/// Help of --cut-material.
inline constexpr const char* kCutMaterialHelp =
    "Give flat ends the material of the images of another PREFIX, of which the colour is a picture of a cut "
    "that fills it.";

/// Names of the images of the materials of a surface, by slot; may be empty.
struct MaterialPrefixes {
    std::filesystem::path bark;  ///< of --material
    std::filesystem::path twig;  ///< of --twig-material
    std::filesystem::path cut;   ///< of --cut-material

    bool has_slots() const { return !twig.empty() || !cut.empty(); }  ///< whether there are several
};

/// Adds --material, --twig-material and --cut-material.
void add_material_options(OptionList& options, MaterialPrefixes& prefixes, HelpPlace display = {});
/// Throws UsageError if a slot has a material, but bark has none.
void check_materials(const MaterialPrefixes& prefixes);
/// Returns the materials by MaterialSlot, with different names; those without a prefix are empty. Returns
/// none if there are no prefixes. Throws IoError if there is no colour.
std::vector<MaterialFiles> find_materials(const MaterialPrefixes& prefixes);
/// Returns the slots that materials require.
SlotOptions make_slots(const MaterialPrefixes& prefixes, SlotOptions options);

/// Warns of files that cannot store materials.
void warn_of_lost_materials(Run& run, const MaterialPrefixes& prefixes,
                            std::span<const std::filesystem::path> outputs);

/// Throws UsageError for options of textures that have no effect, and for a material of a surface without
/// the coordinates that it requires.
void check_texture(const GivenOptions& given, const TextureOptions& texture);
/// Uses the extent that an image states for the tile, unless a tile is given; returns a summary, with a
/// leading semicolon.
std::string use_tile_of_image(Run& run, const GivenOptions& given, const std::filesystem::path& image,
                              TextureOptions& texture);

/// Writes the mesh of a surface of any method.
void write_surface(const std::filesystem::path& path, const MeshResult& result,
                   const MeshWriteOptions& options, const Context& ctx);

/// Adds the options of MeshWriteOptions except the format.
void add_mesh_write_options(OptionList& options, MeshWriteOptions& write);
/// Throws UsageError if an option has no effect on any of the files.
void check_mesh_write_options(const MeshWriteOptions& write, std::span<const std::filesystem::path> outputs);

/// Reports the device that computed the surface, and the reason if it is not the requested one.
void tell_device(Run& run, const MeshResult& result);
/// Adds the figures of a surface to the report; returns its summary.
std::string count_surface(Run& run, const MeshResult& result);

/// Describes the axes of the skeleton that the surface does not cover: a sentence for severed branches, and
/// one for short tips.
std::vector<std::string> find_faults(const AxesReport& axes);

/// The verdict on a surface, compared with its skeleton.
struct Verdict {
    bool is_good = true;
    std::string text;  ///< text for the summary
};
/// Adds the figures of a comparison to the report, and warns of defects.
Verdict report_verdict(Run& run, const SurfaceVerdict& verdict, bool is_cage = false);
/// Compares a surface with its skeleton, adds the figures to the report, and warns of defects. Does nothing
/// for surfaces that judge_surface() does not judge. `ends` must equal the options that made the surface.
Verdict judge(Run& run, const MeshResult& result, const Skeleton& skeleton, const ControlOptions& ends);

/// Creates and writes the surface of --then-mesh; returns the text to append to the summary, with a leading
/// semicolon. Does nothing if `path` is empty.
std::string then_mesh(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                      const MeshOptions& options);

}  // namespace coppice::cli
