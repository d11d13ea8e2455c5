#include "coppice/scene/script/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/base/random.h"
#include "coppice/options/quantity.h"
#include "coppice/options/spelling.h"

namespace coppice {
namespace {

constexpr int kDeepest = 100;
constexpr std::size_t kLongestName = 64;
constexpr std::uint64_t kRandomStage = 71;  // separates the sequence from those of the commands
constexpr double kDegree = std::numbers::pi / 180;

constexpr std::array<std::string_view, 12> kReserved{"let",  "for", "in",  "step", "repeat", "if",
                                                     "else", "end", "and", "or",   "not",    "pi"};

using Numbers = std::span<const double>;

/// A function of numbers.
struct Function {
    std::string_view name;
    std::size_t least, most;  // minimum and maximum number of arguments
    double (*value)(Numbers);
};

constexpr std::size_t kAny = 1000;
constexpr std::array<Function, 16> kFunctions{{
    {"sin", 1, 1, [](Numbers x) { return std::sin(x[0] * kDegree); }},
    {"cos", 1, 1, [](Numbers x) { return std::cos(x[0] * kDegree); }},
    {"tan", 1, 1, [](Numbers x) { return std::tan(x[0] * kDegree); }},
    {"asin", 1, 1, [](Numbers x) { return std::asin(x[0]) / kDegree; }},
    {"acos", 1, 1, [](Numbers x) { return std::acos(x[0]) / kDegree; }},
    {"atan", 1, 1, [](Numbers x) { return std::atan(x[0]) / kDegree; }},
    {"atan2", 2, 2, [](Numbers x) { return std::atan2(x[0], x[1]) / kDegree; }},
    {"sqrt", 1, 1, [](Numbers x) { return std::sqrt(x[0]); }},
    {"exp", 1, 1, [](Numbers x) { return std::exp(x[0]); }},
    {"log", 1, 1, [](Numbers x) { return std::log(x[0]); }},
    {"abs", 1, 1, [](Numbers x) { return std::abs(x[0]); }},
    {"floor", 1, 1, [](Numbers x) { return std::floor(x[0]); }},
    {"ceil", 1, 1, [](Numbers x) { return std::ceil(x[0]); }},
    {"round", 1, 1, [](Numbers x) { return std::round(x[0]); }},
    {"min", 1, kAny, [](Numbers x) { return *std::ranges::min_element(x); }},
    {"max", 1, kAny, [](Numbers x) { return *std::ranges::max_element(x); }},
}};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool starts_name(char c) { return is_letter(c) || c == '_'; }

double finite(double value, std::string_view of) {
    if (!std::isfinite(value)) throw InvalidInput(fmt::format("the result of {} is not a finite number", of));
    return value == 0 ? 0 : value;  // removes the sign of -0
}

/// Returns the remainder with the sign of the divisor, so that -1 % 6 is 5.
double modulo(double a, double b) { return a - b * std::floor(a / b); }

/// Recursive-descent parser that evaluates an expression.
class Evaluation {
  public:
    Evaluation(std::string_view text, SceneVariables& variables) : rest_(text), variables_(variables) {}

    SceneValue value() { return either(); }
    std::string_view rest() {
        skip_blanks();
        return rest_;
    }

  private:
    /// Counts nested levels, because each uses some of the stack.
    class Level {
      public:
        explicit Level(int& depth) : depth_(depth) {
            if (++depth_ > kDeepest) {
                --depth_;
                throw InvalidInput(fmt::format("the expression is nested more than {} deep", kDeepest));
            }
        }
        ~Level() { --depth_; }
        Level(const Level&) = delete;
        Level& operator=(const Level&) = delete;

      private:
        int& depth_;
    };

    SceneValue either() {
        const Level level(depth_);
        SceneValue left = both();
        while (takes_word("or")) {
            const bool a = number_in(left, "or") != 0, b = number_in(both(), "or") != 0;
            left = a || b ? 1.0 : 0.0;
        }
        return left;
    }

    SceneValue both() {
        SceneValue left = comparison();
        while (takes_word("and")) {
            const bool a = number_in(left, "and") != 0, b = number_in(comparison(), "and") != 0;
            left = a && b ? 1.0 : 0.0;
        }
        return left;
    }

    SceneValue comparison() {
        SceneValue left = sum();
        for (const std::string_view sign : {"==", "!=", "<=", ">=", "<", ">"}) {
            if (!takes(sign)) continue;
            const SceneValue right = sum();
            if (sign == "==" || sign == "!=") return (left == right) == (sign == "==") ? 1.0 : 0.0;
            const double a = number_in(left, sign), b = number_in(right, sign);
            const bool less = sign[0] == '<';
            const bool holds = a == b ? sign.size() == 2 : (less ? a < b : a > b);
            return holds ? 1.0 : 0.0;
        }
        return left;
    }

