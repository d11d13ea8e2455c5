#include "coppice/io_mesh/solid_writer.h"

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice {
namespace {

using namespace io_internal;

Vec3d world(const SolidMesh& solid, std::size_t v) { return solid.origin + Vec3d(solid.positions[v]); }

/// Encodes bytes as base64 in groups of three, so that encodings of whole groups can be concatenated.
class Base64 {
  public:
    explicit Base64(Chunk& out) : out_(out) {}
    ~Base64() {
        if (held_ > 0) put(held_);
    }
    Base64(const Base64&) = delete;
    Base64& operator=(const Base64&) = delete;

    template <class T>
    void put_raw(const T& value) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(&value);
        out_.reserve(2 * sizeof value + 8);
        for (std::size_t i = 0; i < sizeof value; ++i) {
            three_[held_++] = bytes[i];
            if (held_ == 3) put(3);
        }
    }

  private:
    void put(std::size_t count) {
        static constexpr std::string_view kDigits =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (std::size_t i = count; i < 3; ++i) three_[i] = 0;
        const unsigned bits = unsigned{three_[0]} << 16 | unsigned{three_[1]} << 8 | three_[2];
        for (std::size_t i = 0; i < 4; ++i) out_.put(i <= count ? kDigits[bits >> (18 - 6 * i) & 63] : '=');
        held_ = 0;
    }

    Chunk& out_;
    std::array<unsigned char, 3> three_{};
    std::size_t held_ = 0;
};

/// Writes a VTU array: its size in bytes, then the items; three items are a whole number of base64 groups.
template <class Put>
void write_array(AtomicFile& file, std::string_view attributes, std::size_t count, std::size_t item_bytes,
                 ProgressRange part, const Context& ctx, const Put& put) {
    file.write(fmt::format("<DataArray {} format=\"binary\">", attributes));
    Chunk header;
    header.reserve(64);
    {
        Base64 text(header);
        text.put_raw(std::uint64_t{count} * item_bytes);
    }
    file.write(header.view());
    constexpr std::size_t kTogether = 3;
    write_items(file, (count + kTogether - 1) / kTogether, part, ctx, [&](std::size_t run, Chunk& chunk) {
        Base64 text(chunk);
        for (std::size_t i = kTogether * run; i < std::min(count, kTogether * (run + 1)); ++i) put(text, i);
    });
    file.write("</DataArray>\n");
}

void write_vtu(AtomicFile& file, const SolidMesh& solid, const Context& ctx) {
    const std::size_t vertices = solid.positions.size(), cells = solid.tetra.size();
    file.write(
        fmt::format("<?xml version=\"1.0\"?>\n"
                    "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
                    "header_type=\"UInt64\">\n<UnstructuredGrid>\n"
                    "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
                    vertices, cells));
    write_array(file, "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"", vertices, 24, {0, 0.4f},
                ctx, [&](Base64& out, std::size_t v) { out.put_raw(world(solid, v)); });
    file.write("</Points>\n<Cells>\n");
    write_array(file, "type=\"Int64\" Name=\"connectivity\"", cells, 32, {0.4f, 0.8f}, ctx,
                [&](Base64& out, std::size_t t) {
                    for (const std::uint32_t v : solid.tetra[t]) out.put_raw(std::int64_t{v});
                });
    write_array(file, "type=\"Int64\" Name=\"offsets\"", cells, 8, {0.8f, 0.95f}, ctx,
                [&](Base64& out, std::size_t t) { out.put_raw(static_cast<std::int64_t>(4 * (t + 1))); });
    constexpr std::uint8_t kTetra = 10;
    write_array(file, "type=\"UInt8\" Name=\"types\"", cells, 1, {0.95f, 1}, ctx,
                [&](Base64& out, std::size_t) { out.put_raw(kTetra); });
    file.write("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
}

template <class... Numbers>
void put_ints(Chunk& chunk, Numbers... numbers) {
    (chunk.put_raw(static_cast<std::int32_t>(numbers)), ...);
}

void write_msh(AtomicFile& file, const SolidMesh& solid, const Context& ctx) {
    const std::size_t vertices = solid.positions.size(), cells = solid.tetra.size();
    if (std::max(vertices, cells) > 0x7fffffff)
        throw Unsupported("Gmsh supports at most 2^31 vertices or tetrahedra; use a longer edge or .vtu");
    const auto write_ints = [&](auto... numbers) {
        Chunk chunk;
        chunk.reserve(64);
        put_ints(chunk, numbers...);
        file.write(chunk.view());
    };
    file.write("$MeshFormat\n2.2 1 8\n");
    write_ints(1);
    file.write(fmt::format("\n$EndMeshFormat\n$Nodes\n{}\n", vertices));
    write_items(file, vertices, {0, 0.5f}, ctx, [&](std::size_t v, Chunk& chunk) {
        chunk.reserve(28);
        put_ints(chunk, v + 1);
        chunk.put_raw(world(solid, v));
    });
    file.write(fmt::format("\n$EndNodes\n$Elements\n{}\n", cells));
    constexpr int kTetra = 4, kTags = 2;
    write_ints(kTetra, cells, kTags);
    write_items(file, cells, {0.5f, 1}, ctx, [&](std::size_t t, Chunk& chunk) {
        chunk.reserve(28);
        put_ints(chunk, t + 1, 1, 1);
        for (const std::uint32_t v : solid.tetra[t]) put_ints(chunk, v + 1);
    });
    file.write("\n$EndElements\n");
}

}  // namespace

std::optional<SolidFormat> solid_format_of_name(const std::filesystem::path& path) {
    if (path.extension() == ".vtu") return SolidFormat::vtu;
    if (path.extension() == ".msh") return SolidFormat::msh;
    return std::nullopt;
}

void write_solid(const std::filesystem::path& path, const SolidMesh& solid, const Context& ctx) {
    const std::optional<SolidFormat> format = solid_format_of_name(path);
    if (!format) {
        throw Unsupported(fmt::format(
            "'{}' is not the name of a tetrahedra file; use the extension .vtu or .msh", path.string()));
    }
    if (solid.tetra.empty()) throw InvalidInput("there are no tetrahedra to write");
    AtomicFile file(path);
    if (*format == SolidFormat::vtu) {
        write_vtu(file, solid, ctx);
    } else {
        write_msh(file, solid, ctx);
    }
    file.commit();
    ctx.report(1);
}

}  // namespace coppice
