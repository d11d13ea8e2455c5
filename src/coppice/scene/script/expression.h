#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>

namespace coppice {

/// What a variable of a scene holds: a number or a text.
using SceneValue = std::variant<double, std::string>;

/// The variables of a scene, and how far its random numbers have been drawn.
struct SceneVariables {
    std::map<std::string, SceneValue, std::less<>> values;  ///< by name
    int seed = 0;                                           ///< of random(); >= 0
    std::uint64_t draws = 0;  ///< calls of random() since the seed was set: the next draw is this one
};

/// The value of an expression: numbers with + - * / % ^, comparisons, and, or, not, parentheses, functions
/// (angles in degrees), names of variables, and texts in double quotes. docs/user/scenes.md lists them. What
/// is true is 1, what is false 0. random() moves `variables.draws` on.
///
/// Throws InvalidInput, one sentence without the place: a name that is not known (with the nearest), what is
/// no expression, a text where a number has to stand, a result that is no finite number, parentheses nested
/// more than 100 deep, a text of more than kLongestText bytes. O(n).
SceneValue evaluate(std::string_view expression, SceneVariables& variables);

/// The value of the longest expression that a text begins with; leaves in `text` what follows it.
SceneValue evaluate_front(std::string_view& text, SceneVariables& variables);

/// A number as evaluate() gives it. Throws InvalidInput for a text; `what` names it in the message.
double number_in(const SceneValue& value, std::string_view what);

/// The text with the value in place of every ${EXPRESSION}; $${ stands for ${. Numbers are written with as
/// many digits as give them back. Throws as evaluate() does, and for a ${ that is not closed.
std::string expanded(std::string_view text, SceneVariables& variables);

/// As it is put into a line: 3, 0.25, oak.
std::string text_of(const SceneValue& value);

/// A letter or _, then letters, digits and _, at most 64, and no word of the language: what variables may be
/// called.
bool is_variable_name(std::string_view name);

inline constexpr std::size_t kLongestText = 4096;  ///< [bytes] of the value of a variable

}  // namespace coppice
