#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/sketch/sketch.h"
#include "coppice/sketch/snapshot.h"
#include "coppice/sketch/trace/trace.h"
#include "coppice/system/folder_sandbox.h"

namespace coppice {

/// Returns whether a file of this name contains a sketch: it ends with .sketch.json.
bool is_sketch_name(const std::filesystem::path& path);

/// Reads a sketch: JSON as specified by docs/user/sketch.schema.json. Uncalibrated cameras are computed from
/// the height of the tree, those of COLMAP are read from its files. Throws IoError if it cannot be read,
/// Unsupported for a newer version, InvalidInput with line or field: invalid JSON, fields that are missing,
/// unknown or of the wrong type, and the errors of `validate`. O(points).
Sketch read_sketch(const std::filesystem::path& path, const Context& ctx = {});

/// Cameras of a sketch that may have no strokes yet.
struct SketchCameras {
    std::vector<SketchView> views;                   ///< those of snapshots have names, images and sizes only
    std::vector<std::optional<Snapshot>> snapshots;  ///< of the views with uncalibrated cameras
    double height = 0;                               ///< [m] height of the tree; 0: unknown
};

/// Reads the views of a sketch and ignores its branches, which may be missing. Throws like `read_sketch`.
SketchCameras read_cameras(const std::filesystem::path& path, const Context& ctx = {});

/// Parses the text of `read_cameras`; other files are restricted to the sandbox.
SketchCameras parse_cameras(std::string_view text, const std::string& source, const FolderSandbox& sandbox);

/// Proposes strokes from the silhouettes of the views, one for each, in order, by `trace`; uncalibrated
/// cameras are computed from the height of the tree and the extents of their silhouettes. `source` names the
/// cameras in messages. Throws like `trace`, `compute_extent` and `snapshot_view`.
TraceResult trace_views(const SketchCameras& cameras, std::span<const Mask> silhouettes,
                        const std::string& source, const Context& ctx = {});

/// Parses the text of `read_sketch`; `source` names it in messages, cameras of COLMAP are read relative to
/// `folder`.
Sketch parse_sketch(std::string_view text, const std::string& source,
                    const std::filesystem::path& folder = {});
/// Parses a sketch that may read files only within the sandbox, by names relative to its folder; throws
/// IoError if it names others.
Sketch parse_sketch(std::string_view text, const std::string& source, const FolderSandbox& sandbox);

/// Returns the text that `parse_sketch` reads, with the shortest digits that restore the same numbers.
std::string encode_sketch(const Sketch& sketch);

/// Writes a sketch atomically. Throws IoError if it cannot be written.
void write_sketch(const std::filesystem::path& path, const Sketch& sketch);

}  // namespace coppice
