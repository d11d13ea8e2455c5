#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"
#include "coppice/mesh/vertex_attribute.h"
#include "coppice/scene/surface_leaves.h"

namespace coppice::cli {

/// A surface in memory, as a command made it.
struct HeldSurface {
    std::variant<QuadMesh, TriMesh, PolygonMesh> mesh;
    Buffer<TexturePoint> texture = {};                 ///< one per corner; empty without coordinates
    Buffer<TextureBlend> blends = {};                  ///< the second set; one per corner, or empty
    std::vector<VertexAttribute> attributes = {};      ///< values of the vertices
    std::vector<std::uint32_t> slots = {};             ///< MaterialSlot of each face as a number, or empty
    std::shared_ptr<const SurfaceLeaves> leaves = {};  ///< null without leaves
};

/// An immutable object in memory that commands use like a file; the text is that of a scene, or the bytes of
/// an image.
using HeldObject = std::variant<std::shared_ptr<const SkeletonFile>, std::shared_ptr<const HeldSurface>,
                                std::shared_ptr<const PointFile>, std::shared_ptr<const std::string>>;

/// Objects in the memory of a program that calls the library, by the names that commands use for them.
class HeldObjects {
  public:
    /// Returns whether a name is that of an object: "memory:" and a file name; its extension selects the
    /// kind of an output.
    static bool is_name(const std::filesystem::path& path) { return path.native().starts_with("memory:"); }

    /// Stores an object under a name; replaces another one.
    void put(const std::filesystem::path& name, HeldObject object) {
        objects_.insert_or_assign(name.native(), std::move(object));
    }
    /// Returns the object of a name; null if there is none.
    const HeldObject* find(const std::filesystem::path& name) const {
        const auto found = objects_.find(name.native());
        return found == objects_.end() ? nullptr : &found->second;
    }

  private:
    std::map<std::string, HeldObject> objects_;
};

}  // namespace coppice::cli
