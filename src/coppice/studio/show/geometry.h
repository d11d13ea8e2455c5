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
#include "coppice/pipeline/json.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/scene/object.h"

namespace coppice {

/// What the colours of a geometry stand for.
enum class StudioColor {
    plain,      ///< nothing
    radius,     ///< [m] of the wood
    order,      ///< of branching: trunks have 0
    deviation,  ///< [radius] of a surface outside the cones of its skeleton
    evidence,   ///< share of measures in the radius: the attribute of that name
};

template <>
struct EnumNames<StudioColor> {
    static constexpr std::array<std::string_view, 5> names{"plain", "radius", "order", "deviation",
                                                           "evidence"};
};

/// What is said of a geometry besides its arrays.
struct GeometryHead {
    ObjectKind kind = ObjectKind::solid;  ///< of the object
    std::string name;                     ///< of the object
    std::uint64_t version = 0;            ///< of the object
    std::optional<std::uint64_t> seq;     ///< of the preview that it belongs to
};

/// Geometry in the form of docs/library/studio-protocol.md: a header and arrays of numbers.
class GeometryWriter {
  public:
    /// `kind` is that of the protocol: "surface".
    GeometryWriter(std::string_view kind, const GeometryHead& head, Vec3d origin);
    ~GeometryWriter();  ///< gives its memory back
    GeometryWriter(const GeometryWriter&) = delete;
    GeometryWriter& operator=(const GeometryWriter&) = delete;

    Json& header();  ///< for what else is to stand there
    /// Adds an array of elements of `size` numbers each.
    void add(std::string_view name, std::span<const float> numbers, std::size_t size);
    void add(std::string_view name, std::span<const std::uint32_t> numbers, std::size_t size);  ///< as above
    void add(std::string_view name, std::span<const std::uint8_t> numbers, std::size_t size);   ///< as above
    void add(std::string_view name, std::span<const std::int8_t> numbers, std::size_t size);    ///< as above
    std::string finish();  ///< all of it; once

  private:
    void add_bytes(std::string_view name, std::string_view type, std::span<const std::byte> bytes,
                   std::size_t size, std::size_t count);
    struct Body;
    std::unique_ptr<Body> body_;
};

/// An object as it is seen: solids as a surface of cells that are so many to the longest side, skeletons as
/// axes, profiles lie in the plane z = 0. Throws InvalidInput for a colour that the object has not; what
/// polygonize throws.
std::string encode_object(const SceneObject& object, const GeometryHead& head, int cells, StudioColor color,
                          const Context& ctx);

/// The whole of a surface that follows edits. `tree` is the skeleton that it is of.
std::string encode_live_surface(const LiveSurface& surface, const SceneObject& tree, const GeometryHead& head,
                                StudioColor color, const Context& ctx);

/// What of such a surface an edit changed, in place of that of version `base`.
std::string encode_patch(const LiveSurface& surface, const SurfaceChange& change, const GeometryHead& head,
                         std::uint64_t base);

/// The least and the greatest corner of an object in the scene; none where it holds nothing.
std::optional<std::pair<Vec3d, Vec3d>> bounds_of(const SceneObject& object);

/// How large an object is, and in what.
struct ObjectCount {
    std::uint64_t count;    ///< 0: not counted
    std::string_view unit;  ///< "nodes"
};
ObjectCount count_of(const SceneObject& object);  ///< O(1)

}  // namespace coppice
