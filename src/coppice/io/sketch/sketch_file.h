#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io/jail.h"
#include "coppice/sketch/sketch.h"
#include "coppice/sketch/snapshot.h"
#include "coppice/sketch/trace/trace.h"

namespace coppice {

/// Whether a file of this name holds a sketch: it ends with .sketch.json.
bool is_sketch_name(const std::filesystem::path& path);

/// Reads a sketch: JSON as docs/user/sketch.schema.json describes it. Cameras that nobody measured follow
/// from the height of the tree, those of COLMAP are read from its files. Throws IoError when it cannot be
/// read, Unsupported for a newer version, InvalidInput naming line or field: no JSON, fields that are
/// missing, unknown or of the wrong kind, and what `validate` finds. O(points).
Sketch read_sketch(const std::filesystem::path& path, const Context& ctx = {});

/// The cameras of a sketch in which nothing need be drawn yet.
struct SketchCameras {
    std::vector<SketchView> views;  ///< those of snapshots have names, images and sizes alone
    std::vector<std::optional<Snapshot>> snapshots;  ///< of the views whose camera nobody measured
    double height = 0;                               ///< [m] of the tree; 0 = not told
};

/// Reads the views of a sketch and passes over its branches, which may be missing. Throws as `read_sketch`.
SketchCameras read_cameras(const std::filesystem::path& path, const Context& ctx = {});

/// `read_cameras` of a text, with files beside it within the jail.
SketchCameras parse_cameras(std::string_view text, const std::string& source, const Jail& jail);

/// Proposes strokes from the silhouettes of the views, one for each, in order: `trace`, where cameras that
/// nobody measured follow from the height of the tree and what their silhouettes reach. `source` names the
/// cameras in messages. Throws what `trace`, `extent_of` and `snapshot_view` throw.
TraceResult trace_views(const SketchCameras& cameras, std::span<const Mask> silhouettes,
                        const std::string& source, const Context& ctx = {});

/// `read_sketch` of a text; `source` names it in messages, cameras of COLMAP are looked for beside `folder`.
Sketch parse_sketch(std::string_view text, const std::string& source,
                    const std::filesystem::path& folder = {});
/// The same where files may be read within the jail alone, by names relative to its folder; throws IoError
/// where the sketch names others.
Sketch parse_sketch(std::string_view text, const std::string& source, const Jail& jail);

/// The text that `parse_sketch` reads, with the fewest digits that give the same numbers.
std::string encode_sketch(const Sketch& sketch);

/// Writes a sketch; the file appears whole or not at all. Throws IoError when it cannot be written.
void write_sketch(const std::filesystem::path& path, const Sketch& sketch);

}  // namespace coppice
