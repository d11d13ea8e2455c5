#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

/// A skeleton, and a mesh or a cloud created from it, from which it is to be extracted.
struct TruthScene {
    std::string name;
    Skeleton truth;
    std::variant<PolygonMesh, PointSet> input;

    bool is_cloud() const { return std::holds_alternative<PointSet>(input); }
    std::size_t input_size() const;  ///< vertices used by faces, or points
};

/// Returns the default scenes.
std::vector<std::string> default_truth_scenes();

/// Returns the kinds of input, in the order of docs/user/comparing.md.
std::vector<std::string_view> truth_kinds();

/// Creates a scene by its name TREE:KIND. TREE is an argument of `make_scene`: tree300, tree3k, ..., or a
/// file. KIND:
///   mesh       the closed surface with its defaults, two levels of subdivision
///   coarse     the same at one level
///   noise      mesh, with noise of a tenth of the minimum radius along the normals
///   holes      mesh, with one hole of five minimum radii for every 50 segments
///   decimated  mesh in triangles, edges collapsed until a third of the vertices is left
///   cloud      points all over the mesh: 100,000, or 500,000 from 10,000 segments on; noise of 1 mm
///   scan       as many points, visible to six scanners at two diagonals of the tree; noise of 1 mm in range
/// Throws InvalidInput, IoError.
TruthScene make_truth_scene(const std::string& name, const Context& ctx);

}  // namespace coppice::bench
