#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/cuda/batch/batch_plan_internal.h"
#include "coppice/cuda/batch/joined_jobs_internal.h"
#include "coppice/cuda/batch/quad_tile_internal.h"
#include "coppice/cuda/lists/lists_stages_internal.h"
#include "coppice/cuda/quads/project_field_internal.h"

namespace coppice::cuda {

/// Executes jobs completely: all of them as one if they fit into memory, otherwise in rounds of as many as
/// fit, and a job that does not fit by itself in tiles. Positions are bit-identical for any rounds, except
/// that jobs in tiles are not unfolded: see QuadReport.
template <class Exec>
class QuadRun {
  public:
    /// The executor must outlive this object.
    explicit QuadRun(Exec& exec, const Context& ctx = {}) : exec_(exec), ctx_(ctx) {}

    /// Uploads the jobs, or the first round of them, and starts the work. Jobs and fields must outlive
    /// finish(); they must have the same levels and options, and their fields the same options. Throws
    /// DeviceError if the executor has too little memory; the other functions do as well.
    void begin(std::span<const QuadTask> tasks) {
        clear();
        std::vector<JobBytes> bytes;
        for (const QuadTask& task : tasks) {
            const ConvolutionField& field = *task.field;
            const std::uint64_t entries =
                field.own_lists().segments.size() + field.competitor_lists().segments.size();
            jobs_.push_back(task.job);
            fields_.push_back(&field);
            region_counts_.push_back(field.region_count());
            bytes.push_back({bytes_of_job(task.job), bytes_of_field(field.segments().size(), entries)});
        }
        plan(bytes);
        if (!tasks.empty()) kernel_ = fields_.front()->kernel();
        if (!rounds_.empty()) start();
    }
    /// Starts jobs with fields without regions: first finds the active segments of each region, which waits.
    /// `contacts` has one element for each job. Returns false if this must be done on the CPU because lists
    /// are too long or not all jobs fit at once.
    bool begin(std::span<const QuadJob> jobs, std::span<const ContactInput> contacts) {
        COPPICE_ASSERT(jobs.size() == contacts.size());
        clear();
        jobs_.assign(jobs.begin(), jobs.end());
        std::vector<JobBytes> bytes;
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            const std::uint64_t regions = contacts[i].control.region_node.size();
            const std::uint64_t segments = contacts[i].field.segments().size();
            bytes.push_back({bytes_of_job(jobs[i]), bytes_of_contacts(segments, regions)});
            region_counts_.push_back(static_cast<std::uint32_t>(regions));
        }
        plan(bytes);
        if (rounds_.empty()) return true;
        if (rounds_.back().jobs.size() != jobs.size()) return false;
        kernel_ = contacts.front().field.kernel();
        exec_.reserve(reserved_);
        if (!find_lists(contacts)) return false;
        after_field_ = exec_.mark();
        sent_ = rounds_.front().jobs;
        start();
        return true;
    }

    /// Completes the remaining work and copies the results; `out` has one element for each job.
    std::vector<QuadReport> finish(std::span<const QuadPlaces> out) {
        COPPICE_ASSERT(out.size() == jobs_.size());
        std::vector<QuadReport> reports(jobs_.size());
        for (std::size_t i = 0; i < jobs_.size(); ++i) {
            const std::uint32_t count = refined_counts(jobs_[i].cage, jobs_[i].levels).vertices;
            out[i].positions->resize(count);
            if (out[i].anchors != nullptr) out[i].anchors->resize(count);
        }
        while (!rounds_.empty()) {
            exec_.wait();
            if (rounds_.front().is_tile) {
                collect_tile(out, reports);
            } else {
                collect(out, reports);
            }
            rounds_.pop_front();
            if (!rounds_.empty()) start();
        }
        return reports;
    }

