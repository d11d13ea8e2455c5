#include <fmt/format.h>

#include <filesystem>
#include <span>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/scene/bark_images.h"
#include "coppice/studio/session_internal.h"
#include "coppice/system/file.h"
#include "coppice/texture/bark.h"

namespace coppice::studio_internal {
namespace {

namespace fs = std::filesystem;

/// Bark is identified by its content, because a scene that is run again makes it again.
std::uint64_t compute_hash(const BarkMaps& maps) {
    return Hash()
        .add(std::span(maps.color))
        .add(std::span(maps.normal))
        .add(std::span(maps.roughness))
        .add(std::span(maps.occlusion))
        .value();
}

Json offer_bark(Studio& studio, const SurfaceMaterial& material) {
    constexpr std::uint64_t kBytesOfTexel = 3;
    studio.check_size(kBytesOfTexel * material.bark->size(), material.files.name);
    const std::uint64_t hash = compute_hash(*material.bark);
    Json keys = Json::object();
    for (const char* map : {"color", "normal", "roughness", "occlusion"}) {
        const std::string key = fmt::format("bark-{:016x}-{}", hash, map);
        studio.blobs.offer(key, [of = std::weak_ptr(material.bark), map]() -> std::optional<std::string> {
            const auto there = of.lock();
            if (!there) return std::nullopt;
            return encode_bark_map(*there, map);
        });
        keys[map] = key;
    }
    return keys;
}

/// Offers an image in the folder, which is read on request. Its key changes with the file.
std::string offer_file(Studio& studio, const fs::path& file) {
    const std::shared_ptr<const FolderSandbox> sandbox = studio.options.scene.sandbox;
    const std::string name = file.lexically_relative(sandbox->folder()).generic_string();
    const fs::path path = sandbox->to_read(name);
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path, error);
    const fs::file_time_type time = fs::last_write_time(path, error);
    if (error) throw IoError(fmt::format("'{}' cannot be read: {}", name, error.message()));
    studio.check_size(bytes, name);
    const std::uint64_t hash =
        Hash().add(std::span<const char>(name)).add(bytes).add(time.time_since_epoch().count()).value();
    std::string key = fmt::format("image-{:016x}", hash);
    studio.blobs.offer(key, [sandbox, name, bytes]() -> std::optional<std::string> {
        return read_file(sandbox->to_read(name), bytes);
    });
    return key;
}

Json offer_files(Studio& studio, const SurfaceMaterial& material) {
    const auto& files = material.files;
    Json keys = Json::object();
    const auto offer = [&](const char* map, const fs::path& file) {
        if (!file.empty()) keys[map] = offer_file(studio, file);
    };
    offer("color", files.color);
    offer("normal", files.normal);
    offer("roughness", files.roughness);
    offer("occlusion", files.occlusion);
    return keys;
}

/// Offers the images of the materials of a mesh.
Json material(Studio& studio, const Request& request) {
    const ObjectPtr mesh = studio.object(ObjectKind::mesh, request.text("name"));
    return {{"images", offer_images(studio, std::get<Surface>(mesh->value).materials)}};
}

}  // namespace

Json offer_images(Studio& studio, std::span<const SurfaceMaterial> materials) {
    Json images = Json::array();
    for (const SurfaceMaterial& material : materials)
        images.push_back(material.bark ? offer_bark(studio, material) : offer_files(studio, material));
    return images;
}

std::map<std::string, Handler> material_requests() { return {{"material", material}}; }

}  // namespace coppice::studio_internal
