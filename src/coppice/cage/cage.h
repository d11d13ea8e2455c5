#pragma once

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Shape of a branch beyond its last node: half a ball, or a disc through the node.
enum class TipShape { round, flat };
/// Shape of a tree at a root with one child: a disc, half a ball, or a hole.
enum class BaseShape { flat, round, open };

template <>
struct EnumNames<TipShape> {
    static constexpr std::array<std::string_view, 2> names{"round", "flat"};
};
template <>
struct EnumNames<BaseShape> {
    static constexpr std::array<std::string_view, 3> names{"flat", "round", "open"};
};

/// Options of the control cage.
struct ControlOptions {
    int sides = 4;  ///< number of quads around a branch before subdivision; 4, 8 or 16 for a cage
    TipShape tips = TipShape::round;   ///< shape of the ends of branches
    BaseShape base = BaseShape::flat;  ///< shape of the end of a tree at a root with one child
};

/// Lists the members for front ends.
void list_fields(ControlOptions& o, FieldList& list);

/// Builds a coarse cage of quads around a skeleton: closed (except for an open base), manifold and oriented
/// for every skeleton, one sphere per tree, in O(n) and in parallel.
///
/// A tube of four quads (or `sides`) wraps every segment. At a node where two segments meet they share a ring
/// of four vertices. At a branch node at which the leader continues the stem, rings cross both, below and
/// above the laterals, and each lateral leaves through one of the four faces between them: it has four
/// vertices of valence 5, and rows of quads pass straight along it. At other branch nodes, and where there is
/// too little room for that, the directions around the node are divided into one cell of four corners per
/// segment, and the cell is the ring with which its tube begins. The cells of stem and leader share a ring;
/// every lateral opens one of the existing corners, so that the node adds no faces of its own (a scaffold
/// [FuentesSuarez2018]: a fork has two poles of valence 6, and no other irregular vertices).
///
/// Round ends are closed by one quad beyond the end node. A flat end is in the plane through its node across
/// the branch: a ring of quads from the rim inward and one quad within (identified by a clip plane). An open
/// base has its border in that plane. Trees of one node are balls; roots with several children have no base.
///
/// `source` maps each node of `skeleton` to the node of the skeleton of the field; both may be the same.
/// Trees end round at `round_roots` (ascending), for any base. `joins` (by `end`) identify tips at a node
/// that is not a tip of a single root: they end there as laterals of that node do, and each join removes a
/// sphere or adds a handle.
ControlMesh build_control_mesh(const Skeleton& skeleton, std::span<const NodeId> source,
                               const ControlOptions& options, const Context& ctx,
                               std::span<const NodeId> round_roots = {},
                               std::span<const NodeJoin> joins = {});

}  // namespace coppice
