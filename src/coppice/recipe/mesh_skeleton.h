#pragma once

#include <string>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/control/control.h"
#include "coppice/control/graft.h"
#include "coppice/control/part.h"

#include "coppice/field/field_options.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/prepare.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"

namespace coppice {

/// Everything that decides what surface a skeleton gets.
struct MeshOptions {
    int levels = 2;      ///< times the cage is subdivided; each makes four quads of one
    float graft = 0.6f;  ///< [sum of radii] branches whose axes come nearer than this are grafted; 0 = off
    PrepareOptions prepare;
    ControlOptions control;
    FieldOptions field;
    ProjectOptions project;
    UntangleOptions untangle;
};

template <class Self, class Visitor>
requires SameOptions<Self, MeshOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"levels", "times the cage is subdivided; each makes four quads of one", Unit::none, 0, 6},
          o.levels);
    visit(Field{"graft",
                "branches whose axes come nearer than this times the sum of their radii are grafted; 0 = off",
                Unit::none, 0, 1},
          o.graft);
    visit(Field{"prepare", "Preparing the skeleton"}, o.prepare);
    visit(Field{"control", "Control cage"}, o.control);
    visit(Field{"field", "Convolution field"}, o.field);
    visit(Field{"project", "Projection onto the field"}, o.project);
    visit(Field{"untangle", "Unfolding"}, o.untangle);
}

struct MeshResult {
    QuadMesh mesh;
    ControlMesh cage;
    PrepareReport prepared;
    GraftReport grafted;
    PartReport parted;
    ProjectReport projected;
    UntangleReport untangled;
    std::vector<std::pair<std::string, double>> stages;  ///< name, seconds
};

/// Wraps a skeleton in one closed surface of quads, one sphere per tree: prepares the skeleton, grafts
/// branches that run through each other, finds where branches part, builds a coarse cage, subdivides it,
/// moves it onto the convolution field, and unfolds what was folded [Zhu2015].
///
/// About 64 quads per segment at two levels. O(n log n); memory: at most 120 bytes per quad above the input.
/// Throws InvalidInput naming an option out of range, or `levels` when the mesh would be too large to index.
MeshResult mesh_skeleton(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
