#pragma once

#include <cstddef>
#include <string>

namespace coppice {

/// Which of `count` models is meant, from 0: `model` counts from 1, and 0 is the only one. Throws
/// InvalidInput saying how many there are where that is none of them.
std::size_t chosen_model(std::size_t count, int model, const std::string& source);

}  // namespace coppice
