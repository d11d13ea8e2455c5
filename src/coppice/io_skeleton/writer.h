#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/io/file_up.h"
#include "coppice/io_skeleton/format.h"
#include "coppice/io_skeleton/length_unit.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options for writing a skeleton file.
struct WriteSkeletonOptions {
    SkeletonFormat format = SkeletonFormat::automatic;  ///< automatic: by the extension of the name
    bool binary = true;     ///< writes PLY as little-endian binary instead of ASCII
    FileUp up = FileUp::z;  ///< up axis of the file
    /// unit of lengths, stated in SWC, JSON, OBJ, PLY, RSML and MTG; automatic: m
    LengthUnit units = LengthUnit::m;
};

/// Lists the members for front ends.
void list_fields(WriteSkeletonOptions& options, FieldList& list);

/// Writes a skeleton as swc, cylinders (.csv), ply, obj, json, rsml or mtg; the file is written atomically.
/// Positions are in world space: the origin is added in double precision, with enough digits to restore the
/// same floats if the origin is zero (15 digits otherwise).
///
/// All formats except `cylinders` store every node and radius, including coincident nodes. A cylinder
/// represents a segment by a single radius with equal volume, so taper and trees of a single node are lost.
///
/// JSON stores stable ids if the skeleton has them; the reader restores them.
///
/// JSON stores attributes as arrays, PLY as vertex properties, RSML as functions and MTG as features; SWC
/// stores `type` if all values are integers from 0 to 2^24, and `id` for nodes with an integer from 1 to 2^24
/// that no previous node has; the other formats store no attributes. The reader restores them.
///
/// Throws InvalidInput if there are no nodes, IoError if the file cannot be written, Unsupported if the
/// format cannot be written: a read-only format, a name with an unknown extension, a list of cylinders of a
/// skeleton without segments; Cancelled. O(n).
void write_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                    const WriteSkeletonOptions& options = {}, std::span<const NodeAttribute> attributes = {},
                    const Context& ctx = {});

/// Returns the bytes that `write_skeleton` writes; the format must not be automatic.
std::string encode_skeleton(const Skeleton& skeleton, const WriteSkeletonOptions& options,
                            std::span<const NodeAttribute> attributes = {}, const Context& ctx = {});

}  // namespace coppice
