#pragma once

#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "coppice/base/error.h"

namespace coppice::test {

/// The text of the error of type E that `call` throws; a failure when it throws none.
template <class E, class Call>
std::string error_of(Call&& call) {
    try {
        call();
    } catch (const E& error) {
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

template <class T>
std::string bytes_of(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

}  // namespace coppice::test
