#include "coppice/field/field_options.h"

#include "coppice/base/option_fields.h"

namespace coppice {

void list_fields(FieldOptions& o, FieldList& list) {
    list.add(Field{"kernel", "Kernel that is integrated along the segments."}, o.kernel);
    list.add(Field{"support",
                   "Distance at which the influence of a segment ends, for the quartic kernel and balls.",
                   Unit::radius, 1.1, 4},
             o.support);
    list.add(Field{"kernel_width", "Sharpness of the Cauchy kernel, times the reciprocal of the radius.",
                   Unit::none, 0.5, 8},
             o.width);
    list.add(Field{"ball_bulge", "Maximum difference of the radii of a long branch, at and between balls.",
                   Unit::radius, 0.0005, 0.5},
             o.ball_bulge);
    list.add(Field{"reach", "Distance beyond which segments are ignored, for the Cauchy kernel.",
                   Unit::radius, 1.5, 32},
             o.reach);
    list.add(
        Field{"tip_extension",
              "Length of the skeleton line beyond tips; a negative value makes round tips of one radius.",
              Unit::radius, -1, 4},
        o.tip_extension);
    list.add(Field{"root_extension",
                   "Length of the skeleton line below roots; a negative value makes round ends as at tips.",
                   Unit::radius, -1, 4},
             o.root_extension);
    list.add(
        Field{"blend",
              "Exponent that combines axes: 1 is the plain sum; 2, 4 and 8 make increasingly tight forks.",
              Unit::none, 1, 8},
        o.blend);
    list.add(Field{"contact",
                   "Strength with which branches that would cross repel each other; 0 disables the contact.",
                   Unit::none, 0, 10},
             o.contact);
    list.add(Field{"radius_scale",
                   "Factor on all radii; 0 uses the factor at which rings of quads have the area of the "
                   "specified circles, 1 places vertices at the radius.",
                   Unit::none, 0, 2},
             o.radius_scale);
    list.add(Field{"weights",
                   "Weights of the segments: local weights treat each segment as if it were alone; global "
                   "weights are fitted together to points on the given surface, by the plain sum of all "
                   "segments (blend 1 is used)."},
             o.weights);
    list.add(
        Field{"constraint_density", "Mean number of points per segment to which global weights are fitted.",
              Unit::none, 4, 256},
        o.constraint_density);
    list.add(Field{"weight_averaging",
                   "Number of times that fitted global weights are averaged with those of adjacent segments.",
                   Unit::none, 0, 100},
             o.weight_averaging);
}

}  // namespace coppice
