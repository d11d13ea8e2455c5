#pragma once

#include <cstddef>
#include <string>

namespace coppice {

/// Returns the index of the selected one of `count` models: `model` counts from 1, and 0 selects the only
/// one. Throws InvalidInput with the number of models if `model` does not select one.
std::size_t chosen_model(std::size_t count, int model, const std::string& source);

}  // namespace coppice
