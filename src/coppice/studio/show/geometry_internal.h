#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/options/json.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/scene/object.h"

namespace coppice {

/// The quantity that the colours of a geometry represent.
enum class StudioColor {
    plain,      ///< none
    radius,     ///< [m] of the branches
    order,      ///< branching order: trunks have 0
    deviation,  ///< [radius] distance of a surface outside the cones of its skeleton
    evidence,   ///< fraction of the radius that is based on measurements: the attribute of that name
};

template <>
struct EnumNames<StudioColor> {
    static constexpr std::array<std::string_view, 5> names{"plain", "radius", "order", "deviation",
                                                           "evidence"};
};

/// The attributes of a geometry besides its arrays.
struct GeometryHead {
    ObjectKind kind = ObjectKind::solid;  ///< of the object
    std::string name;                     ///< of the object
    std::uint64_t version = 0;            ///< of the object
    std::optional<std::uint64_t> seq;     ///< of its preview
};

/// Geometry in the format of docs/library/studio-protocol.md: a header and arrays of numbers.
class GeometryWriter {
  public:
    /// `kind` is that of the protocol: "surface".
    GeometryWriter(std::string_view kind, const GeometryHead& head, Vec3d origin);
    ~GeometryWriter();  ///< releases its memory reservation
    GeometryWriter(const GeometryWriter&) = delete;
    GeometryWriter& operator=(const GeometryWriter&) = delete;

    Json& header();  ///< for additional fields
    /// Adds an array of elements with `size` numbers each.
    void add(std::string_view name, std::span<const float> numbers, std::size_t size);
    void add(std::string_view name, std::span<const std::uint32_t> numbers, std::size_t size);  ///< as above
    void add(std::string_view name, std::span<const std::uint8_t> numbers, std::size_t size);   ///< as above
    void add(std::string_view name, std::span<const std::int8_t> numbers, std::size_t size);    ///< as above
    std::string finish();  ///< returns the encoded bytes; only once

  private:
    void add_bytes(std::string_view name, std::string_view type, std::span<const std::byte> bytes,
                   std::size_t size, std::size_t count);
    struct Body;
    std::unique_ptr<Body> body_;
};

/// Encodes an object for display: solids as a surface with that many cells along the longest side, skeletons
/// as axes, profiles in the plane z = 0. Throws InvalidInput for a colouring that the object does not
/// support; throws as polygonize.
std::string encode_object(const SceneObject& object, const GeometryHead& head, int cells, StudioColor color,
                          const Context& ctx);

/// Encodes the whole of a surface that follows edits. `tree` is its skeleton.
std::string encode_live_surface(const LiveSurface& surface, const SceneObject& tree, const GeometryHead& head,
                                StudioColor color, const Context& ctx);

/// Encodes the changes of such a surface by an edit, relative to version `base`.
std::string encode_patch(const LiveSurface& surface, const SurfaceChange& change, const GeometryHead& head,
                         std::uint64_t base);

/// Returns the minimum and maximum corner of an object; nullopt if it is empty.
std::optional<std::pair<Vec3d, Vec3d>> compute_bounds(const SceneObject& object);

/// The size of an object and its unit.
struct ObjectCount {
    std::uint64_t count;    ///< 0: not counted
    std::string_view unit;  ///< "nodes"
};
ObjectCount count_elements(const SceneObject& object);  ///< O(1)

}  // namespace coppice
