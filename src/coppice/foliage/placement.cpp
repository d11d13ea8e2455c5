#include "coppice/foliage/placement.h"

namespace coppice {
namespace {

void list_arrangement(LeafRules& o, FieldList& list) {
    list.add(common_field("arrangement", "Arrangement of the leaves on a shoot."), o.arrangement);
    list.add(common_field("season", "Season, which sets sizes, colours and the share of fallen leaves."),
             o.season);
    list.add(Field{"evergreen", "Keep the leaves in winter."}, o.evergreen);
    list.add(common_field("max_radius", "Maximum radius of leafy shoots; 0 is twice the median of all tips.",
                          Unit::metre, 0, 1),
             o.max_radius);
    list.add(common_field("shoot_length", "Length of the leafy end of an axis.", Unit::metre, 1e-3, 100),
             o.shoot_length);
    list.add(
        Field{"min_order", "Minimum branch order of leafy shoots; 0 includes stems.", Unit::none, 0, 1000},
        o.min_order);
    list.add(common_field("internode", "Mean distance between the nodes of a shoot.", Unit::metre, 2e-4, 10),
             o.internode);
    list.add(Field{"clustering", "Degree to which leaves gather at the tip of a shoot.", Unit::none, 0, 1},
             o.clustering);
    list.add(Field{"divergence", "Angle around the shoot between one leaf and the next of a spiral.",
                   Unit::radian, 0, 6.2832},
             o.divergence);
    list.add(Field{"whorl", "Number of leaves at a node of whorled leaves.", Unit::none, 2, 50}, o.whorl);
}

void list_form(LeafRules& o, FieldList& list) {
    list.add(common_field("angle", "Angle of the petiole to the shoot.", Unit::radian, 0, 3.1416), o.angle);
    list.add(Field{"light", "Share by which leaves turn level, with the upper side up.", Unit::none, 0, 1},
             o.light);
    list.add(common_field("droop", "Angle by which leaves hang down.", Unit::radian, -1.6, 1.6), o.droop);
    list.add(Field{"spread", "Standard deviation of all angles of leaves.", Unit::radian, 0, 1.6}, o.spread);
    list.add(common_field("size", "Factor of the size of all leaves.", Unit::none, 0.01, 100), o.size);
    list.add(Field{"size_spread", "Maximum relative deviation of the sizes of leaves.", Unit::none, 0, 0.9},
             o.size_spread);
    list.add(Field{"base_size", "Size of leaves at the base of a shoot relative to those at its tip.",
                   Unit::none, 0.05, 5},
             o.base_size);
    list.add(common_field("density", "Share of the leaves that are kept.", Unit::none, 0, 1), o.density);
    list.add(
        Field{"max_index",
              "Maximum leaf area index in summer, to which leaves or branchlets are thinned out; 0 is no "
              "limit.",
              Unit::none, 0, 100},
        o.max_index);
    list.add(
        Field{"color_spread", "Maximum relative deviation of the brightness of leaves.", Unit::none, 0, 1},
        o.color_spread);
    list.add(Field{"young_color", "Colour of young leaves in sRGB from 0 to 1; by default light green."},
             o.young_color);
    list.add(Field{"summer_color", "Colour of leaves in summer in sRGB; by default green."}, o.summer_color);
    list.add(Field{"autumn_color", "Colour of leaves in autumn in sRGB; by default yellow."}, o.autumn_color);
    list.add(common_field("seed", "Seed of all random numbers.", Unit::none, 0, 2147483647), o.seed);
}

}  // namespace

void list_fields(LeafRules& o, FieldList& list) {
    list_arrangement(o, list);
    list_form(o, list);
}

}  // namespace coppice
