#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/io/file_up.h"
#include "coppice/io/skeleton/format.h"
#include "coppice/io/skeleton/length_unit.h"
#include "coppice/io/skeleton/node_attribute.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What kind of skeleton file is written.
struct WriteSkeletonOptions {
    SkeletonFormat format = SkeletonFormat::automatic;  ///< automatic = by the ending of the name
    bool binary = true;                                 ///< PLY as little-endian binary instead of ASCII
    FileUp up = FileUp::z;                              ///< axis that points up in the file
    LengthUnit units =
        LengthUnit::m;  ///< what lengths are in, which SWC, JSON, OBJ, PLY, RSML and MTG say; automatic = m
};

template <class Self, class Visitor>
requires SameOptions<Self, WriteSkeletonOptions>
constexpr void visit_fields(Self& options, Visitor&& visit) {
    visit(Field{"format", "kind of the skeleton file; automatic goes by the ending of its name"},
          options.format);
    visit(Field{"binary", "write PLY as binary instead of ASCII"}, options.binary);
    visit(Field{"up", "axis that points up in the file"}, options.up);
    visit(Field{"units",
                "what a unit of length is, which written SWC, JSON, OBJ, PLY, RSML and MTG say; nothing is "
                "converted"},
          options.units);
}

/// Writes a skeleton as swc, cylinders (.csv), ply, obj, json, rsml or mtg; the file appears whole or not at
/// all. Positions are in world space: the origin is added back in double precision, and the digits are enough
/// for a reader to find the same floats when the origin is zero (to 15 digits otherwise).
///
/// All formats but `cylinders` keep every node and radius, coincident nodes included. A cylinder stands for a
/// segment and has one radius, that of equal volume, so it loses taper and trees of a single node.
///
/// Stable ids go into JSON where the skeleton has some, and are read again.
///
/// Attributes go into JSON, each an array of its own, PLY, as properties of the vertices, RSML, as functions,
/// and MTG, as features; SWC has a place for `type` where that is a whole number from 0 to 2^24 everywhere,
/// and for `id`, where a node has a whole number from 1 to 2^24 that no node before it has; the other formats
/// have none. They are read again.
///
/// Throws IoError when the file cannot be written, Unsupported when the format cannot be: one that is read
/// only, a name without a known ending, a list of cylinders of a skeleton without segments; Cancelled. O(n).
void write_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                    const WriteSkeletonOptions& options = {}, std::span<const NodeAttribute> attributes = {},
                    const Context& ctx = {});

/// The bytes that `write_skeleton` writes; the format must not be automatic.
std::string encode_skeleton(const Skeleton& skeleton, const WriteSkeletonOptions& options,
                            std::span<const NodeAttribute> attributes = {}, const Context& ctx = {});

}  // namespace coppice
