#include "coppice/render/trace/traced_scene_internal.h"

#include <algorithm>
#include <array>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"

namespace coppice {
namespace {

constexpr double kMaxSize = 1e15;  // [m] beyond it squares of floats overflow
constexpr std::size_t kGrain = 65536;
constexpr std::size_t kMaxPoints = 4'000'000;  // maximum number of drawn points
constexpr float kMinRadius = 1e-6f;            // of balls, relative to the diagonal

struct Box3d {
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    void extend(Vec3d p, double radius) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k] - radius);
            high[k] = std::max(high[k], p[k] + radius);
        }
    }
};

struct Ball {
    Vec3 center;
    float radius;
};
static_assert(sizeof(Ball) == 16);

/// Segments as cones; degenerate cones (zero length, one end inside the other, a single node) as balls.
struct Tubes {
    std::vector<Ball> cones;  ///< two per cone
    std::vector<Ball> balls;
    std::vector<std::uint32_t> cone_nodes, ball_nodes;  ///< their nodes

    void add(Ball a, Ball b, NodeId node) {
        if (distance(a.center, b.center) <= std::abs(a.radius - b.radius) * 1.0001f + 1e-9f) {
            add(a.radius > b.radius ? a : b, node);
        } else {
            cones.push_back(a);
            cones.push_back(b);
            cone_nodes.push_back(node.index());
        }
    }
    void add(Ball ball, NodeId node) {
        balls.push_back(ball);
        ball_nodes.push_back(node.index());
    }
};

void attach(RTCScene scene, RTCDevice device, RTCGeometryType type, const std::vector<Ball>& balls) {
    if (balls.empty()) return;
    const EmbreeGeometry geometry(rtcNewGeometry(device, type));
    std::ranges::copy(balls, new_embree_buffer<Ball>(geometry.get(), RTC_BUFFER_TYPE_VERTEX,
                                                     RTC_FORMAT_FLOAT4, balls.size())
                                 .begin());
    if (type == RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE) {
        const auto first = new_embree_buffer<std::uint32_t>(geometry.get(), RTC_BUFFER_TYPE_INDEX,
                                                            RTC_FORMAT_UINT, balls.size() / 2);
        for (std::size_t i = 0; i < first.size(); ++i) first[i] = static_cast<std::uint32_t>(2 * i);
    }
    attach_geometry(scene, geometry.get());
}

}  // namespace

TracedScene::TracedScene(const RenderScene& scene, const RenderOptions& options, const Context& ctx)
    : deviation_(scene.deviation),
      evidence_(scene.evidence),
      distance_to_(scene.distance_to),
      node_colors_(scene.skeleton_colors) {
    for (const Rgb color : scene.mesh_colors) vertex_colors_.push_back(to_linear(color));
    const bool inside = scene.mesh != nullptr || scene.cloud != nullptr;
    const float skeleton_width = inside ? options.axis_width : 1;
    if (scene.cloud != nullptr) {
        cloud_size_ = scene.cloud->points.size();
        point_count_ = std::min(cloud_size_, kMaxPoints);
        point_colors_ = scene.cloud->colors;
    }
    place(scene, skeleton_width, ctx);
    device_ = new_embree_device(ctx);
    solid_.reset(rtcNewScene(device_.get()));
    if (scene.mesh != nullptr) build_mesh(scene, options.flat, ctx);
    if (point_count_ > 0) {
        attach_points(solid_.get(), scene);
        kinds_.push_back(GeometryKind::points);
    }
    if (scene.skeleton != nullptr && inside) {
        axis_.reset(rtcNewScene(device_.get()));
        attach_tubes(axis_.get(), *scene.skeleton, skeleton_width);
        commit_scene(device_.get(), axis_.get(), ctx);
    } else if (scene.skeleton != nullptr) {
        attach_tubes(solid_.get(), *scene.skeleton, skeleton_width);
        kinds_.assign(tube_nodes_.size(), GeometryKind::tubes);
    }
    if (scene.instances != nullptr) build_copies(scene, options.flat, ctx);
    commit_scene(device_.get(), solid_.get(), ctx);
    collect_frame_points(scene, skeleton_width);
}

