#include <fmt/format.h>
#include <stdlib.h>

#include <string>
#include <system_error>

#include "coppice/base/error.h"
#include "coppice/studio/scratch_internal.h"

namespace coppice::studio_internal {

Scratch::~Scratch() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path Scratch::next(std::string_view ending) {
    if (folder_.empty()) {
        std::error_code error;
        std::string name = (std::filesystem::temp_directory_path(error) / "coppice-XXXXXX").string();
        if (error || ::mkdtemp(name.data()) == nullptr)
            throw IoError(fmt::format("cannot create a folder for temporary files: {}", name));
        folder_ = name;
    }
    return folder_ / fmt::format("{}{}", ++count_, ending);
}

}  // namespace coppice::studio_internal