    SceneValue sum() {
        SceneValue left = product();
        for (;;) {
            const char sign = take_any("+-");
            if (sign == 0) return left;
            const double a = number_in(left, "+ or -"), b = number_in(product(), "+ or -");
            left = finite(sign == '+' ? a + b : a - b, "the sum");
        }
    }

    SceneValue product() {
        SceneValue left = signed_value();
        for (;;) {
            const char sign = take_any("*/%");
            if (sign == 0) return left;
            const std::string_view subject(&sign, 1);
            const double a = number_in(left, subject), b = number_in(signed_value(), subject);
            if (sign != '*' && b == 0) throw InvalidInput(fmt::format("{} divides by 0", subject));
            if (sign == '%') {
                left = finite(modulo(a, b), subject);
            } else {
                left = finite(sign == '*' ? a * b : a / b, subject);
            }
        }
    }

    SceneValue signed_value() {
        const Level level(depth_);
        if (takes_word("not")) return number_in(signed_value(), "not") == 0 ? 1.0 : 0.0;
        if (takes("-")) return finite(-number_in(signed_value(), "-"), "-");
        if (takes("+")) return number_in(signed_value(), "+");
        return power();
    }

    SceneValue power() {
        SceneValue base = single();
        if (!takes("^")) return base;
        const double a = number_in(base, "^"), b = number_in(signed_value(), "^");
        return finite(std::pow(a, b), "^");
    }

    SceneValue single() {
        skip_blanks();
        if (rest_.empty()) throw InvalidInput("the expression ends where a number or a name is required");
        const char c = rest_.front();
        if (is_digit(c) || c == '.') return number();
        if (starts_name(c)) return named();
        if (c == '"') return quoted();
        if (takes("(")) {
            SceneValue inner = either();
            if (!takes(")")) throw InvalidInput("a parenthesis is not closed");
            return inner;
        }
        throw InvalidInput(fmt::format("{} does not begin a number, name or text", quote(rest_)));
    }

    SceneValue number() {
        std::size_t end = digits_from(0);
        // 1..8 is a range, not 1. and .8
        if (end < rest_.size() && rest_[end] == '.' && !rest_.substr(end).starts_with(".."))
            end = digits_from(end + 1);
        if (end < rest_.size() && (rest_[end] == 'e' || rest_[end] == 'E')) {
            std::size_t exponent = end + 1;
            if (exponent < rest_.size() && (rest_[exponent] == '+' || rest_[exponent] == '-')) ++exponent;
            if (digits_from(exponent) > exponent) end = digits_from(exponent);
        }
        const std::string_view word = rest_.substr(0, end);
        const auto value = parse_finite(word);
        if (!value) throw InvalidInput(fmt::format("{} is not a number", quote(word.empty() ? rest_ : word)));
        rest_.remove_prefix(end);
        return *value;
    }

    SceneValue named() {
        const std::string name(taken_name());
        skip_blanks();
        if (rest_.starts_with("(")) return call(name);
        if (name == "pi") return std::numbers::pi;
        if (const auto found = variables_.values.find(name); found != variables_.values.end())
            return found->second;
        std::vector<std::string> known;
        for (const auto& [other, value] : variables_.values) known.push_back(other);
        throw InvalidInput(fmt::format("there is no variable {}{}", quote(name), did_you_mean(name, known)));
    }

    SceneValue call(const std::string& name) {
        const Level level(depth_);
        const std::vector<double> values = arguments(name);
        if (name == "random") return drawn(values);
        const auto found = std::ranges::find(kFunctions, name, &Function::name);
        if (found == kFunctions.end()) {
            std::vector<std::string> known{"random"};
            for (const Function& f : kFunctions) known.emplace_back(f.name);
            throw InvalidInput(
                fmt::format("there is no function {}{}", quote(name), did_you_mean(name, known)));
        }
        if (values.size() < found->least || values.size() > found->most) {
            throw InvalidInput(fmt::format("{} takes {}{}, not {}", name, found->least,
                                           found->most > found->least ? " or more" : "", values.size()));
        }
        return finite(found->value(values), name);
    }

