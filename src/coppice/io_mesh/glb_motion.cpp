#include "coppice/io_mesh/glb_parts_internal.h"
#include "coppice/io_mesh/motion_internal.h"

namespace coppice::io_internal {
namespace {

using nlohmann::json;

/// Writes a morph target for each frame, the differences from the rest shape; the animation shows them in
/// sequence.
class GlbMotion : public MotionWriter::Format, private GlbMotionPart {
  public:
    GlbMotion(const MeshView& rest, std::size_t frames, double rate)
        : file_(rest.path), rest_(rest), rate_(rate) {
        moved_.reserve(frames);
    }

    void add(std::span<const Vec3> positions, const Context&) override {
        Buffer<Vec3>& moved = moved_.emplace_back(positions.size());
        for (std::size_t v = 0; v < positions.size(); ++v) moved[v] = positions[v] - rest_.positions[v];
    }

    void finish(const Context& ctx) override {
        write_glb(file_, rest_, this, ctx);
        file_.commit();
    }

  private:
    void lay_out(const GlbVertices& vertices, json& primitive, GlbLayout& layout) override {
        json& targets = primitive["targets"] = json::array();
        for (const Buffer<Vec3>& moved : moved_) {
            json target{{"POSITION", layout.add_vectors(divide(moved, vertices))},
                        {"NORMAL", layout.add_vectors(vertices.count())}};
            if (!vertices.tangents.empty()) target["TANGENT"] = layout.add_vectors(vertices.count());
            targets.push_back(std::move(target));
        }
        const std::size_t count = moved_.size();
        times_ = layout.add(count * sizeof(float), 0, kFloat, count, "SCALAR");
        layout[times_]["min"] = json::array({0.0});
        layout[times_]["max"] = json::array({double{get_time(count - 1)}});
        weights_ = layout.add(count * count * sizeof(float), 0, kFloat, count * count, "SCALAR");
    }

    void describe(json& file) const override {
        file["meshes"][0]["weights"] = std::vector<int>(moved_.size(), 0);
        file["animations"] = json::array(
            {{{"name", "motion"},
              {"samplers", {{{"input", times_}, {"output", weights_}, {"interpolation", "LINEAR"}}}},
              {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}});
    }

    void write(AtomicFile& file, const GlbVertices& vertices, const Context& ctx) override {
        const float share = 1 / static_cast<float>(moved_.size());
        std::vector<Vec3> positions(rest_.positions.size());
        MeshView now = rest_;
        now.positions = positions;
        for (std::size_t i = 0; i < moved_.size(); ++i) {
            const float begin = share * static_cast<float>(i), middle = begin + 0.5f * share;
            write_vectors(file, divide(moved_[i], vertices), {begin, middle}, ctx);
            for (std::size_t v = 0; v < positions.size(); ++v)
                positions[v] = rest_.positions[v] + moved_[i][v];
            std::vector<Vec3> turned = divide(smooth_normals(now), vertices);
            const std::vector<Vec3> tangents = turn_tangents(positions, turned, vertices, ctx);
            for (std::size_t v = 0; v < turned.size(); ++v) turned[v] -= vertices.normals[v];
            write_vectors(file, turned, {middle, begin + share}, ctx);
            write_vectors(file, tangents, {begin + share, begin + share}, ctx);
        }
        write_times(file);
    }

    /// Returns vectors of the vertices of the file from those of the surface.
    static std::vector<Vec3> divide(std::span<const Vec3> vectors, const GlbVertices& vertices) {
        if (vertices.split) return split_vectors(vectors, *vertices.split);
        return {vectors.begin(), vectors.end()};
    }

    /// Returns the differences of the tangents from those at rest; none without tangents.
    static std::vector<Vec3> turn_tangents(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                           const GlbVertices& vertices, const Context& ctx) {
        if (vertices.tangents.empty()) return {};
        SplitMesh& split = *vertices.split;
        for (std::size_t v = 0; v < split.positions.size(); ++v)
            split.positions[v] = positions[split.table.vertex[v]];
        std::vector<Vec3> out;
        out.reserve(normals.size());
        for (const Tangent& t : compute_tangents(split, normals, ctx))
            out.push_back(t.direction - vertices.tangents[out.size()].direction);
        return out;
    }

    float get_time(std::size_t frame) const { return static_cast<float>(static_cast<double>(frame) / rate_); }

    void write_times(AtomicFile& file) const {
        std::vector<float> numbers;
        for (std::size_t i = 0; i < moved_.size(); ++i) numbers.push_back(get_time(i));
        file.write(std::as_bytes(std::span(numbers)));
        for (std::size_t i = 0; i < moved_.size(); ++i) {
            numbers.assign(moved_.size(), 0);
            numbers[i] = 1;
            file.write(std::as_bytes(std::span(numbers)));
        }
    }

    AtomicFile file_;
    MeshView rest_;
    double rate_;
    std::vector<Buffer<Vec3>> moved_;      ///< displacements by frame and vertex
    std::size_t times_ = 0, weights_ = 0;  ///< accessors
};

}  // namespace

std::unique_ptr<MotionWriter::Format> glb_motion(const MeshView& rest, std::size_t frames, double rate) {
    return std::make_unique<GlbMotion>(rest, frames, rate);
}

}  // namespace coppice::io_internal
