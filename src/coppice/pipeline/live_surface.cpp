#include "coppice/pipeline/live_surface.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/pipeline/live/affected_internal.h"
#include "coppice/pipeline/live/edit_zone_internal.h"
#include "coppice/pipeline/live/patch_store_internal.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/skeleton/prepare.h"

namespace coppice {
namespace {

using namespace pipeline_internal;

constexpr std::uint8_t kFirstTrusted = 2;  // Initial number of trusted levels,
constexpr std::uint8_t kMoreTrusted = 3;   // and the increment when they were not sufficient.
constexpr int kAttempts = 3;

MeshOptions checked(const MeshOptions& options) {
    check_fields(options, "mesh");
    if (options.method != MeshMethod::quads && options.method != MeshMethod::bmesh)
        throw InvalidInput("mesh: method must be quads or bmesh for a surface that follows edits");
    if (options.field.weights != Weights::local)
        throw InvalidInput("mesh: weights must be local for a surface that follows edits");
    if (options.fit == Fit::volume)
        throw InvalidInput("mesh: fit must not be volume for a surface that follows edits");
    if (options.overlaps == Overlaps::apart)
        throw InvalidInput(
            "mesh: overlaps must not be apart for a surface that follows edits; bend trees "
            "apart by an edit instead, as with: apart all");
    return options.method == MeshMethod::bmesh ? on_metaballs(options) : options;
}

// The surface of a tree, or of a part of a tree, divided into patches.
struct Traced {
    SurfacePatches patches;
    bool is_local;  // whether the result at each location is independent of distant ones
};

// `refined(part)` is called with the surface before it is remeshed; it returns per node whether to remesh
// there.
template <class Refined>
Traced trace(const Skeleton& tree, const MeshOptions& options, const Context& ctx, const Refined& refined) {
    std::vector<std::pair<std::string, double>> seconds;
    Stages stages(ctx, seconds);
    const PrepareResult prepared = prepare(tree, options.prepare);
    check_branches(prepared.skeleton);
    const auto find_patches = [&](const QuadMesh& mesh, const QuadBuild& build) {
        return take_apart(mesh, build, prepared.new_of_old, prepared.skeleton);
    };
    SurfacePatches patches;
    const auto wanted_tubes = [&](const QuadMesh& mesh, const QuadBuild& build) {
        patches = find_patches(mesh, build);
        const std::vector<std::uint8_t> wanted = refined(patches);
        std::vector<std::uint8_t> out;
        for (const NodeId n : patches.node) out.push_back(wanted[n.index()]);
        return out;
    };
    const BuiltQuads built =
        mesh_by_quads(prepared.skeleton, PointSet{}, options, {.wanted = wanted_tubes}, ctx, stages);
    const RemeshTrace& remeshed = built.build.remeshed;
    if (!remeshed.repair_patches.empty()) patches = find_patches(built.surface.mesh, built.build);
    // If the number of inserted nodes would be very large, segments are split less everywhere.
    const bool is_local = remeshed.is_local && prepared.report.resample.inserted <= tree.size();
    return {std::move(patches), is_local};
}

}  // namespace

class LiveSurface::State {
  public:
    State(const Skeleton& tree, const MeshOptions& options, const Context& ctx)
        : options_(checked(options)), tree_(tree) {
        make_whole(tree, ctx);
    }

    SurfaceChange update(const Skeleton& now, std::span<const StableId> changed, const Context& ctx) {
        if (changed.empty()) return {};
        std::optional<SurfaceChange> change;
        if (is_local_ && !store_.is_sparse()) change = update_part(now, changed, ctx);
        if (!change) change = make_whole(now, ctx);
        tree_ = now;
        return *change;
    }

    const PatchStore& store() const { return store_; }
    const Skeleton& tree() const { return tree_; }

  private:
    SurfaceChange make_whole(const Skeleton& now, const Context& ctx) {
        std::vector<std::uint8_t> all(now.size(), 1);
        const Traced whole = trace(now, options_, ctx, [&](const SurfacePatches&) { return all; });
        PatchStore store;
        store.merge({now, whole.patches, all, all}, {});
        store_ = std::move(store);
        is_local_ = whole.is_local;
        const auto range = [](std::size_t count) {
            return std::vector<NumberRange>{{0, static_cast<std::uint32_t>(count)}};
        };
        return {true, range(store_.positions().size()), range(store_.quads().size()), now.size()};
    }

