#pragma once

#include "coppice/cuda/exec/cuda_check.cuh"

namespace coppice::cuda {

/// Launches that a card was told of once, to do them all at one word: a CUDA graph.
class Graph {
  public:
    Graph() = default;
    Graph(const Graph&) = delete;
    Graph& operator=(const Graph&) = delete;
    ~Graph() { clear(); }

    /// Forgets them. None may still be running.
    void clear() {
        if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
        graph_ = nullptr;
    }
    /// Whether there is something to launch.
    bool has_launches() const { return graph_ != nullptr; }
    void launch(cudaStream_t stream) const {
        check(cudaGraphLaunch(graph_, stream), "run again what it ran");
    }

    /// Notes what work() begins in the stream, which does not run now. False where that cannot be.
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
    // Ends with its scope, whatever is thrown there.
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
            cudaGetLastError();  // of an end that came too early
        }
    };
    bool failed() {
        cudaGetLastError();  // it can all be done without
        graph_ = nullptr;
        return false;
    }

    cudaGraphExec_t graph_ = nullptr;
};

}  // namespace coppice::cuda
