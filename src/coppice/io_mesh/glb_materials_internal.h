#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coppice/io_mesh/glb_parts_internal.h"
#include "coppice/io_mesh/material.h"

namespace coppice::io_internal {

/// Materials of a GLB file, with the images, which are part of it.
class GlbMaterials {
  public:
    /// Lays out the images of a material. The files must outlive this object.
    void add(const MaterialFiles& files, GlbLayout& layout);
    /// Appends the materials, images, textures and the sampler to the description of a file; returns the
    /// index of the first material.
    std::size_t describe(nlohmann::json& file) const;
    /// Writes the bytes of the images.
    void write(AtomicFile& file) const;

  private:
    struct Image {
        std::string bytes;
        const char* type;
        std::size_t view = 0;
    };
    void add_image(const MaterialFiles& files, const std::filesystem::path& path, GlbLayout& layout);

    std::vector<const MaterialFiles*> materials_;
    std::vector<Image> images_;
    std::map<std::filesystem::path, std::size_t> index_of_image_;
};

}  // namespace coppice::io_internal
