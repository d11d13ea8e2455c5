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

/// A skeleton, and a mesh or a cloud made of it, from which it is to be found again.
struct TruthScene {
    std::string name;
    Skeleton truth;
    std::variant<PolygonMesh, PointSet> input;

    bool is_cloud() const { return std::holds_alternative<PointSet>(input); }
    std::size_t input_size() const;  ///< vertices that faces use, or points
};

/// The scenes that are measured when none is named.
std::vector<std::string> default_truth_scenes();

/// The kinds of input, in the order of their explanation in docs/user/comparing.md.
std::vector<std::string_view> truth_kinds();

/// A scene by its name TREE:KIND. TREE is what `make_scene` takes: tree300, tree3k, ..., or a file. KIND:
///   mesh       the closed surface with its defaults, two levels of subdivision
///   coarse     the same at one level
///   noise      mesh, with noise of a tenth of the least radius along the normals
///   holes      mesh, with one hole of five least radii for every 50 segments
///   decimated  mesh in triangles, edges collapsed until a third of the vertices is left
///   cloud      points all over the mesh: 100,000, or 500,000 from 10,000 segments on; noise of 1 mm
///   scan       as many as six scanners see from two diagonals of the tree away; noise of 1 mm in range
/// Throws InvalidInput, IoError.
TruthScene make_truth_scene(const std::string& name, const Context& ctx);

}  // namespace coppice::bench