    /// Repeats the work of begin() and finish() with the data on the executor, for measurements: including
    /// normals and quads, but without copying results. Waits. Requires that finish() was called and the jobs
    /// took one round.
    void repeat() {
        COPPICE_ASSERT(stages_.has_value() && round_count_ == 1);
        stages_->make_room();
        const auto before = exec_.mark();
        exec_.replay(recording_, [&] {
            if (contacts_) {
                begin_contacts(exec_, contacts_->tables, contacts_->geometry, contacts_->order,
                               contacts_->lists);
            }
            stages_->refine();
            cuda::project(*stages_, kernel_, field_);
            folds_ = stages_->find_folds();
            stages_->make_normals();
            stages_->make_quads();
        });
        bool has_moved = false;
        for (const UntangleReport& report : cuda::unfold(*stages_, folds_, kernel_, field_))
            has_moved = has_moved || report.moved > 0;
        if (has_moved) stages_->make_normals();
        exec_.wait();
        exec_.rewind(before);
    }

    std::size_t round_count() const { return round_count_; }  ///< number of rounds of the jobs so far

    /// Returns the stages of the last round.
    QuadStages<Exec>& stages() { return *stages_; }

  private:
    // Data from which the lists of a field are computed, if the executor computes them.
    struct Contacts {
        ContactTables tables;
        ContactGeometry geometry;
        std::span<const std::uint32_t> order;
        ListArrays lists;
    };

    void clear() {
        recording_.clear();
        stages_.reset();
        contacts_.reset();
        exec_.reset();
        jobs_.clear();
        fields_.clear();
        region_counts_.clear();
        rounds_.clear();
        sent_ = {};
        round_count_ = 0;
    }

    void plan(std::span<const JobBytes> bytes) {
        bytes_.assign(bytes.begin(), bytes.end());
        const std::uint64_t room = exec_.room();
        const std::vector<BatchRound> rounds = plan_batch(jobs_, bytes, room);
        rounds_.assign(rounds.begin(), rounds.end());
        reserved_ = 0;
        for (const BatchRound& round : rounds) {
            std::uint64_t sum = kSlackBytes;
            for (std::size_t i = round.jobs.begin; i < round.jobs.end; ++i) sum += bytes[i].sum();
            // Tiles use all available memory: one may be larger than the previous one.
            reserved_ = std::max(reserved_, round.is_tile ? room : sum);
        }
    }

    bool find_lists(std::span<const ContactInput> inputs) {
        const ConvolutionField& field = inputs.front().field;
        const ContactTables tables = upload_contacts(exec_, contact_topology(inputs));
        const ContactGeometry geometry = upload_geometry(exec_, inputs);
        const std::span<const std::uint32_t> order = competitor_order(exec_, tables, geometry);
        const ContactsFound found =
            find_contacts(exec_, tables, geometry, order, usual_room(tables.tubes.size()));
        contacts_ = {tables, geometry, order, found.arrays};
        field_ = {geometry.segments, found.lists.own, found.lists.competitors, field.blend(),
                  field.contact()};
        return !found.state.is_cut;
    }

    // Starts the first of the remaining rounds.
    void start() {
        send_fields(rounds_.front().jobs);
        const QuadJob& job = rounds_.front().is_tile ? next_tile() : next_jobs();
        stages_.emplace(exec_, job);
        stages_->refine();
        cuda::project(*stages_, kernel_, field_);
        counts_ = stages_->count_projected();
        if (!rounds_.front().is_tile) folds_ = stages_->find_folds();
        ++round_count_;
    }

    void send_fields(IndexRange jobs) {
        stages_.reset();
        if (jobs.begin == sent_.begin && jobs.end == sent_.end) return exec_.rewind(after_field_);
        exec_.reset();
        exec_.reserve(reserved_);
        field_ = upload_fields(exec_, std::span(fields_).subspan(jobs.begin, jobs.size()));
        after_field_ = exec_.mark();
        sent_ = jobs;
    }

