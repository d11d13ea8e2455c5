#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/fields.h"

namespace coppice {

/// The action of a menu item.
enum class MenuAction {
    tool,       ///< activates a tool of the page
    line,       ///< runs a line of the scene
    page,       ///< runs a command of the page
    set,        ///< sets the initial value of an argument in forms
    program,    ///< starts a program that the user allowed
    separator,  ///< none: a line between items
};

template <>
struct EnumNames<MenuAction> {
    static constexpr std::array<std::string_view, 6> names{"tool", "line",    "page",
                                                           "set",  "program", "separator"};
};

/// An item of the menu.
struct MenuItem {
    std::string menu;                         ///< the menu that contains it
    std::string label;                        ///< displayed text
    MenuAction does = MenuAction::separator;  ///< action of the item
    std::string text = {};                    ///< tool, line, command or setting
    std::vector<std::string> words = {};      ///< for a program: its words
};

/// The menu of the studio: ordered items, those of one menu together. docs/user/studio.md documents the
/// format:
///
///     [Crown]
///     Ball = line sphere ${new crown} radius=2
///     ---
///     Place a solid = tool place
///     [Programs]
///     Open in Blender = program blender ${file}
///
/// An additional file extends the menu: an item with the menu and label of an existing one replaces it,
/// `LABEL = nothing` removes it, and a line `clear` before the first menu removes all items.
class Menu {
  public:
    Menu();  ///< the built-in menu, without programs

    /// Adds the items of a user's file. Returns the errors, one sentence for each line that is skipped, with
    /// `source` and the line.
    std::vector<std::string> add(std::string_view text, const std::string& source);

    std::span<const MenuItem> items() const { return items_; }  ///< items are numbered by their position

  private:
    std::vector<MenuItem> items_;
};

/// Returns the text of the built-in menu, as the start of a custom file.
std::string_view built_in_menu();

}  // namespace coppice
