#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/cage/cage.h"
#include "coppice/cage/cylinders.h"
#include "coppice/cuda/device.h"
#include "coppice/field/field_options.h"
#include "coppice/ramification/ramification.h"
#include "coppice/skeleton/prepare.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"
#include "coppice/tetra/march/march.h"

namespace coppice {

/// Method that builds a surface from a skeleton.
enum class MeshMethod {
    quads,          ///< a cage around the skeleton, subdivided and moved onto the field [Zhu2015]
    tetrahedra,     ///< triangles of the iso surface of the field, found in tetrahedra [Zhu2013]
    cylinders,      ///< a separate tube for every axis [Huang2017]
    ramifications,  ///< units at forks, connected or pasted, subdivided and moved onto the field [Huang2017]
    bmesh,          ///< as quads, but moved onto metaballs [Ji2010], the comparison of [Zhu2015]
};

template <>
struct EnumNames<MeshMethod> {
    static constexpr std::array<std::string_view, 5> names{"quads", "tetrahedra", "cylinders",
                                                           "ramifications", "bmesh"};
};

/// Property of the skeleton that a surface preserves.
enum class Fit {
    surface,   ///< vertices are on the field, with radii at which rings have the areas of the specified
               ///< circles
    volume,    ///< the surface encloses the volume of the skeleton's rounded cones, locally and as a whole
    automatic  ///< as `surface`, but quads as `volume` if their volume would deviate
};

template <>
struct EnumNames<Fit> {
    static constexpr std::array<std::string_view, 3> names{"surface", "volume", "automatic"};
};

/// Treatment of branches that intersect each other.
enum class Overlaps {
    merge,  ///< they are merged into one body if the axis of one runs inside the other
    graft,  ///< the section that enters another branch is cut off, and the section that leaves it is attached
            ///< there
    apart,  ///< trees are bent apart, so that each keeps its branches; within a tree as graft
    keep,   ///< they are kept and cross, and so do their quads
};

template <>
struct EnumNames<Overlaps> {
    static constexpr std::array<std::string_view, 4> names{"merge", "graft", "apart", "keep"};
};

/// Initial tetrahedra of the method `tetrahedra`.
enum class TetraBase {
    octree,     ///< a lattice, as fine as the local radius requires
    polyhedron  ///< a polyhedron around the branches, a few tetrahedra for each segment [Zhu2013]
};

template <>
struct EnumNames<TetraBase> {
    static constexpr std::array<std::string_view, 2> names{"octree", "polyhedron"};
};

/// Size and accuracy of the triangles of the method `tetrahedra`.
struct TetraOptions {
    TetraBase base = TetraBase::octree;  ///< initial tetrahedra, each of which is cut into eight
    float edge = 0.5f;                   ///< [radii] approximate edge length of the triangles
    /// More levels are faster for short edges, but grade less finely. The tetrahedra of a polyhedron are as
    /// wide as its sections and are cut as often as `edge` requires, independent of the levels: see
    /// polyhedron_levels.
    MarchOptions march{.levels = 1};
};

/// Returns the number of times that tetrahedra of a polyhedron three radii wide are cut to come closest to
/// `edge`: three at the default edge, as published, and at least one. Throws InvalidInput naming `edge` if it
/// is more than five.
int polyhedron_levels(const TetraOptions& options);

/// Lists the members for front ends.
void list_fields(TetraOptions& o, FieldList& list);

/// Texture coordinates of a surface.
enum class TextureCoordinates {
    none,  ///< no coordinates
    bark,  ///< around and along each branch, for a texture of bark that repeats
    atlas  ///< in the unit square without overlaps, for one image of the whole surface
};

template <>
struct EnumNames<TextureCoordinates> {
    static constexpr std::array<std::string_view, 3> names{"none", "bark", "atlas"};
};

/// Options of texture coordinates.
struct TextureOptions {
    TextureCoordinates coordinates = TextureCoordinates::none;  ///< kind of coordinates
    float tile = 0.4f;      ///< [m] width of one repetition of the texture; branches are a whole number of
                            ///< repetitions around, at least one; bark only
    float tile_height = 0;  ///< [m] height of one repetition; 0: as its width
    int atlas_size = 4096;  ///< [pixels] side of the image of an atlas, in which parts are two pixels apart
    bool blend = false;     ///< a second set of coordinates that hides where branches begin; bark only, and
                            ///< not for cylinders
};

/// Lists the members for front ends.
void list_fields(TextureOptions& o, FieldList& list);

/// Classes of the faces of a surface that can have different materials.
enum class MaterialSlot : std::uint8_t {
    bark,  ///< all faces that are in no other slot
    twig,  ///< bark of thin branches
    cut,   ///< flat ends
};

/// Options of the slots of faces, for surfaces with bark coordinates.
struct SlotOptions {
    bool twigs = false;  ///< whether twigs have a slot of their own; not for cylinders
    /// [m] Branches are twigs from the place on beyond which no part of them is thicker: a ring of edges
    /// separates the slots, on surfaces of triangles and in remeshed places a jagged line.
    float twig_diameter = 0.02f;
    float twig_tile = 0;  ///< [m] width of one repetition of the texture around twigs; 0: as elsewhere
    bool cuts = false;  ///< whether flat ends have a slot of their own, with the coordinates of a picture of
                        ///< a cut that fills the unit square
};

/// Lists the numbers for front ends; the slots follow from the materials.
void list_fields(SlotOptions& o, FieldList& list);

/// Options of the surface of a skeleton. Tetrahedra only use prepare, field, tetra, and the ends of control;
/// cylinders only levels, prepare, control and tube_sides. Surfaces that are moved along with their skeleton
/// have the same number of quads around all branches.
struct MeshOptions {
    MeshMethod method = MeshMethod::quads;  ///< kind of faces: quads, triangles or tubes
    int levels = 2;          ///< number of subdivisions of the cage, or of the tetrahedra, which begin larger
    Fit fit = Fit::surface;  ///< property that the final positions of the vertices preserve
    Overlaps overlaps = Overlaps::merge;  ///< treatment of branches that intersect each other
    float graft = 0.6f;      ///< [sum of radii] branches with axes closer than this overlap; 0 = no overlaps
    PrepareOptions prepare;  ///< preparation of the skeleton
    ControlOptions control;  ///< the cage, and the ends of branches
    FieldOptions field;      ///< the surface that the radii specify
    ProjectOptions project;  ///< projection of the cage onto the field
    UntangleOptions untangle;          ///< removal of folds
    int remesh_rounds = 12;            ///< maximum number of rounds that find and remesh crossing quads
    TetraOptions tetra;                ///< used by tetrahedra only
    RamificationOptions ramification;  ///< used by ramifications only
    TubeSides tube_sides = TubeSides::automatic;  ///< faces around thin axes; not for tetrahedra
    /// [m] With sides by radius: maximum distance of the sides of sections from their circles; 0 = the
    /// distance at the thickest axis, where the levels determine the number of sides. Quads only.
    float chord_error = 0;
    TextureOptions texture;             ///< texture coordinates; not listed with the others
    SlotOptions slots;                  ///< classes of the faces; not listed with the others
    bool attributes = false;            ///< attributes of the vertices; not listed with the others
    Device device = Device::automatic;  ///< device that subdivides quads and samples tetrahedra
};

/// Lists the members for front ends.
void list_fields(MeshOptions& o, FieldList& list);

/// Returns the options of a surface that is written to a file: its volume is measured and repaired.
inline MeshOptions options_of_written_surface() {
    MeshOptions options;
    options.fit = Fit::automatic;
    return options;
}

}  // namespace coppice