    const QuadJob& next_jobs() {
        const IndexRange jobs = rounds_.front().jobs;
        joined_.emplace(std::span(jobs_).subspan(jobs.begin, jobs.size()),
                        std::span(region_counts_).subspan(jobs.begin, jobs.size()));
        return joined_->job();
    }

    const QuadJob& next_tile() {
        for (;;) {
            const BatchRound round = rounds_.front();
            const QuadJob& whole = jobs_[round.jobs.begin];
            tile_.emplace(whole, round.quads);
            const std::uint64_t needed =
                kSlackBytes + bytes_[round.jobs.begin].field + bytes_of_job(tile_->job());
            if (needed <= reserved_) return tile_->job();
            const auto [half, other_half] = split(round, whole, needed, reserved_);
            rounds_.front() = other_half;
            rounds_.push_front(half);
        }
    }

    void collect(std::span<const QuadPlaces> out, std::vector<QuadReport>& reports) {
        const IndexRange jobs = rounds_.front().jobs;
        const std::vector<ProjectReport> projected = stages_->make_reports(counts_);
        std::vector<UntangleReport> untangled = cuda::unfold(*stages_, folds_, kernel_, field_);
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            const QuadJob& job = jobs_[jobs.begin + i];
            for (std::uint32_t& quad : untangled[i].still_bad)
                quad -= joined_->offsets()[i].faces << (2 * job.levels);
            reports[jobs.begin + i] = {projected[i], std::move(untangled[i])};
        }
        copy_out(stages_->positions(), out.subspan(jobs.begin, jobs.size()), &QuadPlaces::positions);
        copy_out(stages_->anchors(), out.subspan(jobs.begin, jobs.size()), &QuadPlaces::anchors);
    }

    void copy_out(std::span<const Vec3> from, std::span<const QuadPlaces> out,
                  Buffer<Vec3>* QuadPlaces::*which) {
        if (std::ranges::all_of(out, [&](const QuadPlaces& p) { return p.*which == nullptr; })) return;
        if (out.size() == 1) return exec_.download(from, std::span(*(out.front().*which)));
        Buffer<Vec3> all(from.size());
        exec_.download(from, std::span(all));
        parallel_for(ctx_, out.size(), 1, [&](std::size_t i) {
            if (out[i].*which != nullptr) joined_->copy_part(i, all, *(out[i].*which));
        });
    }

    void collect_tile(std::span<const QuadPlaces> out, std::vector<QuadReport>& reports) {
        const std::size_t job = rounds_.front().jobs.begin;
        reports[job].projected += stages_->make_reports(counts_).front();
        reports[job].is_whole = false;
        Buffer<Vec3> points(stages_->counts().vertices);
        const auto put = [&](std::span<const Vec3> from, Buffer<Vec3>* to) {
            if (to == nullptr) return;
            exec_.download(from, std::span(points));
            tile_->put(points, *to);
        };
        put(stages_->positions(), out[job].positions);
        put(stages_->anchors(), out[job].anchors);
    }

    Exec& exec_;
    Context ctx_;
    std::vector<QuadJob> jobs_;
    std::vector<const ConvolutionField*> fields_;  // of the jobs, unless the executor computes the lists
    std::vector<std::uint32_t> region_counts_;     // of the fields of the jobs
    std::vector<JobBytes> bytes_;                  // of the jobs
    std::deque<BatchRound> rounds_;                // remaining rounds, the started one first
    std::size_t round_count_ = 0;
    std::uint64_t reserved_ = 0;
    IndexRange sent_;  // the jobs with fields on the executor
    typename Exec::Mark after_field_{};
    KernelConstants kernel_;
    FieldArrays field_;
    std::optional<Contacts> contacts_;
    std::optional<JoinedJobs> joined_;
    std::optional<QuadTile> tile_;
    std::optional<QuadStages<Exec>> stages_;
    typename QuadStages<Exec>::ProjectionCounts counts_;
    typename QuadStages<Exec>::FoldSearch folds_;
    typename Exec::Recording recording_;
};

}  // namespace coppice::cuda
