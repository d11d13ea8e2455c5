#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/mesh/instances.h"

namespace coppice {

/// The outlines of blades without lobes; each one is a pair of exponents, see LeafShape::base_exponent.
enum class LeafOutline {
    elliptic,    ///< widest in the middle: apple
    ovate,       ///< widest below the middle: beech
    obovate,     ///< widest above the middle: oak
    lanceolate,  ///< narrow, widest below the middle: willow
    linear,      ///< with parallel sides
    cordate,     ///< a heart with lobes behind the petiole: lime, hazel
    triangular,  ///< with a broad base and straight sides: birch
    rhombic,     ///< with a tapered base and a long tip: poplar
    orbicular,   ///< nearly round
};

template <>
struct EnumNames<LeafOutline> {
    static constexpr std::array<std::string_view, 9> names{"elliptic",   "ovate",   "obovate",
                                                           "lanceolate", "linear",  "cordate",
                                                           "triangular", "rhombic", "orbicular"};
};

/// The arrangements of lobes.
enum class LeafLobes {
    none,     ///< no lobes
    pinnate,  ///< lobes along both sides: oak
    palmate,  ///< lobes around the end of the petiole: maple
};

template <>
struct EnumNames<LeafLobes> {
    static constexpr std::array<std::string_view, 3> names{"none", "pinnate", "palmate"};
};

/// The margins of blades.
enum class LeafMargin {
    entire,          ///< smooth
    serrate,         ///< teeth that point towards the tip
    double_serrate,  ///< large teeth with small ones
    crenate,         ///< rounded teeth
};

template <>
struct EnumNames<LeafMargin> {
    static constexpr std::array<std::string_view, 4> names{"entire", "serrate", "double_serrate", "crenate"};
};

/// The parts of a leaf.
enum class LeafParts {
    simple,   ///< one blade
    palmate,  ///< leaflets around the end of the petiole: horse chestnut
    pinnate,  ///< pairs of leaflets and one at the end: ash
    needles,  ///< a single needle, or a bundle of several: spruce, pine
};

template <>
struct EnumNames<LeafParts> {
    static constexpr std::array<std::string_view, 4> names{"simple", "palmate", "pinnate", "needles"};
};

/// Shape of a leaf; the defaults are those of an elliptic leaf with a smooth margin. Lengths and widths of
/// compound leaves are those of the largest leaflet.
struct LeafShape {
    LeafParts parts = LeafParts::simple;          ///< division into leaflets or needles
    LeafOutline outline = LeafOutline::elliptic;  ///< outline without lobes and teeth
    LeafLobes lobes = LeafLobes::none;            ///< arrangement of the lobes
    LeafMargin margin = LeafMargin::entire;       ///< teeth
    float length = 0.08f;  ///< [m] of the blade from the petiole to the tip; in [1e-3, 10]
    float width = 0.04f;   ///< [m] of the blade; in [1e-4, 10]
    /// The half-width at the fraction t of the length is proportional to t^a (1 - t)^b: a; 0: that of the
    /// outline; in [0, 4].
    float base_exponent = 0;
    float tip_exponent = 0;         ///< b of that formula; 0: that of the outline; in [0, 4]
    int leaflets = 5;               ///< number of leaflets, or of needles in a bundle; in [1, 301]
    float leaflet_angle = 0.7f;     ///< [rad] between leaflets, or of needles to the bundle; in [0, 1.6]
    float leaflet_spacing = 1.15f;  ///< distance of pairs of leaflets per width of a leaflet; in [0.1, 10]
    float leaflet_taper = 0;        ///< share by which pairs are shorter at the tip of the leaf; in [0, 1]
    int lobe_count = 4;             ///< lobes on each side, or around the petiole if palmate; in [1, 15]
    float lobe_depth = 0.45f;       ///< depth of the sinuses per half-width; in [0, 0.95]
    int teeth = 20;                 ///< number of teeth on each side; in [1, 200]
    float tooth_depth = 0.02f;      ///< height of the teeth per length of the blade; in [0, 0.2]
    int veins = 7;                  ///< pairs of secondary veins; in [0, 60]
    float vein_angle = 0.85f;       ///< [rad] between secondary veins and the midrib; in [0.3, 1.57]
    float fold = 0.2f;              ///< [rad] by which each half is raised at the midrib; in [-1.5, 1.5]
    float cup = 0.15f;              ///< [rad] by which each half bends up towards the margin; in [-3, 3]
    float curl = 0.4f;              ///< [rad] by which the blade bends down towards the tip; in [-3, 3]
    float arch = 0;                 ///< [rad] by which a whole leaf bends down towards its tip; in [-3, 3]
    float wave = 0;                 ///< height of the waves of the margin per length; in [0, 0.2]
    float petiole_length = 0.015f;  ///< [m] in [0, 2]
    float petiole_width = 0.0015f;  ///< [m] in [1e-4, 0.1]
    float blade_angle = 0.2f;       ///< [rad] by which the blade bends down at the petiole; in [-1.6, 1.6]
    int rows = 10;                  ///< number of rows of faces along a blade or a needle; in [2, 200]
    int columns = 1;                ///< number of faces across each half of a blade; in [1, 16]
};

/// Lists the members for front ends.
void list_fields(LeafShape& o, FieldList& list);

/// A leaf to be placed on a tree.
struct LeafModel {
    Prototype prototype;  ///< its mesh; see Prototype for its frame
    double area = 0;      ///< [m^2] of its blades, of one side; of needles half of their surface
};

/// Makes the mesh of a leaf: the blade with its fold, curl and waves, or its leaflets or needles, and a
/// petiole with three sides. Neighbouring faces of a blade have the same orientation; its upper side faces
/// +z. The texture is the leaf before it is bent, so that the image of make_leaf_image() fits. Lobes and
/// teeth need rows: a blade with fewer than two rows for each tooth has a smooth margin. The mesh of a blade
/// with an entire margin has 4 rows x columns triangles, less those at the base and the tip. O(rows columns).
/// Throws InvalidInput if a number is out of range.
///
/// Sources: outlines by exponents as in a beta distribution; see docs/decisions/0038-foliage.md.
LeafModel make_leaf(const LeafShape& shape);

/// Returns `count` models of a shape that differ in fold, curl, cup, blade angle and size of the waves by up
/// to a third. Throws InvalidInput for a count that is not in [1, 1000].
std::vector<LeafModel> make_leaves(const LeafShape& shape, int count, int seed = 0);

/// Returns a rectangle of two triangles that bounds the unbent leaf, with the same texture as make_leaf() and
/// the same area of the leaf. Throws InvalidInput if a number is out of range.
LeafModel make_leaf_card(const LeafShape& shape);

}  // namespace coppice
