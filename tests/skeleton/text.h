#pragma once

#include <cstring>
#include <string>

#include "errors.h"

namespace coppice::test {

template <class T>
std::string to_bytes(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

}  // namespace coppice::test
