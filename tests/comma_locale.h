#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace coppice::test {

/// Makes streams and the C library write 1.5 as 1,5 and 1000 as 1.000 during its lifetime: streams always,
/// the C library if such a locale is installed.
class CommaLocale {
  public:
    CommaLocale() : streams_(std::locale::global(std::locale(std::locale(), new Punctuation))) {
        for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "de_DE"})
            if (std::setlocale(LC_ALL, name) != nullptr) break;
    }
    ~CommaLocale() {
        std::locale::global(streams_);
        std::setlocale(LC_ALL, "C");
    }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;

  private:
    struct Punctuation : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };
    std::locale streams_;
};

}  // namespace coppice::test
