#include "coppice/scene/drawing.h"

#include <algorithm>

#include "coppice/base/id.h"
#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/scene/drawn_material.h"

namespace coppice {
namespace {

constexpr float kPointSize = 1 / 250.0f;  // [size of the bounding box of the points]
constexpr int kPathSteps = 200;

/// Collects surfaces and balls of all objects relative to the origin of the first one.
class Gatherer {
  public:
    Gatherer(float point_radius, const Context& ctx) : point_radius_(point_radius), ctx_(ctx) {}

    void operator()(const Solid& solid) {
        const SolidField field(solid);
        PolygonizeOptions options;
        const Vec3 size = field.surface_bounds().size();
        options.cell = std::max({size.x, size.y, size.z}) / 128;
        const TriMesh made = polygonize(field, options, ctx_);
        PolygonMesh part;
        part.positions.assign(made.positions.begin(), made.positions.end());
        for (const auto& t : made.triangles) part.add_face(t);
        add(part, {}, {});
    }
    void operator()(const Surface& surface) {
        PolygonMesh part = make_polygons(surface);
        if (!surface.texture.empty()) part.texture = surface.texture;
        if (!surface.texture_blends.empty()) part.texture_blends = surface.texture_blends;
        std::vector<std::uint32_t> materials;
        for (const SurfaceMaterial& material : surface.materials)
            materials.push_back(material.empty() ? kNoIndex : number_material(material));
        add(part, materials, surface.slots);
        if (surface.leaves) add_leaves(*surface.leaves);
    }
    void operator()(const Skeleton& s) {
        const Vec3 shift = compute_shift(s.origin());
        const auto base = static_cast<std::uint32_t>(positions_.size());
        for (const NodeId n : nodes(s)) {
            const NodeId parent = s.parent(n);
            parents_.push_back(parent ? NodeId(base + parent.index()) : NodeId{});
            positions_.push_back(s.position(n) + shift);
            radii_.push_back(s.radius(n));
        }
    }
    void operator()(const PointSet& points) {
        const Vec3 shift = compute_shift(points.origin);
        const float radius = ball_radius(bounds(points));
        for (const Vec3 p : points.positions) add_ball(p + shift, radius, NodeId{});
    }
    void operator()(const Curve& path) {
        const Vec3 shift = compute_shift({});
        const float radius = ball_radius(path.bounds());
        NodeId before;
        for (int i = 0; i <= kPathSteps; ++i) {
            const Vec3 p(path.position(path.at_fraction(static_cast<double>(i) / kPathSteps)));
            before = add_ball(p + shift, radius, before);
        }
    }
    void operator()(const SurfaceMaterial&) {
        throw InvalidInput("a material cannot be drawn; draw a mesh that has it");
    }
    void operator()(const Profile&) {
        throw InvalidInput("a profile cannot be drawn; draw a solid that is made from it");
    }

    std::optional<PolygonMesh> mesh() {
        if (mesh_.face_count() == 0) return {};
        mesh_.origin = origin_.value_or(Vec3d{});
        return std::move(mesh_);
    }
    /// The materials of the meshes, each once, and per face of the mesh the index of its material.
    std::span<const SurfaceMaterial> materials() const { return materials_; }
    std::vector<std::uint32_t> face_materials() {
        return materials_.empty() ? std::vector<std::uint32_t>() : std::move(face_materials_);
    }
    Instances& leaves() {
        leaves_.origin = origin_.value_or(Vec3d{});
        return leaves_;
    }
    std::vector<Prototype>& prototypes() { return prototypes_; }
    std::vector<RenderMaterial>& leaf_materials() { return leaf_materials_; }
    std::optional<Skeleton> skeleton() {
        if (positions_.empty()) return {};
        return Skeleton(std::move(parents_), std::move(positions_), std::move(radii_),
                        origin_.value_or(Vec3d{}));
    }