/// Includes the axis inside a mesh with its drawn width, so that the ground touches the mesh.
void TracedScene::place(const RenderScene& scene, float skeleton_width, const Context& ctx) {
    Box3d box;
    if (scene.mesh != nullptr) {
        for (const std::uint32_t v : scene.mesh->corners) {
            box.extend(Vec3d(scene.mesh->positions[v]) + scene.mesh->origin, 0);
        }
    }
    for (std::size_t k = 0; k < point_count_; ++k)
        box.extend(scene.cloud->points.world(drawn_point(k)), double{scene.point_radius});
    if (scene.skeleton != nullptr) {
        for (const NodeId n : nodes(*scene.skeleton)) {
            box.extend(Vec3d(scene.skeleton->position(n)) + scene.skeleton->origin(),
                       skeleton_width * scene.skeleton->radius(n));
        }
    }
    if (scene.instances != nullptr) {
        const Box3 copies = compute_bounds(scene.prototypes, *scene.instances, ctx);
        for (const Vec3 corner : {copies.low, copies.high})
            box.extend(Vec3d(corner) + scene.instances->origin, 0);
    }
    if (!scene.framed.empty()) {
        box = {};
        for (const Vec3d& p : scene.framed) box.extend(p, 0);
    }
    const double size = distance(box.low, box.high);
    if (!(size < kMaxSize))
        throw InvalidInput("render: the object is larger than 1e15 m; check its coordinates");
    center_ = 0.5 * (box.low + box.high);
    scale_ = size > 0 ? 1 / size : 1;
    const Vec3d half = 0.5 * scale_ * (box.high - box.low);
    bounds_.extend(Vec3(half));
    bounds_.extend(-Vec3(half));
}

void TracedScene::build_mesh(const RenderScene& scene, bool flat, const Context& ctx) {
    const PolygonMesh& mesh = *scene.mesh;
    std::vector<Vec3> positions;
    positions.reserve(mesh.positions.size());
    for (const Vec3 p : mesh.positions) positions.push_back(local(p, mesh.origin));
    mesh_.set_faces(mesh, std::move(positions));
    if (!flat) mesh_.smooth_normals();
    mesh_material_count_ = static_cast<std::uint32_t>(scene.materials.size());
    if (!scene.materials.empty()) mesh_.set_texture(mesh, scene.face_materials, scene.materials);
    attach_geometry(solid_.get(), mesh_.make_geometry(device_.get(), mesh_.quads(), ctx).get());
    kinds_.push_back(GeometryKind::mesh);
    if (scene.marked_faces.empty()) return;
    std::vector<std::uint32_t> faces(scene.marked_faces.begin(), scene.marked_faces.end());
    sort_unique(faces);
    std::vector<Quad> marked;
    for (const std::uint32_t f : faces) {
        const auto quads = mesh_.quads_of(f);
        marked.insert(marked.end(), quads.begin(), quads.end());
    }
    marked_.reset(rtcNewScene(device_.get()));
    attach_geometry(marked_.get(), mesh_.make_geometry(device_.get(), marked, ctx).get());
    commit_scene(device_.get(), marked_.get(), ctx);
}

void TracedScene::build_copies(const RenderScene& scene, bool flat, const Context& ctx) {
    const Instances& instances = *scene.instances;
    std::vector<Vec3> positions(instances.size());
    parallel_for(ctx, positions.size(), kGrain,
                 [&](std::size_t i) { positions[i] = local(instances.positions[i], instances.origin); });
    copies_ = std::make_unique<TracedCopies>(scene.prototypes, scene.prototype_materials, instances,
                                             positions, static_cast<float>(scale_), flat, device_.get(), ctx);
    copies_->attach(solid_.get(), device_.get());
    kinds_.push_back(GeometryKind::copies);
}