    std::vector<double> arguments(const std::string& name) {
        takes("(");
        std::vector<double> values;
        if (takes(")")) return values;
        do {
            values.push_back(number_in(either(), name));
            if (values.size() > kAny) throw InvalidInput(fmt::format("{} takes {} at most", name, kAny));
        } while (takes(","));
        if (!takes(")")) throw InvalidInput(fmt::format("the parenthesis after {} is not closed", name));
        return values;
    }

    SceneValue drawn(Numbers bounds) {
        if (bounds.size() != 2) {
            throw InvalidInput(fmt::format(
                "random takes 2 numbers, the minimum and the upper bound, as in random(0, 1), not {}",
                bounds.size()));
        }
        const CounterRandom random(static_cast<std::uint64_t>(variables_.seed), kRandomStage);
        return finite(random.uniform(variables_.draws++, bounds[0], bounds[1]), "random");
    }

    SceneValue quoted() {
        std::string text;
        std::size_t at = 1;
        for (; at < rest_.size() && rest_[at] != '"'; ++at) {
            const bool escaped =
                rest_[at] == '\\' && at + 1 < rest_.size() && (rest_[at + 1] == '"' || rest_[at + 1] == '\\');
            if (escaped) ++at;
            text += rest_[at];
        }
        if (at >= rest_.size()) throw InvalidInput("a quote is not closed");
        rest_.remove_prefix(at + 1);
        const Level level(depth_);
        text = expanded(text, variables_);
        if (text.size() > kLongestText)
            throw InvalidInput(fmt::format("a text may have at most {} bytes", kLongestText));
        return text;
    }

    void skip_blanks() {
        while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
    }
    std::size_t digits_from(std::size_t at) const {
        while (at < rest_.size() && is_digit(rest_[at])) ++at;
        return at;
    }
    std::string_view taken_name() {
        std::size_t end = 0;
        while (end < rest_.size() && (starts_name(rest_[end]) || is_digit(rest_[end]))) ++end;
        const std::string_view name = rest_.substr(0, end);
        rest_.remove_prefix(end);
        return name;
    }
    bool takes(std::string_view sign) {
        skip_blanks();
        if (!rest_.starts_with(sign)) return false;
        rest_.remove_prefix(sign.size());
        return true;
    }
    /// Reads one of the characters; returns 0 if none follows.
    char take_any(std::string_view signs) {
        skip_blanks();
        if (rest_.empty() || signs.find(rest_.front()) == signs.npos) return 0;
        const char sign = rest_.front();
        rest_.remove_prefix(1);
        return sign;
    }
    bool takes_word(std::string_view word) {
        skip_blanks();
        if (!rest_.starts_with(word)) return false;
        const std::string_view after = rest_.substr(word.size());
        if (!after.empty() && (starts_name(after.front()) || is_digit(after.front()))) return false;
        rest_ = after;
        return true;
    }

    std::string_view rest_;
    SceneVariables& variables_;
    int depth_ = 0;
};

}  // namespace

SceneValue evaluate_front(std::string_view& text, SceneVariables& variables) {
    Evaluation evaluation(text, variables);
    SceneValue value = evaluation.value();
    text = evaluation.rest();
    return value;
}

SceneValue evaluate(std::string_view expression, SceneVariables& variables) {
    std::string_view rest = expression;
    SceneValue value = evaluate_front(rest, variables);
    if (!rest.empty()) {
        throw InvalidInput(
            fmt::format("{} follows the expression, where an operator is required", quote(rest)));
    }
    return value;
}

double number_in(const SceneValue& value, std::string_view subject) {
    if (const double* number = std::get_if<double>(&value)) return *number;
    throw InvalidInput(
        fmt::format("{} takes numbers, and {} is a text", subject, quote(std::get<std::string>(value))));
}

std::string to_text(const SceneValue& value) {
    if (const double* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
    return std::get<std::string>(value);
}

std::string expanded(std::string_view text, SceneVariables& variables) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t open = std::min(text.find("${", at), text.size());
        out += text.substr(at, open - at);
        if (open == text.size()) break;
        if (open > at && text[open - 1] == '$') {
            out += '{';
            at = open + 2;
            continue;
        }
        const std::size_t close = text.find('}', open);
        if (close == text.npos) throw InvalidInput("a ${ is not closed by }");
        out += to_text(evaluate(text.substr(open + 2, close - open - 2), variables));
        at = close + 1;
    }
    return out;
}

bool is_variable_name(std::string_view name) {
    const auto inside = [](char c) { return starts_name(c) || is_digit(c); };
    return !name.empty() && name.size() <= kLongestName && starts_name(name.front()) &&
           std::ranges::all_of(name, inside) && std::ranges::find(kReserved, name) == kReserved.end();
}

}  // namespace coppice
