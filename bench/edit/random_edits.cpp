#include "random_edits.h"

#include "coppice/edit/cut.h"
#include "coppice/edit/deform.h"
#include "coppice/edit/join.h"
#include "coppice/edit/rigid.h"
#include "coppice/edit/thickness.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::bench {

std::vector<Kind> all_kinds() {
    using T = EditableTree;
    const auto kind = [](const char* name, std::function<EditChange(T&, Dice&)> edit) {
        return Kind{.name = name, .edit = std::move(edit), .seconds = {}};
    };
    return {
        kind("rotate", [](T& t, Dice& d) { return rotate(t, {d.node(t)}, {.angle = d.uniform(-0.5, 0.5)}); }),
        kind("translate",
             [](T& t, Dice& d) {
                 return translate(t, {d.node(t)}, {0, 0, d.uniform(0.01, 0.02)});
             }),
        kind("bend", [](T& t, Dice& d) { return bend(t, {d.node(t)}, d.uniform(-0.3, 0.3)); }),
        kind("twist", [](T& t, Dice& d) { return twist(t, {d.node(t)}, d.uniform(-0.3, 0.3)); }),
        kind("move a node",
             [](T& t, Dice& d) {
                 const StableId n = d.node(t);
                 const double r = double{t.radius(n)};
                 return move_node(t, n, t.origin() + Vec3d(t.position(n)) + Vec3d{r, 0, r}, 20 * r);
             }),
        kind("split", [](T& t, Dice& d) { return split(t, {d.node(t)}); }),
        kind("append",
             [](T& t, Dice& d) {
                 return append(t, d.node(t), {0.01, 0.02, d.uniform(0.01, 0.03)});
             }),
        kind("delete a twig",
             [](T& t, Dice& d) {
                 StableId n = d.node(t);
                 while (!t.is_tip(n)) n = t.first_child(n);
                 return remove_branches(t, {n});
             }),
        kind("detach", [](T& t, Dice& d) { return detach(t, {d.node(t)}); }),
        kind("graft", [](T& t, Dice& d) { return graft(t, d.node(t), d.node(t)); }),
        kind("radius", [](T& t, Dice& d) { return scale_radii(t, {d.node(t)}, 1.01); }),
        kind("pipe radii", [](T& t, Dice& d) { return pipe_radii(t, {d.node(t)}, 2.2); }),
    };
}

Skeleton EditFlags::skeleton() const {
    return tree.empty() ? random_tree(segments, seed) : read_skeleton(tree).skeleton;
}

void add_edit_flags(CLI::App& app, EditFlags& flags) {
    app.add_option("--tree", flags.tree, "Skeleton to edit instead of a synthetic tree.");
    app.add_option("--segments", flags.segments, "Number of segments of the synthetic tree.");
    app.add_option("--edits", flags.edits, "how many");
    app.add_option("--seed", flags.seed, "Random seed of the tree and the edits.");
    app.add_option("--markdown", flags.program.markdown, "Also write the table to this file.");
}

}  // namespace coppice::bench