void TracedScene::collect_frame_points(const RenderScene& scene, float skeleton_width) {
    if (!scene.framed.empty()) {
        for (const Vec3d& p : scene.framed) frame_points_.push_back({local(p)});
        return;
    }
    if (scene.mesh != nullptr) {
        const auto& positions = mesh_.positions();
        std::vector<bool> used(positions.size());
        for (const std::uint32_t v : scene.mesh->corners) used[v] = true;
        for (std::size_t v = 0; v < used.size(); ++v) {
            if (used[v]) frame_points_.push_back({positions[v]});
        }
    }
    for (std::size_t k = 0; k < point_count_; ++k) {
        frame_points_.push_back(
            {local(scene.cloud->points.world(drawn_point(k))), local_length(scene.point_radius)});
    }
    if (scene.instances != nullptr) collect_frame_balls(scene);
    if (scene.skeleton == nullptr) return;
    const Skeleton& s = *scene.skeleton;
    for (const NodeId n : nodes(s)) {
        frame_points_.push_back(
            {local(s.position(n), s.origin()), static_cast<float>(skeleton_width * s.radius(n) * scale_)});
    }
}

/// Adds a ball around each copy.
void TracedScene::collect_frame_balls(const RenderScene& scene) {
    const Instances& instances = *scene.instances;
    std::vector<Box3> boxes(scene.prototypes.size());
    for (std::size_t p = 0; p < boxes.size(); ++p)
        for (const Vec3 v : scene.prototypes[p].mesh.positions) boxes[p].extend(v);
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const Box3& box = boxes[instances.prototypes[i]];
        frame_points_.push_back({local(instances.place(i, box.center()), instances.origin),
                                 local_length(0.5 * double{instances.scales[i] * box.diagonal()})});
    }
}

void TracedScene::attach_points(RTCScene scene, const RenderScene& of) {
    std::vector<Ball> balls;
    balls.reserve(point_count_);
    const float radius = std::max(kMinRadius, local_length(of.point_radius));
    for (std::size_t k = 0; k < point_count_; ++k)
        balls.push_back({local(of.cloud->points.world(drawn_point(k))), radius});
    attach(scene, device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT, balls);
}

void TracedScene::attach_tubes(RTCScene scene, const Skeleton& s, float width) {
    const auto ball = [&](Vec3 p, float radius) {
        return Ball{local(p, s.origin()), std::max(kMinRadius, static_cast<float>(width * radius * scale_))};
    };
    Tubes tubes;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) {
            const Segment g = s.segment(n);
            tubes.add(ball(g.a, g.radius_a), ball(g.b, g.radius_b), n);
        } else if (s.is_tip(n)) {
            tubes.add(ball(s.position(n), s.radius(n)), n);
        }
    }
    attach(scene, device_.get(), RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, tubes.cones);
    attach(scene, device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT, tubes.balls);
    // Geometries without elements are not attached.
    for (auto* part_nodes : {&tubes.cone_nodes, &tubes.ball_nodes})
        if (!part_nodes->empty()) tube_nodes_.push_back(std::move(*part_nodes));
}

std::optional<Hit> TracedScene::trace(Vec3 origin, Vec3 direction) const {
    return trace(solid_.get(), origin, direction);
}

std::optional<Hit> TracedScene::trace_axis(Vec3 origin, Vec3 direction) const {
    return trace(axis_.get(), origin, direction);
}

std::optional<Hit> TracedScene::trace_marked(Vec3 origin, Vec3 direction) const {
    return trace(marked_.get(), origin, direction);
}