    // Returns nullopt if the whole surface has to be built.
    std::optional<SurfaceChange> update_part(const Skeleton& now, std::span<const StableId> changed,
                                             const Context& ctx) {
        const NodeIndex at_before(tree_), at_now(now);
        const Touched touched = touched_by(changed, tree_, at_before, now, at_now);
        std::vector<StableId> removed;
        std::ranges::copy_if(changed, std::back_inserter(removed),
                             [&](StableId id) { return at_before[id] && !at_now[id]; });
        std::ranges::sort(removed);
        std::uint8_t trusted = kFirstTrusted;
        Touched seeds = touched;
        for (int attempt = 0; attempt < kAttempts; ++attempt) {
            const std::optional<EditZone> zone = edit_zone(now, seeds, trusted, ctx);
            if (!zone) return {};
            const Tried tried = update_zone(*zone, trusted, touched, removed, ctx);
            if (tried.change || tried.is_hopeless) return tried.change;
            for (const StableId id : tried.missing) {
                if (at_now[id]) seeds.nodes.push_back(at_now[id]);
            }
            if (tried.missing.empty()) trusted += kMoreTrusted;
        }
        return {};
    }

    struct Tried {
        std::optional<SurfaceChange> change;  // none if it continues beyond the zone
        bool is_hopeless = false;             // independent of the zone
        std::vector<StableId> missing;        // number of levels that the zone should have trusted, if known
    };

    Tried update_zone(const EditZone& zone, std::uint8_t trusted, const Touched& touched,
                      std::span<const StableId> removed, const Context& ctx) {
        const Skeleton& part = zone.part;
        std::vector<std::uint8_t> is_trusted;
        for (const std::uint8_t level : zone.level) is_trusted.push_back(level <= trusted ? 1 : 0);
        bool goes_on = false;
        AffectedNodes affected;
        const auto refined = [&](const SurfacePatches& patches) {
            std::vector<NodeId> changed;
            for (const NodeId n : nodes(part)) {
                if (is_trusted[n.index()] == 0 || !store_.differs({part, patches, {}, {}}, n)) continue;
                goes_on |= zone.level[n.index()] == trusted;
                changed.push_back(n);
            }
            if (!goes_on) affected = affected_nodes(zone, trusted, changed, touched, store_, ctx);
            const bool is_hopeless = goes_on || !affected.missing.empty();
            return is_hopeless ? std::vector<std::uint8_t>(part.size(), 0) : affected.is_wanted;
        };
        const Traced made = trace(part, options_, ctx, refined);
        if (!made.is_local) return {.is_hopeless = true};
        if (goes_on || !affected.missing.empty()) return {.missing = std::move(affected.missing)};
        Merged merged = store_.merge({part, made.patches, affected.is_wanted, is_trusted}, removed);
        if (!merged.change) return {.missing = std::move(merged.missing)};
        merged.change->meshed = part.size();
        return {.change = std::move(merged.change)};
    }

    MeshOptions options_;
    Skeleton tree_;
    PatchStore store_;
    bool is_local_ = false;
};

LiveSurface::LiveSurface(const Skeleton& tree, const MeshOptions& options, const Context& ctx)
    : state_(std::make_unique<State>(tree, options, ctx)) {}
LiveSurface::~LiveSurface() = default;
LiveSurface::LiveSurface(LiveSurface&&) noexcept = default;
LiveSurface& LiveSurface::operator=(LiveSurface&&) noexcept = default;

SurfaceChange LiveSurface::update(const Skeleton& now, std::span<const StableId> changed,
                                  const Context& ctx) {
    return state_->update(now, changed, ctx);
}

std::span<const Vec3> LiveSurface::positions() const { return state_->store().positions(); }
std::span<const Quad> LiveSurface::quads() const { return state_->store().quads(); }
Vec3d LiveSurface::origin() const { return state_->tree().origin(); }

QuadMesh LiveSurface::mesh() const {
    QuadMesh out = state_->store().compact();
    out.origin = origin();
    return out;
}

}  // namespace coppice
