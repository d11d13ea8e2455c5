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

/// Which way a branch that is put in points.
enum class ComposePose {
    host,  ///< where the branch pointed that it replaces
    own,   ///< about its host as on that branch's side, but as far from the axis as on its own host
};

template <>
struct EnumNames<ComposePose> {
    static constexpr std::array<std::string_view, 2> names{"host", "own"};
};

/// What radii a branch gets that is put in.
enum class ComposeRadii {
    scaled,  ///< its own, times what makes its first as thick as its length asks for beside the one
             ///< replaced, by the pipe model: segments are about as many as tips
    xu,  ///< at every node, the first too, r (l / L)^1.5 of the radius r of the node before, where l is the
         ///< length of all segments that hang on the one and L on the other [Xu2007]; never below its tips'
    pipes,  ///< all of the tree's by the pipe model [Shinozaki1964]
};

template <>
struct EnumNames<ComposeRadii> {
    static constexpr std::array<std::string_view, 3> names{"scaled", "xu", "pipes"};
};

/// How a tree is composed.
struct ComposeOptions {
    float probability = 0.7f;  ///< that a branch is replaced, for those on the main axis; in [0, 1]
    float probability_falloff =
        1;                    ///< the same for each order more, over that of the order before; in [0, 1]
    int depth = 3;            ///< times that branches of branches that were put in are replaced again, and 1
    float tolerance = 0.5f;   ///< how much longer or shorter than the branch replaced, as a part of it
    int order_tolerance = 1;  ///< how many orders of branches more or less
    ComposePose pose = ComposePose::host;  ///< which way branches point
    float turn = 0.2f;                     ///< [rad] by which directions stray at most
    float roll = 0.35f;                    ///< [rad] by which branches are rolled about themselves at most
    float phototropism = 0;                ///< part of the way from their direction to straight up; in [0, 1]
    ComposeRadii radii = ComposeRadii::scaled;  ///< how thick they get
    float pipe_exponent = 2.5f;                 ///< of scaled and pipes; in [2, 3]
    float clearance = 1;  ///< where axes come nearer than this many times both radii, branches cross; 0
                          ///< does not look for it
    int tries = 8;        ///< branches and rolls tried for each that is to be replaced
    int max_nodes = 50'000'000;  ///< a tree that would get more is an error
};

template <class Self, class Visitor>
requires SameOptions<Self, ComposeOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(
        common_field("probability", "Probability that a branch on a main axis is replaced", Unit::none, 0, 1),
        o.probability);
    visit(Field{"probability_falloff", "of each order more, over that of the order before", Unit::none, 0, 1},
          o.probability_falloff);
    visit(common_field("depth",
                       "Number of replacement passes: 1 replaces branches of the template, 2 also branches "
                       "of the inserted ones, and so on",
                       Unit::none, 1, 20),
          o.depth);
    visit(Field{"tolerance", "how much longer or shorter than what it replaces, as a part of that",
                Unit::none, 0, 100},
          o.tolerance);
    visit(Field{"order_tolerance", "how many orders of branches more or less than what it replaces",
                Unit::none, 0, 100},
          o.order_tolerance);
    visit(Field{"pose", "points where the replaced one did, or is inclined as on its own host"}, o.pose);
    visit(Field{"turn", "directions stray by so much at most", Unit::radian, 0, 3.15}, o.turn);
    visit(Field{"roll", "branches are rolled about themselves by so much at most", Unit::radian, 0, 3.15},
          o.roll);
    visit(Field{"phototropism", "part of the way from their direction to straight up", Unit::none, 0, 1},
          o.phototropism);
    visit(common_field("radii",
                       "Radii of inserted branches: scaled to the branch replaced, by what each node "
                       "carries, or by the pipe model"),
          o.radii);
    visit(Field{"pipe_exponent", "of the pipe model, for scaled radii and pipes", Unit::none, 2, 3},
          o.pipe_exponent);
    visit(Field{"clearance", "axes may not come nearer than this many times both radii; 0 does not look",
                Unit::none, 0, 100},
          o.clearance);
    visit(Field{"tries", "branches and rolls tried for each that is to be replaced", Unit::none, 1, 1000},
          o.tries);
    visit(Field{"max_nodes", "a tree that would get more, those that were replaced too, is refused",
                Unit::none, 1, 5e7},
          o.max_nodes);
}

/// What became of the branches that were to be replaced.
struct ComposeReport {
    std::uint32_t chosen = 0;     ///< branches that were to be replaced
    std::uint32_t replaced = 0;   ///< of these, those that were
    std::uint32_t unmatched = 0;  ///< of these, those like which there is none in the library
    std::uint32_t crossed = 0;    ///< tries that would have crossed other branches
    std::uint32_t outside = 0;    ///< tries that would have left the crown
    std::uint32_t blocked = 0;    ///< of the chosen, those for which all tries failed; they stay as they were
    std::uint32_t depth = 0;      ///< greatest number of branches put one into another
};

/// A composed tree.
struct ComposeResult {
    Skeleton skeleton;     ///< origin as the template's
    ComposeReport report;  ///< what was done
};

/// Composes trees of a template by replacing branches, at random and again within what was put in, by child
/// trees of like length and order [Zhu2015, figures 18 to 20].
///
/// A branch that is put in sits at the branch node of the one that it replaces; on a thicker host than its
/// own its first segment is as much longer. A leader is as thick as the one before. A lateral is as thick as
/// the one before times (l / l')^(1 / pipe_exponent), where l and l' are the lengths of all segments of both,
/// but no thicker than the leader beside it.
///
/// The same seed makes the same tree. Threads may share a composer.
class TreeComposer {
  public:
    /// O(library). Throws InvalidInput when an option is out of its range or the library is empty.
    TreeComposer(std::vector<ChildTree> library, const ComposeOptions& options);

    /// Branches leave `crown`, if there is one, nowhere; it is in the coordinates of the skeleton's origin.
    /// About O(n log n) of the result. Throws InvalidInput where the tree would grow beyond
    /// ComposeOptions::max_nodes; Cancelled.
    ComposeResult compose(const Skeleton& host, std::uint64_t seed, const SolidField* crown = nullptr,
                          const Context& ctx = {}) const;

    /// A child tree with what is looked up of it again and again.
    struct Entry {
        ChildTree tree;                     ///< as it was given
        std::vector<double> length;         ///< [m] per node, of the branch that begins there
        std::vector<std::uint32_t> orders;  ///< per node, of that branch
    };

  private:
    ComposeOptions options_;
    std::vector<Entry> entries_;  ///< by length, those that lead apart from the others
    std::size_t laterals_ = 0;    ///< number of entries that do not lead, which come first
};

}  // namespace coppice
