#include "coppice/pipeline/mesh_options.h"

#include "coppice/base/option_fields.h"

namespace coppice {

void list_fields(TetraOptions& o, FieldList& list) {
    list.add(
        Field{"tetra_base",
              "Initial tetrahedra: those of an octree around the branches, or of a polyhedron with a few "
              "for each segment, which are cut into eight as often as edge requires."},
        o.base);
    list.add(Field{"tetra_edge", "Approximate edge length of the triangles of the method tetrahedra.",
                   Unit::radius, 0.05, 4},
             o.edge);
    list.add(Field{"tetra_levels", "Number of times that the tetrahedra of an octree are cut into eight.",
                   Unit::none, 0, 4},
             o.march.levels);
    list_accuracy_fields(o.march, list);
}

void list_fields(TextureOptions& o, FieldList& list) {
    list.add(
        common_field("uv",
                     "Texture coordinates: none, those of bark, around and along each branch, or those of "
                     "an atlas, in the unit square without overlaps."),
        o.coordinates);
    list.add(Field{"tile",
                   "Width of one repetition of the texture; there is a whole number of them around a branch.",
                   Unit::metre, 1e-6, 1e6},
             o.tile);
    list.add(Field{"tile_height", "Extent of the tile along the stem; 0 makes it as high as wide.",
                   Unit::metre, 0, 1e6},
             o.tile_height);
    list.add(Field{"atlas_size",
                   "Side of the image in pixels for which an atlas is packed, with two pixels between its "
                   "parts.",
                   Unit::none, 64, 65536},
             o.atlas_size);
    list.add(Field{"uv_blend",
                   "Add a second set of bark coordinates with weights, which continues the bark of the stem "
                   "into branches and hides the rings where the number of tiles changes."},
             o.blend);
}

void list_fields(SlotOptions& o, FieldList& list) {
    list.add(
        Field{"twig_diameter", "Diameter below which branches have the material of twigs up to their tips.",
              Unit::metre, 1e-6, 1e6},
        o.twig_diameter);
    list.add(
        Field{"twig_tile",
              "Width of one repetition of the texture around twigs, in the shape of the tile; 0 makes it "
              "as wide as on the other branches.",
              Unit::metre, 0, 1e6},
        o.twig_tile);
}

void list_fields(MeshOptions& o, FieldList& list) {
    list.add(
        common_field("method",
                     "Kind of surface: quads along the branches, triangles of the level set, one tube per "
                     "axis, quads of ramification units, or quads on metaballs."),
        o.method);
    list.add(
        common_field("levels", "Number of subdivisions of the control cage; each divides a quad into four.",
                     Unit::none, 0, 6),
        o.levels);
    list.add(common_field(
                 "fit",
                 "Property that the surface preserves: the areas of sections of branches, the volume of the "
                 "rounded cones of the skeleton, or automatically the volume for quads if it would deviate."),
             o.fit);
    list.add(
        common_field("overlaps",
                     "Treatment of branches that intersect each other: they are merged into one body, one "
                     "is cut off and grafted onto the other, trees are bent apart, or they are kept."),
        o.overlaps);
    list.add(Field{"graft",
                   "Maximum distance between the axes of overlapping branches, as a multiple of the sum of "
                   "their radii; 0 disables the detection of overlaps.",
                   Unit::none, 0, 1},
             o.graft);
    list.add(Field{"prepare", "Preparation of the skeleton"}, o.prepare);
    list.add(Field{"control", "Control cage"}, o.control);
    list.add(Field{"field", "Convolution field"}, o.field);
    list.add(Field{"project", "Projection onto the field"}, o.project);
    list.add(Field{"untangle", "Unfolding"}, o.untangle);
    list.add(Field{"remesh_rounds",
                   "Maximum number of rounds that find and remesh crossing quads; 0 disables the remeshing.",
                   Unit::none, 0, 100},
             o.remesh_rounds);
    list.add(Field{"tetra", "Tetrahedra"}, o.tetra);
    list.add(Field{"ramification", "Ramifications"}, o.ramification);
    list.add(
        Field{"tube_sides",
              "Number of faces around thin branches: the same as around thick ones, proportional to the "
              "root of the radius (at least 4), or automatically by radius if a number of faces is given."},
        o.tube_sides);
    list.add(
        Field{"chord_error",
              "Maximum distance of the sides of sections from their circles with tube_sides by_radius; 0 "
              "uses the distance at the thickest axis, where the levels determine the number of sides.",
              Unit::metre, 0, 1e6},
        o.chord_error);
    list.add(
        Field{"device",
              "Device that computes the surface: a GPU if there is one and the surface is large, the CPU, "
              "or a GPU with CUDA."},
        o.device);
}

}  // namespace coppice
