#include "coppice/sketch/sketch.h"

#include <cmath>
#include <set>

#include "coppice/base/error.h"

namespace coppice {
namespace {

template <class List>
void check_names(const List& list, const std::string& where) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string place = where + "[" + std::to_string(i) + "].name";
        if (list[i].name.empty()) throw InvalidInput(place + " is missing");
        if (!names.insert(list[i].name).second)
            throw InvalidInput(place + ": '" + list[i].name + "' is already the name of another one");
    }
}

void check_widths(const Stroke& stroke, const std::string& where) {
    const std::size_t count = stroke.widths.size();
    if (count != 0 && count != 2 && count != stroke.points.size()) {
        throw InvalidInput(where + ".widths must contain two numbers, or one for each of the " +
                           std::to_string(stroke.points.size()) + " points, not " + std::to_string(count));
    }
    for (const double width : stroke.widths)
        if (!(width > 0) || !std::isfinite(width)) throw InvalidInput(where + ".widths must be above 0");
}

void check_stroke(const Sketch& sketch, const Stroke& stroke, std::set<std::uint32_t>& views,
                  const std::string& branch) {
    if (stroke.view >= sketch.views.size()) throw InvalidInput(branch + ".strokes: there is no such view");
    const std::string where = branch + ".strokes." + sketch.views[stroke.view].name;
    if (!views.insert(stroke.view).second) throw InvalidInput(where + " occurs twice");
    if (stroke.points.size() < 2) throw InvalidInput(where + ".points must contain at least two points");
    for (std::size_t i = 0; i < stroke.points.size(); ++i) {
        if (!(std::abs(stroke.points[i].x) < 1e9 && std::abs(stroke.points[i].y) < 1e9))
            throw InvalidInput(where + ".points[" + std::to_string(i) + "] is outside of every picture");
    }
    check_widths(stroke, where);
}

void check_branch(const Sketch& sketch, const SketchBranch& branch, const std::string& where) {
    if (branch.parent && *branch.parent >= sketch.branches.size())
        throw InvalidInput(where + ".parent: there is no such branch");
    if (branch.attach && !(*branch.attach >= 0 && *branch.attach <= 1))
        throw InvalidInput(where + ".attach must be between 0 and 1");
    if (branch.attach && !branch.parent) throw InvalidInput(where + ".attach needs a parent");
    if (branch.diameters) {
        for (const double d : *branch.diameters)
            if (!(d > 0) || !std::isfinite(d)) throw InvalidInput(where + ".diameters must be above 0");
    }
    std::set<std::uint32_t> views;
    for (const Stroke& stroke : branch.strokes) check_stroke(sketch, stroke, views, where);
}

void check_circles(const Sketch& sketch, const std::string& where) {
    // 0 = not visited, 1 = on the current path, 2 = connected to a stem
    std::vector<char> state(sketch.branches.size(), 0);
    std::vector<std::uint32_t> way;
    for (std::uint32_t i = 0; i < sketch.branches.size(); ++i) {
        way.clear();
        std::optional<std::uint32_t> at = i;
        while (at && state[*at] == 0) {
            state[*at] = 1;
            way.push_back(*at);
            at = sketch.branches[*at].parent;
        }
        if (at && state[*at] == 1) {
            throw InvalidInput(where + "[" + std::to_string(*at) + "].parent: '" + sketch.branches[*at].name +
                               "' is its own ancestor");
        }
        for (const std::uint32_t b : way) state[b] = 2;
    }
}

}  // namespace

void validate(const Sketch& sketch, const std::string& source) {
    const std::string start = source + ": ";
    if (sketch.views.size() < 2) throw InvalidInput(start + "views: a sketch needs at least two");
    if (sketch.branches.empty()) throw InvalidInput(start + "branches: a sketch needs at least one");
    check_names(sketch.views, start + "views");
    check_names(sketch.branches, start + "branches");
    for (std::size_t i = 0; i < sketch.views.size(); ++i)
        validate(sketch.views[i], start + "views[" + std::to_string(i) + "]");
    for (std::size_t i = 0; i < sketch.branches.size(); ++i)
        check_branch(sketch, sketch.branches[i], start + "branches[" + std::to_string(i) + "]");
    check_circles(sketch, start + "branches");
}

}  // namespace coppice
