#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"

namespace coppice {

/// What an item of the menu does.
enum class MenuAction {
    tool,       ///< puts a tool of the page in hand
    line,       ///< runs a line of the scene
    page,       ///< a command of the page itself
    set,        ///< what an argument is from now on, where forms begin
    program,    ///< starts a program that the user allowed
    separator,  ///< nothing: a line between items
};

template <>
struct EnumNames<MenuAction> {
    static constexpr std::array<std::string_view, 6> names{"tool", "line",    "page",
                                                           "set",  "program", "separator"};
};

/// An item of the menu.
struct MenuItem {
    std::string menu;                         ///< that it stands in
    std::string label;                        ///< as it is shown
    MenuAction does = MenuAction::separator;  ///< when it is chosen
    std::string text = {};                    ///< what is put in hand, run or set
    std::vector<std::string> words = {};      ///< of a program: its words
};

/// The menu of the studio: items in order, those of one menu together. docs/user/studio.md explains its text:
///
///     [Crown]
///     Ball = line sphere ${new crown} radius=2
///     ---
///     Place a solid = tool place
///     [Programs]
///     Open in Blender = program blender ${file}
///
/// A file that is added extends what is there: an item of the same menu and label takes the place of the one
/// that there was, `LABEL = nothing` takes it out, and a line `clear` before the first menu takes all out.
class Menu {
  public:
    Menu();  ///< what is built in, without programs

    /// Adds what a user's own file says. Returns what is wrong with it, a sentence for each line that is left
    /// out; it names `source` and the line.
    std::vector<std::string> add(std::string_view text, const std::string& source);

    std::span<const MenuItem> items() const { return items_; }  ///< an item's number is its place

  private:
    std::vector<MenuItem> items_;
};

/// The text of what is built in, to begin a file of one's own with.
std::string_view built_in_menu();

}  // namespace coppice
