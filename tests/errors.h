#pragma once

#include <string>

#include "coppice/base/error.h"

namespace coppice::test {

/// Returns the text of the error of type E that `call` throws; "no error" if it throws none.
template <class E = InvalidInput, class Call>
std::string error_of(Call&& call) {
    try {
        call();
    } catch (const E& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace coppice::test
