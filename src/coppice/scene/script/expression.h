#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>

namespace coppice {

/// Value of a scene variable: a number or a text.
using SceneValue = std::variant<double, std::string>;

/// The variables of a scene and the state of its random numbers.
struct SceneVariables {
    std::map<std::string, SceneValue, std::less<>> values;  ///< by name
    int seed = 0;                                           ///< seed of random(); >= 0
    std::uint64_t draws = 0;  ///< number of calls of random() since the seed was set
};

/// Evaluates an expression: numbers with + - * / % ^, comparisons, and, or, not, parentheses, functions
/// (angles in degrees), names of variables, and texts in double quotes; see docs/user/scenes.md. True is 1,
/// false is 0. random() increments `variables.draws`.
///
/// Throws InvalidInput with a sentence without the location: for an unknown name (with the closest one), a
/// syntax error, a text instead of a number, a result that is not finite, more than 100 nested parentheses,
/// or a text of more than kLongestText bytes. O(n).
SceneValue evaluate(std::string_view expression, SceneVariables& variables);

/// Evaluates the longest expression at the beginning of a text; leaves the remaining characters in `text`.
SceneValue evaluate_front(std::string_view& text, SceneVariables& variables);

/// Returns the number of a value. Throws InvalidInput for a text; `subject` names it in the message.
double number_in(const SceneValue& value, std::string_view subject);

/// Replaces every ${EXPRESSION} by its value; $${ is replaced by ${. Numbers are written with enough digits
/// to restore them exactly. Throws as evaluate() does, and for a ${ that is not closed.
std::string expanded(std::string_view text, SceneVariables& variables);

/// Returns the text of a value in a line: 3, 0.25, oak.
std::string to_text(const SceneValue& value);

/// Returns whether a variable may have this name: a letter or _, then letters, digits and _, at most 64, and
/// not a keyword.
bool is_variable_name(std::string_view name);

inline constexpr std::size_t kLongestText = 4096;  ///< [bytes] maximum length of the value of a variable

}  // namespace coppice