std::optional<Hit> TracedScene::trace(RTCScene scene, Vec3 origin, Vec3 direction) const {
    const RTCRayHit r = cast_ray(scene, origin, direction);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    Hit hit;
    hit.distance = r.ray.tfar;
    hit.position = origin + direction * hit.distance;
    hit.geometric_normal = normalized(Vec3{r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z}, -direction);
    const bool is_solid = scene == solid_.get();
    hit.on_mesh = is_solid && kinds_[r.hit.geomID] == GeometryKind::mesh;
    if (is_solid && kinds_[r.hit.geomID] == GeometryKind::points) hit.point = r.hit.primID;
    if (scene == axis_.get() || (is_solid && kinds_[r.hit.geomID] == GeometryKind::tubes))
        hit.node = tube_nodes_[r.hit.geomID][r.hit.primID];
    if (is_solid && kinds_[r.hit.geomID] == GeometryKind::copies) {
        hit.copy = r.hit.instID[0];
        hit.geometric_normal = copies_->turned(*hit.copy, hit.geometric_normal);
    }
    hit.place = {r.hit.primID, r.hit.u, r.hit.v};
    if (dot(hit.geometric_normal, direction) > 0) hit.geometric_normal = -hit.geometric_normal;
    hit.normal = hit.geometric_normal;
    hit.lifted = hit.position;
    smooth(hit);
    return hit;
}

/// Interpolates the normals of the vertices, if there are any.
void TracedScene::smooth(Hit& hit) const {
    const auto set_normal = [&](Vec3 normal) {
        const Vec3 smooth = normalized(normal, hit.geometric_normal);
        const float side = dot(smooth, hit.geometric_normal) < 0 ? -1.0f : 1.0f;
        hit.normal = smooth * side;
        return side;
    };
    if (hit.on_mesh && mesh_.has_normals())
        hit.lifted = mesh_.lifted(hit.place, hit.position, set_normal(mesh_.normal(hit.place)));
    if (!hit.copy) return;
    const TracedMesh& prototype = copies_->prototype(*hit.copy);
    if (prototype.has_normals()) set_normal(copies_->turned(*hit.copy, prototype.normal(hit.place)));
}

bool TracedScene::occluded(Vec3 origin, Vec3 direction, float far) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay r{};
    r.org_x = origin.x, r.org_y = origin.y, r.org_z = origin.z;
    r.dir_x = direction.x, r.dir_y = direction.y, r.dir_z = direction.z;
    r.tfar = far;
    r.mask = ~0u;
    rtcOccluded1(solid_.get(), &context, &r);
    return r.tfar < 0;
}

float TracedScene::deviation(const Hit& hit) const { return mesh_.blend(hit.place, deviation_); }

std::optional<Vec3> TracedScene::object_color(const Hit& hit) const {
    if (hit.on_mesh && !vertex_colors_.empty())
        return mesh_.blend(hit.place, std::span<const Vec3>(vertex_colors_));
    if (hit.node && !node_colors_.empty()) return to_linear(node_colors_[*hit.node]);
    return std::nullopt;
}

std::optional<TexturePlaces> TracedScene::texture_places(const Hit& hit) const {
    if (hit.on_mesh) return mesh_.texture_places(hit.place);
    if (!hit.copy) return std::nullopt;
    TexturePlaces out = copies_->texture_places(*hit.copy, hit.place);
    out.material += mesh_material_count_;
    return out;
}

double TracedScene::distance_to_other(const Hit& hit) const {
    // More accurate than hit.position, which is rounded in proportion to the distance of the camera.
    const Vec3d p(mesh_.blend(hit.place, std::span(mesh_.positions())));
    return distance_to_->signed_distance(p / scale_ + (center_ - distance_to_->mesh().origin));
}

SketchView TracedScene::local(SketchView view) const {
    // scale (R X + t) = R (scale (X - center)) + scale (R center + t), and the image of a perspective camera
    // does not depend on the scale.
    view.t = (view.r * center_ + view.t) * scale_;
    if (view.projection == Projection::orthographic)
        for (const std::size_t row : {std::size_t{0}, std::size_t{1}})
            for (const std::size_t column : {std::size_t{0}, std::size_t{1}}) view.k[row][column] /= scale_;
    return view;
}

}  // namespace coppice