  private:
    Vec3 compute_shift(Vec3d origin) {
        if (!origin_) origin_ = origin;
        return Vec3(origin - *origin_);
    }
    float ball_radius(const Box3& box) const {
        return point_radius_ > 0 ? point_radius_ : std::max(1e-6f, kPointSize * box.diagonal());
    }
    NodeId add_ball(Vec3 p, float radius, NodeId parent) {
        parents_.push_back(parent);
        positions_.push_back(p);
        radii_.push_back(radius);
        return NodeId(static_cast<std::uint32_t>(positions_.size() - 1));
    }
    std::uint32_t number_material(const SurfaceMaterial& material) {
        const auto found = std::ranges::find_if(materials_, [&](const SurfaceMaterial& m) {
            return m.bark == material.bark && m.files.color == material.files.color;
        });
        const auto index = static_cast<std::uint32_t>(found - materials_.begin());
        if (found == materials_.end()) materials_.push_back(material);
        return index;
    }
    void add_leaves(const SurfaceLeaves& leaves) {
        const Instances& from = leaves.tree.foliage.instances;
        const Vec3 shift = compute_shift(from.origin);
        const auto first = static_cast<std::uint32_t>(prototypes_.size());
        const auto first_material = static_cast<std::uint32_t>(leaf_materials_.size());
        for (const Prototype& p : leaves.tree.prototypes) {
            prototypes_.push_back(p);
            prototypes_.back().material += first_material;
        }
        for (RenderMaterial& material : make_render_materials(leaves))
            leaf_materials_.push_back(std::move(material));
        for (std::size_t i = 0; i < from.size(); ++i) {
            leaves_.prototypes.push_back(first + from.prototypes[i]);
            leaves_.positions.push_back(from.positions[i] + shift);
        }
        leaves_.rotations.insert(leaves_.rotations.end(), from.rotations.begin(), from.rotations.end());
        leaves_.scales.insert(leaves_.scales.end(), from.scales.begin(), from.scales.end());
        leaves_.colors.insert(leaves_.colors.end(), from.colors.begin(), from.colors.end());
    }
    /// Adds a mesh; `materials` are those of its slots, `slots` those of its faces.
    void add(const PolygonMesh& part, std::span<const std::uint32_t> materials,
             std::span<const std::uint32_t> slots) {
        const Vec3 shift = compute_shift(part.origin);
        const auto base = static_cast<std::uint32_t>(mesh_.positions.size());
        for (const Vec3 p : part.positions) mesh_.positions.push_back(p + shift);
        std::vector<std::uint32_t> corners;
        for (std::uint32_t f = 0; f < part.face_count(); ++f) {
            corners.clear();
            for (const std::uint32_t v : part.face(f)) corners.push_back(base + v);
            mesh_.add_face(corners);
            const std::uint32_t slot = slots.empty() ? 0 : slots[f];
            face_materials_.push_back(slot < materials.size() ? materials[slot] : kNoIndex);
        }
        mesh_.texture.insert(mesh_.texture.end(), part.texture.begin(), part.texture.end());
        mesh_.texture.resize(mesh_.corners.size(), TexturePoint{});  // without coordinates: no material
        if (part.texture_blends.empty() && mesh_.texture_blends.empty()) return;
        mesh_.texture_blends.resize(mesh_.corners.size() - part.corners.size(), TextureBlend{});
        mesh_.texture_blends.insert(mesh_.texture_blends.end(), part.texture_blends.begin(),
                                    part.texture_blends.end());
        mesh_.texture_blends.resize(mesh_.corners.size(), TextureBlend{});
    }

    float point_radius_;
    const Context& ctx_;
    std::optional<Vec3d> origin_;
    PolygonMesh mesh_;
    std::vector<std::uint32_t> face_materials_;
    std::vector<SurfaceMaterial> materials_;
    std::vector<NodeId> parents_;
    std::vector<Vec3> positions_;
    std::vector<float> radii_;
    Instances leaves_;
    std::vector<Prototype> prototypes_;
    std::vector<RenderMaterial> leaf_materials_;
};

}  // namespace

Drawing::Drawing(std::span<const ObjectPtr> objects, float point_radius, const SceneCall& call) {
    Context quiet = call.context();
    quiet.progress = nullptr;  // progress is reported for the image
    Gatherer gatherer(point_radius, quiet);
    constexpr double kBytesOfSurface = 5e7;  // of a solid at the resolution of images
    double bytes = 0;
    for (const ObjectPtr& object : objects) {
        bytes += 4.0 * static_cast<double>(object->bytes);
        if (object->kind() == ObjectKind::solid) bytes += kBytesOfSurface;
    }
    call.reserve(bytes);
    for (const ObjectPtr& object : objects) std::visit(gatherer, object->value);
    mesh_ = gatherer.mesh();
    skeleton_ = gatherer.skeleton();
    face_materials_ = gatherer.face_materials();
    leaves_ = std::move(gatherer.leaves());
    prototypes_ = std::move(gatherer.prototypes());
    leaf_materials_ = std::move(gatherer.leaf_materials());
    load_materials(gatherer.materials(), call, quiet);
}

void Drawing::load_materials(std::span<const SurfaceMaterial> materials, const SceneCall& call,
                             const Context& ctx) {
    double pixels = 0;
    for (const SurfaceMaterial& material : materials) {
        if (material.bark)
            call.reserve(kBytesOfDrawnTexel * (pixels + static_cast<double>(material.bark->size())));
        materials_.push_back(load_render_material(material, ctx));
        pixels += static_cast<double>(materials_.back().color.pixels.size());
        call.reserve(kBytesOfDrawnTexel * pixels);
    }
}

}  // namespace coppice
