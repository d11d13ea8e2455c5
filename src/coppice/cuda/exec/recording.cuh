#pragma once

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice::cuda {

/// A CUDA graph: launches that were recorded once and can be repeated with a single call.
class Graph {
  public:
    Graph() = default;
    Graph(const Graph&) = delete;
    Graph& operator=(const Graph&) = delete;
    ~Graph() { clear(); }

    /// Removes the launches, which must not be running.
    void clear() {
        if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
        graph_ = nullptr;
    }
    /// Returns whether there are launches.
    bool has_launches() const { return graph_ != nullptr; }
    void launch(cudaStream_t stream) const {
        check(cudaGraphLaunch(graph_, stream), "launch a recorded graph");
    }

    /// Records the launches that work() starts in the stream, without running them. Returns false if they
    /// cannot be recorded.
    template <class Work>
    bool record(cudaStream_t stream, const Work& work) {
        clear();
        if (cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal) != cudaSuccess) return failed();
        Capture capture{stream};
        try {
            work();
        } catch (const DeviceError&) {
            return failed();
        }
        const bool is_recorded = capture.end() == cudaSuccess && capture.graph != nullptr &&
                                 cudaGraphInstantiate(&graph_, capture.graph, 0) == cudaSuccess;
        return is_recorded || failed();
    }

  private:
    // Ends with its scope, also after an exception.
    struct Capture {
        cudaStream_t stream;
        cudaGraph_t graph = nullptr;
        bool has_ended = false;

        cudaError_t end() {
            has_ended = true;
            return cudaStreamEndCapture(stream, &graph);
        }
        ~Capture() {
            if (!has_ended) end();
            if (graph != nullptr) cudaGraphDestroy(graph);
            cudaGetLastError();  // of a premature end
        }
    };
    bool failed() {
        cudaGetLastError();  // the work can be done without a recording
        graph_ = nullptr;
        return false;
    }

    cudaGraphExec_t graph_ = nullptr;
};

}  // namespace coppice::cuda
