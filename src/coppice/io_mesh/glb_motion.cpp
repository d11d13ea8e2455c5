#include "coppice/io_mesh/glb_parts_internal.h"
#include "coppice/io_mesh/motion_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

/// Writes a morph target for each frame, the differences from the rest shape; the animation shows them in
/// sequence.
class GlbMotion : public MotionWriter::Format {
  public:
    GlbMotion(const std::filesystem::path& path, const QuadMesh& rest, std::size_t frames, double rate)
        : file_(path), rest_(rest), rate_(rate) {
        moved_.reserve(frames);
    }

    void add(std::span<const Vec3> positions, const Context&) override {
        Buffer<Vec3>& moved = moved_.emplace_back(positions.size());
        for (std::size_t v = 0; v < positions.size(); ++v) moved[v] = positions[v] - rest_.positions[v];
    }

    void finish(const Context& ctx) override {
        const MeshView mesh(rest_);
        const std::vector<Vec3> normals = smooth_normals(mesh);
        GlbLayout layout;
        const std::string text = described(mesh, layout).dump();
        write_glb_head(file_, text, layout.bytes());
        write_vectors(file_, mesh.positions, {0, 0.05f}, ctx);
        write_vectors(file_, normals, {0.05f, 0.1f}, ctx);
        write_triangles(file_, mesh, {0.1f, 0.15f}, ctx);
        const float share = 0.8f / static_cast<float>(moved_.size());
        QuadMesh now = rest_;
        for (std::size_t i = 0; i < moved_.size(); ++i) {
            const float begin = 0.15f + share * static_cast<float>(i);
            write_vectors(file_, moved_[i], {begin, begin + 0.5f * share}, ctx);
            for (std::size_t v = 0; v < now.positions.size(); ++v)
                now.positions[v] = rest_.positions[v] + moved_[i][v];
            std::vector<Vec3> turned = smooth_normals(MeshView(now));
            for (std::size_t v = 0; v < turned.size(); ++v) turned[v] -= normals[v];
            write_vectors(file_, turned, {begin + 0.5f * share, begin + share}, ctx);
        }
        write_times();
        file_.commit();
    }

  private:
    json described(const MeshView& mesh, GlbLayout& layout) const {
        const std::size_t count = moved_.size(), vertices = mesh.positions.size();
        const std::size_t positions = layout.add_vectors(mesh.positions);
        const std::size_t normals = layout.add_vectors(vertices);
        const std::uint64_t corners = 3 * mesh.triangle_count();
        const std::size_t indices =
            layout.add(corners * sizeof(std::uint32_t), kElementArrayBuffer, kUnsignedInt, corners, "SCALAR");
        json targets = json::array();
        for (const Buffer<Vec3>& moved : moved_) {
            const std::size_t place = layout.add_vectors(moved);
            targets.push_back({{"POSITION", place}, {"NORMAL", layout.add_vectors(vertices)}});
        }
        const std::size_t times = layout.add(count * sizeof(float), 0, kFloat, count, "SCALAR");
        layout[times]["min"] = json::array({0.0});
        layout[times]["max"] = json::array({double{get_time(count - 1)}});
        const std::size_t weights =
            layout.add(count * count * sizeof(float), 0, kFloat, count * count, "SCALAR");
        json out = describe_tree(mesh,
                                 {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                                  {"indices", indices},
                                  {"targets", targets}},
                                 layout);
        out["meshes"][0]["weights"] = std::vector<int>(count, 0);
        out["animations"] = json::array(
            {{{"name", "motion"},
              {"samplers", {{{"input", times}, {"output", weights}, {"interpolation", "LINEAR"}}}},
              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}});
        return out;
    }

    float get_time(std::size_t frame) const { return static_cast<float>(static_cast<double>(frame) / rate_); }

    void write_times() {
        std::vector<float> numbers;
        for (std::size_t i = 0; i < moved_.size(); ++i) numbers.push_back(get_time(i));
        file_.write(std::as_bytes(std::span(numbers)));
        for (std::size_t i = 0; i < moved_.size(); ++i) {
            numbers.assign(moved_.size(), 0);
            numbers[i] = 1;
            file_.write(std::as_bytes(std::span(numbers)));
        }
    }

    AtomicFile file_;
    const QuadMesh& rest_;
    double rate_;
    std::vector<Buffer<Vec3>> moved_;  ///< displacements by frame and vertex
};

}  // namespace

std::unique_ptr<MotionWriter::Format> glb_motion(const std::filesystem::path& path, const QuadMesh& rest,
                                                 std::size_t frames, double rate) {
    return std::make_unique<GlbMotion>(path, rest, frames, rate);
}

}  // namespace coppice::io_internal
