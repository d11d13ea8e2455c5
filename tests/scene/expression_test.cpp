#include "coppice/scene/script/expression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/error.h"
#include "errors.h"

namespace coppice {
namespace {

SceneVariables some() {
    SceneVariables v;
    v.values["n"] = 3.0;
    v.values["height"] = 2.5;
    v.values["kind"] = std::string("oak");
    return v;
}

double number(const std::string& text) {
    SceneVariables v = some();
    return std::get<double>(evaluate(text, v));
}

std::string refusal(const std::string& text) {
    SceneVariables v = some();
    return test::error_of([&] { evaluate(text, v); });
}

TEST(Expression, OperatorsHaveTheUsualPrecedence) {
    EXPECT_EQ(number("1 + 2 * 3"), 7);
    EXPECT_EQ(number("(1 + 2)*3"), 9);
    EXPECT_EQ(number("2^3^2"), 512);
    EXPECT_EQ(number("-2^2"), -4);
    EXPECT_EQ(number("2^-1"), 0.5);
    EXPECT_EQ(number("7 - 2 - 1"), 4);
    EXPECT_EQ(number("12 / 3 / 2"), 2);
    EXPECT_EQ(number("7 % 3 + n"), 4);
    EXPECT_EQ(number("-1 % 6"), 5);
    EXPECT_EQ(number("1.5e2"), 150);
    EXPECT_EQ(number(".5"), 0.5);
    EXPECT_FALSE(std::signbit(number("0 * -1")));
}

TEST(Expression, EvaluatesComparisonsAndConditions) {
    EXPECT_EQ(number("n >= 3 and not (n > 3)"), 1);
    EXPECT_EQ(number("n < 3 or n != 3"), 0);
    EXPECT_EQ(number("kind == \"oak\""), 1);
    EXPECT_EQ(number("kind == 3"), 0);
    EXPECT_EQ(number("1 <= 1"), 1);
    EXPECT_EQ(number("1 < 1"), 0);
}

TEST(Expression, FunctionsUseDegrees) {
    EXPECT_DOUBLE_EQ(number("sin(30)"), 0.5);
    EXPECT_DOUBLE_EQ(number("atan2(1, -1)"), 135);
    EXPECT_DOUBLE_EQ(number("acos(0)"), 90);
    EXPECT_EQ(number("max(1, n, 2) + min(4)"), 7);
    EXPECT_EQ(number("floor(-0.5) + ceil(0.5) + round(2.4) + abs(-1)"), 3);
    EXPECT_NEAR(number("pi"), 3.14159265358979, 1e-12);
    EXPECT_DOUBLE_EQ(number("exp(log(5))"), 5);
}

TEST(Expression, RandomNumbersFollowTheSeed) {
    SceneVariables a, b, c;
    c.seed = 1;
    bool same = true, other = false;
    for (int i = 0; i < 100; ++i) {
        const double x = std::get<double>(evaluate("random(2, 5)", a));
        EXPECT_GE(x, 2);
        EXPECT_LT(x, 5);
        same = same && x == std::get<double>(evaluate("random(2, 5)", b));
        other = other || x != std::get<double>(evaluate("random(2, 5)", c));
    }
    EXPECT_TRUE(same);
    EXPECT_TRUE(other);
    EXPECT_EQ(a.draws, 100u);
}

TEST(Expression, ExpandsValuesInTexts) {
    SceneVariables v = some();
    EXPECT_EQ(expanded("tree${n}", v), "tree3");
    EXPECT_EQ(expanded("${n/4},0,${ -n }", v), "0.75,0,-3");
    EXPECT_EQ(expanded("${kind}_${kind}.obj", v), "oak_oak.obj");
    EXPECT_EQ(expanded("$5 { } $", v), "$5 { } $");
    EXPECT_EQ(expanded("$${n}", v), "${n}");
    EXPECT_EQ(expanded("${0.1 + 0.2}", v), "0.30000000000000004");  // with all digits
    v.values["dollar"] = std::string("$");
    EXPECT_EQ(expanded("${dollar}${n}", v), "$3");
    EXPECT_EQ(to_text(evaluate("\"a ${kind} of ${n}\"", v)), "a oak of 3");
}

TEST(Expression, ErrorsReportTheFault) {
    EXPECT_EQ(refusal("hieght + 1"), "there is no variable 'hieght'; did you mean height?");
    EXPECT_EQ(refusal("sine(3)"), "there is no function 'sine'; did you mean sin?");
    EXPECT_EQ(refusal("zzz"), "there is no variable 'zzz'");
    EXPECT_EQ(refusal("1 / (n - 3)"), "/ divides by 0");
    EXPECT_EQ(refusal("1 % 0"), "% divides by 0");
    EXPECT_EQ(refusal("sqrt(-1)"), "the result of sqrt is not a finite number");
    EXPECT_EQ(refusal("10^400"), "the result of ^ is not a finite number");
    EXPECT_EQ(refusal("kind + 1"), "+ or - takes numbers, and 'oak' is a text");
    EXPECT_EQ(refusal("min()"), "min takes 1 or more, not 0");
    EXPECT_EQ(refusal("sin(1, 2)"), "sin takes 1, not 2");
    EXPECT_EQ(refusal("1 2"), "'2' follows the expression, where an operator is required");
    EXPECT_EQ(refusal("(1"), "a parenthesis is not closed");
    EXPECT_EQ(refusal("sin(1"), "the parenthesis after sin is not closed");
    EXPECT_EQ(refusal("1 +"), "the expression ends where a number or a name is required");
    EXPECT_EQ(refusal("\"a"), "a quote is not closed");
    EXPECT_EQ(refusal("\"${n\""), "a ${ is not closed by }");
    EXPECT_EQ(refusal("#"), "'#' does not begin a number, name or text");
    EXPECT_EQ(refusal("1..2"), "'..2' follows the expression, where an operator is required");
}

TEST(Expression, LongAndDeepExpressionsTerminate) {
    EXPECT_EQ(refusal(std::string(1 << 20, '(')), "the expression is nested more than 100 deep");
    EXPECT_EQ(refusal(std::string(1 << 20, '-') + "1"), "the expression is nested more than 100 deep");
    std::string calls, sums = "1", powers = "1";
    for (int i = 0; i < 200'000; ++i) {
        calls += "sin(";
        sums += "+1";
        powers += "^1";
    }
    EXPECT_EQ(refusal(calls), "the expression is nested more than 100 deep");
    EXPECT_EQ(refusal(powers), "the expression is nested more than 100 deep");
    EXPECT_EQ(number(sums), 200'001);
    EXPECT_EQ(refusal("\"" + std::string(kLongestText + 1, 'a') + "\""),
              "a text may have at most 4096 bytes");
    EXPECT_EQ(refusal("min(" + std::string(5000, '1') + ")"),
              "'" + std::string(80, '1') + "...' is not a number");
}

TEST(Expression, ChecksNamesOfVariables) {
    for (const char* name : {"n", "_a", "tree_2", "X", "random", "sin"})
        EXPECT_TRUE(is_variable_name(name)) << name;
    for (const char* name : {"", "2a", "a-b", "a.b", "end", "in", "pi", "not"})
        EXPECT_FALSE(is_variable_name(name)) << name;
    EXPECT_FALSE(is_variable_name(std::string(65, 'a')));
}

}  // namespace
}  // namespace coppice
