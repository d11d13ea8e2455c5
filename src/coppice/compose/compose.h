#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/compose/child_tree.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Direction of an inserted branch.
enum class ComposePose {
    host,  ///< direction of the branch that it replaces
    own,   ///< azimuth of the branch that it replaces, and the inclination that it had to its own parent
           ///< branch
};

template <>
struct EnumNames<ComposePose> {
    static constexpr std::array<std::string_view, 2> names{"host", "own"};
};

/// Radii of an inserted branch.
enum class ComposeRadii {
    scaled,  ///< its own, scaled so that its first radius relates to that of the replaced branch as their
             ///< lengths do by the pipe model, the number of tips being proportional to the length
    xu,  ///< at each node, including the first, r (l / L)^1.5, where r is the radius of the previous node, l
         ///< the length of all segments that the node carries and L that of the previous node [Xu2007]; never
         ///< below the radius of its tips
    pipes,  ///< radii of the whole tree by the pipe model [Shinozaki1964]
};

template <>
struct EnumNames<ComposeRadii> {
    static constexpr std::array<std::string_view, 3> names{"scaled", "xu", "pipes"};
};

/// Options of TreeComposer.
struct ComposeOptions {
    float probability = 0.7f;       ///< probability that a branch on a main axis is replaced; in [0, 1]
    float probability_falloff = 1;  ///< factor on the probability for each further order; in [0, 1]
    int depth = 3;  ///< number of passes: 1 replaces branches of the template, 2 also branches of the
                    ///< inserted ones, ...
    float tolerance = 0.5f;                ///< maximum relative difference of length from the replaced branch
    int order_tolerance = 1;               ///< maximum difference in the number of branch orders
    ComposePose pose = ComposePose::host;  ///< direction of inserted branches
    float turn = 0.2f;                     ///< [rad] maximum random deviation of directions
    float roll = 0.35f;                    ///< [rad] maximum random roll of branches about themselves
    float phototropism = 0;  ///< fraction by which directions are interpolated towards vertical; in [0, 1]
    ComposeRadii radii = ComposeRadii::scaled;  ///< radii of inserted branches
    float pipe_exponent = 2.5f;                 ///< exponent for `scaled` and `pipes`; in [2, 3]
    float clearance = 1;  ///< branches intersect where the distance of their axes is less than this factor
                          ///< times the sum of their radii; 0 disables the test
    int tries = 8;        ///< maximum number of candidate branches and rolls for each replacement
    int max_nodes = 50'000'000;  ///< maximum number of nodes; exceeding it is an error
};

/// Lists the members for front ends.
void list_fields(ComposeOptions& o, FieldList& list);

/// Counts of branches selected for replacement and of their outcomes.
struct ComposeReport {
    std::uint32_t chosen = 0;     ///< branches selected for replacement
    std::uint32_t replaced = 0;   ///< selected branches that were replaced
    std::uint32_t unmatched = 0;  ///< selected branches without a similar branch in the library
    std::uint32_t crossed = 0;    ///< candidates rejected because they intersect other branches
    std::uint32_t outside = 0;    ///< candidates rejected because they leave the crown
    std::uint32_t blocked = 0;    ///< selected branches left unchanged because all candidates were rejected
    std::uint32_t depth = 0;      ///< maximum nesting depth of inserted branches
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const ComposeReport& r, Visitor&& visit) {
    visit("chosen", r.chosen);
    visit("replaced", r.replaced);
    visit("unmatched", r.unmatched);
    visit("crossed_tries", r.crossed);
    visit("outside_tries", r.outside);
    visit("blocked", r.blocked);
    visit("depth", r.depth);
}

/// A composed tree.
struct ComposeResult {
    Skeleton skeleton;     ///< same origin as the template
    ComposeReport report;  ///< counts of replaced branches
};

/// Composes trees from a template by replacing branches at random, also branches of inserted ones, with child
/// trees of similar length and order [Zhu2015, figures 18 to 20].
///
/// An inserted branch begins at the branch node of the branch that it replaces. If its parent branch is
/// thicker than its original one, its first segment is longer by the difference. A leader has the first
/// radius of the leader that it replaces. A lateral has the first radius of the replaced one times (l /
/// l')^(1 / pipe_exponent), where l and l' are the total lengths of both, but at most that of its thickest
/// sibling.
///
/// The result depends only on the inputs and the seed. A composer may be shared between threads.
class TreeComposer {
  public:
    /// Throws InvalidInput if an option is out of range or the library is empty. O(library).
    TreeComposer(std::vector<ChildTree> library, const ComposeOptions& options);

    /// Composes a tree from `template_tree`. If `crown` is given, inserted branches stay inside it; it is
    /// in coordinates relative to the origin of the skeleton. About O(n log n) in the size of the result.
    /// Throws InvalidInput if the tree would exceed ComposeOptions::max_nodes; Cancelled.
    ComposeResult compose(const Skeleton& template_tree, std::uint64_t seed,
                          const SolidField* crown = nullptr, const Context& ctx = {}) const;

    /// A child tree with its precomputed sizes.
    struct Entry {
        ChildTree tree;                     ///< as passed to the constructor
        std::vector<double> length;         ///< [m] per node: length of the branch that begins there
        std::vector<std::uint32_t> orders;  ///< per node: number of orders of that branch
    };

  private:
    ComposeOptions options_;
    std::vector<Entry> entries_;  ///< sorted by length; laterals first, then leaders
    std::size_t laterals_ = 0;    ///< number of laterals
};

}  // namespace coppice
